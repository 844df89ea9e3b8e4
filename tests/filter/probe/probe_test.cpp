// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/probe.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/probe/resample.h"
#include "index/cell_locator.h"
#include "index/locator_meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

double linear(Vec3 p) { return 1 + 2 * p.x - p.y + 0.5 * p.z; }

// A mesh of the search tests with a linear field "f" (f64), the same as f32 vector "v", the integers "n", and the cell's number "c".
DatasetPtr with_fields(const DatasetPtr& mesh) {
  CellReader reader(mesh);
  const size_t n = mesh->point_count();
  std::vector<double> f(n, NAN);
  std::vector<float> v(3 * n, 0);
  std::vector<int32_t> number(n, 0), c(mesh->cell_count());
  for (size_t cell = 0; cell < reader.count(); ++cell) {
    reader.open(cell);
    for (size_t k = 0; k < reader.ids().size(); ++k) {
      const size_t id = size_t(reader.ids()[k]);
      f[id] = linear(reader.at()[k]);
      for (size_t a = 0; a < 3; ++a) v[3 * id + a] = float(f[id] * double(a + 1));
      number[id] = 10;
    }
  }
  for (size_t i = 0; i < c.size(); ++i) c[i] = int32_t(i + 1);
  DatasetParts parts = mesh->parts();
  parts.fields.add({"f", Association::point, Array::from_vector(f), "K", Role::scalars});
  parts.fields.add({"v", Association::point, Array::from_vector(v, 3), "", Role::vectors});
  parts.fields.add({"n", Association::point, Array::from_vector(number), "", Role::none});
  if (!c.empty()) parts.fields.add({"c", Association::cell, Array::from_vector(c), "", Role::none});
  return make_dataset(std::move(parts));
}

DatasetPtr random_points(const Box3& box, size_t n) {
  std::vector<double> xyz;
  for (size_t i = 0; i < n; ++i)
    for (int a = 0; a < 3; ++a) xyz.push_back(box.lo[a] + box.size()[a] * (1.2 * random_unit(4, 3 * i + size_t(a)) - 0.1));
  PointCloud c;
  c.points.xyz = Array::from_vector(xyz, 3);
  return make_dataset(std::move(c));
}

Vec3 place(const Dataset& d, size_t i) {
  if (const auto* c = d.as<PointCloud>()) return c->points.at(i);
  const auto& g = *d.as<UniformGrid>();
  return g.origin + g.spacing * Vec3(double(i % g.dims[0]), double(i / g.dims[0] % g.dims[1]), double(i / g.dims[0] / g.dims[1]));
}

struct Comparison {
  size_t valid = 0, wrong_cell = 0, wrong_missing = 0;
  double error = 0;
};
// A result of probe or resample against the locator and the linear field.
Comparison compare(const Dataset& result, const DatasetPtr& source) {
  Comparison r;
  Context context;
  const CellLocator locator(source, context);
  LocatorCursor cursor(locator);
  const auto valid = result.fields().require("valid", Association::point).array.view<uint8_t>();
  const Array &f = result.fields().require("f").array, &v = result.fields().require("v").array, &n = result.fields().require("n").array;
  const Field* c = result.fields().find("c", Association::point);
  for (size_t i = 0; i < result.point_count(); ++i) {
    const Vec3 x = place(result, i);
    const int64_t cell = cursor.find(x);
    if ((cell >= 0) != (valid[i] == 1)) ++r.wrong_cell;
    if (!valid[i]) {
      r.wrong_missing += !std::isnan(f.get(i)) || !std::isnan(v.get(i, 2)) || !std::isnan(n.get(i)) || (c && c->array.get(i) != 0);
      continue;
    }
    ++r.valid;
    if (c) r.wrong_cell += c->array.get(i) != double(cell + 1);
    const double expected = linear(cursor.place().nearest);
    const double size = 1 + std::abs(expected);
    r.error = std::max({r.error, std::abs(f.get(i) - expected) / size, std::abs(v.get(i, 1) - 2 * expected) / size * 1e-4,
                        std::abs(n.get(i) - 10) * 1e-5});
  }
  return r;
}

