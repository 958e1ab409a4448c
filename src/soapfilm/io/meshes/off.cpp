#include "soapfilm/io/meshes/off.h"

#include <fmt/format.h>

#include <cmath>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/mesh_points.h"
#include "soapfilm/io/meshes/polygon.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

class OffReader {
 public:
  explicit OffReader(ByteSource& source, bool is_mesh = true) : cursor_(source), is_mesh_(is_mesh) {}

  /// Counts of faces are in the head.
  bool has_faces() {
    read_head();
    return faces_ > 0;
  }

  Mesh read() {
    read_head();
    Mesh mesh;
    mesh.vertices.reserve(vertices_);
    for (uint64_t i = 0; i < vertices_; ++i) read_vertex(mesh, i);
    mesh.triangles.reserve(faces_);
    for (uint64_t i = 0; i < faces_; ++i) read_face(mesh, i);
    std::string_view rest;
    if (cursor_.next_content_line(rest)) cursor_.fail(fmt::format("text after the last of {} faces", faces_));
    if (is_mesh_ && mesh.triangles.empty()) cursor_.fail("holds no faces, must be a mesh");
    return mesh;
  }

 private:
  /// "[ST][C][N]OFF", which may be missing, and the three counts on the same line or the next.
  void read_head() {
    std::string_view line = content_line("the head");
    std::string_view rest = line;
    std::string_view word;
    next_field(rest, word);
    if (word.size() >= 3 && word.substr(word.size() - 3) == "OFF") {
      parse_prefix(word);
      line = rest;
      if (!next_field(rest, word)) line = content_line("the counts");
      if (word == "BINARY") cursor_.fail("binary OFF, must be text");
    }
    int64_t vertices = 0;
    int64_t faces = 0;
    std::string_view field;
    const bool valid = next_field(line, field) && parse_integer(field, vertices) && next_field(line, field) &&
                       parse_integer(field, faces);
    if (!valid || vertices <= 0 || faces < 0)
      cursor_.fail("not an OFF file: " + in_quotes(field) + ", must be the counts of vertices and faces, integers > 0");
    vertices_ = static_cast<uint64_t>(vertices);
    faces_ = static_cast<uint64_t>(faces);
    // Shortest rows: "0 0 0\n" and "3 0 0 0\n"; the last line's end may be missing.
    const uint64_t left = cursor_.remaining() + 1;
    if (vertices_ > left / 6 || faces_ > left / 8)
      cursor_.fail(fmt::format("counts = {} vertices, {} faces, but the file is truncated: {} bytes are left",
                               vertices_, faces_, cursor_.remaining()));
  }

  void parse_prefix(std::string_view word) {
    std::string_view prefix = word.substr(0, word.size() - 3);
    if (prefix.substr(0, 2) == "ST") prefix.remove_prefix(2);
    has_color_ = !prefix.empty() && prefix.front() == 'C';
    if (has_color_) prefix.remove_prefix(1);
    has_normal_ = !prefix.empty() && prefix.front() == 'N';
    if (has_normal_) prefix.remove_prefix(1);
    if (!prefix.empty()) cursor_.fail("head " + in_quotes(word) + ", must be [ST][C][N]OFF (three dimensions)");
  }

  void read_vertex(Mesh& mesh, uint64_t index) {
    std::string_view line = content_line(fmt::format("vertex {}", index));
    const Vec3d position = read_vector(line, index);
    if (is_mesh_ && !is_finite(position)) cursor_.fail(fmt::format("vertex {}: the position must be finite", index));
    mesh.vertices.push_back(position);
    if (has_normal_) mesh.normals.push_back(static_cast<Vec3f>(read_vector(line, index)));
    if (!has_color_) return;
    Rgb8 rgb{};
    for (uint8_t& c : rgb) {
      std::string_view field;
      double value = 0;
      if (!next_field(line, field) || !parse_number(field, value))
        cursor_.fail(fmt::format("vertex {}: color {}, must be a number", index, in_quotes(field)));
      // Whole numbers are 0 to 255, numbers with a point 0 to 1.
      if (field.find('.') != std::string_view::npos) value *= 255;
      c = value > 0 ? static_cast<uint8_t>(std::lround(std::min(value, 255.0))) : uint8_t{0};
    }
    mesh.colors.push_back(rgb);
  }

