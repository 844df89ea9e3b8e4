// SPDX-License-Identifier: Apache-2.0
#include "pipeline/hostile/hostile_inputs.h"

#include <cmath>

#include "filter/every_mesh.h"

namespace sg::test::hostile {

namespace {

UniformGrid box(size_t nx, size_t ny, size_t nz) {
  UniformGrid g;
  g.dims = {nx, ny, nz};
  g.spacing = {0.5, 0.25, 0.125};
  return g;
}

Points points_of(std::vector<double> xyz) { return {Array::from_vector(std::move(xyz), 3), {}}; }

UnstructuredMesh cells(CellType type, int corners, std::vector<double> xyz, std::vector<int32_t> ids) {
  UnstructuredMesh m;
  m.points = points_of(std::move(xyz));
  m.cells = {Array::from_vector(std::move(ids)), {}, corners};
  m.single_type = type;
  return m;
}

UnstructuredMesh tetrahedra(std::vector<double> xyz, std::vector<int32_t> ids) {
  return cells(CellType::tetra, 4, std::move(xyz), std::move(ids));
}

SurfaceMesh surface(std::vector<double> xyz, std::vector<int32_t> triangles, std::vector<int32_t> lines = {}) {
  SurfaceMesh m;
  m.points = points_of(std::move(xyz));
  if (!triangles.empty()) m.polygons = {Array::from_vector(std::move(triangles)), {}, 3};
  if (!lines.empty()) m.lines = {Array::from_vector(std::move(lines)), {}, 2};
  return m;
}

CurvilinearGrid curved(size_t n, double scale, double bad) {
  CurvilinearGrid g;
  g.dims = {n, n, n};
  std::vector<double> xyz;
  for (size_t i = 0; i < n * n * n; ++i)
    for (const size_t c : {i % n, i / n % n, i / n / n}) xyz.push_back(scale * double(c));
  if (bad != 0) xyz[4] = bad;
  g.points = points_of(std::move(xyz));
  return g;
}

const std::vector<double> corners{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};

double value(Values values, size_t i, int components) {
  switch (values) {
    case Values::nan: return NAN;
    case Values::zero: return 0;
    case Values::infinite: return i % 7 == 3 ? HUGE_VAL : i % 11 == 5 ? -HUGE_VAL : std::sin(0.7 * double(i));
    case Values::huge: return i % 3 == 0 ? 1e300 : i % 3 == 1 ? -1e300 : 1;
    default: return std::sin(0.7 * double(i) + components) + 0.2;
  }
}

template <class M>
DatasetPtr plain(M mesh) {
  return with(make_dataset(Mesh(std::move(mesh))), Values::plain);
}

// Every place times a factor, in the type that the mesh has.
template <class M>
M scaled(M mesh, double factor) {
  if constexpr (std::is_same_v<M, UniformGrid>) {
    mesh.spacing *= factor;
  } else {
    std::vector<double> xyz;
    for (size_t i = 0; i < mesh.points.count(); ++i)
      for (int c = 0; c < 3; ++c) xyz.push_back(mesh.points.xyz.get(i, c) * factor);
    mesh.points = points_of(std::move(xyz));
  }
  return mesh;
}

// A vertex, a line, a triangle, a quad, a tetrahedron, a pyramid and a polygon over the same eight points.
UnstructuredMesh mixed_cells() {
  UnstructuredMesh m;
  m.points = points_of({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1});
  m.cells.connectivity = Array::from_vector(std::vector<int32_t>{7, 6, 7, 4, 5, 6, 0, 1, 2, 3, 0, 1, 3, 4, 0, 1, 2, 3, 5, 2, 3, 7, 6, 5});
  m.cells.offsets = Array::from_vector(std::vector<int32_t>{0, 1, 3, 6, 10, 14, 19, 24});
  using enum CellType;
  std::vector<uint8_t> types;
  for (const CellType t : {vertex, line, triangle, quad, tetra, pyramid, polygon}) types.push_back(uint8_t(t));
  m.types = Array::from_vector(std::move(types));
  return m;
}

// Vertices, lines, polygons and a strip of one surface.
SurfaceMesh mixed_surface() {
  SurfaceMesh s = surface(corners, {0, 1, 2}, {3, 4});
  s.vertices.connectivity = Array::from_vector(std::vector<int32_t>{4}), s.vertices.fixed = 1;
  s.strips.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 3, 4}), s.strips.fixed = 4;
  return s;
}

