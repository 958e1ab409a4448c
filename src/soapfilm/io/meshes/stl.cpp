#include "soapfilm/io/meshes/stl.h"

#include <fmt/format.h>

#include <bit>

#include "soapfilm/core/indices.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

constexpr size_t head_bytes = 80;
constexpr size_t triangle_bytes = 50;  // normal and three corners of 3 floats, 2 bytes of attributes

/// Finds equal positions: an open-addressing table of vertex indices. Vertices are numbered as they first appear.
class VertexMerger {
 public:
  explicit VertexMerger(std::vector<Vec3d>& vertices) : vertices_(vertices), slots_(1024, empty) {}

  uint32_t index_of(Vec3d p) {
    p = {p.x + 0.0, p.y + 0.0, p.z + 0.0};  // changes -0 to 0
    size_t slot = hash(p) & (slots_.size() - 1);
    while (slots_[slot] != empty && !(vertices_[slots_[slot]] == p)) slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] != empty) return slots_[slot];
    require_indices(vertices_.size() + 1, most_indices, "vertices of the mesh");
    const uint32_t index = static_cast<uint32_t>(vertices_.size());
    slots_[slot] = index;
    vertices_.push_back(p);
    if (2 * vertices_.size() > slots_.size()) grow();
    return index;
  }

 private:
  static constexpr uint32_t empty = UINT32_MAX;

  static size_t hash(const Vec3d& p) {
    uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
      h = (h ^ std::bit_cast<uint64_t>(p[axis])) * 0x9E3779B97F4A7C15ull;
      h ^= h >> 29;
    }
    return static_cast<size_t>(h ^ (h >> 32));
  }

  void grow() {
    slots_.assign(4 * slots_.size(), empty);
    for (size_t i = 0; i < vertices_.size(); ++i) {
      size_t slot = hash(vertices_[i]) & (slots_.size() - 1);
      while (slots_[slot] != empty) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = static_cast<uint32_t>(i);
    }
  }

  std::vector<Vec3d>& vertices_;
  std::vector<uint32_t> slots_;
};

uint32_t binary_count(ByteSource& source) {
  ByteCursor cursor(source);
  cursor.skip(head_bytes);
  return cursor.read<uint32_t>();
}

/// Binary files may begin with "solid" too; their size shows that they are binary.
bool is_binary(ByteSource& source) {
  const size_t size = source.bytes().size();
  if (size < head_bytes + 4) return false;
  if (size == head_bytes + 4 + triangle_bytes * size_t{binary_count(source)}) return true;
  std::string_view text = after_byte_order_mark(source.bytes().substr(0, head_bytes)), word;
  next_field(text, word);
  return lower_case(word.substr(0, 5)) != "solid";
}

Mesh read_binary_stl(ByteSource& source, ReadReport& report) {
  const uint32_t count = binary_count(source);
  ByteCursor cursor(source, head_bytes + 4);
  if (count == 0 || count > cursor.remaining() / triangle_bytes)
    throw InputError(
        fmt::format("{}: byte {}: not an STL file or truncated: count of triangles = {}, must be from 1 to "
                    "{} (what the file can hold)",
                    source.path(), head_bytes, count, cursor.remaining() / triangle_bytes));
  Mesh mesh;
  mesh.triangles.resize(count);
  VertexMerger merger(mesh.vertices);
  for (uint32_t i = 0; i < count; ++i) {
    cursor.skip(3 * sizeof(float));  // the normal follows from the corners
    for (uint32_t& vertex : mesh.triangles[i]) {
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = static_cast<double>(cursor.read<float>());
      if (!is_finite(p))
        throw InputError(fmt::format("{}: byte {}: triangle {}: corner ({}, {}, {}), must be finite", source.path(),
                                     cursor.offset() - 3 * sizeof(float), i, p.x, p.y, p.z));
      vertex = merger.index_of(p);
    }
    cursor.skip(2);
    cursor.release();
  }
  if (const size_t rest = cursor.remaining(); rest > 0)
    report.warnings.push_back(fmt::format(
        "{}: {} bytes after the last triangle are not read: the header's count, {} triangles, may be too small",
        source.path(), rest, count));
  return mesh;
}

class AsciiStlReader {
 public:
  explicit AsciiStlReader(ByteSource& source) : cursor_(source), merger_(mesh_.vertices) {}