bool same_fields(const Dataset& a, const Dataset& b) {
  bool same = a.fields().size() == b.fields().size();
  for (size_t i = 0; same && i < a.fields().size(); ++i) {
    const Field &f = a.fields()[i], &g = b.fields()[i];
    same = f.name == g.name && f.array.type() == g.array.type() && f.array.bytes() == g.array.bytes() &&
           std::memcmp(f.array.raw(), g.array.raw(), f.array.bytes()) == 0;
  }
  return same;
}

double sum_of(const Dataset& d, std::string_view name, int c = 0) {
  const Array& a = d.fields().require(name, Association::cell).array;
  double sum = 0;
  for (size_t i = 0; i < a.count(); ++i) sum += a.get(i, c);
  const Vec3 h = d.as<UniformGrid>()->spacing;
  return sum * h.x * h.y * h.z;
}

}  // namespace

TEST_CASE("probe: a linear field is reproduced in every cell of every mesh kind, by the cell that the locator names; nothing outside") {
  for (const NamedMesh& mesh : search_meshes()) {
    if (mesh.name == "points") continue;
    CAPTURE(mesh.name);
    const DatasetPtr source = with_fields(mesh.data);
    Context context;
    Box3 box = source->bounds();
    const DatasetPtr points = random_points(box, mesh.name == "curved" ? 500 : 6000);
    const DatasetPtr result = probe(points, source, {}, context);
    const Comparison r = compare(*result, source);
    const bool surface =
        mesh.name == "triangles" || mesh.name == "surface" || mesh.name == "curvilinear, flat" || mesh.name == "uniform, flat";
    CHECK((surface || r.valid > 100));  // random points do not hit a surface
    CHECK(r.wrong_cell == 0);
    CHECK(r.wrong_missing == 0);
    CHECK(r.error < 1e-9);
    CHECK(result->fields().require("f").unit == "K");
    CHECK(result->fields().require("n").array.type() == ElementType::f32);
  }
}

TEST_CASE("resample: a linear field is reproduced at every point of the grid, from every mesh kind, and nothing outside") {
  for (const NamedMesh& mesh : search_meshes()) {
    if (mesh.name == "points") continue;
    CAPTURE(mesh.name);
    const DatasetPtr source = with_fields(mesh.data);
    Context context;
    ResampleParams params;
    params.size = mesh.name == "curved" ? 8 : 23;
    const DatasetPtr result = resample(source, params, context);
    const Comparison r = compare(*result, source);
    const bool surface = mesh.name == "triangles" || mesh.name == "surface" || mesh.name.ends_with(", flat");
    CHECK((surface || r.valid > 20));
    CHECK(r.wrong_cell == 0);
    CHECK(r.wrong_missing == 0);
    CHECK(r.error < 1e-9);
  }
}

TEST_CASE("probe: points of a surface probed on itself are all found, with its own values") {
  for (const DatasetPtr& d : {ball(12, false), ball(12, true), curvilinear({15, 14, 1}, false)}) {
    const DatasetPtr source = with_fields(d);
    Context context;
    const DatasetPtr result = probe(d, source, {}, context);
    const auto valid = result->fields().require("valid").array.view<uint8_t>();
    const Array &f = result->fields().require("f").array, &g = source->fields().require("f").array;
    size_t missing = 0;
    double error = 0;
    for (size_t i = 0; i < valid.count; ++i) {
      missing += !valid[i];
      if (valid[i] && !std::isnan(g.get(i))) error = std::max(error, std::abs(f.get(i) - g.get(i)));
    }
    CHECK(missing == 0);
    CHECK(error < 1e-5);  // the cell found may be another that lies within the tolerance
  }
}

