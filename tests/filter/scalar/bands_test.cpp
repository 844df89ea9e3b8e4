// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <random>

#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/surface.h"
#include "filter/scalar/bands.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/surface/feature_edges.h"
#include "filter/surface/surface_shapes.h"

using namespace sg;

namespace {

// Area of each band, by the vector areas of its polygons.
std::map<int, double> areas(const Dataset& d) {
  const auto& m = *d.as<SurfaceMesh>();
  const CellsView p = cells_view(m.polygons);
  const Field& band = d.fields().require("band", Association::cell);
  std::map<int, double> r;
  for (size_t c = 0; c < p.count; ++c) {
    std::vector<Vec3> at;
    for (size_t k = 0; k < p.size(c); ++k) at.push_back(m.points.at(size_t(p.point(c, k))));
    r[int(band.array.get(c))] += length(polygon_vector_area(at));
  }
  for (auto& [b, a] : r) a /= 2;
  return r;
}

double total(const std::map<int, double>& a) {
  double s = 0;
  for (const auto& [b, x] : a) s += x;
  return s;
}

}  // namespace

TEST_CASE("bands: a circle's disc has its area with order 2, and the bands add up to the square") {
  Context ctx;
  double h[4], error[4];
  for (int l = 0; l < 4; ++l) {
    const size_t n = (size_t(16) << l) + 1;
    const auto a = areas(*bands(test::square_grid(n, [](Vec3 p) { return length(p); }), {.values = {1, 0.5}}, ctx));
    CHECK(total(a) == doctest::Approx(9).epsilon(1e-13));
    h[l] = 1.0 / double(n), error[l] = std::abs(a.at(0) + a.at(1) - test::shapes::pi);
  }
  CHECK(test::observed_order(h, error, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("bands: random values: exact cover without gaps, every polygon within its band, also where samples equal a border") {
  Context ctx;
  std::mt19937 random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const DatasetPtr d = test::square_grid(9, [&](Vec3) { return double(random() % 7); });
    std::vector<double> values = trial % 2 ? std::vector<double>{1, 2, 3.5, 5} : std::vector<double>{0.5, 1.7, 2.2, 4.4};
    if (trial >= 36)  // so many that they are halved first
      for (int k = 0; k < 300; ++k) values.push_back(trial % 2 ? 0.02 * k : 0.013 + 0.02 * k);
    const DatasetPtr b = bands(d, {.values = values}, ctx);
    CHECK(total(areas(*b)) == doctest::Approx(9).epsilon(1e-12));
    const auto& m = *b->as<SurfaceMesh>();
    const CellsView p = cells_view(m.polygons);
    const Field &f = b->fields().require("f", Association::point), &lo = b->fields().require("band low", Association::cell),
                &hi = b->fields().require("band high", Association::cell);
    bool within = true, right_way = true;
    for (size_t c = 0; c < p.count; ++c) {
      std::vector<Vec3> at;
      for (size_t k = 0; k < p.size(c); ++k) {
        const double x = f.array.get(size_t(p.point(c, k)));
        within = within && x >= lo.array.get(c) && x <= hi.array.get(c);
        at.push_back(m.points.at(size_t(p.point(c, k))));
      }
      right_way = right_way && polygon_vector_area(at).z > -1e-12;
    }
    CHECK(within);
    CHECK(right_way);
    // Open edges only along the border of the square.
    FeatureEdgesParams only;
    only.feature = only.non_manifold = false;
    const DatasetPtr open = feature_edges(b, only, ctx);
    const auto& e = *open->as<SurfaceMesh>();
    double border = 0;
    for (size_t i = 0; i < e.lines.size(); ++i)
      border += length(e.points.at(size_t(cells_view(e.lines).point(i, 0))) - e.points.at(size_t(cells_view(e.lines).point(i, 1))));
    CHECK(border == doctest::Approx(12).epsilon(1e-12));
  }
}

TEST_CASE("bands: an ambiguous cell is joined or separated by the bilinear function") {
  Context ctx;
  UniformGrid g;
  g.dims = {2, 2, 1};
  auto pieces = [&](std::vector<double> v) {
    FieldSet fields;
    fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
    const DatasetPtr d = bands(make_dataset(g, fields), {.values = {0}}, ctx);
    const Field& band = d->fields().require("band", Association::cell);
    int above = 0;
    for (size_t i = 0; i < band.array.count(); ++i) above += band.array.get(i) == 1;
    return above;
  };
  CHECK(pieces({3, -1, -1, 3}) == 1);
  CHECK(pieces({1, -3, -3, 1}) == 2);
}

TEST_CASE("bands: every mesh kind; a linear field's bands have exact areas") {
  Context ctx;
  using namespace test::meshes;
  for (const DatasetPtr& d : {uniform_box(4, 4, 4), solid_box(CellType::tetra, 3), solid_box(CellType::polyhedron, 2),
                              solid_box(CellType::hexahedron, 3), solid_box(CellType::quadratic_tetra, 2)}) {
    const DatasetPtr b = bands(d, {.field = {"f"}, .values = {0, 1.3, 2.9}}, ctx);
    CHECK(total(areas(*b)) == doctest::Approx(6).epsilon(1e-12));
    CHECK(linear_error(*b, b->as<SurfaceMesh>()->points) < 1e-12);
    CHECK(b->fields().find("c", Association::cell));
    const auto a = areas(*b), coarse = areas(*bands(uniform_box(1, 1, 1), {.field = {"f"}, .values = {0, 1.3, 2.9}}, ctx));
    for (const auto& [band, x] : coarse) CHECK(a.at(band) == doctest::Approx(x).epsilon(1e-11));
  }
  const auto flat = areas(*bands(uniform_box(5, 3, 0), {.field = {"f"}, .values = {0}}, ctx));  // x + 2y < 1: a triangle of 1/4
  CHECK(flat.at(0) == doctest::Approx(0.25).epsilon(1e-13));
  // A non-convex polygon and a strip.
  test::shapes::Builder b;
  for (Vec3 p : {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(1, 0.5, 0), Vec3(0, 2, 0)}) b.point(p);
  b.polygon({0, 1, 2, 3, 4});
  DatasetParts parts = b.dataset()->parts();
  parts.fields.add({"y", Association::point, Array::from_vector(std::vector<double>{0, 0, 2, 0.5, 2}), "", Role::scalars});
  CHECK(areas(*bands(make_dataset(parts), {.values = {0.5}}, ctx)).at(0) == doctest::Approx(1).epsilon(1e-13));
}

TEST_CASE("bands: a constant field, outer bands left out, NaN, and bad input") {
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view text) { said += text; };
  CHECK(areas(*bands(test::square_grid(5, [](Vec3) { return 2.0; }), {}, ctx)).size() == 1);
  const auto x = [](Vec3 p) { return p.x; };
  const auto inner = areas(*bands(test::square_grid(7, x), {.values = {1, -1, -1, 0.2}, .outside = false}, ctx));
  CHECK(inner.size() == 2);
  CHECK(inner.at(1) == doctest::Approx(3.6).epsilon(1e-12));
  CHECK(areas(*bands(test::square_grid(7, x), {.count = 6}, ctx)).size() == 6);
  const DatasetPtr nan =
      bands(test::square_grid(3, [](Vec3 p) { return p.x > 1 && p.y > 1 ? std::nan("") : p.x; }), {.values = {0.3}}, ctx);
  CHECK(total(areas(*nan)) == doctest::Approx(9 * 0.75).epsilon(1e-12));
  CHECK(said.find("1 polygons with a corner without a value") != std::string::npos);
  CHECK(bands(test::square_grid(3, x), {.values = {100}, .outside = false}, ctx)->cell_count() == 0);
  CHECK(said.find("nothing is left") != std::string::npos);
  auto error = [&](const BandsParams& p, const DatasetPtr& d) { return test::error_of([&] { bands(d, p, ctx); }); };
  CHECK(error({.values = {HUGE_VAL}}, test::square_grid(3, x)).find("not a valid band limit") != std::string::npos);
  CHECK(error({.field = {"g"}}, test::square_grid(3, x)).find("'g'") != std::string::npos);
  CHECK(error({.field = {"c"}}, test::meshes::uniform_box(2, 2, 0)).find("cell_to_point") != std::string::npos);
  CHECK(error({.component = 3}, test::square_grid(3, x)).find("component") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(error({}, make_dataset(Mesh(cloud))).find("no faces") != std::string::npos);
}

TEST_CASE("bands: the same bytes for any number of threads") {
  Context ctx;
  const DatasetPtr d = test::square_grid(150, [](Vec3 p) { return std::sin(5 * p.x) * std::cos(7 * p.y); });
  set_thread_count(1);
  const DatasetPtr one = bands(d, {}, ctx);
  set_thread_count(8);
  CHECK(test::meshes::same_surface(*one, *bands(d, {}, ctx)));
  set_thread_count(0);
}
