// Reconstructions: of a cloud, and of scans as they come.
#include <pybind11/stl.h>

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "points.h"
#include "result.h"
#include "soapfilm/reconstruct.h"
#include "work.h"

namespace soapfilm::python {

namespace py = pybind11;

namespace {

/// Scans as they come, and how they were read.
struct Scans {
  Reconstructor reconstructor;
  ReadReport read;
};

/// The mesh and report.json; lines about reading come before those of the run, as the program has them.
py::tuple result_of(Reconstruction&& found, const ReadReport& read, const std::optional<StageTime>& reading) {
  ReconstructReport& report = found.report;
  report.input.dropped = read.dropped();
  for (const FileReport& file : read.files) report.input.no_return += file.no_return;
  report.warnings.insert(report.warnings.begin(), read.warnings.begin(), read.warnings.end());
  if (reading) report.stages.insert(report.stages.begin(), *reading);
  MeshHolder mesh{std::make_shared<const Mesh>(std::move(found.mesh)), report.grid.voxel};
  return py::make_tuple(py::cast(std::move(mesh)), to_json(report));
}

/// `use_up`: the cloud may be freed during the run.
py::tuple run_points(Points& points, bool use_up, const std::string& parameters, int threads,
                     const py::object& on_event, std::optional<size_t> memory) {
  const ReconstructParams params = params_from_json(parameters);
  Reconstruction found;
  work_beside_python(
      threads, on_event,
      [&](const Context& context) {
        found = use_up ? reconstruct(take_cloud(points), params, context) : reconstruct(*points.cloud, params, context);
      },
      memory);
  return result_of(std::move(found), points.read, points.reading);
}

py::tuple run_scans(const Scans& scans, const std::string& parameters, int threads, const py::object& on_event,
                    std::optional<size_t> memory) {
  const ReconstructParams params = params_from_json(parameters);
  Reconstruction found;
  work_beside_python(
      threads, on_event, [&](const Context& context) { found = scans.reconstructor.reconstruct(params, context); },
      memory);
  return result_of(std::move(found), scans.read, std::nullopt);
}

void add_scan(Scans& scans, Points& points, bool use_up, const std::optional<std::array<double, 16>>& pose) {
  const py::gil_scoped_release unlocked;
  scans.reconstructor.add(use_up ? take_cloud(points) : *points.cloud, pose ? &*pose : nullptr);
  const ReadReport& read = points.read;
  scans.read.files.insert(scans.read.files.end(), read.files.begin(), read.files.end());
  scans.read.warnings.insert(scans.read.warnings.end(), read.warnings.begin(), read.warnings.end());
}

}  // namespace

void add_runs(py::module_& module) {
  module.def("reconstruct", &run_points, py::arg("points"), py::arg("use_up"), py::arg("parameters"),
             py::arg("threads"), py::arg("on_event"), py::arg("memory") = py::none());
  module.def("default_parameters", [] { return to_json(ReconstructParams{}); });
  py::class_<Scans>(module, "Scans")
      .def(py::init<>())
      .def("add", &add_scan)
      .def("reconstruct", &run_scans, py::arg("parameters"), py::arg("threads"), py::arg("on_event"),
           py::arg("memory") = py::none())
      .def_property_readonly("size", [](const Scans& s) { return s.reconstructor.cloud().size(); })
      .def_property_readonly("scans", [](const Scans& s) { return s.reconstructor.cloud().scans.size(); });
}

}  // namespace soapfilm::python