TEST_CASE("probe: a point cloud as source gives the value of its nearest point") {
  const DatasetPtr source = with_fields(cloud(500));
  Context context;
  const DatasetPtr result = probe_at(source, {.points = {0.1, 0.2, 0.3, 5, 5, 5}}, context);
  const auto& points = source->as<PointCloud>()->points;
  for (size_t q = 0; q < 2; ++q) {
    const Vec3 x = result->as<PointCloud>()->points.at(q);
    double best = HUGE_VAL, value = 0;
    for (size_t i = 0; i < 500; ++i)
      if (const Vec3 d = points.at(i) - x; dot(d, d) < best) best = dot(d, d), value = linear(points.at(i));
    CHECK(result->fields().require("f").array.get(q) == value);
  }
}

TEST_CASE("probe: fields of the first input stay unless the second has the name, or all go") {
  const DatasetPtr source = with_fields(block_cells("tetra", 3, 0.2).dataset());
  DatasetParts parts = random_points(source->bounds(), 50)->parts();
  parts.fields.add({"own", Association::point, Array::from_vector(std::vector<float>(50, 4)), "", Role::none});
  parts.fields.add({"f", Association::point, Array::from_vector(std::vector<float>(50, 4)), "", Role::none});
  const DatasetPtr points = make_dataset(parts);
  Context context;
  const DatasetPtr kept = probe(points, source, {}, context);
  CHECK(kept->fields().require("own").array.get(3) == 4);
  CHECK(kept->fields().require("f").array.get(3) != 4);
  CHECK(probe(points, source, {.keep_fields = false}, context)->fields().find("own") == nullptr);
}

TEST_CASE("probe: a cell field with the name of a point field is kept beside it") {
  DatasetParts parts = block_cells("tetra", 2, 0).dataset()->parts();
  parts.fields.add({"f", Association::point, Array::from_vector(std::vector<float>(27, 2)), "", Role::none});
  parts.fields.add({"f", Association::cell, Array::from_vector(std::vector<int16_t>(48, 5)), "", Role::none});
  Context context;
  const DatasetPtr r = probe_at(make_dataset(parts), {.points = {0.1, 0.2, 0.3}}, context);
  CHECK(r->fields().require("f").array.get(0) == 2);
  CHECK(r->fields().require("f_cell").array.get(0) == 5);
  CHECK(r->fields().require("f_cell").array.type() == ElementType::i16);
}

TEST_CASE("probe_at: a line has its points, ends included, and the distance along it") {
  const DatasetPtr source = with_fields(block_cells("tetra", 3, 0.2).dataset());
  Context context;
  const DatasetPtr line = probe_at(source, {.from = Vec3(-2, 0, 0), .to = Vec3(2, 0, 0), .count = 41}, context);
  REQUIRE(line->as<SurfaceMesh>());
  CHECK(line->point_count() == 41);
  CHECK(line->cell_count() == 1);
  CHECK(line->fields().require("distance").array.get(40) == 4);
  const auto valid = line->fields().require("valid").array.view<uint8_t>();
  CHECK(std::accumulate(valid.data, valid.data + 41, 0) == 21);
  CHECK(line->fields().require("f").array.get(20) == doctest::Approx(1));
}

TEST_CASE("probe and resample: wrong parameters are refused with what would be right") {
  const DatasetPtr source = with_fields(block_cells("tetra", 2, 0).dataset());
  Context context;
  auto at = [&](ProbeAtParams p) { return error_of([&] { probe_at(source, p, context); }); };
  CHECK(at({}).find("points=x,y,z") != std::string::npos);
  CHECK(at({.points = {1, 2, 3}, .from = Vec3()}).find("either") != std::string::npos);
  CHECK(at({.points = {1, 2, 3, 4}}).find("three numbers per point") != std::string::npos);
  CHECK(at({.from = Vec3()}).find("add to=") != std::string::npos);
  auto grid = [&](ResampleParams p) { return error_of([&] { resample(source, p, context); }); };
  CHECK(grid({.dims = {4, 4}}).find("give three: nx,ny,nz") != std::string::npos);
  CHECK(grid({.bounds = {0, 1}}).find("six: xmin") != std::string::npos);
  CHECK(grid({.bounds = {0, 1, 2, 1, 0, 1}}).find("bounds of y") != std::string::npos);
  CHECK(grid({.dims = {4, 4, 4}, .bounds = {0, 1, 0, 1, 0, 0}}).find("no extent") != std::string::npos);
  CHECK(grid({.dims = {100000, 100000, 1000}}).find("10^12") != std::string::npos);
  CHECK(grid({.dims = {4, 4, 1}, .mode = ResampleMode::conservative}).find("2 points or more") != std::string::npos);
  CHECK(error_of([&] { resample(ball(6, false), {.mode = ResampleMode::conservative}, context); }).find("mode=linear") !=
        std::string::npos);
  CHECK(error_of([&] { resample(cloud(0), {}, context); }).find("no finite extent") != std::string::npos);
}

