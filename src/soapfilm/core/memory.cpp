#include "soapfilm/core/memory.h"

#include <fmt/format.h>

#include <cctype>
#include <iterator>

#include "soapfilm/core/number_text.h"
#include "soapfilm/error.h"

namespace soapfilm {

size_t parse_memory(std::string_view text) {
  const auto refuse = [&] {
    return ParameterError(fmt::format("memory = '{}', must be a number of bytes, or one with K, M, G or T", text));
  };
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [unit, error] = number_from_text(text.data(), end, value, false);
  if (error != std::errc{}) throw refuse();

  std::string suffix(unit, end);
  suffix.erase(0, suffix.find_first_not_of(' '));
  for (char& c : suffix) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  if (!suffix.empty() && suffix != "B") {
    const size_t power = std::string_view("KMGT").find(suffix[0]);
    const std::string rest = suffix.substr(1);
    if (power == std::string_view::npos || (!rest.empty() && rest != "B" && rest != "IB")) throw refuse();
    for (size_t i = 0; i <= power; ++i) value *= rest == "B" ? 1000 : 1024;
  }
  if (!(value >= 1 && value < 0x1p63)) throw refuse();
  return static_cast<size_t>(value);
}

std::string format_bytes(uint64_t bytes) {
  if (bytes < 1024) return fmt::format("{} B", bytes);
  constexpr const char* units[] = {"KiB", "MiB", "GiB", "TiB", "PiB", "EiB"};
  double value = static_cast<double>(bytes) / 1024;
  size_t unit = 0;
  // 999.5 would print as 1000: four digits, where three are enough in the next unit.
  for (; value >= 999.5 && unit + 1 < std::size(units); ++unit) value /= 1024;
  return fmt::format("{:.{}f} {}", value, value < 9.995 ? 2 : value < 99.95 ? 1 : 0, units[unit]);
}

}  // namespace soapfilm
