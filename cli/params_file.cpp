#include "cli/params_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "soapfilm/core/error.h"

namespace soapfilm::cli {

namespace {

std::string read_text(const std::string& path) {
  constexpr size_t longest = size_t{64} << 20;
  std::ifstream in(path, std::ios::binary);
  std::string text;
  if (in) {
    text.resize(longest + 1);
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<size_t>(in.gcount()));
  }
  if (in.bad() || (!in && !in.eof())) throw InputError(fmt::format("{}: {}", path, std::strerror(errno)));
  if (text.size() > longest) throw InputError(fmt::format("{}: over 64 MiB, no parameters are that long", path));
  return text;
}

}  // namespace

ReconstructParams read_params(const std::string& path) {
  const std::string text = read_text(path);
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
