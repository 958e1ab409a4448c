#include "arrays.h"

namespace soapfilm::python {

namespace {

py::buffer_info buffer_of(const View& view) {
  static const double nothing = 0;  // numpy wants an address for an array without rows, too
  std::vector<py::ssize_t> strides(view.shape.size(), static_cast<py::ssize_t>(view.value_bytes));
  if (view.shape.size() > 1) strides[0] *= view.shape[1];
  void* data = const_cast<void*>(view.data ? view.data : &nothing);
  return py::buffer_info(data, static_cast<py::ssize_t>(view.value_bytes), view.format,
                         static_cast<py::ssize_t>(view.shape.size()), view.shape, std::move(strides), true);
}

}  // namespace

void add_views(py::module_& module) {
  py::class_<View>(module, "View", py::buffer_protocol(),
                   "Memory of the library for numpy.asarray(): read-only, alive as long as the array.")
      .def_buffer(&buffer_of);
}

}  // namespace soapfilm::python
