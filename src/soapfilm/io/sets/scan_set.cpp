#include "soapfilm/io/sets/scan_set.h"

#include <fmt/format.h>

#include <algorithm>

#include "soapfilm/core/placement.h"
#include "soapfilm/core/printable.h"
#include "soapfilm/error.h"
#include "soapfilm/io/files.h"
#include "soapfilm/io/sets/set_members.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm {

namespace {

using io::in_quotes;
using io::next_field;

/// "file tx ty tz qi qj qk ql"; the file's name may contain blanks, so the numbers are counted from the end.
ScanSetEntry parse_bmesh(std::string_view rest, const io::TextCursor& cursor) {
  std::vector<std::string_view> fields;
  for (std::string_view field; next_field(rest, field);) fields.push_back(field);
  constexpr size_t numbers = 7;
  if (fields.size() < numbers + 1)
    cursor.fail(
        fmt::format("bmesh with {} fields, must be a file, a translation (3) and a quaternion (4)", fields.size()));
  std::array<double, numbers> v{};
  const size_t first = fields.size() - numbers;
  for (size_t i = 0; i < numbers; ++i)
    if (!io::parse_number(fields[first + i], v[i]) || !std::isfinite(v[i]))
      cursor.fail("bmesh: " + in_quotes(fields[first + i]) + ", must be a finite number");
  const double length = std::sqrt(v[3] * v[3] + v[4] * v[4] + v[5] * v[5] + v[6] * v[6]);
  if (!(std::abs(length - 1) < 0.01))
    cursor.fail(fmt::format("bmesh: quaternion of length {}, must be 1 (within 0.01)", length));

  ScanSetEntry entry;
  const char* name_begin = fields.front().data();
  const char* name_end = fields[first - 1].data() + fields[first - 1].size();
  entry.file.assign(name_begin, name_end);
  // It stands in messages, which are one line.
  if (std::any_of(entry.file.begin(), entry.file.end(), is_control))
    cursor.fail("bmesh: file " + in_quotes(entry.file) + ", must be a name without control characters");
  entry.pose.translation = {v[0], v[1], v[2]};
  entry.pose.quaternion = {v[3] / length, v[4] / length, v[5] / length, v[6] / length};
  return entry;
}

std::vector<ScanSetEntry> parse_scan_set(io::ByteSource& source, ReadReport& report) {
  std::vector<ScanSetEntry> entries;
  io::TextCursor cursor(source);
  std::string_view line;
  while (cursor.next_content_line(line)) {
    std::string_view keyword;
    next_field(line, keyword);
    if (keyword == "bmesh")
      entries.push_back(parse_bmesh(line, cursor));
    else if (keyword != "camera" && keyword != "mesh")
      report.warnings.push_back(fmt::format("{}:{}: keyword {} ignored, known are bmesh, camera and mesh",
                                            source.path(), cursor.line(), in_quotes(keyword)));
  }
  if (entries.empty()) throw InputError(source.path() + ": has no bmesh line, must name at least one scan");
  return entries;
}

}  // namespace

Vec3d ScanPose::rotate(Vec3d v) const {
  // v rotated by the conjugate quaternion (-q, w): v + 2 q' x (q' x v + w v) with q' = -q.
  const Vec3d q{-quaternion[0], -quaternion[1], -quaternion[2]};
  return v + 2.0 * cross(q, cross(q, v) + quaternion[3] * v);
}

void apply_pose(const ScanPose& pose, PointCloud& cloud) { place_cloud(pose, cloud); }

std::vector<ScanSetEntry> read_scan_set(const std::string& path, ReadReport* report) {
  io::ByteSource source(path);
  ReadReport unused;
  return parse_scan_set(source, report != nullptr ? *report : unused);
}

void write_scan_set(const std::string& path, const std::vector<ScanSetEntry>& entries) {
  std::string text;
  for (const ScanSetEntry& entry : entries) {
    if (entry.file.empty() || entry.file.find_first_of("\r\n") != std::string::npos)
      throw ParameterError("scan set: file " + in_quotes(entry.file) + ", must be a name on one line");
    const Vec3d& t = entry.pose.translation;
    const auto& q = entry.pose.quaternion;
    text += fmt::format("bmesh {} {} {} {} {} {} {} {}\n", entry.file, t.x, t.y, t.z, q[0], q[1], q[2], q[3]);
  }
  write_text_file(path, text);
}

std::vector<io::SetMember> io::scan_set_members(ByteSource& source, ReadReport& report) {
  std::vector<SetMember> members;
  for (const ScanSetEntry& entry : parse_scan_set(source, report))
    members.push_back({entry.file, [pose = entry.pose](PointCloud& cloud) {
                         for (Scan& scan : cloud.scans)
                           if (!scan.sensor && !scan.view_direction && cloud.sensors.empty())
                             scan.view_direction = Vec3d{0, 0, 1};
                         apply_pose(pose, cloud);
                       }});
  return members;
}

PointCloud io::read_scan_set_points(ByteSource& source, ReadReport& report, const ReadOptions& options,
                                    const Context& context) {
  return read_members(source, "bmesh", scan_set_members(source, report), report, options, context);
}

}  // namespace soapfilm
