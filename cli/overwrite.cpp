#include "cli/overwrite.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

#include "soapfilm/error.h"

namespace soapfilm::cli {

namespace {

/// The path of a file that exists or not, links resolved.
std::filesystem::path place_of(const std::string& path) {
  std::error_code error;
  // Absolute first: a relative path whose first folder does not exist would stay relative.
  const std::filesystem::path place = std::filesystem::weakly_canonical(std::filesystem::absolute(path, error), error);
  return error ? std::filesystem::path(path) : place;
}

/// Pipes and devices can be read and written at once.
bool same_file(const std::string& a, const std::string& b) {
  if (a.empty() || b.empty()) return false;
  std::error_code error;
  if (std::filesystem::exists(a, error) && !std::filesystem::is_regular_file(a, error)) return false;
  return place_of(a) == place_of(b) || std::filesystem::equivalent(a, b, error);
}

}  // namespace

void refuse_overwriting(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
  for (size_t i = 0; i < outputs.size(); ++i) {
    for (const std::string& input : inputs)
      if (same_file(outputs[i], input))
        throw OutputError(fmt::format("{}: is also an input, an output must be another file", outputs[i]));
    for (size_t k = 0; k < i; ++k)
      if (same_file(outputs[i], outputs[k]))
        throw OutputError(fmt::format("{}: is named for two outputs, must be two files", outputs[i]));
  }
}

}  // namespace soapfilm::cli