  Vec3d read_vector(std::string_view& line, uint64_t index) const {
    Vec3d v;
    std::string_view field;
    for (int axis = 0; axis < 3; ++axis)
      if (!next_field(line, field) || !parse_number(field, v[axis]))
        cursor_.fail(fmt::format("vertex {}: {}, must be a number", index, in_quotes(field)));
    return v;
  }

  /// "n i1 ... in"; a color may follow.
  void read_face(Mesh& mesh, uint64_t index) {
    std::string_view line = content_line(fmt::format("face {}", index));
    std::string_view field;
    int64_t count = 0;
    if (!next_field(line, field) || !parse_integer(field, count) || count < 3)
      cursor_.fail(fmt::format("face {}: {} vertices, must be at least 3", index, in_quotes(field)));
    corners_.clear();
    for (int64_t i = 0; i < count; ++i) {
      int64_t vertex = 0;
      if (!next_field(line, field) || !parse_integer(field, vertex) || vertex < 0 ||
          static_cast<uint64_t>(vertex) >= vertices_)
        cursor_.fail(
            fmt::format("face {}: vertex {}, must be an integer from 0 to {}", index, in_quotes(field), vertices_ - 1));
      corners_.push_back(static_cast<uint32_t>(vertex));
    }
    append_fan(mesh.triangles, corners_.size(), [&](size_t c) { return corners_[c]; });
    cursor_.release();
  }

  std::string_view content_line(const std::string& what) {
    std::string_view line;
    if (!cursor_.next_content_line(line)) cursor_.fail("truncated: the file ends where " + what + " must follow");
    return line;
  }

  TextCursor cursor_;
  bool is_mesh_;
  uint64_t vertices_ = 0;
  uint64_t faces_ = 0;
  bool has_color_ = false;
  bool has_normal_ = false;
  std::vector<uint32_t> corners_;  // of the face in progress
};

/// Numbers with a blank between them, each the shortest text that reads back as the same value.
template <class T>
void put_off_numbers(AtomicFile& file, const Vec3<T>& v, bool begins) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis > 0 || !begins) file.append(" ");
    file.append_text(v[axis]);
  }
}

}  // namespace

bool off_has_faces(ByteSource& source) { return OffReader(source).has_faces(); }

PointCloud read_off_points(ByteSource& source, ReadReport& report, const ReadOptions&, const Context&) {
  return points_of_mesh(OffReader(source, false).read(), source, "OFF", false, report);
}

Mesh read_off(ByteSource& source, ReadReport&) { return OffReader(source).read(); }

WriteReport write_off(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context&) {
  check_mesh(mesh);
  WriteReport report;
  report.format = "OFF";
  report.double_coordinates = needs_double(mesh, options.coordinate_precision);
  const bool colors = !mesh.colors.empty(), normals = !mesh.normals.empty();
  file.append(fmt::format("{}{}OFF\n{} {} 0\n", colors ? "C" : "", normals ? "N" : "", mesh.vertices.size(),
                          mesh.triangles.size()));
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (report.double_coordinates)
      put_off_numbers(file, mesh.vertices[i], true);
    else
      put_off_numbers(file, static_cast<Vec3f>(mesh.vertices[i]), true);
    if (normals) put_off_numbers(file, mesh.normals[i], false);
    if (colors) {
      for (const uint8_t c : mesh.colors[i]) {
        file.append(" ");
        file.append_text(uint64_t{c});
      }
      file.append(" 255");  // opaque
    }
    file.append("\n");
  }
  for (const Triangle& triangle : mesh.triangles) {
    file.append("3");
    for (const uint32_t v : triangle) {
      file.append(" ");
      file.append_text(uint64_t{v});
    }
    file.append("\n");
  }
  if (!mesh.attributes.empty())
    report.warnings.push_back(file.path() + ": OFF holds no vertex attributes: they were left out; PLY keeps them");
  return report;
}

}  // namespace soapfilm::io
