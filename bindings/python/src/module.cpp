// soapfilm._core: what the Python package is made of. Everything users see is in soapfilm/*.py.
#include <pybind11/pybind11.h>

#include "arrays.h"
#include "errors.h"
#include "points.h"
#include "result.h"
#include "soapfilm/context.h"
#include "soapfilm/version.h"

namespace soapfilm::python {
#ifdef SOAPFILM_PYTHON_TOOLS
void add_tools(py::module_& module);
#endif
}  // namespace soapfilm::python

PYBIND11_MODULE(_core, module) {
  namespace py = pybind11;
  using namespace soapfilm::python;
  module.attr("version") = soapfilm::version;
  translate_errors();
  add_views(module);
  add_points(module);
  add_meshes(module);
  add_runs(module);
#ifdef SOAPFILM_PYTHON_TOOLS
  add_tools(module);
#endif
  module.attr("has_tools") = py::hasattr(module, "render");
}
