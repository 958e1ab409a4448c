// OBJ as a cloud: its vertices are the samples. Faces are read in a second pass, for the normals: they need no memory
// then, wherever they stand.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <string>

#include "soapfilm/context.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/meshes/obj.h"
#include "soapfilm/io/meshes/obj_text.h"
#include "soapfilm/io/point_table.h"
#include "soapfilm/io/text/number_line.h"
#include "soapfilm/io/text/text.h"
#include "soapfilm/io/text/text_encoding.h"

namespace soapfilm::io {

namespace {

/// The lines of a file by their keyword.
struct ObjCounts {
  uint64_t vertices = 0;
  uint64_t normals = 0;
  uint64_t faces = 0;
};

/// Calls put(line, offset of its end) for each line that may have content, until that returns false.
template <class Put>
void for_each_obj_line(std::string_view text, const Put& put) {
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    while (begin < end && is_blank(text[begin])) ++begin;
    const std::string_view line = text.substr(begin, end - begin);
    if (line.size() > 2 && !put(line, end)) return;
    begin = end + 1;
  }
}

bool is_keyword(std::string_view line, std::string_view keyword) {
  return line.size() > keyword.size() && line.substr(0, keyword.size()) == keyword && is_blank(line[keyword.size()]);
}

ObjCounts count_obj_lines(std::string_view text) {
  ObjCounts counts;
  for_each_obj_line(text, [&](std::string_view line, size_t) {
    counts.vertices += is_keyword(line, "v");
    counts.normals += is_keyword(line, "vn");
    counts.faces += is_keyword(line, "f");
    return true;
  });
  return counts;
}

class ObjPointsReader {
 public:
  ObjPointsReader(ByteSource& source, const Context& context)
      : source_(source), context_(context), counts_(count_obj_lines(source.bytes())) {}

  PointCloud read(ReadReport& report) {
    plan();
    read_vertices();
    FileReport file;
    file.format = "OBJ";
    if (counts_.faces > 0) {
      if (!read_faces()) file.format += ", normals from its faces";
    } else if (cloud_.normals.size() != cloud_.size()) {
      if (!cloud_.normals.empty())
        report.warnings.push_back(fmt::format("{}: {} normals (vn) for {} vertices (v) without faces: not used",
                                              source_.path(), cloud_.normals.size(), cloud_.size()));
      cloud_.normals.clear();
    }
    if (has_color_) cloud_.colors = colors_.bytes(false);
    warn(report);
    return finish(std::move(file), report);
  }

 private:
  void plan() {
    constexpr size_t least_bytes = sizeof("v 0 0 0");  // with the end of the line
    PointHeader header;
    header.samples = std::min<uint64_t>(counts_.vertices, source_.bytes().size() / least_bytes + 1);
    header.normals = counts_.faces > 0 || counts_.normals > 0;
    cloud_ = cloud_for(header, source_.path());
  }

  void read_vertices() {
    TextCursor cursor(source_);
    std::string_view line;
    for (size_t k = 0; cursor.next_content_line(line); ++k) {
      if (k % lines_between_checks == 0) context_.check();
      std::string_view keyword;
      next_field(line, keyword);
      if (keyword == "v")
        read_vertex(cursor, line);
      else if (keyword == "vn")
        read_normal(cursor, line);
      else
        remember_unused(keyword);
      cursor.release();
    }
  }

  void read_vertex(const TextCursor& cursor, std::string_view line) {
    const size_t count = parse_number_line(cursor, line, values_);
    if (count < 3) cursor.fail(fmt::format("vertex of {} numbers, must be at least 3", count));
    cloud_.positions.push_back({values_[0], values_[1], values_[2]});
    const bool colored = count == 6;
    numbers_unused_ = numbers_unused_ || (count == 4 && values_[3] != 1) || count == 5 || count > 6;
    if (colored && !has_color_) {
      colors_.reserve(counts_.vertices);
      for (size_t i = 1; i < cloud_.size(); ++i) colors_.add(-1, -1, -1);
    }
    has_color_ = has_color_ || colored;
    if (colored)
      colors_.add(values_[3], values_[4], values_[5]);
    else if (has_color_)
      colors_.add(-1, -1, -1);
  }

