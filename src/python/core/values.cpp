// SPDX-License-Identifier: Apache-2.0
#include "python/core/values.h"

#include <cmath>

namespace sightglass::python {

namespace py = pybind11;

namespace {

bool is_whole(py::handle o) { return PyLong_Check(o.ptr()) || (PyIndex_Check(o.ptr()) && !PyBool_Check(o.ptr())); }

[[noreturn]] void fail_type(const std::string& name, py::handle o) {
  throw py::type_error("parameter '" + name + "' takes numbers, text, or lists of them, not " +
                       py::str(py::type::handle_of(o).attr("__name__")).cast<std::string>());
}

int64_t whole(py::handle o) {
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(o.ptr()));
  if (!index) throw py::error_already_set();
  return index.cast<int64_t>();
}

Value list_of(const std::string& name, py::handle o) {
  std::vector<py::object> all;
  for (const py::handle h : py::reinterpret_borrow<py::object>(o)) {
    if (py::isinstance<py::sequence>(h) && !py::isinstance<py::str>(h)) {  // a list of points: their numbers one after the other
      for (const py::handle inner : h) all.push_back(py::reinterpret_borrow<py::object>(inner));
    } else {
      all.push_back(py::reinterpret_borrow<py::object>(h));
    }
  }
  bool texts = !all.empty(), wholes = true;
  for (const py::object& x : all) texts = texts && py::isinstance<py::str>(x), wholes = wholes && is_whole(x);
  if (texts) {
    std::vector<std::string> words;
    for (const py::object& x : all) words.push_back(x.cast<std::string>());
    return words;
  }
  if (wholes) {
    std::vector<int64_t> numbers;
    for (const py::object& x : all) numbers.push_back(whole(x));
    return numbers;
  }
  std::vector<double> numbers;
  for (const py::object& x : all) {
    if (!PyNumber_Check(x.ptr())) fail_type(name, x);
    numbers.push_back(py::float_(x));
  }
  return numbers;
}

}  // namespace

Value value_of(const std::string& name, py::handle o) {
  if (o.is_none()) return {};
  if (PyBool_Check(o.ptr())) return o.cast<bool>();
  if (py::isinstance<py::str>(o)) return o.cast<std::string>();
  if (py::hasattr(o, "__fspath__")) return py::str(o.attr("__fspath__")()).cast<std::string>();
  if (py::hasattr(o, "ndim"))  // of numpy
    return o.attr("ndim").cast<int>() == 0 ? value_of(name, o.attr("item")()) : list_of(name, o);
  if (is_whole(o)) return whole(o);
  if (PyFloat_Check(o.ptr())) return o.cast<double>();
  if (py::isinstance<py::bytes>(o) || py::isinstance<py::dict>(o)) fail_type(name, o);
  if (py::isinstance<py::iterable>(o)) return list_of(name, o);
  if (PyNumber_Check(o.ptr())) return double(py::float_(py::reinterpret_borrow<py::object>(o)));
  fail_type(name, o);
}

Params params_of(const py::dict& stated) {
  Params params;
  for (const auto& [name, value] : stated)
    if (!value.is_none()) params.push_back({name.cast<std::string>(), value_of(name.cast<std::string>(), value)});
  return params;
}

}  // namespace sightglass::python
