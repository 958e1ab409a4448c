// Meshes and results for Python.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <string>

#include "soapfilm/mesh.h"

namespace soapfilm::python {

struct MeshHolder {
  std::shared_ptr<const Mesh> mesh;
  double voxel = 0;  ///< of a result, input units; 0: none
};

void add_meshes(pybind11::module_& module);
void add_runs(pybind11::module_& module);

}  // namespace soapfilm::python