  void read_normal(const TextCursor& cursor, std::string_view line) {
    if (parse_number_line(cursor, line, values_) != 3) cursor.fail("a normal must have 3 numbers");
    cloud_.normals.push_back(static_cast<Vec3f>(Vec3d{values_[0], values_[1], values_[2]}));
  }

  /// Gives the samples the normals of the faces, unless the file's own correspond to them one to one: then true.
  bool read_faces() {
    FaceNormals from_faces(cloud_.positions);
    bool same_indices = cloud_.normals.size() == cloud_.size();
    TextCursor cursor(source_);
    std::vector<uint32_t> corners;
    size_t vertices = 0, normals = 0;  // so far
    std::string_view line;
    for (size_t k = 0; cursor.next_content_line(line); ++k) {
      if (k % lines_between_checks == 0) context_.check();
      cursor.release();
      std::string_view keyword;
      next_field(line, keyword);
      vertices += keyword == "v";
      normals += keyword == "vn";
      if (keyword != "f") continue;
      corners.clear();
      for (std::string_view field; next_field(line, field);) {
        const ObjCorner corner = parse_obj_corner(cursor, field, vertices, normals);
        if (corner.vertex >= cloud_.size())
          cursor.fail(fmt::format("vertex {}, must be from 1 to {}", uint64_t{corner.vertex} + 1, cloud_.size()));
        same_indices = same_indices && corner.normal == corner.vertex;
        corners.push_back(corner.vertex);
      }
      if (!same_indices) from_faces.add(corners);
    }
    if (same_indices) return true;
    closed_ = from_faces.closed();
    cloud_.normals = from_faces.finish();
    return false;
  }

  void remember_unused(std::string_view keyword) {
    constexpr std::string_view structure[] = {"f", "vt", "vp", "g", "o", "s", "p", "usemtl", "mtllib"};
    constexpr size_t most = 8;
    if (std::find(std::begin(structure), std::end(structure), keyword) != std::end(structure)) return;
    if (std::find(unused_.begin(), unused_.end(), keyword) == unused_.end() && unused_.size() < most)
      unused_.push_back(keyword);
  }

  void warn(ReadReport& report) const {
    std::string names;
    for (const std::string_view keyword : unused_) names += (names.empty() ? "" : ", ") + in_quotes(keyword);
    if (!names.empty())
      report.warnings.push_back(fmt::format("{}: lines that begin with {} are not used", source_.path(), names));
    if (numbers_unused_)
      report.warnings.push_back(
          fmt::format("{}: of v lines with other than 3 or 6 numbers only x y z are used", source_.path()));
  }

  PointCloud finish(FileReport file, ReadReport& report) {
    file.path = source_.path();
    file.properties = {"x", "y", "z"};
    const auto add = [&](std::initializer_list<const char*> names) {
      file.properties.insert(file.properties.end(), names.begin(), names.end());
    };
    if (!cloud_.normals.empty() && counts_.normals > 0) add({"nx", "ny", "nz"});
    if (has_color_) add({"red", "green", "blue"});
    Scan scan;
    scan.name = std::filesystem::path(source_.path()).stem().string();
    scan.end = cloud_.size();
    cloud_.scans.push_back(std::move(scan));
    finish_points(cloud_, std::move(file), {.has_faces = counts_.faces > 0, .closed = closed_}, report);
    return std::move(cloud_);
  }

  static constexpr size_t lines_between_checks = 4096;

  ByteSource& source_;
  const Context& context_;
  ObjCounts counts_;
  bool closed_ = false;  ///< the faces, where they were looked at
  PointCloud cloud_;
  ColorNumbers colors_;
  bool has_color_ = false;
  bool numbers_unused_ = false;
  std::vector<std::string_view> unused_;  // keywords
  std::array<double, 8> values_{};
};

}  // namespace

bool obj_has_faces(ByteSource& source) {
  bool found = false;
  const std::optional<std::string> converted = utf8_of_utf16(source.bytes());
  for_each_obj_line(converted ? *converted : source.bytes(), [&](std::string_view line, size_t end) {
    found = is_keyword(line, "f");
    if (!converted) source.release_before(end);
    return !found;
  });
  return found;
}

PointCloud read_obj_points(ByteSource& source, ReadReport& report, const ReadOptions&, const Context& context) {
  ObjSource text(source);
  return ObjPointsReader(text.plain(), context).read(report);
}

}  // namespace soapfilm::io
