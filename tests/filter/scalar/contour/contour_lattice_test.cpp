// SPDX-License-Identifier: Apache-2.0
// Contours of the three kinds of grids: the trilinear topology, what is carried into cells, values, cell fields.
#include "base/parallel.h"
#include "base/random.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/scalar/contour/known_surfaces.h"
#include "support/params.h"

using namespace sg;
using namespace sg::test;

namespace {

const char* const kinds[] = {"uniform", "rectilinear", "curvilinear"};

// The same points and samples as a uniform grid's.
DatasetPtr as_kind(const DatasetPtr& d, const std::string& kind) {
  if (kind == "uniform") return d;
  const auto n = lattice_dims(d->mesh());
  const Lattice lattice(d->mesh());
  DatasetParts parts = d->parts();
  if (kind == "rectilinear") {
    RectilinearGrid g;
    std::vector<double> axis[3];
    for (size_t a = 0; a < 3; ++a)
      for (size_t i = 0; i < n[a]; ++i) axis[a].push_back(lattice.view().position(a == 0 ? i : 0, a == 1 ? i : 0, a == 2 ? i : 0)[int(a)]);
    g.x = Array::from_vector(axis[0]), g.y = Array::from_vector(axis[1]), g.z = Array::from_vector(axis[2]);
    parts.mesh = g;
  } else {
    CurvilinearGrid g;
    g.dims = n;
    std::vector<double> xyz;
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) {
          const Vec3 p = lattice.view().position(i, j, k);
          xyz.insert(xyz.end(), {p.x, p.y, p.z});
        }
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    parts.mesh = g;
  }
  return make_dataset(std::move(parts));
}

// A ball in coordinates that are bent and unevenly spaced, so that no kernel for regular grids applies.
DatasetPtr bent(size_t n, const std::string& kind, double (*f)(Vec3), double r) {
  auto stretch = [&](double u) { return r * (u + 0.2 * u * u * u) / 1.2; };  // -1..1 -> -r..r
  std::vector<double> axis, xyz, values;
  for (size_t i = 0; i < n; ++i) axis.push_back(stretch(2.0 * double(i) / double(n - 1) - 1));
  for (double z : axis)
    for (double y : axis)
      for (double x : axis) {
        const Vec3 p = kind == "rectilinear" ? Vec3(x, y, z) : Vec3(x + 0.1 * std::sin(2 * y), y + 0.1 * std::sin(2 * z), z + 0.05 * x * y);
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
        values.push_back(f(p));
      }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  if (kind == "rectilinear") {
    RectilinearGrid g;
    g.x = Array::from_vector(axis), g.y = Array::from_vector(axis), g.z = Array::from_vector(axis);
    return make_dataset(g, fields);
  }
  CurvilinearGrid g;
  g.dims = {n, n, n};
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  return make_dataset(g, fields);
}

DatasetPtr noise_grid(size_t n, uint64_t seed = 1) {
  return cube<float>(n, 1, [&](Vec3 p) {
    return float(random_unit(seed, uint64_t(std::lround((p.x + 1) * 1000) + 4000 * std::lround((p.y + 1) * 1000) +
                                            16000000 * std::lround((p.z + 1) * 1000))) -
                 0.5);
  });
}

DatasetPtr with(const DatasetPtr& d, std::vector<Field> more) {
  DatasetParts p = d->parts();
  for (Field& f : more) p.fields.add(std::move(f));
  return make_dataset(std::move(p));
}

}  // namespace

TEST_CASE("contour: sphere on stretched and bent grids: area, volume, points and normals converge with order 2") {
  for (const std::string kind : {"rectilinear", "curvilinear"}) {
    double h[3], area[3], volume[3], vertex[3] = {}, normal[3] = {};
    for (int i = 0; i < 3; ++i) {
      const size_t n = size_t(16) * (size_t(1) << i) + 1;
      const auto d = contour_at(bent(n, kind, sphere, 1.4), 0);
      const Surface s(d);
      h[i] = 1.0 / double(n - 1);
      area[i] = std::abs(s.area() - 4 * M_PI);
      volume[i] = std::abs(-s.volume() - 4 * M_PI / 3);
      CHECK(s.euler() == 2);
      CHECK(s.faults() == 0);
      const Field& normals = d->fields().require("Normals");
      for (size_t v = 0; v < s.points.size(); ++v) {
        vertex[i] = std::max(vertex[i], std::abs(length(s.points[v]) - 1));
        const Vec3 g(normals.array.get(v, 0), normals.array.get(v, 1), normals.array.get(v, 2));
        normal[i] = std::max(normal[i], length(g + normalize(s.points[v])));
      }
    }
    CAPTURE(kind);
    for (const double* error : {area, volume, vertex, normal}) {
      const double order = std::log2(error[1] / error[2]);
      CHECK(order == doctest::Approx(2).epsilon(0.15));
    }
    CHECK(h[0] > h[2]);
  }
}

