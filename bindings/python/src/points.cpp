#include "points.h"

#include <pybind11/stl.h>

#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "arrays.h"
#include "work.h"

namespace soapfilm::python {

namespace {

/// Arrays of one or several scans, checked by soapfilm/_points.py; None where there is none.
struct Arrays {
  Table positions, normals, sensors, weights, colors;
  Table order;  ///< sample i is row order[i]; absent: row i
  size_t size() const { return order ? order.rows() : positions.rows(); }
  size_t row(size_t i) const { return order ? order.at<size_t>(i) : i; }
};

bool is_finite(Vec3d v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

[[noreturn]] void refuse(size_t row, const std::string& what) {
  throw SamplesError("sample " + std::to_string(row) + ": " + what);
}

void fill(const Arrays& arrays, PointCloud& cloud) {
  const size_t n = arrays.size();
  cloud.positions.resize(n);
  for (size_t i = 0; i < n; ++i) {
    cloud.positions[i] = arrays.positions.vector<double>(arrays.row(i));
    if (!is_finite(cloud.positions[i])) refuse(arrays.row(i), "position is not finite");
  }
  if (arrays.normals) {
    cloud.normals.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const Vec3d normal = arrays.normals.vector<double>(arrays.row(i));
      if (is_finite(normal)) cloud.normals[i] = static_cast<Vec3f>(normal);  // else zero: none
    }
  }
  if (arrays.sensors) {
    cloud.sensors.resize(n);
    for (size_t i = 0; i < n; ++i) cloud.sensors[i] = arrays.sensors.vector<double>(arrays.row(i));
  }
  if (arrays.weights) {
    cloud.weights.resize(n);
    for (size_t i = 0; i < n; ++i) {
      const double weight = arrays.weights.at<double>(arrays.row(i));
      if (!(weight >= 0 && std::isfinite(weight)))
        refuse(arrays.row(i), "weight = " + std::to_string(weight) + ", must be >= 0 and finite");
      cloud.weights[i] = static_cast<float>(weight);
    }
  }
  if (arrays.colors) {
    cloud.colors.resize(n);
    for (size_t i = 0; i < n; ++i)
      for (size_t k = 0; k < 3; ++k) cloud.colors[i][k] = arrays.colors.at<uint8_t>(arrays.row(i), k);
  }
}

std::optional<Vec3d> vector_in(const py::dict& facts, const char* key) {
  if (!facts.contains(key) || facts[key].is_none()) return {};
  const auto v = py::cast<std::array<double, 3>>(facts[key]);
  return Vec3d{v[0], v[1], v[2]};
}

/// A scan that begins where the one before it ends: `end`, and optionally `name`, `sensor`, `view_direction`,
/// `range_grid`.
Scan scan_of(const py::dict& facts, size_t begin) {
  Scan scan;
  scan.begin = begin;
  scan.end = py::cast<size_t>(facts["end"]);
  if (facts.contains("name")) scan.name = py::cast<std::string>(facts["name"]);
  scan.sensor = vector_in(facts, "sensor");
  scan.view_direction = vector_in(facts, "view_direction");
  const Table grid(facts.contains("range_grid") ? py::object(facts["range_grid"]) : py::none());
  if (!grid) return scan;
  RangeGrid& range = scan.range_grid.emplace();
  range.rows = static_cast<int>(grid.rows());
  range.columns = static_cast<int>(grid.columns());
  range.sample.reserve(grid.rows() * grid.columns());
  for (size_t row = 0; row < grid.rows(); ++row)
    for (size_t k = 0; k < grid.columns(); ++k) range.sample.push_back(grid.at<int32_t>(row, k));
  return scan;
}

FileReport file_of(const py::dict& facts) {
  return {py::cast<std::string>(facts["path"]),
          py::cast<std::string>(facts["format"]),
          py::cast<size_t>(facts["samples"]),
          py::cast<size_t>(facts["dropped"]),
          py::cast<size_t>(facts["no_return"]),
          py::cast<size_t>(facts["ignored_normals"]),
          py::cast<std::vector<std::string>>(facts["properties"])};
}

/// What facts_of() gave.
void take_facts(const py::dict& facts, Points& points) {
  points.cloud->coordinate_system = py::cast<std::string>(facts["coordinate_system"]);
  points.cloud->is_survey = py::cast<bool>(facts["is_survey"]);
  points.read.warnings = py::cast<std::vector<std::string>>(facts["warnings"]);
  for (const py::handle& file : py::cast<py::list>(facts["files"]))
    points.read.files.push_back(file_of(py::cast<py::dict>(file)));
}

/// `columns`: (name, array, is_label) each. `scans`: of scan_of(), in order. `facts`: of facts_of(), or empty.
Points points_of(const py::dict& columns_of_samples, const py::list& columns, const py::list& scans,
                 const py::dict& facts) {
  const auto table = [&](const char* key) { return Table(columns_of_samples[key]); };
  const Arrays arrays{table("positions"), table("normals"), table("sensors"),
                      table("weights"),   table("colors"),  table("order")};
  std::vector<std::pair<Column, Table>> values;
  for (const py::handle& entry : columns) {
    const auto column = py::cast<py::tuple>(entry);
    values.emplace_back(Column{py::cast<std::string>(column[0]), {}, py::cast<bool>(column[2])}, Table(column[1]));
  }
  Points points;
  PointCloud& cloud = *points.cloud;
  for (const py::handle& scan : scans)
    cloud.scans.push_back(scan_of(py::cast<py::dict>(scan), cloud.scans.empty() ? 0 : cloud.scans.back().end));
  if (!facts.empty()) take_facts(facts, points);
  const py::gil_scoped_release unlocked;
  fill(arrays, cloud);
  for (auto& [column, table_of] : values) {
    column.values.resize(cloud.size());
    for (size_t i = 0; i < cloud.size(); ++i) column.values[i] = table_of.at<float>(arrays.row(i));
    cloud.columns.push_back(std::move(column));
  }
  return points;
}

/// As the program: dropped samples are a warning, rays that met nothing a fact.
void tell_of_reading(const Points& points, Progress& progress) {
  for (const std::string& warning : points.read.warnings) progress.warn(warning);
  const size_t dropped = points.read.dropped(), size = points.cloud->size();
  if (dropped > 0)
    progress.warn(std::to_string(dropped) + " of " + std::to_string(dropped + size) + " samples dropped: not finite");
}

Points read_files(const std::vector<std::string>& paths, const std::string& columns, const std::string& trajectory,
                  bool trust_viewpoint, double spacing, int threads, const py::object& on_event) {
  Points points;
  work_beside_python(threads, on_event, [&](const Context& context) {
    const auto begin = std::chrono::steady_clock::now();
    const double cpu = context.cpu_seconds();
    context.progress().begin_stage("read");
    ReadOptions options{columns, trajectory, trust_viewpoint};
    options.spacing = spacing;
    *points.cloud = read_points(paths, &points.read, context, options);
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    context.progress().end_stage(elapsed);
    points.reading = StageTime{"read", elapsed, context.cpu_seconds() - cpu};
    tell_of_reading(points, context.progress());
  });
  return points;
}

py::tuple vector_of(Vec3d v) { return py::make_tuple(v.x, v.y, v.z); }
py::object vector_of(const std::optional<Vec3d>& v) { return v ? py::object(vector_of(*v)) : py::object(py::none()); }

py::list scans_of(const Points& points) {
  py::list scans;
  for (const Scan& scan : points.cloud->scans) {
    py::dict facts;
    facts["name"] = scan.name;
    facts["begin"] = scan.begin;
    facts["end"] = scan.end;
    facts["sensor"] = vector_of(scan.sensor);
    facts["view_direction"] = vector_of(scan.view_direction);
    facts["range_grid"] = py::none();
    if (const auto& grid = scan.range_grid) {
      View view = view_of<int32_t>(points.cloud, grid->sample);
      view.shape = {grid->rows, grid->columns};
      facts["range_grid"] = py::cast(std::move(view));
    }
    scans.append(facts);
  }
  return scans;
}

py::list columns_of(const Points& points) {
  py::list columns;
  for (const Column& column : points.cloud->columns)
    columns.append(py::make_tuple(column.name, view_of<float>(points.cloud, column.values), column.is_label));
  return columns;
}

py::list files_of(const Points& points) {
  py::list files;
  for (const FileReport& file : points.read.files) {
    py::dict facts;
    facts["path"] = file.path;
    facts["format"] = file.format;
    facts["samples"] = file.samples;
    facts["dropped"] = file.dropped;
    facts["no_return"] = file.no_return;
    facts["ignored_normals"] = file.ignored_normals;
    facts["properties"] = file.properties;
    files.append(facts);
  }
  return files;
}

/// What is neither of single samples nor of scans; for take_facts().
py::dict facts_of(const Points& points) {
  py::dict facts;
  facts["coordinate_system"] = points.cloud->coordinate_system;
  facts["is_survey"] = points.cloud->is_survey;
  facts["files"] = files_of(points);
  facts["warnings"] = points.read.warnings;
  return facts;
}

/// Both clouds, as further scans.
Points joined(const Points& first, const Points& second) {
  const py::gil_scoped_release unlocked;
  Points both;
  both.read = first.read;
  both.read.files.insert(both.read.files.end(), second.read.files.begin(), second.read.files.end());
  both.read.warnings.insert(both.read.warnings.end(), second.read.warnings.begin(), second.read.warnings.end());
  *both.cloud = *first.cloud;
  both.cloud->append(PointCloud(*second.cloud));
  return both;
}

void save_points(const Points& points, const std::string& path, bool ascii) {
  WriteOptions options;
  options.ascii = ascii;
  const py::gil_scoped_release unlocked;
  write_points(path, *points.cloud, options, Context(0));
}

}  // namespace

PointCloud take_cloud(Points& points) {
  if (points.cloud.use_count() > 1) return *points.cloud;
  return std::exchange(*points.cloud, {});
}

void add_points(py::module_& module) {
  py::class_<Points, std::shared_ptr<Points>>(module, "Points")
      .def_property_readonly("size", [](const Points& p) { return p.cloud->size(); })
      .def_property_readonly("positions", [](const Points& p) { return view_of<double>(p.cloud, p.cloud->positions); })
      .def_property_readonly("normals", [](const Points& p) { return optional_view<float>(p.cloud, p.cloud->normals); })
      .def_property_readonly("sensors",
                             [](const Points& p) { return optional_view<double>(p.cloud, p.cloud->sensors); })
      .def_property_readonly("weights", [](const Points& p) { return optional_view<float>(p.cloud, p.cloud->weights); })
      .def_property_readonly("colors", [](const Points& p) { return optional_view<uint8_t>(p.cloud, p.cloud->colors); })
      .def_property_readonly("columns", &columns_of)
      .def_property_readonly("scans", &scans_of)
      .def_property_readonly("files", &files_of)
      .def_property_readonly("warnings", [](const Points& p) { return p.read.warnings; })
      .def_property_readonly("coordinate_system", [](const Points& p) { return p.cloud->coordinate_system; })
      .def_property_readonly("facts", &facts_of)
      .def("joined", &joined)
      .def("save", &save_points);
  module.def("points_of", &points_of);
  module.def("read", &read_files);
}

}  // namespace soapfilm::python
