#include "result.h"

#include <pybind11/stl.h>

#include <utility>
#include <vector>

#include "arrays.h"
#include "soapfilm/io.h"
#include "soapfilm/simplify.h"
#include "work.h"

namespace soapfilm::python {

namespace {

/// `attributes`: (name, array) each. The Python side has checked shapes and types. `voxel`: of a result, else 0.
MeshHolder mesh_of(const py::object& vertices, const py::object& triangles, const py::object& normals,
                   const py::object& colors, const py::list& attributes, double voxel) {
  const auto mesh = std::make_shared<Mesh>();
  const Table vertex(vertices), corner(triangles), normal(normals), color(colors);
  mesh->vertices.resize(vertex.rows());
  for (size_t i = 0; i < vertex.rows(); ++i) mesh->vertices[i] = vertex.vector<double>(i);
  mesh->triangles.resize(corner.rows());
  for (size_t i = 0; i < corner.rows(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      const auto index = corner.at<int64_t>(i, k);
      if (index < 0 || static_cast<size_t>(index) >= vertex.rows())
        throw ParameterError("triangle " + std::to_string(i) + ": vertex " + std::to_string(index) +
                             ", must be in [0, " + std::to_string(vertex.rows()) + ")");
      mesh->triangles[i][k] = static_cast<uint32_t>(index);
    }
  if (normal) {
    mesh->normals.resize(normal.rows());
    for (size_t i = 0; i < normal.rows(); ++i) mesh->normals[i] = normal.vector<float>(i);
  }
  if (color) {
    mesh->colors.resize(color.rows());
    for (size_t i = 0; i < color.rows(); ++i)
      for (size_t k = 0; k < 3; ++k) mesh->colors[i][k] = color.at<uint8_t>(i, k);
  }
  for (const py::handle& entry : attributes) {
    const auto given = py::cast<py::tuple>(entry);
    const Table values(given[1]);
    Column& column = mesh->attributes.emplace_back(Column{py::cast<std::string>(given[0]), {}, false});
    column.values.resize(values.rows());
    for (size_t i = 0; i < values.rows(); ++i) column.values[i] = values.at<float>(i);
  }
  return {mesh, voxel};
}

py::list attributes_of(const MeshHolder& holder) {
  py::list attributes;
  for (const Column& column : holder.mesh->attributes)
    attributes.append(py::make_tuple(column.name, view_of<float>(holder.mesh, column.values)));
  return attributes;
}

/// With the precision that the program writes its results with. Returns warnings.
std::vector<std::string> save_mesh(const MeshHolder& holder, const std::string& path, bool ascii,
                                   const std::string& up) {
  WriteOptions options;
  const int axis = up.back() - 'x';  // "x" to "z", "-x" to "-z"
  options.up = static_cast<Axis>(static_cast<int>(up.front() == '-' ? Axis::minus_x : Axis::x) + axis);
  options.ascii = ascii;
  options.coordinate_precision = 1e-3 * holder.voxel;
  options.voxel = holder.voxel;
  const py::gil_scoped_release unlocked;
  return write_mesh(path, *holder.mesh, options, Context(0)).warnings;
}

py::dict topology_of(const MeshHolder& holder) {
  const TopologyReport t = [&] {
    const py::gil_scoped_release unlocked;
    return check_topology(*holder.mesh);
  }();
  py::dict facts;
  facts["vertices"] = t.vertices;
  facts["triangles"] = t.triangles;
  facts["closed"] = t.closed();
  facts["manifold"] = t.manifold();
  facts["watertight"] = t.watertight();
  facts["components"] = t.components.size();
  facts["genus"] = t.genus();
  facts["boundary_edges"] = t.boundary_edges;
  facts["non_manifold_edges"] = t.non_manifold_edges;
  facts["non_manifold_vertices"] = t.non_manifold_vertices;
  return facts;
}

/// The mesh and warnings.
std::pair<MeshHolder, std::vector<std::string>> read_file(const std::string& path) {
  const py::gil_scoped_release unlocked;
  ReadReport report;
  auto mesh = std::make_shared<const Mesh>(read_mesh(path, &report));
  return {{std::move(mesh)}, std::move(report.warnings)};
}

/// `triangles` > 0: at most so many, else within `tolerance`. The mesh and its report.
std::pair<MeshHolder, py::dict> simplify_mesh(const MeshHolder& holder, double tolerance, size_t triangles, int threads,
                                              const py::object& on_event) {
  Simplified found;
  work_beside_python(threads, on_event, [&](const Context& context) {
    found = triangles > 0 ? simplify_to(*holder.mesh, triangles, context) : simplify(*holder.mesh, tolerance, context);
  });
  py::dict report;
  report["triangles_before"] = found.report.triangles_before;
  report["triangles"] = found.report.triangles;
  report["tolerance"] = found.report.tolerance;
  report["proved"] = found.report.proved;
  return {{std::make_shared<const Mesh>(std::move(found.mesh)), holder.voxel}, report};
}

}  // namespace

void add_meshes(py::module_& module) {
  py::class_<MeshHolder>(module, "Mesh")
      .def_property_readonly("vertices", [](const MeshHolder& m) { return view_of<double>(m.mesh, m.mesh->vertices); })
      .def_property_readonly("triangles",
                             [](const MeshHolder& m) { return view_of<uint32_t>(m.mesh, m.mesh->triangles); })
      .def_property_readonly("normals",
                             [](const MeshHolder& m) { return optional_view<float>(m.mesh, m.mesh->normals); })
      .def_property_readonly("colors",
                             [](const MeshHolder& m) { return optional_view<uint8_t>(m.mesh, m.mesh->colors); })
      .def_property_readonly("attributes", &attributes_of)
      .def_property_readonly("area", [](const MeshHolder& m) { return m.mesh->area(); })
      .def_property_readonly("volume", [](const MeshHolder& m) { return m.mesh->volume(); })
      .def_property_readonly("voxel", [](const MeshHolder& m) { return m.voxel; })
      .def("topology", &topology_of)
      .def("save", &save_mesh);
  module.def("mesh_of", &mesh_of);
  module.def("read_mesh", &read_file);
  module.def("simplify", &simplify_mesh);
}

}  // namespace soapfilm::python
