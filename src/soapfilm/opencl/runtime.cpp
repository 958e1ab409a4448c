#include "soapfilm/opencl/runtime.h"

#include <fmt/core.h>

#include <algorithm>
#include <vector>

#include "soapfilm/error.h"

namespace soapfilm {

namespace {

std::string text_of(cl_device_id device, cl_device_info what) {
  size_t bytes = 0;
  if (clGetDeviceInfo(device, what, 0, nullptr, &bytes) != CL_SUCCESS || bytes == 0) return {};
  std::string text(bytes, '\0');
  if (clGetDeviceInfo(device, what, bytes, text.data(), nullptr) != CL_SUCCESS) return {};
  text.resize(text.find('\0'));
  return text;
}

template <class T>
T value_of(cl_device_id device, cl_device_info what) {
  T value{};
  return clGetDeviceInfo(device, what, sizeof(value), &value, nullptr) == CL_SUCCESS ? value : T{};
}

/// Of all platforms, graphics processors first.
std::vector<cl_device_id> all_devices() {
  cl_uint count = 0;
  std::vector<cl_device_id> devices;
  if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS || count == 0) return devices;
  std::vector<cl_platform_id> platforms(count);
  if (clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS) return devices;
  for (const cl_platform_id platform : platforms) {
    cl_uint more = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &more) != CL_SUCCESS || more == 0) continue;
    std::vector<cl_device_id> of_platform(more);
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, more, of_platform.data(), nullptr) != CL_SUCCESS) continue;
    devices.insert(devices.end(), of_platform.begin(), of_platform.end());
  }
  std::stable_partition(devices.begin(), devices.end(), [](cl_device_id device) {
    return (value_of<cl_device_type>(device, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) != 0;
  });
  return devices;
}

cl_device_id find_device(const std::string& name) {
  const std::vector<cl_device_id> devices = all_devices();
  if (devices.empty()) throw ParameterError("OpenCL: this machine has no platform with a device");
  const auto found = std::find_if(devices.begin(), devices.end(), [&](cl_device_id device) {
    return text_of(device, CL_DEVICE_NAME).find(name) != std::string::npos;
  });
  if (found == devices.end())
    throw ParameterError(fmt::format("OpenCL device = '{}': none of {} has it in its name, the first is '{}'", name,
                                     devices.size(), text_of(devices.front(), CL_DEVICE_NAME)));
  return *found;
}

/// Other devices would give other bits.
void check_rounding(cl_device_id device, const std::string& name) {
  constexpr cl_device_fp_config needed =
      CL_FP_ROUND_TO_NEAREST | CL_FP_DENORM | CL_FP_INF_NAN | CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  if ((value_of<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG) & needed) != needed)
    throw ParameterError(
        fmt::format("OpenCL device '{}' does not round floats as the CPU does: quotients, roots, denormals", name));
}

/// The first line with a word in it, of many.
std::string first_line(const std::string& log) {
  const size_t begin = log.find_first_not_of(" \t\r\n");
  if (begin == std::string::npos) return "it does not say why";
  return log.substr(begin, log.find_first_of("\r\n", begin) - begin);
}

ClProgram compile(const ClRuntime& runtime, const char* source) {
  cl_int code = CL_SUCCESS;
  ClProgram program(clCreateProgramWithSource(runtime.context.get(), 1, &source, nullptr, &code));
  runtime.check(code, "clCreateProgramWithSource");
  code = clBuildProgram(program.get(), 1, &runtime.device, "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt",
                        nullptr, nullptr);
  if (code == CL_SUCCESS) return program;
  std::string log;
  size_t bytes = 0;
  if (clGetProgramBuildInfo(program.get(), runtime.device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &bytes) == CL_SUCCESS) {
    log.resize(bytes);
    clGetProgramBuildInfo(program.get(), runtime.device, CL_PROGRAM_BUILD_LOG, bytes, log.data(), nullptr);
    log.resize(std::min(log.find('\0'), log.size()));
  }
  throw ParameterError(fmt::format("OpenCL device '{}' does not compile the kernels (error {}): {}", runtime.name, code,
                                   first_line(log)));
}

}  // namespace

void ClRuntime::check(cl_int code, const char* call) const {
  if (code == CL_SUCCESS) return;
  if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES || code == CL_OUT_OF_HOST_MEMORY ||
      code == CL_INVALID_BUFFER_SIZE)
    throw MemoryError(fmt::format("OpenCL device '{}' is out of memory: {} gives error {}", name, call, code));
  throw ParameterError(fmt::format("OpenCL device '{}': {} gives error {}", name, call, code));
}

ClRuntime open_runtime(const std::string& name, const char* source) {
  ClRuntime runtime;
  runtime.device = find_device(name);
  runtime.name = text_of(runtime.device, CL_DEVICE_NAME);
  check_rounding(runtime.device, runtime.name);
  runtime.most_bytes = value_of<cl_ulong>(runtime.device, CL_DEVICE_GLOBAL_MEM_SIZE);
  runtime.most_bytes_of_buffer = value_of<cl_ulong>(runtime.device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  cl_int code = CL_SUCCESS;
  runtime.context.reset(clCreateContext(nullptr, 1, &runtime.device, nullptr, nullptr, &code));
  runtime.check(code, "clCreateContext");
  runtime.program = compile(runtime, source);
  return runtime;
}

}  // namespace soapfilm
