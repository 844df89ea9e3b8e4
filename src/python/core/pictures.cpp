// SPDX-License-Identifier: Apache-2.0
// Scenes and what is drawn of them.
#include <pybind11/stl.h>

#include <cstring>
#include <optional>

#include "python/core/calls.h"
#include "python/core/module.h"
#include "python/core/numbers.h"
#include "python/core/values.h"

namespace sightglass::python {

namespace py = pybind11;

namespace {

// Rows from the top; a view that keeps the picture.
py::array pixels_of(const Image& image) {
  auto* owner = new Image(image);
  const py::capsule keep(owner, [](void* p) { delete static_cast<Image*>(p); });
  py::array_t<uint8_t> r({py::ssize_t(image.height()), py::ssize_t(image.width()), py::ssize_t(image.channels())}, owner->pixels().data(),
                         keep);
  r.attr("flags").attr("writeable") = false;
  return r;
}

// One number a pixel; a view that keeps the picture. Empty for the pictures of a film.
template <class T>
py::array plane_of(const Image& image, std::span<const T> (Image::*plane)() const) {
  auto* owner = new Image(image);
  const py::capsule keep(owner, [](void* p) { delete static_cast<Image*>(p); });
  const std::span<const T> numbers = (owner->*plane)();
  py::array_t<T> r({py::ssize_t(numbers.empty() ? 0 : image.height()), py::ssize_t(image.width())}, numbers.data(), keep);
  r.attr("flags").attr("writeable") = false;
  return r;
}

// Of a scene or a pipeline.
template <class T>
std::string page_of(const T& of, const py::dict& params, int width, int height) {
  const Params stated = params_of(params);
  return call([&](const Context& context) { return of.page(stated, width, height, context); });
}

// f(context), while pictures on the way go to a Python function. What that raises ends the work.
template <class F>
Image watched(const py::object& on_picture, F&& f) {
  if (on_picture.is_none()) return call(f);
  std::optional<py::error_already_set> raised;
  try {
    Image image = call([&](Context& context) {
      context.on_picture([&](const Image& image) {
        const py::gil_scoped_acquire locked;
        try {
          if (!raised) on_picture(image);
        } catch (py::error_already_set& e) {
          raised.emplace(e), context.cancel();
        }
      });
      return f(context);
    });
    if (raised) throw *raised;  // the work was done before it could be cancelled
    return image;
  } catch (const Error&) {
    if (raised) throw *raised;
    throw;
  }
}

template <size_t N>
py::array_t<uint8_t> colors_of(const std::vector<std::array<uint8_t, N>>& colors) {
  py::array_t<uint8_t> r({py::ssize_t(colors.size()), py::ssize_t(N)});
  if (!colors.empty()) std::memcpy(r.mutable_data(), colors.data(), N * colors.size());
  return r;
}

// Title, unit, scale, low, high, colours, entries (value, name, colour), opacity.
py::tuple legend_of(const Legend& l) {
  py::list entries, opacity;
  for (const Legend::Entry& e : l.entries)
    entries.append(py::make_tuple(e.value, e.name, py::make_tuple(e.color[0], e.color[1], e.color[2])));
  for (const auto& [value, share] : l.opacity) opacity.append(py::make_tuple(value, share));
  return py::make_tuple(l.title, l.unit, l.scale, l.low, l.high, colors_of(l.colors), entries, opacity);
}

void declare_image(py::module_& m) {
  py::class_<Image>(m, "Image")
      .def_property_readonly("width", &Image::width)
      .def_property_readonly("height", &Image::height)
      .def("pixels", &pixels_of)
      .def("depth", [](const Image& image) { return plane_of(image, &Image::depth); })
      .def("error", [](const Image& image) { return plane_of(image, &Image::error); })
      .def("ids", [](const Image& image) { return plane_of(image, &Image::ids); })
      .def("legends",
           [](const Image& image) {
             py::list r;
             for (const Legend& l : image.legends()) r.append(legend_of(l));
             return r;
           })
      .def("notes", &Image::notes)
      .def("recipe", &Image::recipe)
      .def("png",
           [](const Image& image) {
             const std::vector<uint8_t> bytes = image.png();
             return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
           })
      .def("write", [](const Image& image, const std::string& path) { image.write(path); });
}

void declare_scene(py::module_& m) {
  py::class_<Scene>(m, "Scene")
      .def(py::init<>())
      .def(py::init<const Scene&>())
      .def("show",
           [](Scene& scene, const Data& data, const std::string& way, const py::dict& params) { scene.show(data, way, params_of(params)); })
      .def("camera", [](Scene& scene, const py::dict& params) { scene.camera(params_of(params)); })
      .def("picture", [](Scene& scene, const py::dict& params) { scene.picture(params_of(params)); })
      .def(
          "render",
          [](const Scene& scene, int width, int height, const py::object& on_picture) {
            return watched(on_picture, [&](const Context& context) { return scene.render(width, height, context); });
          },
          py::arg("width"), py::arg("height"), py::arg("on_picture") = py::none())
      .def("film",
           [](const Scene& scene, const std::string& output, const py::dict& params, int width, int height) {
             const Params stated = params_of(params);
             return call([&](const Context& context) { return scene.film(output, stated, width, height, context); });
           })
      .def("page", &page_of<Scene>);
}

void declare_pipeline(py::module_& m) {
  py::class_<Pipeline>(m, "Pipeline")
      .def(py::init<const Data&>())
      .def(py::init<const Pipeline&>())
      .def_static("parse", [](const std::string& yaml) { return Pipeline::parse(yaml); })
      .def_static("read", &Pipeline::read)
      .def_static("open",
                  [](const std::string& picture) {
                    std::vector<std::string> changed;
                    Pipeline p = Pipeline::open(picture, &changed);
                    return py::make_tuple(std::move(p), changed);
                  })
      .def("steps",
           [](const Pipeline& p) {
             py::list all;
             for (const Pipeline::Step& s : p.steps()) all.append(py::make_tuple(s.name, s.operation, s.stated, s.from));
             return all;
           })
      .def("set",
           [](Pipeline& p, const std::string& step, const py::dict& params) {
             Params all;
             for (const auto& [name, value] : params) all.push_back({name.cast<std::string>(), value_of(name.cast<std::string>(), value)});
             p.set(step, all);
           })
      .def("result",
           [](const Pipeline& p, const std::string& step) { return call([&](const Context& context) { return p.result(step, context); }); })
      .def(
          "render",
          [](const Pipeline& p, int width, int height, const py::object& on_picture) {
            return watched(on_picture, [&](const Context& context) { return p.render(width, height, context); });
          },
          py::arg("width"), py::arg("height"), py::arg("on_picture") = py::none())
      .def("page", &page_of<Pipeline>)
      .def("explain", &Pipeline::explain)
      .def("text", &Pipeline::text)
      .def("write", &Pipeline::write)
      .def("set_cache_limit", &Pipeline::set_cache_limit);
}

}  // namespace

void declare_pictures(py::module_& m) {
  declare_image(m);
  declare_scene(m);
  declare_pipeline(m);
}

}  // namespace sightglass::python
