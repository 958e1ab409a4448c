#include "soapfilm/io/las/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/byte_source.h"
#include "soapfilm/io/point_columns.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t most_trajectory_columns = 64;

/// Splits at blanks, commas and semicolons, up to a comment.
std::vector<std::string_view> trajectory_fields(std::string_view line) {
  std::vector<std::string_view> fields;
  const auto ends_field = [](char c) { return is_blank(c) || c == ',' || c == ';'; };
  for (size_t at = 0; at < line.size() && fields.size() < most_trajectory_columns;) {
    if (ends_field(line[at])) {
      ++at;
      continue;
    }
    if (line[at] == '#' || line.substr(at, 2) == "//") break;
    const size_t begin = at;
    while (at < line.size() && !ends_field(line[at])) ++at;
    fields.push_back(line.substr(begin, at - begin));
  }
  return fields;
}

bool is_time(std::string_view name) {
  constexpr std::string_view times[] = {"t",   "time",   "gpstime",    "timestamp",    "seconds",
                                        "sec", "gpssec", "gpsseconds", "sow",          "gpssow",
                                        "tow", "gpstow", "timegps",    "secondsofweek"};
  std::string bare_name;
  for (const char c : lower_case(name)) {
    if (c == '(' || c == '[') break;
    if (c >= 'a' && c <= 'z') bare_name += c;
  }
  return std::find(std::begin(times), std::end(times), bare_name) != std::end(times);
}

/// Where a row has time, x, y and z.
using TrajectoryColumns = std::array<size_t, 4>;

/// What the line before the first row says, if it names a time and a position; else the first four.
TrajectoryColumns trajectory_columns(std::string_view head, size_t count) {
  while (!head.empty() &&
         (is_blank(head.front()) || std::string_view("#/%").find(head.front()) != std::string_view::npos))
    head.remove_prefix(1);
  std::vector<std::string> names;
  for (const std::string_view field : trajectory_fields(head)) names.emplace_back(field);
  const auto time = std::find_if(names.begin(), names.end(), is_time);
  const Triple position = meaning_of(names).position;
  if (names.size() != count || time == names.end() || !position.present()) return {0, 1, 2, 3};
  return {static_cast<size_t>(time - names.begin()), position[0], position[1], position[2]};
}

bool begins_with_number(const std::vector<std::string_view>& fields) {
  double number = 0;
  return !fields.empty() && parse_number(fields.front(), number);
}

}  // namespace

Trajectory::Trajectory(const std::string& path, ReadReport& report) : path_(path) {
  ByteSource source(path);
  TextCursor cursor(source);
  TrajectoryColumns columns{};
  size_t count = 0;  // of columns
  std::string_view line, head;
  while (cursor.next_line(line)) {
    const std::vector<std::string_view> fields = trajectory_fields(line);
    if (rows_.empty() && !begins_with_number(fields)) {
      if (!fields.empty() || line.find_first_not_of(" \t\r") != std::string_view::npos) head = line;
      continue;
    }
    if (fields.empty()) continue;
    if (count == 0) {
      count = fields.size();
      if (count < 4) cursor.fail(fmt::format("{} columns, must be at least 4 (time x y z)", count));
      columns = trajectory_columns(head, count);
    }
    if (fields.size() != count) cursor.fail(fmt::format("{} columns, must be {} as before", fields.size(), count));
    std::array<double, 4> v{};
    for (size_t k = 0; k < 4; ++k) {
      constexpr std::array<std::string_view, 4> names{"time", "x", "y", "z"};
      if (!parse_number(fields[columns[k]], v[k]) || !std::isfinite(v[k]))
        cursor.fail(fmt::format("{} = {}, must be a finite number", names[k], in_quotes(fields[columns[k]])));
    }
    rows_.push_back({v[0], {v[1], v[2], v[3]}});
    cursor.release();
  }
  if (rows_.empty()) throw InputError(path + ": holds no rows, must have lines `time x y z`");
  if (count > 4)
    report.warnings.push_back(
        fmt::format("{}: of its {} columns only the time and the position are used", path, count));
  std::stable_sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.time < b.time; });
}

Vec3d Trajectory::at(double time) {
  if (!(time >= first_time() && time <= last_time())) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan};
  }
  if (time == last_time()) return rows_.back().position;
  const auto holds = [&](size_t i) { return rows_[i].time <= time && time < rows_[i + 1].time; };
  if (!holds(last_)) {
    if (last_ + 2 < rows_.size() && holds(last_ + 1)) {
      ++last_;
    } else {
      const auto after =
          std::upper_bound(rows_.begin(), rows_.end(), time, [](double t, const Row& row) { return t < row.time; });
      last_ = static_cast<size_t>(after - rows_.begin()) - 1;
    }
  }
  const Row& a = rows_[last_];
  const Row& b = rows_[last_ + 1];
  return a.position + (b.position - a.position) * ((time - a.time) / (b.time - a.time));
}

}  // namespace soapfilm::io
