#include "soapfilm/io/text/header_names.h"

#include <algorithm>

#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/io/text/text_rows.h"

namespace soapfilm::io {

namespace {

constexpr size_t longest_header = size_t{1} << 16;

}  // namespace

std::vector<std::string> split_names(std::string_view line, char separator) {
  std::vector<std::string_view> fields;
  split_fields(line.substr(0, longest_header), separator, fields);
  std::vector<std::string> names;
  for (const std::string_view field : fields) {
    const bool is_unit = !field.empty() && (field.front() == '(' || field.front() == '[') && !names.empty();
    if (separator == ' ' && is_unit)
      names.back() += field;
    else if (!(separator == ' ' && names.empty() && field.size() > 1 && field.back() == ':'))  // "columns: x y z"
      names.emplace_back(field);
  }
  return names;
}

std::vector<std::string> header_names(std::string_view line, size_t columns) {
  std::string_view after;
  if (is_comment(line, after)) line = after;
  std::vector<std::string> first;
  for (const char separator : {';', ',', '\t', ' '}) {
    if (separator != ' ' && line.find(separator) == std::string_view::npos) continue;
    std::vector<std::string> names = split_names(line, separator);
    while (names.size() > columns && names.back().empty()) names.pop_back();
    if (names.size() == columns) return names;
    if (first.empty()) first = std::move(names);
  }
  return first;
}

std::vector<std::string> names_before_list(std::string_view line, bool whole) {
  std::string_view after;
  if (is_comment(line, after)) line = after;
  for (const char separator : {';', ',', '\t', ' '}) {
    if (separator != ' ' && line.find(separator) == std::string_view::npos) continue;
    std::vector<std::string> names = split_names(line, separator);
    const auto list = std::find_if(names.begin(), names.end(), [](const std::string& name) {
      return name.find("[]") != std::string::npos || name.find("...") != std::string::npos;
    });
    if (list == names.end() && !whole) continue;
    names.erase(list, names.end());
    if (names_positions(names)) return names;
  }
  return {};
}

bool names_positions(const std::vector<std::string>& names) { return meaning_of(names).position.present(); }

bool names_degrees(const std::vector<std::string>& names) {
  const auto is = [&](std::string_view begin) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return lower_case(name).substr(0, begin.size()) == begin; });
  };
  return is("lat") && is("lon");
}

bool means_no_position(const std::string& name) {
  constexpr std::string_view others[] = {"no",       "nr",  "number", "point",     "pointid", "point_id",
                                         "point id", "fid", "name",   "timestamp", "date",    "row",
                                         "column",   "col", "line",   "range",     "distance"};
  const std::string lower = lower_case(name);
  return name.empty() || is_known_column(name) || holds_labels(name) ||
         std::find(std::begin(others), std::end(others), lower) != std::end(others);
}

}  // namespace soapfilm::io