TEST_CASE("resample: dims follow the box, and dims, size and bounds are honoured") {
  const DatasetPtr box = uniform({21, 11, 6}, false);
  const UniformGrid g = resample_grid(*box, {});
  CHECK(g.dims == std::array<size_t, 3>{128, 55, 34});
  CHECK(g.origin == box->bounds().lo);
  CHECK(resample_grid(*box, {.dims = {5, 6, 7}}).dims == std::array<size_t, 3>{5, 6, 7});
  CHECK(resample_grid(*box, {.size = 5, .bounds = {0, 1, 0, 2, 0, 4}}).dims == std::array<size_t, 3>{2, 3, 5});
  CHECK(resample_grid(*box, {.dims = {5, 6, 1}}).origin.z == box->bounds().center().z);
  CHECK(resample_grid(*curvilinear({9, 9, 1}, false), {.bounds = {0, 1, 0, 1, 0, 0}}).dims[2] == 1);
}

TEST_CASE("probe: a plane through solids gives the same from a grid of points and from single points") {
  const DatasetPtr source = with_fields(block_cells("mixed", 4, 0.1).dataset());
  UniformGrid plane;
  plane.dims = {30, 1, 25};
  plane.origin = {-1.1, 0.05, -1};
  plane.spacing = {0.08, 1, 0.08};
  const DatasetPtr grid = make_dataset(plane);
  Context context;
  const DatasetPtr r = probe(grid, source, {}, context);
  const Comparison c = compare(*r, source);
  CHECK(c.valid > 400);
  CHECK(c.wrong_cell == 0);
  CHECK(c.error < 1e-9);
}

TEST_CASE("probe: many points in one place are found too") {
  const DatasetPtr source = with_fields(block_cells("tetra", 4, 0.2).dataset());
  std::vector<double> xyz{0.9, 0.9, 0.9};
  for (size_t i = 0; i < 9000; ++i) xyz.push_back(1e-5 * random_unit(1, i));
  PointCloud c;
  c.points.xyz = Array::from_vector(xyz, 3);
  Context context;
  const Comparison r = compare(*probe(make_dataset(std::move(c)), source, {}, context), source);
  CHECK(r.valid == 3001);
  CHECK(r.wrong_cell == 0);
}