TEST_CASE("contour: counts, Euler numbers and closedness are the same on all kinds of grids") {
  struct Row {
    double (*f)(Vec3);
    size_t n;
    double r;
    size_t points, triangles;
    long euler;
  };
  for (const Row& row : {Row{sphere, 17, 1.3, 726, 1448, 2}, Row{torus, 33, 1.6, 2216, 4432, 0}, Row{tangle, 41, 3, 6624, 13264, -8}})
    for (const char* kind : kinds) {
      const auto d = contour_at(as_kind(cube(row.n, row.r, row.f), kind), 0);
      CHECK(d->point_count() == row.points);
      CHECK(d->cell_count() == row.triangles);
      const Surface s(d);
      CHECK(s.euler() == row.euler);
      CHECK(s.components() == 1);
      CHECK(s.faults() == 0);
    }
}

TEST_CASE("contour: tunnels, deciders and ties come out the same on all kinds of grids") {
  for (const char* kind : kinds) {
    auto surface = [&](std::vector<double> v, std::array<size_t, 3> n, ContourTopology topology) {
      ContourParams p;
      p.values = {0};
      p.topology = topology;
      return Surface(contoured(as_kind(grid_of<double>(n, std::move(v)), kind), p));
    };
    const Surface tunnel = surface({9, -1, -1, -1, -1, -1, -1, 9}, {2, 2, 2}, ContourTopology::trilinear);
    CHECK(tunnel.euler() == 0);
    CHECK(tunnel.components() == 1);
    const Surface discs = surface({1, -1, -1, -1, -1, -1, -1, 1}, {2, 2, 2}, ContourTopology::trilinear);
    CHECK(discs.euler() == 2);
    CHECK(discs.components() == 2);
    CHECK(surface({9, -1, -1, -1, -1, -1, -1, 9}, {2, 2, 2}, ContourTopology::fixed).components() == 2);
    CHECK(surface({3, -1, -1, 3, -1, -1, -1, -1}, {2, 2, 2}, ContourTopology::trilinear).components() == 1);
    CHECK(surface({3, -1, -1, 3, -1, -1, -1, -1}, {2, 2, 2}, ContourTopology::fixed).components() == 2);
    CHECK(surface({1, -3, -3, 1, -1, -1, -1, -1}, {2, 2, 2}, ContourTopology::trilinear).components() == 2);
    const Box3 box{{0, 0, 0}, {1, 1, 2}};
    CHECK(surface({13, -1, -1, -7, -1, 1, 7, -7, 15, -9, -3, -1}, {2, 2, 3}, ContourTopology::trilinear).faults(box) == 0);
  }
}

TEST_CASE("contour: on noise all kinds of grids give one surface, closed but for the border, without triangles in faces") {
  const auto d = noise_grid(12);
  const Surface u(contour_at(d, 0));
  CHECK(u.faults(d->bounds()) == 0);
  CHECK(u.every_point_used());
  for (const char* kind : kinds) {
    const Surface s(contour_at(as_kind(d, kind), 0));
    CHECK(s.triangles == u.triangles);
    REQUIRE(s.points.size() == u.points.size());
    double worst = 0;
    for (size_t i = 0; i < s.points.size(); ++i) worst = std::max(worst, length(s.points[i] - u.points[i]));
    CHECK(worst < 1e-6);
  }
  // Left-handed axes turn triangles round, so that volumes keep their sign.
  DatasetParts mirrored = d->parts();
  UniformGrid g = *d->as<UniformGrid>();
  g.direction.m[0][0] = -1;
  mirrored.mesh = g;
  const Surface m(contour_at(make_dataset(std::move(mirrored)), 0));
  REQUIRE(m.triangles.size() == u.triangles.size());
  for (size_t t = 0; t < m.triangles.size(); t += 17) CHECK(m.triangles[t][0] == u.triangles[t][0]);
  CHECK(m.triangles[0][1] == u.triangles[0][2]);
}

