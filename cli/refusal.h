// What is wrong with a command line, in one line.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace soapfilm::cli {

/// CLI11 would read an empty text, such as of an unset shell variable, as 0.
void refuse_empty_numbers(CLI::App& app);

/// A long option with one dash would be read as several short ones with values. Throws ParameterError that names it.
void refuse_single_dashes(const CLI::App& program, const std::vector<std::string>& arguments);

/// The error's message, and for an unknown word what it is and which one was meant.
std::string parse_message(const CLI::App& program, const CLI::ParseError& error);

}  // namespace soapfilm::cli
