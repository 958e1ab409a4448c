#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <unordered_set>

#include "soapfilm/core/cloud_layout.h"
#include "soapfilm/core/context_state.h"
#include "soapfilm/core/parallel.h"
#include "soapfilm/error.h"
#include "soapfilm/io/bytes/encode.h"
#include "soapfilm/io/ply/ply.h"
#include "soapfilm/io/precision.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// How values are written: as text or little-endian; coordinates as float or double.
struct PlyStyle {
  bool ascii;
  bool double_coordinates;
};

/// Some rows of an element, in the encoding of the file.
class PlyBody {
 public:
  /// Has room for `rows` of at most `values` each.
  PlyBody(PlyStyle style, size_t rows, size_t values)
      : style_(style),
        bytes_(std::make_unique_for_overwrite<char[]>(rows * (values * (style.ascii ? longest_number + 1 : 8) + 1))),
        end_(bytes_.get()) {}

  std::string_view bytes() const { return {bytes_.get(), static_cast<size_t>(end_ - bytes_.get())}; }
  void clear() { end_ = bytes_.get(); }

  template <class T>
  void put(T value) {
    if (style_.ascii) {
      if (row_begun_) *end_++ = ' ';
      row_begun_ = true;
      end_ = put_text(end_, value);
    } else {
      end_ = put_binary(end_, value);
    }
  }
  template <class T>
  void put(const Vec3<T>& v) {
    put(v.x);
    put(v.y);
    put(v.z);
  }
  void put_position(const Vec3d& p) {
    if (style_.double_coordinates)
      put(p);
    else
      put(static_cast<Vec3f>(p));
  }
  void put_color(const Rgb8& rgb) {
    for (const uint8_t c : rgb) put(c);
  }
  void end_row() {
    if (style_.ascii) *end_++ = '\n';
    row_begun_ = false;
  }

 private:
  PlyStyle style_;
  std::unique_ptr<char[]> bytes_;
  char* end_;
  bool row_begun_ = false;
};

/// Writes the rows that put_row(i, body) makes of at most `values` each, in order: many are made at once on all
/// threads, and written by one.
template <class PutRow>
void write_rows(AtomicFile& file, PlyStyle style, size_t rows, size_t values, const Context& context,
                PutRow&& put_row) {
  constexpr size_t rows_at_once = size_t{1} << 13;
  std::vector<PlyBody> bodies;
  for (int k = 0; k < 2 * context.threads(); ++k) bodies.emplace_back(style, std::min(rows, rows_at_once), values);
  for (size_t first = 0; first < rows; first += bodies.size() * rows_at_once) {
    for (PlyBody& body : bodies) body.clear();
    const size_t count = std::min(rows - first, bodies.size() * rows_at_once);
    parallel_chunks(context, count, rows_at_once, [&](size_t begin, size_t end) {
      PlyBody& body = bodies[begin / rows_at_once];
      for (size_t i = first + begin; i < first + end; ++i) {
        put_row(i, body);
        body.end_row();
      }
    });
    for (const PlyBody& body : bodies) file.append(body.bytes());
    context.progress().advance(static_cast<double>(first + count) / static_cast<double>(rows), {});
  }
}

std::string header_begin(bool ascii, const std::vector<std::string>& comments) {
  std::string text = fmt::format("ply\nformat {} 1.0\n", ascii ? "ascii" : "binary_little_endian");
  for (const std::string& comment : comments) {
    if (comment.find_first_of("\r\n") != std::string::npos)
      throw ParameterError("comment " + in_quotes(comment) + ", must be one line");
    text += "comment " + comment + "\n";
  }
  return text;
}

void add_properties(std::string& header, const char* type, std::initializer_list<const char*> names) {
  for (const char* name : names) header += fmt::format("property {} {}\n", type, name);
}

void add_columns(std::string& header, const std::vector<Column>& columns) {
  std::unordered_set<std::string> names{"x",     "y",    "z",        "nx",       "ny",       "nz",    "red",
                                        "green", "blue", "sensor_x", "sensor_y", "sensor_z", "weight"};
  for (const Column& attribute : columns) {
    const bool printable = std::all_of(attribute.name.begin(), attribute.name.end(), [](char c) { return c > ' '; });
    if (attribute.name.empty() || !printable || !names.insert(attribute.name).second)
      throw ParameterError("attribute " + in_quotes(attribute.name) +
                           ", must be one word, used once and not x ... weight");
    header += "property float " + attribute.name + "\n";
  }
}

/// Refuses a cloud whose columns or scans do not fit together.
void check_cloud(const PointCloud& cloud) {
  check_layout(cloud);
  for (const Scan& scan : cloud.scans)
    if (scan.name.find_first_of("\r\n") != std::string::npos)
      throw ParameterError("cloud: scan name " + in_quotes(scan.name) + ", must be one line");
}

void add_scans(std::string& header, const std::vector<Scan>& scans) {
  for (const Scan& scan : scans) {
    if (scans.size() > 1) header += fmt::format("obj_info scan_samples {}\n", scan.size());
    if (!scan.name.empty()) header += fmt::format("obj_info scan_name {}\n", scan.name);
    if (scan.sensor) header += fmt::format("comment sensor {} {} {}\n", scan.sensor->x, scan.sensor->y, scan.sensor->z);
    if (const auto& v = scan.view_direction)
      header += fmt::format("comment view_direction {} {} {}\n", v->x, v->y, v->z);
    if (const auto& grid = scan.range_grid)
      header += fmt::format("obj_info num_cols {}\nobj_info num_rows {}\n", grid->columns, grid->rows);
  }
}