TEST_CASE("contour: points inside cells carry fields with trilinear weights, cell fields and unit normals") {
  const size_t n = 10;
  const auto base = noise_grid(n, 5);
  const Mesh& g = base->mesh();
  std::vector<int32_t> ids((n - 1) * (n - 1) * (n - 1));
  std::iota(ids.begin(), ids.end(), 0);
  auto linear = [](Vec3 p) { return 20 * p.x - 10 * p.y + 5 * p.z + 100; };
  const auto d = with(base, {point_field<double>(g, {n, n, n}, linear, "linear"),
                             point_field<uint8_t>(g, {n, n, n}, linear, "bytes"),
                             {"cell id", Association::cell, Array::from_vector(ids), "", Role::none}});
  for (const char* kind : kinds) {
    ContourParams p;
    p.field.name = "f";
    p.values = {0, 0.2};
    const auto c = contoured(as_kind(d, kind), p);
    const Surface s(c);
    const Field &l = c->fields().require("linear"), &b = c->fields().require("bytes"), &f = c->fields().require("f"),
                &normals = c->fields().require("Normals"), &value = c->fields().require("contour value");
    CHECK(b.array.type() == ElementType::u8);
    REQUIRE(l.array.count() == s.points.size());
    int inside = 0;
    double worst = 0, worst_byte = 0, worst_normal = 0;
    for (size_t i = 0; i < s.points.size(); ++i) {
      const Vec3 q = (s.points[i] + Vec3(1, 1, 1)) * (0.5 * double(n - 1));
      int on = 0;
      for (int a = 0; a < 3; ++a) on += std::abs(q[a] - std::round(q[a])) < 1e-5;
      inside += on == 0;
      worst = std::max(worst, std::abs(l.array.get(i) - linear(s.points[i])));
      worst_byte = std::max(worst_byte, std::abs(b.array.get(i) - linear(s.points[i])));
      worst_normal =
          std::max(worst_normal, std::abs(length(Vec3(normals.array.get(i, 0), normals.array.get(i, 1), normals.array.get(i, 2))) - 1));
    }
    CHECK(inside > 50);
    CHECK(worst < 1e-4);
    CHECK(worst_byte < 1.6);  // the samples are cut to whole numbers, the result is rounded
    CHECK(worst_normal < 1e-5);
    const Field& id = c->fields().require("cell id");
    for (size_t t = 0; t < s.triangles.size(); ++t) {
      const int cell = int(id.array.get(t)), m = int(n) - 1, at[3] = {cell % m, cell / m % m, cell / m / m};
      for (int v : s.triangles[t]) {
        const Vec3 q = (s.points[size_t(v)] + Vec3(1, 1, 1)) * (0.5 * m);
        for (int a = 0; a < 3; ++a)
          if (!(q[a] > at[a] - 1e-4 && q[a] < at[a] + 1 + 1e-4)) FAIL("a point lies outside its cell");
        CHECK(f.array.get(size_t(v)) == doctest::Approx(value.array.get(t)));
      }
    }
  }
}

TEST_CASE("contour: noise gives the same bytes for 1 and 8 threads, several values the same as one by one") {
  const auto base = noise_grid(40, 9);
  const auto d = with(base, {point_field<float>(
                                base->mesh(), {40, 40, 40}, [](Vec3 p) { return p.x; }, "x")});
  ContourParams p;
  p.field.name = "f";
  p.values = {0.1, -0.2, 0.1, 0};  // unsorted and repeated: as asked
  set_thread_count(1);
  const auto one = contoured(d, p);
  set_thread_count(8);
  const auto eight = contoured(d, p);
  set_thread_count(0);
  CHECK(same_surface(one, eight));
  for (const char* name : {"Normals", "f", "x", "contour value"})
    CHECK(same_bytes(one->fields().require(name).array, eight->fields().require(name).array));
  size_t points = 0, triangles = 0;
  const Surface all(one);
  for (double value : p.values) {
    ContourParams single = p;
    single.values = {value};
    const auto c = contoured(d, single);
    const Surface s(c);
    bool same = points + s.points.size() <= all.points.size() && triangles + s.triangles.size() <= all.triangles.size();
    for (size_t i = 0; same && i < s.points.size(); ++i) same = s.points[i] == all.points[points + i];
    for (size_t t = 0; same && t < s.triangles.size(); ++t)
      for (size_t k = 0; k < 3; ++k) same = same && s.triangles[t][k] + int(points) == all.triangles[triangles + t][k];
    CHECK(same);
    points += s.points.size(), triangles += s.triangles.size();
  }
  CHECK(points == all.points.size());
  CHECK(triangles == all.triangles.size());
}