std::vector<Input> small_inputs() {
  std::vector<Input> r;
  for (const Values v : {Values::none, Values::plain, Values::nan, Values::zero, Values::huge, Values::flat, Values::infinite}) {
    constexpr const char* titles[] = {"bare ", "", "NaN ", "zero ", "huge valued ", "2-component ", "", "infinite "};
    const std::string what = titles[int(v)];
    auto add = [&](const char* name, auto mesh) { r.push_back({what + name, with(make_dataset(Mesh(std::move(mesh))), v)}); };
    add("grid", box(4, 4, 4));
    add("flat grid", box(5, 4, 1));
    add("tetrahedra", tetrahedra(corners, {0, 1, 2, 3, 1, 2, 3, 4}));
    add("surface", surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4}));
    add("lines", surface(corners, {}, {0, 1, 1, 2, 3, 4}));
    add("cloud", PointCloud{points_of(corners)});
    if (v != Values::none && v != Values::plain && v != Values::nan) continue;
    add("point", PointCloud{points_of({1, 2, 3})});
    add("grid of a point", box(1, 1, 1));
    add("grid of a row", box(4, 1, 1));
    add("grid of a cell", box(2, 2, 2));
    add("tetrahedron", tetrahedra(corners, {0, 1, 2, 3}));
    add("triangle", surface(corners, {0, 1, 2}));
    add("line without length", surface({1, 1, 1, 1, 1, 1}, {}, {0, 1}));
    add("collapsed grid", curved(3, 0, 0));
    add("empty cloud", PointCloud{points_of({})});
    add("empty surface", surface({}, {}));
    add("empty tetrahedra", tetrahedra({}, {}));
    add("points without cells", tetrahedra(corners, {}));
  }
  return r;
}

std::vector<Input> make_inputs() {
  std::vector<Input> r = small_inputs();
  auto add = [&](std::string name, auto mesh) { r.push_back({std::move(name), plain(std::move(mesh))}); };
  add("huge grid", curved(3, 1e300, 0));
  add("tiny grid", curved(3, 1e-300, 0));
  for (const double factor : {1e30, 1e-30}) {
    const std::string size = factor > 1 ? "vast " : "minute ";
    add(size + "grid", scaled(box(4, 4, 4), factor));
    add(size + "flat grid", scaled(box(5, 4, 1), factor));
    add(size + "tetrahedra", scaled(tetrahedra(corners, {0, 1, 2, 3, 1, 2, 3, 4}), factor));
    add(size + "surface", scaled(surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4}), factor));
    add(size + "lines", scaled(surface(corners, {}, {0, 1, 1, 2, 3, 4}), factor));
    add(size + "cloud", scaled(PointCloud{points_of(corners)}, factor));
  }
  add("cells of every dimension", mixed_cells());
  add("surface of all its parts", mixed_surface());
  add("grid with a NaN place", curved(3, 1, NAN));
  add("grid with an infinite place", curved(3, 1, HUGE_VAL));
  add("tetrahedra without volume", tetrahedra({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, {0, 1, 2, 3, 0, 0, 1, 2, 3, 3, 3, 3}));
  add("tetrahedra inside out", tetrahedra(corners, {1, 0, 2, 3, 1, 3, 2, 4}));
  add("hexahedron with its corners mixed up",
      cells(CellType::hexahedron, 8, {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1}, {0, 2, 1, 3, 7, 5, 4, 6}));
  add("triangles without area", surface({0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 1, 0}, {0, 1, 2, 1, 1, 3, 2, 2, 2}));
  add("far from the origin", [] {
    UniformGrid g = box(4, 4, 4);
    g.origin = {1e15, -1e15, 1e15};
    return g;
  }());
  // Curved solids of many nodes take most of the time; tetrahedra and flat cells stand for them.
  const auto slow = [](const std::string& name) {
    const bool curved = name.find("quadratic") != name.npos || name.find("lagrange") != name.npos || name.find("bezier") != name.npos;
    const bool thick = name.find("hexahedron") != name.npos || name.find("wedge") != name.npos || name.find("pyramid") != name.npos;
    return (curved && thick) || name == "curved hexahedron";
  };
  for (const MeshKind& kind : every_mesh()) r.push_back({kind.name, with(kind.make(2, 1), Values::smooth), slow(kind.name)});
  for (const MeshKind& kind : every_mesh())
    if (kind.name == "quadratic tetra") r.push_back({"quadratic tetrahedra of noise", with(kind.make(6, 1), Values::plain)});
  for (const bool flat : {false, true})
    r.push_back(
        {flat ? "flat parts" : "parts", collection_of(halves(flat, 2, 1), [](const DatasetPtr& d) { return with(d, Values::plain); })});
  auto unlike = std::make_shared<Collection>();
  for (const size_t k : {0, 8, 15, 20}) unlike->parts.push_back({r[k].name, r[k].data});
  r.push_back({"parts unlike", CollectionPtr(unlike)});
  r.push_back({"empty collection", CollectionPtr(std::make_shared<Collection>())});
  r.push_back({"empty table", TablePtr(std::make_shared<Table>())});
  return r;
}

}  // namespace