std::string points_header(const PointCloud& cloud, const WriteOptions& options, const char* coordinate) {
  std::string header = header_begin(options.ascii, options.comments);
  add_scans(header, cloud.scans);
  header += fmt::format("element vertex {}\n", cloud.size());
  add_properties(header, coordinate, {"x", "y", "z"});
  if (!cloud.normals.empty()) add_properties(header, "float", {"nx", "ny", "nz"});
  if (!cloud.sensors.empty()) add_properties(header, coordinate, {"sensor_x", "sensor_y", "sensor_z"});
  if (!cloud.weights.empty()) add_properties(header, "float", {"weight"});
  if (!cloud.colors.empty()) add_properties(header, "uchar", {"red", "green", "blue"});
  add_columns(header, cloud.columns);
  size_t cells = 0;
  for (const Scan& scan : cloud.scans)
    if (scan.range_grid) cells += scan.range_grid->sample.size();
  if (cells > 0) header += fmt::format("element range_grid {}\nproperty list uchar int vertex_indices\n", cells);
  return header + "end_header\n";
}

void put_range_grids(AtomicFile& file, PlyStyle style, const std::vector<Scan>& scans, const Context& context) {
  for (const Scan& scan : scans) {
    if (!scan.range_grid) continue;
    const std::vector<int32_t>& samples = scan.range_grid->sample;
    write_rows(file, style, samples.size(), 2, context, [&](size_t i, PlyBody& body) {
      body.put(static_cast<uint8_t>(samples[i] >= 0));
      if (samples[i] >= 0) body.put(static_cast<int32_t>(scan.begin) + samples[i]);
    });
  }
}

std::string mesh_header(const Mesh& mesh, const WriteOptions& options, const char* coordinate) {
  std::string header = header_begin(options.ascii, options.comments);
  header += fmt::format("element vertex {}\n", mesh.vertices.size());
  add_properties(header, coordinate, {"x", "y", "z"});
  if (!mesh.normals.empty()) add_properties(header, "float", {"nx", "ny", "nz"});
  if (!mesh.colors.empty()) add_properties(header, "uchar", {"red", "green", "blue"});
  add_columns(header, mesh.attributes);
  const bool large = mesh.vertices.size() > INT32_MAX;  // most readers expect int
  return header + fmt::format("element face {}\nproperty list uchar {} vertex_indices\nend_header\n",
                              mesh.triangles.size(), large ? "uint" : "int");
}

const char* format_name(bool ascii) { return ascii ? "PLY, ASCII" : "PLY, binary little-endian"; }

}  // namespace

WriteReport write_ply_mesh(AtomicFile& file, const Mesh& mesh, const WriteOptions& options, const Context& context) {
  check_mesh(mesh);
  WriteReport report;
  report.format = format_name(options.ascii);
  report.double_coordinates = needs_double(mesh, options.coordinate_precision);
  const std::string header = mesh_header(mesh, options, report.double_coordinates ? "double" : "float");

  file.append(header);
  const PlyStyle style{options.ascii, report.double_coordinates};
  const size_t vertex_values = 9 + mesh.attributes.size();
  write_rows(file, style, mesh.vertices.size(), vertex_values, part_of(context, 0, 0.5), [&](size_t i, PlyBody& body) {
    body.put_position(mesh.vertices[i]);
    if (!mesh.normals.empty()) body.put(mesh.normals[i]);
    if (!mesh.colors.empty()) body.put_color(mesh.colors[i]);
    for (const Column& attribute : mesh.attributes) body.put(attribute.values[i]);
  });
  write_rows(file, style, mesh.triangles.size(), 4, part_of(context, 0.5, 1), [&](size_t i, PlyBody& body) {
    body.put(uint8_t{3});
    for (const uint32_t v : mesh.triangles[i]) body.put(v);
  });
  return report;
}

WriteReport write_ply_points(AtomicFile& file, const PointCloud& cloud, const WriteOptions& options,
                             const Context& context) {
  check_cloud(cloud);
  WriteReport report;
  report.format = format_name(options.ascii);
  // As text a float's shortest digits are another double's: they would not be read back as the same.
  report.double_coordinates =
      options.ascii || std::max(float_rounding_error(cloud.positions), float_rounding_error(cloud.sensors)) >
                           options.coordinate_precision;
  const std::string header = points_header(cloud, options, report.double_coordinates ? "double" : "float");

  file.append(header);
  const PlyStyle style{options.ascii, report.double_coordinates};
  const size_t sample_values = 13 + cloud.columns.size();
  write_rows(file, style, cloud.size(), sample_values, context, [&](size_t i, PlyBody& body) {
    body.put_position(cloud.positions[i]);
    if (!cloud.normals.empty()) body.put(cloud.normals[i]);
    if (!cloud.sensors.empty()) body.put_position(cloud.sensors[i]);
    if (!cloud.weights.empty()) body.put(cloud.weights[i]);
    if (!cloud.colors.empty()) body.put_color(cloud.colors[i]);
    for (const Column& column : cloud.columns) body.put(column.values[i]);
  });
  put_range_grids(file, style, cloud.scans, context);
  return report;
}

}  // namespace soapfilm::io
