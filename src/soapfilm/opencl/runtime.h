// What the OpenCL device uses of OpenCL: handles that release themselves, errors of one line, a compiled program.
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <cstddef>
#include <memory>
#include <string>

namespace soapfilm {

template <auto release>
struct ClRelease {
  template <class T>
  void operator()(T* handle) const {
    release(handle);
  }
};
using ClContext = std::unique_ptr<_cl_context, ClRelease<clReleaseContext>>;
using ClProgram = std::unique_ptr<_cl_program, ClRelease<clReleaseProgram>>;
using ClKernel = std::unique_ptr<_cl_kernel, ClRelease<clReleaseKernel>>;
using ClQueue = std::unique_ptr<_cl_command_queue, ClRelease<clReleaseCommandQueue>>;
using ClBuffer = std::unique_ptr<_cl_mem, ClRelease<clReleaseMemObject>>;

/// A program on a device. Solvers on several threads may share it; each has its own queue and kernels.
struct ClRuntime {
  std::string name;  ///< of the device
  cl_device_id device = nullptr;
  ClContext context;
  ClProgram program;
  size_t most_bytes = 0;            ///< of all buffers
  size_t most_bytes_of_buffer = 0;  ///< of one

  /// Throws MemoryError or ParameterError for a code other than CL_SUCCESS, by the name of the call.
  void check(cl_int code, const char* call) const;
};

/// Compiles `source` for the first device whose name contains `name`, graphics processors before others. Throws
/// ParameterError, in one line: there is none, it does not round as the CPU does, or its compiler refuses.
ClRuntime open_runtime(const std::string& name, const char* source);

}  // namespace soapfilm
