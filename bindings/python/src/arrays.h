// Arrays of Python by the buffer protocol: in with any strides, out as views of the library's memory. NumPy itself is
// not needed here, so that it is loaded only by who uses arrays.
#pragma once

#include <pybind11/pybind11.h>

#include <cstddef>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "soapfilm/mesh.h"

namespace soapfilm::python {

namespace py = pybind11;

/// A read-only array whose memory lives as long as it is looked at.
struct View {
  std::shared_ptr<const void> owner;
  const void* data = nullptr;
  std::string format;  ///< of the module struct
  size_t value_bytes = 0;
  std::vector<py::ssize_t> shape;
};

template <class Value, class Row>
View view_of(std::shared_ptr<const void> owner, const std::vector<Row>& rows) {
  static_assert(sizeof(Row) % sizeof(Value) == 0);
  View view{std::move(owner), rows.data(), py::format_descriptor<Value>::format(), sizeof(Value), {}};
  view.shape.push_back(static_cast<py::ssize_t>(rows.size()));
  if (sizeof(Row) > sizeof(Value)) view.shape.push_back(sizeof(Row) / sizeof(Value));
  return view;
}

/// The same, and None for a column that is absent.
template <class Value, class Row>
py::object optional_view(std::shared_ptr<const void> owner, const std::vector<Row>& rows) {
  return rows.empty() ? py::object(py::none()) : py::cast(view_of<Value>(std::move(owner), rows));
}

/// Numbers of a caller in rows; the Python side has checked shape and type: float32, float64, uint8,
/// int32, uint32, int64.
class Table {
 public:
  explicit Table(const py::object& array) {
    if (array.is_none()) return;
    info_ = py::cast<py::buffer>(array).request();
    kind_ = info_.format.empty() ? 'B' : info_.format.back();
    if (kind_ == 'l') kind_ = 'q';  // both are 64 bits wide here
    if (kind_ == 'I' || kind_ == 'L') kind_ = info_.itemsize == 4 ? 'I' : 'q';
  }

  explicit operator bool() const { return kind_ != 0; }
  size_t rows() const { return info_.shape.empty() ? 0 : static_cast<size_t>(info_.shape[0]); }

  size_t columns() const { return info_.ndim > 1 ? static_cast<size_t>(info_.shape[1]) : 1; }

  template <class T>
  T at(size_t row, size_t k = 0) const {
    const char* from = static_cast<const char*>(info_.ptr) + static_cast<py::ssize_t>(row) * info_.strides[0];
    if (info_.ndim > 1) from += static_cast<py::ssize_t>(k) * info_.strides[1];
    switch (kind_) {
      case 'f':
        return static_cast<T>(load<float>(from));
      case 'd':
        return static_cast<T>(load<double>(from));
      case 'B':
        return static_cast<T>(load<uint8_t>(from));
      case 'i':
        return static_cast<T>(load<int32_t>(from));
      case 'I':
        return static_cast<T>(load<uint32_t>(from));
      default:
        return static_cast<T>(load<int64_t>(from));
    }
  }
  template <class T>
  Vec3<T> vector(size_t row) const {
    return {at<T>(row, 0), at<T>(row, 1), at<T>(row, 2)};
  }

 private:
  /// A caller's rows may be unaligned.
  template <class T>
  static T load(const char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
  }

  py::buffer_info info_;
  char kind_ = 0;
};

void add_views(py::module_& module);

}  // namespace soapfilm::python
