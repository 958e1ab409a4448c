#include "errors.h"

#include <pybind11/pybind11.h>

#include <exception>

#include "soapfilm/error.h"

namespace soapfilm::python {

namespace py = pybind11;

namespace {

py::object class_named(const char* name) { return py::module_::import("soapfilm.errors").attr(name); }

void raise(const char* name, const std::exception& error) { PyErr_SetString(class_named(name).ptr(), error.what()); }

}  // namespace

void translate_errors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const SamplesError& error) {
      raise("SamplesError", error);
    } catch (const ParameterError& error) {
      raise("ParameterError", error);
    } catch (const InputError& error) {
      raise("InputError", error);
    } catch (const OutputError& error) {
      raise("OutputError", error);
    } catch (const MemoryError& error) {
      raise("OutOfMemory", error);
    } catch (const EmptyResult& error) {
      const py::object type = class_named("EmptyResult");
      const py::object value = type(error.what(), error.largest_lambda);
      PyErr_SetObject(type.ptr(), value.ptr());
    }
  });
}

}  // namespace soapfilm::python