TEST_CASE("contour: cells with tubes keep clean borders beside NaN") {
  const auto d = noise_grid(14, 3);
  auto v = d->fields().require("f").array.view<float>();
  std::vector<float> holes(v.data, v.data + v.count);
  for (size_t i = 0; i < holes.size(); i += 97) holes[i] = NAN;
  const Surface full(contour_at(d, 0)), s(contour_at(grid_of<float>({14, 14, 14}, holes), 0));
  CHECK(s.triangles.size() > 1000);
  CHECK(s.triangles.size() < full.triangles.size());
  CHECK(s.every_point_used());
  for (const auto& [edge, count] : s.edges()) CHECK(count == 1);
  for (const Vec3& p : s.points) CHECK(std::isfinite(p.x + p.y + p.z));
}

TEST_CASE("contour: takes cell fields, averaged to the points, when asked") {
  const size_t n = 24;
  const auto base = cube(n + 1, 1.5, sphere);
  std::vector<float> cells;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i)
        cells.push_back(
            float(length((Vec3(double(i), double(j), double(k)) + Vec3(.5, .5, .5)) * (3.0 / double(n)) - Vec3(1.5, 1.5, 1.5))));
  const auto d = with(base, {{"radius", Association::cell, Array::from_vector(cells), "m", Role::none}});
  ContourParams p;
  p.field.name = "radius";
  p.values = {1};
  CHECK(error_of([&] { contoured(d, p); }).find("from_cells=true") != std::string::npos);
  p.from_cells = true;
  const auto c = contoured(d, p);
  const Surface s(c);
  CHECK(s.euler() == 2);
  CHECK(s.faults() == 0);
  CHECK(s.area() == doctest::Approx(4 * M_PI).epsilon(0.02));
  CHECK(c->fields().require("radius", Association::cell).array.count() == s.triangles.size());
  p.field.name = "f";
  CHECK(error_of([&] { contoured(d, p); }).find("is defined on the points") != std::string::npos);
  p.field.name = "";
  DatasetParts only = d->parts();
  only.fields.remove("f", Association::point);
  CHECK(Surface(contoured(make_dataset(only), p)).euler() == 2);
  p.from_cells = false;
  CHECK(error_of([&] { contoured(make_dataset(only), p); }).find("from_cells=true") != std::string::npos);
  only.fields.remove("radius", Association::cell);
  p.from_cells = true;
  CHECK(error_of([&] { contoured(make_dataset(only), p); }).find("no cell field") != std::string::npos);
}

TEST_CASE("contour: bad values, bad words and grids with nothing in them") {
  const auto d = cube(6, 1, sphere);
  ContourParams p;
  for (double v : {double(NAN), HUGE_VAL, -HUGE_VAL}) {
    p.values = {0, v};
    CHECK(error_of([&] { contoured(d, p); }).find("finite") != std::string::npos);
  }
  p.values = {0};
  CHECK(error_of([&] { test::params_of<ContourParams>({"topology=classic"}); }).find("trilinear, fixed") != std::string::npos);
  p.values = {-7, 0, 9};  // two of three are out of range
  const auto c = contoured(d, p);
  CHECK(c->cell_count() == contour_at(d, 0)->cell_count());
  CHECK(c->fields().require("contour value").array.get(0) == 0);
  p.values = {5, 6};
  CHECK(contoured(d, p)->cell_count() == 0);
  for (const char* kind : kinds) {
    const Surface one(contour_at(as_kind(grid_of<double>({2, 2, 2}, {1, -1, -1, -1, -1, -1, -1, -1}), kind), 0));
    CHECK(one.triangles.size() == 1);
    CHECK(contour_at(as_kind(grid_of<double>({2, 2, 2}, std::vector<double>(8, 1)), kind), 0)->cell_count() == 0);
  }
}