DatasetPtr with(const DatasetPtr& mesh, Values values) {
  if (values == Values::none) return mesh;
  DatasetParts parts = mesh->parts();
  const Array places = point_positions(mesh->mesh());
  for (const Association a : {Association::point, Association::cell}) {
    const size_t n = a == Association::point ? mesh->point_count() : mesh->cell_count();
    auto field = [&](const char* name, int components, Role role) {
      std::vector<double> v(n * size_t(components));
      for (size_t i = 0; i < v.size(); ++i) v[i] = value(values, i, components);
      if (values == Values::smooth && a == Association::point)
        for (size_t i = 0; i < v.size(); ++i) {
          const size_t k = i / size_t(components), c = i % size_t(components);
          v[i] = std::sin(0.3 * places.get(k, 0) + 0.4 * places.get(k, 1) - 0.2 * places.get(k, 2) + double(c)) + 0.2;
        }
      parts.fields.add({name, a, Array::from_vector(std::move(v), components), "", a == Association::point ? role : Role::none});
    };
    field("s", 1, Role::scalars);
    field("v", values == Values::flat ? 2 : 3, Role::vectors);
    field("t", 6, Role::tensors);
    field("m", 9, Role::none);
    std::vector<int32_t> labels(n);
    for (size_t i = 0; i < n; ++i) labels[i] = int32_t(i * 7 % 5);
    parts.fields.add({"labels", a, Array::from_vector(std::move(labels)), "", Role::labels});
  }
  return make_dataset(std::move(parts));
}

const std::vector<Input>& inputs() {
  static const std::vector<Input> all = make_inputs();
  return all;
}

const std::vector<Input>& unlike_inputs() {
  static const std::vector<Input> few{{"grid", plain(box(4, 4, 4))},
                                      {"bare surface", make_dataset(Mesh(surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4})))},
                                      {"cells of every dimension", plain(mixed_cells())},
                                      {"lines", plain(surface(corners, {}, {0, 1, 1, 2, 3, 4}))},
                                      {"point", plain(PointCloud{points_of({1, 2, 3})})},
                                      {"empty cloud", plain(PointCloud{points_of({})})},
                                      {"empty surface", plain(surface({}, {}))},
                                      {"empty tetrahedra", make_dataset(Mesh(tetrahedra({}, {})))},
                                      {"empty collection", CollectionPtr(std::make_shared<Collection>())}};
  return few;
}

const std::vector<Input>& plain_inputs() {
  static const std::vector<Input> few{{"grid", plain(box(4, 4, 4))},
                                      {"flat grid", plain(box(5, 4, 1))},
                                      {"surface", plain(surface(corners, {0, 1, 2, 0, 1, 3, 1, 2, 4}))},
                                      {"lines", plain(surface(corners, {}, {0, 1, 1, 2, 3, 4}))}};
  return few;
}

std::vector<std::string> words(const ParamDecl& d) {
  std::vector<std::string> r;
  auto add = [&](std::initializer_list<const char*> values) {
    for (const char* value : values) r.push_back(d.name + "=" + value);
  };
  if (!d.choices_.empty()) {
    for (const std::string& choice : d.choices_) r.push_back(d.name + "=" + choice);
    return r;
  }
  switch (d.ref.type()) {
    case ParamType::boolean: add({"true", "false"}); break;
    case ParamType::field: add({"s", "v", "t", "m", "labels", "nothing"}); break;
    case ParamType::word:
    case ParamType::words: add({"s", "v", "nothing", "1e300", "x+*", "-1:nan:3", "0:1:999999999"}); break;
    case ParamType::point: add({"0,0,0", "nan,0,0", "1e300,-1e300,1e300", "1e-300,0,0", "inf,inf,inf"}); break;
    case ParamType::integers:
    case ParamType::numbers:
      add({"0", "-1,-1,-1", "0,0,0,0,0,0", "1e300,1e300,1e300", "nan,nan,nan", "2147483647,2147483647,2147483647", "1,0,1,0,1,0",
           "0,1,0,1,0,1", "9223372036854775807"});
      break;
    case ParamType::number: add({"0", "-1", "1e300", "-1e300", "1e-300", "nan", "inf"}); break;
    case ParamType::integer: add({"0", "-1", "1e300", "1e-300", "nan", "2147483647", "9223372036854775807", "-9223372036854775808"}); break;
  }
  return r;
}

std::vector<Times> series(bool all) {
  const Data grid = plain_inputs()[0].data, flat = plain_inputs()[1].data;
  std::vector<Times> r{{"no step", {}, {}},
                       {"one step", {3}, {grid}},
                       {"equal times", {1, 1, 1}, {grid, grid, grid}},
                       {"falling times", {2, 1, 0}, {grid, grid, grid}},
                       {"NaN times", {0, NAN, 2}, {grid, grid, grid}},
                       {"infinite times", {0, 1, HUGE_VAL}, {grid, grid, grid}},
                       {"huge times", {-1e300, 0, 1e300}, {grid, grid, grid}},
                       {"tiny steps", {0, 1e-300, 2e-300}, {grid, grid, grid}},
                       {"grids unlike", {0, 1, 2}, {grid, flat, grid}}};
  if (!all) return r;
  for (const Input& in : inputs()) {
    r.push_back({in.name + " at all times", {0, 1, 2}, {in.data, in.data, in.data}});
    r.push_back({in.name + " at last", {0, 1}, {grid, in.data}});
  }
  return r;
}

}  // namespace sg::test::hostile