  /// solid [name] { facet normal x y z outer loop vertex x y z (three times) endloop endfacet } endsolid [name]
  Mesh read() {
    std::string word = lower_case(cursor_.token());
    if (word != "solid") cursor_.fail("not an STL file: begins with " + in_quotes(word) + ", must begin with 'solid'");
    for (;;) {
      skip_name(word);
      for (; word == "facet"; word = lower_case(cursor_.token())) read_facet();
      if (word != "endsolid") cursor_.fail(in_quotes(word) + ", must be 'facet' or 'endsolid'");
      std::string_view name;
      cursor_.next_line(name);
      word = lower_case(cursor_.token());
      if (word.empty()) break;
      if (word != "solid") cursor_.fail(in_quotes(word) + ", must be 'solid' or the end of the file");
    }
    if (mesh_.triangles.empty()) cursor_.fail("holds no facets, must be a mesh");
    return std::move(mesh_);
  }

 private:
  /// The name is the rest of the line that `solid` is on.
  void skip_name(std::string& word) {
    std::string_view name;
    cursor_.next_line(name);
    word = lower_case(cursor_.token());
  }

  void read_facet() {
    expect("normal");
    for (int axis = 0; axis < 3; ++axis) cursor_.number("the facet's normal");
    expect("outer");
    expect("loop");
    Triangle triangle{};
    for (uint32_t& vertex : triangle) {
      expect("vertex");
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) p[axis] = cursor_.number("a coordinate");
      if (!is_finite(p)) cursor_.fail(fmt::format("vertex ({}, {}, {}), must be finite", p.x, p.y, p.z));
      vertex = merger_.index_of(p);
    }
    expect("endloop");
    expect("endfacet");
    mesh_.triangles.push_back(triangle);
    cursor_.release();
  }

  void expect(std::string_view word) {
    const std::string_view found = cursor_.token();
    if (found != word && lower_case(found) != word)
      cursor_.fail((found.empty() ? "truncated: the file ends" : in_quotes(found)) + ", must be '" + std::string(word) +
                   "'");
  }

  TextCursor cursor_;
  Mesh mesh_;
  VertexMerger merger_;
};

Vec3f triangle_normal(const Mesh& mesh, const Triangle& t) {
  const Vec3d a = mesh.vertices[t[0]];
  return static_cast<Vec3f>(normalized(cross(mesh.vertices[t[1]] - a, mesh.vertices[t[2]] - a)));
}

void write_binary(AtomicFile& file, const Mesh& mesh) {
  std::string head = "binary STL written by soapfilm";
  head.resize(head_bytes, ' ');
  file.append(head);
  file.append_binary(static_cast<uint32_t>(mesh.triangles.size()));
  const auto put = [&file](const Vec3f& v) {
    for (int axis = 0; axis < 3; ++axis) file.append_binary(v[axis]);
  };
  for (const Triangle& triangle : mesh.triangles) {
    put(triangle_normal(mesh, triangle));
    for (const uint32_t v : triangle) put(static_cast<Vec3f>(mesh.vertices[v]));
    file.append_binary(uint16_t{0});
  }
}

void write_ascii(AtomicFile& file, const Mesh& mesh) {
  const auto put = [&file](std::string_view begin, const Vec3f& v) {
    file.append(begin);
    for (int axis = 0; axis < 3; ++axis) {
      file.append(" ");
      file.append_text(v[axis]);
    }
    file.append("\n");
  };
  file.append("solid soapfilm\n");
  for (const Triangle& triangle : mesh.triangles) {
    put("facet normal", triangle_normal(mesh, triangle));
    file.append("outer loop\n");
    for (const uint32_t v : triangle) put("vertex", static_cast<Vec3f>(mesh.vertices[v]));
    file.append("endloop\nendfacet\n");
  }
  file.append("endsolid soapfilm\n");
}

}  // namespace

Mesh read_stl(ByteSource& source, ReadReport& report) {
  return is_binary(source) ? read_binary_stl(source, report) : AsciiStlReader(source).read();
}

WriteReport write_stl(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context&) {
  check_mesh(mesh);
  if (mesh.triangles.size() > UINT32_MAX)
    throw ParameterError(fmt::format("mesh: {} triangles, STL holds at most {}", mesh.triangles.size(), UINT32_MAX));
  check_float_range(file.path(), "STL", mesh);
  if (options.ascii)
    write_ascii(file, mesh);
  else
    write_binary(file, mesh);

  WriteReport report;
  report.format = options.ascii ? "STL, ASCII" : "STL, binary";
  const double loss = float_rounding_error(mesh.vertices);
  const double precision = mesh_precision(mesh, options.coordinate_precision);
  const size_t collapsed = collapsed_by_float(mesh);
  if (loss > precision || collapsed > 0)
    report.warnings.push_back(fmt::format(
        "{}: STL has 32-bit coordinates: vertices moved by up to {:.2g}, {} triangles lost all area; PLY and "
        "OBJ keep them",
        file.path(), loss, collapsed));
  if (!mesh.colors.empty() || !mesh.attributes.empty())
    report.warnings.push_back(file.path() + ": STL holds no colors or attributes: they were left out; PLY keeps them");
  return report;
}

}  // namespace soapfilm::io
