// The solve on an OpenCL device, by the same bits as on the CPU. Built with SOAPFILM_OPENCL alone.
#pragma once

#include <memory>
#include <string>

#include "soapfilm/device/device.h"

namespace soapfilm {

/// The first device whose name contains `name`, graphics processors before others. Throws ParameterError, in one line,
/// where there is none or it cannot run the kernels. A level that does not fit into its memory is a MemoryError of
/// Device::on(). `most_bytes`: memory that a level may take, 0: all that the device has.
std::shared_ptr<const Device> opencl_device(const std::string& name = {}, size_t most_bytes = 0);

}  // namespace soapfilm
