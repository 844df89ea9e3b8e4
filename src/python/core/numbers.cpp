// SPDX-License-Identifier: Apache-2.0
#include "python/core/numbers.h"

#include <unordered_map>
#include <vector>

namespace sightglass::python {

namespace py = pybind11;

namespace {

// An array that was writable: how often it is lent, and views of it that wait until it is writable again.
struct Locked {
  size_t times = 0;
  std::vector<PyObject*> waiting;
};
// Under the interpreter's lock.
std::unordered_map<PyObject*, Locked>& locked() {
  static auto* all = new std::unordered_map<PyObject*, Locked>();  // outlives what is destroyed at the end
  return *all;
}

// What it is a view of, among what is locked; null for nothing.
Locked* locked_below(PyObject* array) {
  for (auto o = py::reinterpret_borrow<py::object>(array).attr("base").cast<py::object>(); py::isinstance<py::array>(o); o = o.attr("base"))
    if (const auto found = locked().find(o.ptr()); found != locked().end()) return &found->second;
  return nullptr;
}

void unlock(PyObject* array) {
  if (Locked* below = locked_below(array)) {  // a view may be written only where its owner may
    Py_INCREF(array);
    below->waiting.push_back(array);
    return;
  }
  if (PyObject_HasAttrString(array, "flags")) py::reinterpret_borrow<py::object>(array).attr("flags").attr("writeable") = true;
}

// Holds a numpy array and what it is a view of, all of them read-only until the last who holds them lets go. That may be on any thread.
class Lent {
 public:
  Lent(const py::array& used, const py::object& given) {
    take(used);
    if (!given.is(used)) take(given);
  }
  ~Lent() {
    if (!Py_IsInitialized()) return;  // the program ends: the memory goes with it
    const py::gil_scoped_acquire lock;
    for (auto i = arrays_.rbegin(); i != arrays_.rend(); ++i) {
      const auto array = py::reinterpret_steal<py::object>(*i);
      try {
        release(*i);
      } catch (py::error_already_set& e) {
        e.discard_as_unraisable("sightglass: giving an array back");
      }
    }
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

 private:
  void take(py::object o) {
    for (; py::isinstance<py::array>(o); o = o.attr("base")) {
      if (const auto known = locked().find(o.ptr()); known != locked().end()) ++known->second.times;
      else if (o.attr("flags").attr("writeable").cast<bool>()) o.attr("flags").attr("writeable") = false, locked()[o.ptr()].times = 1;
      arrays_.push_back(o.inc_ref().ptr());
    }
  }
  static void release(PyObject* array) {
    const auto known = locked().find(array);
    if (known == locked().end() || --known->second.times > 0) return;
    const std::vector<PyObject*> waiting = std::move(known->second.waiting);
    locked().erase(known);
    unlock(array);
    for (PyObject* view : waiting) {
      const auto held = py::reinterpret_steal<py::object>(view);
      if (locked().find(view) == locked().end()) unlock(view);  // not lent again meanwhile
    }
  }

  std::vector<PyObject*> arrays_;
};

template <class T>
Array wrapped(const py::array& a, std::shared_ptr<const void> owner) {
  const auto* first = static_cast<const T*>(a.data());
  const auto count = size_t(a.shape(0));
  const int components = a.ndim() == 2 ? int(a.shape(1)) : 1;
  const auto stride = size_t(a.strides(0));
  if (count < 2 || stride == size_t(components) * sizeof(T))
    return Array::wrap(std::span<const T>(first, count * size_t(components)), components, std::move(owner));
  return Array::wrap_strided(first, count, components, stride, std::move(owner));
}

template <class T>
py::array view(const Array& a) {
  const std::span<const T> numbers = a.as<T>();
  auto* owner = new Array(a);
  const py::capsule keep(owner, [](void* p) { delete static_cast<Array*>(p); });
  std::vector<py::ssize_t> shape{py::ssize_t(a.count())};
  if (a.components() != 1) shape.push_back(a.components());
  static const T nothing{};
  py::array_t<T> r(shape, numbers.empty() ? &nothing : numbers.data(), keep);
  r.attr("flags").attr("writeable") = false;
  return r;
}

}  // namespace

Array array_of(const Numbers& numbers) {
  const py::array& a = numbers.used;
  const auto owner = std::make_shared<const Lent>(a, numbers.given);
  const char kind = a.dtype().kind();
  const auto size = a.itemsize();
  if (kind == 'f' && size == 4) return wrapped<float>(a, owner);
  if (kind == 'f' && size == 8) return wrapped<double>(a, owner);
  if (kind == 'u' && size == 1) return wrapped<uint8_t>(a, owner);
  if (kind == 'u' && size == 2) return wrapped<uint16_t>(a, owner);
  if (kind == 'u' && size == 4) return wrapped<uint32_t>(a, owner);
  if (kind == 'u' && size == 8) return wrapped<uint64_t>(a, owner);
  if (kind == 'i' && size == 1) return wrapped<int8_t>(a, owner);
  if (kind == 'i' && size == 2) return wrapped<int16_t>(a, owner);
  if (kind == 'i' && size == 4) return wrapped<int32_t>(a, owner);
  if (kind == 'i' && size == 8) return wrapped<int64_t>(a, owner);
  throw py::type_error("numbers of type " + py::str(a.dtype()).cast<std::string>() + " are not known");
}

py::array numpy_of(const Array& a) {
  try {
    switch (a.type()) {
      case Type::u8: return view<uint8_t>(a);
      case Type::i8: return view<int8_t>(a);
      case Type::u16: return view<uint16_t>(a);
      case Type::i16: return view<int16_t>(a);
      case Type::u32: return view<uint32_t>(a);
      case Type::i32: return view<int32_t>(a);
      case Type::u64: return view<uint64_t>(a);
      case Type::i64: return view<int64_t>(a);
      case Type::f32: return view<float>(a);
      case Type::f64: return view<double>(a);
    }
  } catch (const Error&) {  // they lie apart
  }
  return view<double>(Array(a.numbers(), a.components()));
}

}  // namespace sightglass::python
