// SPDX-License-Identifier: Apache-2.0
// Data and meshes from memory.
#include <pybind11/stl.h>

#include "python/core/calls.h"
#include "python/core/module.h"
#include "python/core/numbers.h"
#include "python/core/values.h"

namespace sightglass::python {

namespace py = pybind11;

namespace {

constexpr const char* places[] = {"points", "cells", "whole"};

On place_of(const std::string& word) {
  for (int i = 0; i < 3; ++i)
    if (word == places[i]) return On(i);
  throw py::value_error("on='" + word + "' is not one of 'points', 'cells' and 'whole'");
}

py::tuple tuple_of(const Field& f) { return py::make_tuple(f.name, places[int(f.on)], f.unit, numpy_of(f.values)); }

void declare_class(py::module_& m) {
  py::class_<Data>(m, "Data")
      .def_property_readonly("kind", &Data::kind)
      .def("summary", &Data::summary)
      .def("notes", &Data::notes)
      .def("point_count", &Data::point_count)
      .def("cell_count", &Data::cell_count)
      .def("bounds",
           [](const Data& d) {
             const Box b = d.bounds();
             return py::make_tuple(b.lo, b.hi);
           })
      .def("fields",
           [](const Data& d) {
             py::list all;
             for (const Field& f : d.fields()) all.append(tuple_of(f));
             return all;
           })
      .def("field", [](const Data& d, const std::string& name) { return tuple_of(d.field(name)); })
      .def("range",
           [](const Data& d, const std::string& field, int component) {
             const Range r = d.range(field, component);
             return py::make_tuple(r.lo, r.hi);
           })
      .def("words", [](const Data& d, const std::string& column) { return d.words(column); })
      .def("points", [](const Data& d) { return numpy_of(d.points()); })
      .def("dims", &Data::dims)
      .def("placing",
           [](const Data& d) {
             const Placing p = d.placing();
             return py::make_tuple(p.spacing, p.origin, p.axes);
           })
      .def("coordinates",
           [](const Data& d) {
             py::list all;
             for (const Array& a : d.coordinates()) all.append(numpy_of(a));
             return all;
           })
      .def("cells",
           [](const Data& d) {
             const Cells c = d.cells();
             return py::make_tuple(numpy_of(c.ids), numpy_of(c.offsets), numpy_of(c.types));
           })
      .def("faces",
           [](const Data& d) {
             const Cells c = d.cells();
             return py::make_tuple(numpy_of(c.face_ids), numpy_of(c.face_offsets), numpy_of(c.cell_faces));
           })
      .def("time", &Data::time)
      .def("times", [](const Data& d) { return call([&](const Context& context) { return d.times(context); }); })
      .def("at", [](const Data& d, double time) { return call([&](const Context& context) { return d.at(time, context); }); })
      .def("parts", &Data::parts)
      .def("with_field",
           [](const Data& d, const std::string& name, const std::string& on, const Numbers& values, const std::string& unit) {
             return d.with_field({name, place_of(on), array_of(values), unit});
           })
      .def("run",
           [](const Data& d, const std::string& operation, const py::dict& params, const std::vector<Data>& others) {
             const Params stated = params_of(params);
             return call([&](const Context& context) { return d.run(operation, stated, others, context); });
           })
      .def("write", [](const Data& d, const std::string& path, const py::dict& params) {
        const Params stated = params_of(params);
        call([&](const Context& context) { return d.write(path, stated, context), 0; });
      });
}

using Faces = std::array<Numbers, 3>;

Cells cells_of(const Numbers& ids, const Numbers& offsets, const Numbers& types, const std::optional<Faces>& faces) {
  Cells cells{array_of(ids), array_of(offsets), array_of(types), {}, {}, {}};
  if (faces) cells.face_ids = array_of((*faces)[0]), cells.face_offsets = array_of((*faces)[1]), cells.cell_faces = array_of((*faces)[2]);
  return cells;
}

AmrLevel level_of(Vec3 spacing, const std::vector<std::array<std::array<int64_t, 3>, 2>>& patches) {
  AmrLevel level{spacing, {}};
  for (const auto& [lo, hi] : patches) level.patches.push_back({lo, hi});
  return level;
}

// A function of Python as that of a series: it is called, and goes away, under the interpreter's lock.
std::function<Data(size_t)> step_of(py::object load) {
  const std::shared_ptr<py::object> held(new py::object(std::move(load)), [](py::object* o) {
    if (!Py_IsInitialized()) return void(o->release());
    const py::gil_scoped_acquire lock;
    delete o;
  });
  return [held](size_t number) {
    const py::gil_scoped_acquire lock;
    return (*held)(number).cast<Data>();
  };
}

void declare_meshes(py::module_& m) {
  m.def("uniform_grid", [](std::array<size_t, 3> dims, Vec3 spacing, Vec3 origin, std::array<Vec3, 3> axes) {
    return uniform_grid(dims, {spacing, origin, axes});
  });
  m.def("rectilinear_grid",
        [](const Numbers& x, const Numbers& y, const Numbers& z) { return rectilinear_grid(array_of(x), array_of(y), array_of(z)); });
  m.def("curvilinear_grid", [](std::array<size_t, 3> dims, const Numbers& points) { return curvilinear_grid(dims, array_of(points)); });
  m.def("unstructured_mesh",
        [](const Numbers& points, const Numbers& ids, const Numbers& offsets, const Numbers& types, const std::optional<Faces>& faces) {
          return unstructured_mesh(array_of(points), cells_of(ids, offsets, types, faces));
        });
  m.def("triangle_mesh", [](const Numbers& points, const Numbers& ids) { return triangle_mesh(array_of(points), array_of(ids)); });
  m.def("polygon_mesh", [](const Numbers& points, const Numbers& ids, const Numbers& offsets) {
    return polygon_mesh(array_of(points), array_of(ids), array_of(offsets));
  });
  m.def("line_mesh", [](const Numbers& points, const Numbers& ids, const Numbers& offsets) {
    return line_mesh(array_of(points), array_of(ids), array_of(offsets));
  });
  m.def("surface_mesh", [](const Numbers& points, const std::array<std::optional<std::pair<Numbers, Numbers>>, 4>& cells) {
    SurfaceCells made;
    SurfaceCells::Lists* const kinds[] = {&made.vertices, &made.lines, &made.polygons, &made.strips};
    for (size_t k = 0; k < 4; ++k)
      if (cells[k]) *kinds[k] = {array_of(cells[k]->first), array_of(cells[k]->second)};
    return surface_mesh(array_of(points), made);
  });
  m.def("point_cloud", [](const Numbers& points) { return point_cloud(array_of(points)); });
  m.def("amr_grid", [](const std::vector<std::pair<Vec3, std::vector<std::array<std::array<int64_t, 3>, 2>>>>& levels, Vec3 origin) {
    std::vector<AmrLevel> all;
    for (const auto& [spacing, patches] : levels) all.push_back(level_of(spacing, patches));
    return amr_grid(all, origin);
  });
}

void declare_groups(py::module_& m) {
  m.def("table", [](const std::vector<std::tuple<std::string, Numbers, std::string, std::vector<std::string>>>& columns) {
    std::vector<Column> all;
    for (const auto& [name, values, unit, words] : columns) all.push_back({name, array_of(values), unit, words});
    return table(all);
  });
  m.def("collection", [](const std::vector<std::pair<std::string, Data>>& parts) { return collection(parts); });
  m.def("series", [](std::vector<double> times, py::object load) {
    const auto step = step_of(std::move(load));
    return call([&](const Context& context) { return series(times, step, context); });
  });
}

}  // namespace

void declare_data(py::module_& m) {
  declare_class(m);
  declare_meshes(m);
  declare_groups(m);
  m.def("read", [](const std::string& path, const py::dict& params) {
    const Params stated = params_of(params);
    return call([&](const Context& context) { return read(path, stated, context); });
  });
  m.def("times", [](const std::string& path) { return call([&](const Context& context) { return times(path, context); }); });
  m.def("source", [](const std::string& name, const py::dict& params) {
    const Params stated = params_of(params);
    return call([&](const Context& context) { return source(name, stated, context); });
  });
}

}  // namespace sightglass::python
