#include "soapfilm/opencl/device.h"

#include <gtest/gtest.h>

#include "soapfilm/error.h"
#include "soapfilm/opencl/runtime.h"
#include "support/device_laws.h"

namespace soapfilm {
namespace TEST_FILE {

using namespace test;

template <class Error, class Function>
void expect_one_line(Function&& function, const std::string& part) {
  try {
    function();
    FAIL() << "no error";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

TEST(OpenCl, GivesTheCpusBitsOnRandomLevels) { expect_same_sweeps_on_random_levels(opencl_device(), 20, 90); }

TEST(OpenCl, GivesTheCpusBitsInAWholeSolve) {
  const auto device = opencl_device();
  for (const char* shape : {"knot", "part"}) expect_same_solution(device, shape, 64);
}

TEST(OpenCl, RefusesADeviceThatIsNotThere) {
  expect_one_line<ParameterError>([] { opencl_device("no such device"); }, "'no such device'");
}

TEST(OpenCl, RefusesALevelThatDoesNotFit) {
  RandomLevel random(6);
  const Context cpu(1);
  const auto device = opencl_device({}, 100000);
  expect_one_line<MemoryError>([&] { device->on(random.level, cpu); }, "choose a lower resolution");
}

TEST(OpenCl, SaysWhatItsCompilerSays) {
  expect_one_line<ParameterError>([] { open_runtime({}, "__kernel void primal() { not_declared = 1; }"); },
                                  "does not compile the kernels");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
