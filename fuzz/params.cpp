// Reads the input as parameters in JSON: refused with one line, or written and read again to the same text. With the
// argument --defaults: prints all parameters, a file to begin with.
#include "soapfilm/params.h"

#include <cstring>

#include "fuzz/fuzzer.h"
#include "soapfilm/error.h"

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc == 2 && std::strcmp((*argv)[1], "--defaults") == 0) {
    std::fputs(soapfilm::to_json(soapfilm::ReconstructParams{}).c_str(), stdout);
    std::fflush(stdout);
    std::_Exit(0);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace soapfilm;
  ReconstructParams params;
  try {
    params = params_from_json(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const ParameterError& error) {
    fuzz::require_one_line(error.what());
    return 0;
  }
  const std::string written = to_json(params);
  fuzz::require(to_json(params_from_json(written)) == written, "written parameters read back as they are: " + written);
  return 0;
}
