#include "soapfilm/io/meshes/obj.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/obj_text.h"
#include "soapfilm/io/meshes/polygon.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/text/number_line.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

class ObjReader {
 public:
  explicit ObjReader(ByteSource& source) : source_(source), cursor_(source) {}

  Mesh read() {
    std::string_view line;
    while (cursor_.next_content_line(line)) {
      std::string_view keyword;
      next_field(line, keyword);
      if (keyword == "v")
        read_vertex(line);
      else if (keyword == "vn")
        read_normal(line);
      else if (keyword == "f")
        read_face(line);
      cursor_.release();
    }
    if (mesh_.triangles.empty()) throw InputError(source_.path() + ": holds no faces, must be a mesh");
    if (largest_vertex_ >= mesh_.vertices.size())
      throw InputError(fmt::format("{}:{}: vertex {}, must be from 1 to {}", source_.path(), largest_vertex_line_,
                                   largest_vertex_ + 1, mesh_.vertices.size()));
    if (mesh_.colors.size() != mesh_.vertices.size()) mesh_.colors.clear();
    if (normals_match_ && !normals_.empty() && normals_.size() == mesh_.vertices.size()) mesh_.normals = normals_;
    return std::move(mesh_);
  }

 private:
  void read_vertex(std::string_view line) {
    std::array<double, 8> v{};
    const size_t count = parse_number_line(cursor_, line, v);
    if (count < 3) cursor_.fail(fmt::format("vertex of {} numbers, must be at least 3", count));
    const Vec3d position{v[0], v[1], v[2]};
    if (!is_finite(position)) cursor_.fail(fmt::format("position = ({}, {}, {}), must be finite", v[0], v[1], v[2]));
    mesh_.vertices.push_back(position);
    if (count != 6) return;  // three more are a color from 0 to 1, a fourth alone is a weight
    Rgb8 rgb{};
    for (size_t c = 0; c < 3; ++c)
      rgb[c] = v[3 + c] > 0 ? static_cast<uint8_t>(std::lround(255 * std::min(v[3 + c], 1.0))) : uint8_t{0};
    mesh_.colors.push_back(rgb);
  }

  void read_normal(std::string_view line) {
    std::array<double, 8> n{};
    if (parse_number_line(cursor_, line, n) != 3) cursor_.fail("a normal must have 3 numbers");
    normals_.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
  }

  void read_face(std::string_view line) {
    corners_.clear();
    for (std::string_view field; next_field(line, field);) corners_.push_back(read_corner(field));
    if (corners_.size() < 3) cursor_.fail(fmt::format("face of {} vertices, must be at least 3", corners_.size()));
    append_fan(mesh_.triangles, corners_.size(), [&](size_t c) { return corners_[c]; });
  }

  uint32_t read_corner(std::string_view field) {
    const ObjCorner corner = parse_obj_corner(cursor_, field, mesh_.vertices.size(), normals_.size());
    if (corner.vertex > largest_vertex_ || largest_vertex_line_ == 0) {  // may be defined later in the file
      largest_vertex_ = corner.vertex;
      largest_vertex_line_ = cursor_.line();
    }
    normals_match_ = normals_match_ && corner.normal == corner.vertex;
    return corner.vertex;
  }

  ByteSource& source_;
  TextCursor cursor_;
  Mesh mesh_;
  std::vector<Vec3f> normals_;
  std::vector<uint32_t> corners_;  // of the face in progress
  bool normals_match_ = true;      // every corner's normal has its vertex's index
  uint32_t largest_vertex_ = 0;
  size_t largest_vertex_line_ = 0;
};

/// "v 1 2 3" with the shortest digits that read back as the same value.
class ObjWriter {
 public:
  ObjWriter(AtomicFile& file, bool double_coordinates) : file_(file), double_coordinates_(double_coordinates) {}

  template <class T>
  void put_numbers(const Vec3<T>& v) {
    for (int axis = 0; axis < 3; ++axis) {
      file_.append(" ");
      file_.append_text(v[axis]);
    }
  }
  void put_vertex(const Vec3d& p, const Rgb8* rgb) {
    file_.append("v");
    if (double_coordinates_)
      put_numbers(p);
    else
      put_numbers(static_cast<Vec3f>(p));
    if (rgb != nullptr) {
      const auto unit = [](uint8_t c) { return static_cast<float>(std::round(c / 0.255) / 1000); };
      put_numbers(Vec3f{unit((*rgb)[0]), unit((*rgb)[1]), unit((*rgb)[2])});
    }
    file_.append("\n");
  }
  void put_normal(const Vec3f& n) {
    file_.append("vn");
    put_numbers(n);
    file_.append("\n");
  }
  void put_triangle(const Triangle& triangle, bool normals) {
    file_.append("f");
    for (const uint32_t v : triangle) {
      file_.append(" ");
      file_.append_text(v + uint64_t{1});
      if (!normals) continue;
      file_.append("//");
      file_.append_text(v + uint64_t{1});
    }
    file_.append("\n");
  }

 private:
  AtomicFile& file_;
  bool double_coordinates_;
};

}  // namespace

Mesh read_obj(ByteSource& source, ReadReport&) {
  ObjSource text(source);
  return ObjReader(text.plain()).read();
}

WriteReport write_obj(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context&) {
  check_mesh(mesh);
  WriteReport report;
  report.format = "OBJ";
  report.double_coordinates = needs_double(mesh, options.coordinate_precision);
  for (const std::string& comment : options.comments) {
    if (comment.find_first_of("\r\n") != std::string::npos)
      throw ParameterError("comment " + in_quotes(comment) + ", must be one line");
    file.append("# " + comment + "\n");
  }
  ObjWriter writer(file, report.double_coordinates);
  for (size_t i = 0; i < mesh.vertices.size(); ++i)
    writer.put_vertex(mesh.vertices[i], mesh.colors.empty() ? nullptr : &mesh.colors[i]);
  for (const Vec3f& normal : mesh.normals) writer.put_normal(normal);
  for (const Triangle& triangle : mesh.triangles) writer.put_triangle(triangle, !mesh.normals.empty());
  if (!mesh.attributes.empty())
    report.warnings.push_back(file.path() + ": OBJ holds no vertex attributes: they were left out; PLY keeps them");
  return report;
}

}  // namespace soapfilm::io
