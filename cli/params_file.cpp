#include "cli/params_file.h"

#include <fmt/format.h>

#include "soapfilm/error.h"
#include "soapfilm/io/bytes/byte_source.h"

namespace soapfilm::cli {

ReconstructParams read_params(const std::string& path) {
  constexpr size_t longest = size_t{64} << 20;
  const io::ByteSource file(path);
  if (file.bytes().size() > longest)
    throw InputError(fmt::format("{}: over 64 MiB, no parameters are that long", path));
  try {
    return params_from_json(std::string(file.bytes()));
  } catch (const ParameterError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace soapfilm::cli
