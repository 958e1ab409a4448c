#include "cli/params_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "soapfilm/core/error.h"
#include "soapfilm/io/byte_source.h"

namespace soapfilm::cli {

ReconstructParams read_params(const std::string& path) {
  constexpr size_t longest = size_t{64} << 20;
  const io::ByteSource file(path);
  if (file.bytes().size() > longest)
    throw InputError(fmt::format("{}: over 64 MiB, no parameters are that long", path));
  const std::string text(file.bytes());
  try {
    const auto json = nlohmann::ordered_json::parse(text);
    const bool report = json.is_object() && json.contains("parameters");
    return params_from_json(report ? json["parameters"].dump() : text);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(fmt::format("{}: not JSON: {}", path, error.what()));
  } catch (const ParameterError& error) {
    throw InputError(fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace soapfilm::cli
