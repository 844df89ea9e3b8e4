// SPDX-License-Identifier: Apache-2.0
// The module _core: the C++ facade for the package sightglass.
#include "python/core/module.h"

#include "api/sightglass.h"
#include "python/core/calls.h"

namespace sightglass::python {

namespace py = pybind11;

namespace {

// sightglass.Error and its kinds are Python classes, so that they may derive from ValueError, KeyError and so on.
void raise(const Error& e) {
  constexpr const char* kinds[] = {"usage", "data", "internal", "cancelled"};
  const py::object made =
      py::module_::import("sightglass._errors").attr("made")(kinds[int(e.kind())], e.what(), e.problem(), e.where(), e.hint());
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
}

}  // namespace

PYBIND11_MODULE(_core, m) {
  remember_main_thread();
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const Error& e) {
      raise(e);
    }
  });
  declare_data(m);
  declare_pictures(m);
  m.def("version", &version);
  m.def("help", [](const std::string& operation) { return help(operation); });
  m.def("catalog_json", &catalog_json);
  m.def("show_progress", &show_progress);
  m.def("set_threads", &set_threads);
  m.def("set_memory_limit", &set_memory_limit);
}

}  // namespace sightglass::python
