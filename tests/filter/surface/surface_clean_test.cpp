// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <random>

#include "base/parallel.h"
#include "filter/mesh/append.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/select/components.h"
#include "filter/surface/clean.h"
#include "filter/surface/mass_properties.h"
#include "filter/surface/normals.h"
#include "filter/surface/smooth.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;

TEST_CASE("clean: equal points, repeated corners, doubled and degenerate cells and unused points go") {
  Context ctx;
  std::string said;
  ctx.on_log = [&](LogLevel, std::string_view text) { said += text; };
  Builder b = box();
  b.point({9, 9, 9});                       // unused
  const int64_t twin = b.point({0, 0, 0});  // at the place of point 0
  b.polygon({1, 3, 2, 0});                  // the floor once more
  b.polygon({twin, 0, 1});                  // two points
  b.polygon({0, 1, twin});                  // likewise
  b.polygon({0, 1, 1, 7});                  // a triangle
  const DatasetPtr c = clean(b.dataset(), {}, ctx);
  CHECK(c->point_count() == 8);
  CHECK(c->cell_count() == 7);
  CHECK(cells_view(c->as<SurfaceMesh>()->polygons).size(6) == 3);
  CHECK(said.find("2 points") != std::string::npos);
  CHECK(clean(b.dataset(), {.duplicates = false}, ctx)->cell_count() == 8);
  Builder sliver = box();
  const int64_t m = sliver.point({0.5, 0, 0});
  sliver.polygon({0, m, 1});
  CHECK(clean(sliver.dataset(), {}, ctx)->cell_count() == 7);
  CHECK(clean(sliver.dataset(), {.flat = true}, ctx)->cell_count() == 6);
  Builder near = box();
  near.polygon({near.point({2, 0, 0}), near.point({2 + 1e-6, 0, 0}), near.point({2, 1e-6, 0})});
  CHECK(clean(near.dataset(), {.tolerance = 1e-5}, ctx)->cell_count() == 6);
}

TEST_CASE("clean: every mesh kind, or a word why not") {
  Context ctx;
  using namespace test::meshes;
  const DatasetPtr grid = uniform_box(2, 2, 2);
  CHECK(clean(grid, {}, ctx) == grid);
  for (CellType t : {CellType::tetra, CellType::polyhedron, CellType::hexahedron}) {
    const DatasetPtr d = solid_box(t, 2), twice = append({Data(d), Data(d)}, {}, ctx);
    const DatasetPtr c = clean(twice, {}, ctx);
    CHECK(c->cell_count() == d->cell_count());
    CHECK(c->fields().require("f", Association::point).array.count() == c->point_count());
  }
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 0, 0}, 3);
  CHECK(clean(make_dataset(Mesh(cloud)), {}, ctx)->point_count() == 2);
  AmrGrid amr;
  amr.levels.resize(1);
  amr.levels[0].patches = {{{0, 0, 0}, {1, 1, 1}, 0, 0}};
  CHECK(test::error_of([&] { clean(make_dataset(Mesh(amr)), {}, ctx); }).find("AMR") != std::string::npos);
  SurfaceMesh empty;
  empty.points.xyz = Array::from_vector(std::vector<float>{1, 2, 3}, 3);
  CHECK(clean(make_dataset(Mesh(empty)), {}, ctx)->point_count() == 0);
}

