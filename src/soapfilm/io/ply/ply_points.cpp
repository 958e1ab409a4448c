#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "soapfilm/core/memory.h"
#include "soapfilm/core/vec.h"
#include "soapfilm/error.h"
#include "soapfilm/io/meshes/face_normals.h"
#include "soapfilm/io/ply/ply.h"
#include "soapfilm/io/ply/ply_faces.h"
#include "soapfilm/io/ply/ply_rows.h"
#include "soapfilm/io/ply/ply_scans.h"
#include "soapfilm/io/ply/ply_vertex.h"
#include "soapfilm/io/point_stream.h"
#include "soapfilm/io/text/text.h"

namespace soapfilm::io {

namespace {

/// One column of rows of nothing but floats.
template <class T>
void append_column(const char* rows, size_t count, size_t row_bytes, const Triple& triple,
                   std::vector<Vec3<T>>& column) {
  if (!triple.present()) return;
  const size_t first = column.size();
  column.resize(first + count);
  for (size_t i = 0; i < count; ++i)
    for (int axis = 0; axis < 3; ++axis)
      column[first + i][axis] =
          static_cast<T>(load<float>(rows + i * row_bytes + triple[static_cast<size_t>(axis)] * sizeof(float), false));
}

/// What the header says: a column for each scalar property that has no meaning here.
PointHeader point_header(const PlyElement& vertex, const PlyVertexLayout& layout) {
  PointHeader header{vertex.count,
                     layout.normal.present(),
                     layout.sensor.present(),
                     layout.weight != Triple::absent,
                     layout.has_color(),
                     {}};
  header.colors_in_range_of_all = layout.has_number_colors();
  for (const size_t k : layout.others) header.columns.push_back(vertex.properties[k].name);
  return header;
}

/// Rows of nothing but floats, some at a time while they are in the cache.
void read_floats(PlyRows& rows, const PlyElement& vertex, const PlyVertexLayout& layout, PointStream& stream) {
  constexpr uint64_t rows_at_once = 1 << 12;
  const size_t row_bytes = vertex.properties.size() * sizeof(float);
  for (uint64_t i = 0; i < vertex.count; i += rows_at_once) {
    const size_t count = std::min(rows_at_once, vertex.count - i);
    const char* at = rows.take_floats(count);
    PointCloud& cloud = stream.samples();
    append_column(at, count, row_bytes, layout.position, cloud.positions);
    append_column(at, count, row_bytes, layout.normal, cloud.normals);
    append_column(at, count, row_bytes, layout.sensor, cloud.sensors);
    for (size_t c = 0; c < layout.others.size(); ++c)
      for (size_t k = 0; k < count; ++k)
        cloud.columns[c].values.push_back(load<float>(at + k * row_bytes + layout.others[c] * sizeof(float), false));
    stream.pass();
  }
}

void read_samples(PlyRows& rows, const PlyElement& vertex, const PlyVertexLayout& layout, const std::string& path,
                  PointStream& stream) {
  rows.begin(vertex);
  stream.begin(point_header(vertex, layout), path);
  const bool weighted = layout.weight != Triple::absent;
  if (rows.plain_floats() && !weighted && !layout.has_color()) return read_floats(rows, vertex, layout, stream);

  for (uint64_t i = 0; i < vertex.count; ++i) {
    rows.next();
    PointCloud& cloud = stream.samples();
    cloud.positions.push_back(read(rows, layout.position));
    if (layout.normal.present()) cloud.normals.push_back(static_cast<Vec3f>(read(rows, layout.normal)));
    if (layout.sensor.present()) cloud.sensors.push_back(read(rows, layout.sensor));
    add_color(rows, layout, cloud.colors, stream.colors());
    if (weighted) {
      const float weight = static_cast<float>(rows.scalar(layout.weight));
      if (!(weight >= 0) || !std::isfinite(weight))
        rows.fail(fmt::format("weight = {}, must be finite and >= 0", rows.scalar(layout.weight)));
      cloud.weights.push_back(weight);
    }
    for (size_t c = 0; c < layout.others.size(); ++c)
      cloud.columns[c].values.push_back(static_cast<float>(rows.scalar(layout.others[c])));
    stream.pass();
  }
}

/// One entry per cell of the range grids: a sample's index in the file, -1 for none.
std::vector<int32_t> read_range_grid(PlyRows& rows, const PlyElement& grid, uint64_t samples) {
  const size_t property = grid.find_list("vertex_indices");
  rows.begin(grid);
  std::vector<int32_t> cells;
  cells.reserve(grid.count);
  for (uint64_t i = 0; i < grid.count; ++i) {
    rows.next();
    const std::span<const double> list = rows.list(property);
    if (list.size() > 1) rows.fail(fmt::format("{} samples in a cell, must be 0 or 1", list.size()));
    if (list.empty()) {
      cells.push_back(-1);
      continue;
    }
    if (!(list[0] >= 0) || list[0] >= static_cast<double>(samples))
      rows.fail(fmt::format("sample index = {}, must be from 0 to {}", list[0], samples - 1));
    cells.push_back(static_cast<int32_t>(list[0]));
  }
  return cells;
}

/// Gives each scan its part of the cells, as indices relative to the scan's first sample.
void share_out_range_grids(const std::vector<int32_t>& cells, std::vector<PlyScan>& scans, const std::string& path) {
  auto cell = cells.begin();
  for (PlyScan& from : scans) {
    const uint64_t left = static_cast<uint64_t>(cells.end() - cell);
    if (from.cells() > left || (&from == &scans.back() && from.cells() != left))
      throw InputError(fmt::format("{}: element 'range_grid': {} cells for scan {}, must be num_cols * num_rows = {}",
                                   path, left, in_quotes(from.scan.name), from.cells()));
    if (from.cells() == 0) continue;
    RangeGrid grid;
    grid.columns = static_cast<int>(from.columns);
    grid.rows = static_cast<int>(from.rows);
    grid.sample.reserve(from.cells());
    for (uint64_t i = 0; i < from.cells(); ++i, ++cell) {
      const bool seen = *cell >= 0;
      if (seen && (static_cast<size_t>(*cell) < from.scan.begin || static_cast<size_t>(*cell) >= from.scan.end))
        throw InputError(fmt::format("{}: range_grid {}: sample index = {}, must be from {} to {} (its scan)", path,
                                     cell - cells.begin(), *cell, from.scan.begin, from.scan.end - 1));
      grid.sample.push_back(seen ? *cell - static_cast<int32_t>(from.scan.begin) : -1);
    }
    from.scan.range_grid = std::move(grid);
  }
}

/// What the header says of elements besides the vertices.
struct PlyPlan {
  bool has_faces = false;
  bool faces_tell_normals = false;  ///< the vertices have none
  bool faces_first = false;         ///< before the vertices
  Triple camera;                    ///< where the scanner stood, among the properties of element `camera`
  bool grid_sizes_known = false;
};

PlyPlan plan_of(const PlyHeader& header, const PlyVertexLayout& layout, const std::vector<PlyScan>& scans) {
  PlyPlan plan;
  for (const PlyElement& element : header.elements) {
    if (element.count > 0 && index_list(element) != PlyElement::absent) plan.has_faces = true;
    plan.faces_tell_normals = plan.has_faces && !layout.normal.present();
    if (element.name == "vertex") plan.faces_first = plan.faces_tell_normals;
    if (element.name == "camera" && element.count == 1 && scans.size() == 1)
      plan.camera.index = {element.find_scalar("view_px"), element.find_scalar("view_py"),
                           element.find_scalar("view_pz")};
  }
  plan.grid_sizes_known = std::any_of(scans.begin(), scans.end(), [](const PlyScan& scan) { return scan.cells() > 0; });
  return plan;
}

/// The camera of a range mesh stood where the scanner did. Programs that do not know write zeros.
void read_camera(PlyRows& rows, const PlyElement& camera, const Triple& place, Scan& scan) {
  rows.begin(camera);
  rows.next();
  const Vec3d position = read(rows, place);
  if (is_finite(position) && !(position == Vec3d{}) && !scan.sensor && !scan.view_direction) scan.sensor = position;
}

void add_faces(PlyRows& rows, const PlyElement& element, uint64_t vertices, FaceNormals& normals) {
  read_ply_faces(rows, element, index_list(element), vertices,
                 [&](std::span<const uint32_t> corners) { normals.add(corners); });
}

/// The faces of a file that has them before its vertices, once those were read.
void add_all_faces(ByteSource& source, const PlyHeader& header, uint64_t vertices, FaceNormals& normals) {
  PlyRows rows(source, header);
  for (const PlyElement& element : header.elements) {
    if (index_list(element) == PlyElement::absent)
      rows.skip(element);
    else
      add_faces(rows, element, vertices, normals);
  }
}

void warn_of_unused(const PlyHeader& header, const PlyPlan& plan, const std::string& path, ReadReport& report) {
  std::vector<std::string> unused;
  for (const PlyElement& element : header.elements) {
    const bool is_used = element.name == "vertex" ||
                         (element.name == "range_grid" && element.find_list("vertex_indices") != PlyElement::absent) ||
                         index_list(element) != PlyElement::absent ||
                         (element.name == "camera" && plan.camera.present());
    if (!is_used && element.count > 0 && !element.properties.empty())
      unused.push_back("element " + in_quotes(element.name));
    if (element.name != "vertex") continue;
    for (const PlyProperty& property : element.properties)
      if (property.is_list()) unused.push_back("list " + in_quotes(property.name) + " of the vertices");
  }
  if (!unused.empty()) report.warnings.push_back(fmt::format("{}: not used: {}", path, fmt::join(unused, ", ")));
}

}  // namespace

void read_ply_points(ByteSource& source, PointSink& sink, ReadReport& report, const ReadOptions& options,
                     const Context& context) {
  const PlyHeader header = read_ply_header(source);
  const PlyElement& vertex = vertex_element(header, source.path());
  PlyVertexLayout layout = find_vertex_layout(vertex, source.path());
  std::vector<PlyScan> scans = find_scans(header, vertex.count, source.path());
  const PlyPlan plan = plan_of(header, layout, scans);
  warn_of_unused(header, plan, source.path(), report);
  warn_of_stray_lines(header, source.path(), report);
  warn_of_color_parts(layout, source.path(), report.warnings);

  keep_attributes(options.attributes, layout.names, layout);
  layout.splats = layout.splat_color.present();
  PointStream stream(sink);
  if (plan.faces_tell_normals || (plan.grid_sizes_known && header.find("range_grid"))) stream.keep_whole();
  std::optional<FaceNormals> normals;
  PlyRows rows(source, header, &context);
  for (const PlyElement& element : header.elements) {
    const bool is_grid = element.name == "range_grid" && element.find_list("vertex_indices") != PlyElement::absent;
    if (element.name == "vertex") {
      read_samples(rows, element, layout, source.path(), stream);
      if (plan.faces_tell_normals) normals.emplace(stream.samples().positions);
    } else if (normals && !plan.faces_first && index_list(element) != PlyElement::absent) {
      add_faces(rows, element, vertex.count, *normals);
    } else if (is_grid && plan.grid_sizes_known) {
      share_out_range_grids(read_range_grid(rows, element, vertex.count), scans, source.path());
    } else if (element.name == "camera" && plan.camera.present()) {
      read_camera(rows, element, plan.camera, scans[0].scan);
    } else {
      rows.skip(element);
      if (is_grid)
        report.warnings.push_back(source.path() + ": range grid ignored: the header lacks num_cols and num_rows");
    }
  }
  rows.finish(vertex, report);
  if (plan.faces_first) add_all_faces(source, header, vertex.count, *normals);
  const bool closed = normals && normals->closed();
  if (normals) stream.samples().normals = normals->finish();

  PointEnd end;
  for (PlyScan& scan : scans) end.scans.push_back(std::move(scan.scan));
  FileReport file;
  file.path = source.path();
  file.format = std::string(describe(header.format)) + (plan.faces_tell_normals ? ", normals from its faces" : "") +
                (layout.splats ? ", colors of splats (f_dc)" : "");
  file.properties = layout.names;
  const bool float32 = std::all_of(layout.position.index.begin(), layout.position.index.end(),
                                   [&](size_t k) { return vertex.properties[k].type == PlyType::float32; });
  stream.finish(
      std::move(end), std::move(file),
      {.float32 = float32, .has_faces = plan.has_faces, .closed = closed, .whole_colors = layout.whole_colors}, report);
  stream.close();
}

}  // namespace soapfilm::io
