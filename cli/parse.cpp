#include "cli/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>

#include "cli/suggest.h"
#include "soapfilm/error.h"

namespace soapfilm::cli {

std::vector<double> parse_numbers(const char* option, const std::string& text, char separator, size_t count,
                                  const char* form) {
  std::vector<double> values;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    size_t used = 0;
    try {
      values.push_back(std::stod(word, &used));
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != word.size() || used == 0) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
    begin = end + 1;
  }
  if (values.size() != count) throw ParameterError(fmt::format("{} = {}, must be {}", option, text, form));
  return values;
}

Vec3d parse_point(const char* option, const std::string& text) {
  const std::vector<double> v = parse_numbers(option, text, ',', 3, "three numbers X,Y,Z");
  return {v[0], v[1], v[2]};
}

std::optional<double> number_or_auto(const char* option, const std::string& text, const char* constraint) {
  if (text == "auto") return std::nullopt;
  return parse_numbers(option, text, '\0', 1, fmt::format("'auto' or a number {}", constraint).c_str())[0];
}

double parse_length(const char* option, const std::string& text, double longest) {
  const bool percent = !text.empty() && text.back() == '%';
  const std::string number = percent ? text.substr(0, text.size() - 1) : text;
  const double value = parse_numbers(option, number, '\0', 1, "a number >= 0, or one with a percent sign")[0];
  return percent ? 0.01 * value * longest : value;
}

CLI::Validator also(const std::vector<std::string>& words) {
  return CLI::Validator([](std::string&) { return std::string(); }, fmt::format("{{{}}}", fmt::join(words, ",")));
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  return also(words).operation([words](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return "";
    return fmt::format("Value {} must be one of {}{}", text, fmt::join(words, ", "), did_you_mean(text, words));
  });
}

}  // namespace soapfilm::cli
