// Keyword arguments of Python, as the values of parameter structs. An absent key keeps the default.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "soapfilm/error.h"
#include "soapfilm/vec.h"

namespace soapfilm::python {

namespace py = pybind11;

class Given {
 public:
  explicit Given(const py::dict& values) : values_(values) {}

  bool has(const char* key) const { return values_.contains(key); }

  template <class T>
  void take(const char* key, T& value, const char* kind = "a number") const {
    if (!has(key)) return;
    try {
      value = py::cast<T>(values_[key]);
    } catch (const py::cast_error&) {
      refuse(key, kind);
    }
  }
  template <class T>
  void take(const char* key, std::optional<T>& value, const char* kind) const {
    if (!has(key)) return;
    T inner{};
    take(key, inner, kind);
    value = inner;
  }
  void take(const char* key, Vec3d& value, const char* kind = "three numbers") const {
    std::array<double, 3> v{value.x, value.y, value.z};
    take(key, v, kind);
    value = {v[0], v[1], v[2]};
  }
  void take(const char* key, std::vector<Vec3d>& value, const char* kind = "rows of three numbers") const {
    std::vector<std::array<double, 3>> rows;
    take(key, rows, kind);
    if (has(key)) value.clear();
    for (const auto& [x, y, z] : rows) value.push_back({x, y, z});
  }
  void take_pair(const char* key, double& low, double& high) const {
    std::pair<double, double> pair{low, high};
    take(key, pair, "two numbers");
    low = pair.first, high = pair.second;
  }
  /// A length in input units, or text such as "0.5%": of `longest`.
  void take_length(const char* key, double longest, double& value) const {
    if (!has(key)) return;
    if (!py::isinstance<py::str>(values_[key])) return take(key, value, "a length, or text such as '0.5%'");
    const auto text = py::cast<std::string>(values_[key]);
    size_t used = 0;
    try {
      value = std::stod(text, &used) * longest / 100;
    } catch (const std::exception&) {
      used = 0;
    }
    if (used == 0 || text.substr(used) != "%") refuse(key, "a length, or text such as '0.5%'");
  }
  /// One of the names of an enumeration's values.
  template <class T>
  void take_name(const char* key, std::initializer_list<std::pair<const char*, T>> names, T& value) const {
    if (!has(key)) return;
    std::string known;
    for (const auto& [name, meaning] : names) {
      if (py::object(values_[key]).equal(py::str(name))) {
        value = meaning;
        return;
      }
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    refuse(key, ("one of " + known).c_str());
  }

 private:
  [[noreturn]] void refuse(const char* key, const char* kind) const {
    throw ParameterError(std::string(key) + " = " + py::cast<std::string>(py::repr(values_[key])) + ", must be " +
                         kind);
  }

  py::dict values_;
};

}  // namespace soapfilm::python
