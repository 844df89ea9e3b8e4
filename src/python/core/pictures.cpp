// SPDX-License-Identifier: Apache-2.0
// Scenes and what is drawn of them.
#include <pybind11/stl.h>

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

void declare_image(py::module_& m) {
  py::class_<Image>(m, "Image")
      .def_property_readonly("width", &Image::width)
      .def_property_readonly("height", &Image::height)
      .def("pixels", &pixels_of)
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
      .def("show",
           [](Scene& scene, const Data& data, const std::string& way, const py::dict& params) { scene.show(data, way, params_of(params)); })
      .def("camera", [](Scene& scene, const py::dict& params) { scene.camera(params_of(params)); })
      .def("picture", [](Scene& scene, const py::dict& params) { scene.picture(params_of(params)); })
      .def("render", [](const Scene& scene, int width,
                        int height) { return call([&](const Context& context) { return scene.render(width, height, context); }); })
      .def("film", [](const Scene& scene, const std::string& output, const py::dict& params, int width, int height) {
        const Params stated = params_of(params);
        return call([&](const Context& context) { return scene.film(output, stated, width, height, context); });
      });
}

}  // namespace

void declare_pictures(py::module_& m) {
  declare_image(m);
  declare_scene(m);
}

}  // namespace sightglass::python
