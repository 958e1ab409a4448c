// Option texts as numbers, points and lengths. Errors are ParameterErrors that quote the option and its value.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/core/names.h"
#include "soapfilm/core/vec.h"

namespace soapfilm::cli {

/// Numbers separated by `separator`, exactly `count` of them; `form` describes the expected format.
std::vector<double> parse_numbers(const char* option, const std::string& text, char separator, size_t count,
                                  const char* form);

/// X,Y,Z.
Vec3d parse_point(const char* option, const std::string& text);

/// A length in input units, or with a percent sign in percent of `longest`.
double parse_length(const char* option, const std::string& text, double longest);

/// A number, or nothing when the text is "auto"; `constraint` describes the valid numbers.
std::optional<double> number_or_auto(const char* option, const std::string& text, const char* constraint);

/// Refuses other words than these, and names the nearest.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Words that an option knows beside other values: told to the shell's completion, nothing is refused.
CLI::Validator also(const std::vector<std::string>& words);

/// Converts the name of an enumeration's value, or of a switch's state, for CLI11; refuses other words.
template <class T>
CLI::Validator named(std::vector<std::pair<std::string, T>> names) {
  std::vector<std::string> words;
  for (const auto& [name, value] : names) words.push_back(name);
  CLI::Validator validator = one_of(words);
  const auto refuse = validator;
  return validator.operation([refuse, names = std::move(names)](std::string& text) -> std::string {
    std::string refused = refuse(text);
    for (const auto& [name, value] : names) {
      if (refused.empty() && text == name) {
        text = fmt::format("{}", static_cast<int>(value));
        break;
      }
    }
    return refused;
  });
}

/// The same for all values of an enumeration that parameters have, by their names there.
template <class Enum>
CLI::Validator named() {
  std::vector<std::pair<std::string, Enum>> names;
  for (size_t i = 0; i < names_of<Enum>.size(); ++i) names.emplace_back(names_of<Enum>[i], static_cast<Enum>(i));
  return named(std::move(names));
}

}  // namespace soapfilm::cli