TEST_CASE("resample, conservative: the sum over the grid is the integral over the mesh, whatever the cells") {
  for (const NamedMesh& mesh : search_meshes()) {
    if (mesh.name == "points" || mesh.name == "triangles" || mesh.name == "surface" || mesh.name.ends_with("flat")) continue;
    CAPTURE(mesh.name);
    const DatasetPtr source = with_fields(mesh.data);
    // What the cells themselves say.
    CellMap map(source);
    std::vector<double> w;
    double volume = 0, f = 0, c = 0;
    for (size_t cell = 0; cell < source->cell_count(); ++cell) {
      if (map.reader().hidden(cell)) continue;
      map.open(cell);
      w.resize(map.reader().ids().size());
      map.integration_weights(w);
      for (size_t k = 0; k < w.size(); ++k) {
        volume += w[k], c += w[k] * double(cell + 1);
        f += w[k] * source->fields().require("f").array.get(size_t(map.reader().ids()[k]));
      }
    }
    Context context;
    ResampleParams params{.dims = {9, 7, 8}, .mode = ResampleMode::conservative};
    Box3 b = source->bounds();
    b.lo += Vec3(-0.1, -0.1, -0.1), b.hi += Vec3(0.1, 0.1, 0.1);  // curved cells bulge
    params.bounds = {b.lo.x, b.hi.x, b.lo.y, b.hi.y, b.lo.z, b.hi.z};
    const DatasetPtr r = resample(source, params, context);
    const double exact = mesh.name == "tetrahedra, far away" ? 1e-7 : 1e-11;
    CHECK(sum_of(*r, "coverage") == doctest::Approx(volume).epsilon(1e-6));  // f32
    CHECK(std::abs(sum_of(*r, "f") - f) <= exact * (std::abs(f) + volume));
    CHECK(sum_of(*r, "c") == doctest::Approx(c).epsilon(1e-6));
    CHECK(sum_of(*r, "v", 1) == doctest::Approx(2 * f).epsilon(1e-5));
  }
}

TEST_CASE("resample, conservative: inside the mesh, a linear field has the value of the grid cell's middle, and coverage is one") {
  for (const char* what : {"tetra", "hexahedron", "polyhedron"}) {
    const DatasetPtr source = with_fields(block_cells(what, 4, what == std::string("tetra") ? 0.25 : 0.0).dataset());
    Context context;
    const DatasetPtr r = resample(source, {.dims = {8, 9, 10}, .mode = ResampleMode::conservative}, context);
    const auto& g = *r->as<UniformGrid>();
    double error = 0, gap = 0;
    for (size_t i = 0; i < r->cell_count(); ++i) {
      const Vec3 x = g.origin + g.spacing * Vec3(double(i % 7) + 0.5, double(i / 7 % 8) + 0.5, double(i / 56) + 0.5);
      error = std::max(error, std::abs(r->fields().require("f").array.get(i) - linear(x)));
      gap = std::max(gap, std::abs(r->fields().require("coverage").array.get(i) - 1));
    }
    CHECK(error < 1e-12);
    CHECK(gap < 1e-6);
  }
}

TEST_CASE("resample, conservative: parts in a box are what lies in the box, and NaN spreads") {
  DatasetParts parts = with_fields(uniform({11, 11, 11}, false))->parts();
  Context context;
  const DatasetPtr r = resample(make_dataset(parts),
                                {.dims = {2, 2, 2}, .bounds = {0, 0.5, 0, 0.25, 0, 0.125}, .mode = ResampleMode::conservative}, context);
  CHECK(r->fields().require("f").array.get(0) == doctest::Approx(linear({0.25, 0.125, 0.0625})).epsilon(1e-13));
  std::vector<double> f(1331, 1);
  f[0] = NAN;
  parts.fields.add({"f", Association::point, Array::from_vector(f), "", Role::none});
  const DatasetPtr n = resample(make_dataset(parts), {.dims = {3, 3, 3}, .mode = ResampleMode::conservative}, context);
  CHECK(std::isnan(n->fields().require("f").array.get(0)));
  CHECK(n->fields().require("f").array.get(7) == doctest::Approx(1));
}

TEST_CASE("probe and resample: the same bytes with 1 and 8 threads") {
  for (const char* what : {"tetra", "mixed"}) {
    const DatasetPtr source = with_fields(block_cells(what, 7, 0.15).dataset());
    const DatasetPtr points = random_points(source->bounds(), 20000);
    Context context;
    std::vector<DatasetPtr> results[2];
    for (int t = 0; t < 2; ++t) {
      set_thread_count(t ? 8 : 1);
      results[t] = {probe(points, source, {}, context), resample(source, {.size = 40}, context),
                    resample(source, {.size = 12, .mode = ResampleMode::conservative}, context)};
    }
    set_thread_count(0);
    for (size_t i = 0; i < 3; ++i) CHECK(same_fields(*results[0][i], *results[1][i]));
  }
}