TEST_CASE("components: by point numbers, by a place, the largest; AMR patches hang together") {
  Context ctx;
  const DatasetPtr three =
      append({Data(sphere(1, 1, {0, 0, 0}).dataset()), Data(sphere(2, 1, {5, 0, 0}).dataset()), Data(sphere(0, 1, {10, 0, 0}).dataset())},
             {}, ctx);
  auto cells = [&](const ComponentsParams& p) { return components(three, p, ctx)->cell_count(); };
  CHECK(cells({.points = {0}}) == 32);
  CHECK(cells({.points = {0, 3, int64_t(three->point_count()) - 1}}) == 40);
  CHECK(cells({.keep = 2}) == 160);
  CHECK(cells({.at = Vec3{9, 0, 0}}) == 8);
  CHECK(test::error_of([&] { cells({.points = {100000}}); }).find("100000") != std::string::npos);
  CHECK(test::error_of([&] { cells({.keep = 1, .points = {1}}); }).find("one of them") != std::string::npos);
  AmrGrid amr;
  amr.levels.resize(1);
  amr.levels[0].patches = {{{0, 0, 0}, {1, 1, 1}, 0, 0}, {{2, 0, 0}, {3, 1, 1}, 8, 27}, {{7, 0, 0}, {7, 1, 1}, 16, 54}};
  const DatasetPtr d = components(make_dataset(Mesh(amr)), {}, ctx);
  const Field& f = d->fields().require("component", Association::cell);
  CHECK(f.array.get(0) == 0);
  CHECK(f.array.get(15) == 0);
  CHECK(f.array.get(16) == 1);
}

TEST_CASE("smooth: takes the noise away and keeps the volume") {
  Context ctx;
  Builder b = sphere(5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> d(-0.03, 0.03);
  for (size_t i = 0; i < b.xyz.size(); i += 3) {
    const double r = 1 + d(random);
    for (size_t c = 0; c < 3; ++c) b.xyz[i + c] *= r;
  }
  auto roughness = [](const DatasetPtr& s) {
    double sum = 0;
    for (size_t i = 0; i < s->point_count(); ++i) sum += std::pow(length(s->as<SurfaceMesh>()->points.at(i)) - 1, 2);
    return std::sqrt(sum / double(s->point_count()));
  };
  const DatasetPtr s = smooth(b.dataset(), {}, ctx);
  CHECK(roughness(s) < 0.3 * roughness(b.dataset()));
  const double volume = number(*mass_properties(s, {}, ctx), "volume");
  CHECK(volume == doctest::Approx(4 * pi / 3).epsilon(0.005));
  const DatasetPtr many = smooth(sphere(4).dataset(), {.iterations = 200}, ctx);
  CHECK(number(*mass_properties(many, {}, ctx), "volume") ==
        doctest::Approx(number(*mass_properties(sphere(4).dataset(), {}, ctx), "volume")).epsilon(1e-9));
  CHECK(test::meshes::same_surface(*smooth(b.dataset(), {.iterations = 0}, ctx), *b.dataset()));
  set_thread_count(1);
  const DatasetPtr one = smooth(b.dataset(), {}, ctx);
  set_thread_count(8);
  CHECK(test::meshes::same_surface(*one, *smooth(b.dataset(), {}, ctx)));
  set_thread_count(0);
}

TEST_CASE("smooth: borders stay in their plane or stand still, sharp edges stay sharp, split points stay together, bad input") {
  Context ctx;
  const DatasetPtr flat = test::meshes::uniform_box(6, 6, 0);
  const DatasetPtr fixed = smooth(flat, {.border = false}, ctx);
  for (size_t i = 0; i < fixed->point_count(); ++i) CHECK(std::abs(fixed->as<SurfaceMesh>()->points.at(i).z) < 1e-12);
  CHECK(fixed->bounds().hi.x == 1);
  const DatasetPtr cube = test::meshes::uniform_box(4, 4, 4);
  const DatasetPtr sharp = smooth(cube, {.feature_angle = 40}, ctx);
  CHECK(number(*mass_properties(sharp, {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-9));
  CHECK(number(*mass_properties(smooth(cube, {.keep_volume = false}, ctx), {}, ctx), "volume") != doctest::Approx(1).epsilon(0.01));
  const DatasetPtr split = smooth(normals(cube, {}, ctx), {}, ctx);
  CHECK(number(*mass_properties(split, {}, ctx), "closed") == 1);
  CHECK(!split->fields().find("Normals"));
  CHECK(test::error_of([&] { smooth(cube, {.lambda = 1, .pass_band = 1.5}, ctx); }).find("pass_band") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { smooth(make_dataset(Mesh(cloud)), {}, ctx); }).find("no faces") != std::string::npos);
}
