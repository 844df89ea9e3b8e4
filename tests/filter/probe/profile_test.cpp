// SPDX-License-Identifier: Apache-2.0
#include "filter/probe/profile.h"

#include "support/test.h"

using namespace sg;

namespace {

// A bent line of two parts of lengths 5 and 2, and one of a single length 1, with values at the points and on the lines.
DatasetPtr two_lines(std::vector<double> values) {
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 3, 4, 0, 3, 4, 2, 9, 9, 9, 9, 9, 8}, 3);
  mesh.lines.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 4});
  mesh.lines.offsets = Array::from_vector(std::vector<int64_t>{0, 3, 5});
  DatasetParts parts;
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(values)), "K", Role::scalars});
  parts.fields.add({"line", Association::cell, Array::from_vector(std::vector<int32_t>{7, 8}), "", Role::none});
  parts.mesh = std::move(mesh);
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("profile: distance along each line to the right, the value upwards") {
  Context ctx;
  const DatasetPtr d = profile(two_lines({10, 20, 30, 40, 50}), {}, ctx);
  const auto* mesh = d->as<SurfaceMesh>();
  REQUIRE(mesh);
  const CellsView lines = cells_view(mesh->lines);
  REQUIRE(lines.count == 2);
  const std::vector<Vec3> first{{0, 10, 0}, {5, 20, 0}, {7, 30, 0}}, second{{0, 40, 0}, {1, 50, 0}};
  for (size_t k = 0; k < 3; ++k) CHECK(mesh->points.at(size_t(lines.point(0, k))) == first[k]);
  for (size_t k = 0; k < 2; ++k) CHECK(mesh->points.at(size_t(lines.point(1, k))) == second[k]);
  CHECK(d->fields().require("v").array.get(2) == 30);
  CHECK(d->fields().require("line", Association::cell).array.get(1) == 8);
}

TEST_CASE("profile: a curve is broken where there is no value, and what is left of a single point is none") {
  Context ctx;
  const DatasetPtr d = profile(two_lines({10, NAN, 30, 40, 50}), {}, ctx);
  const CellsView lines = cells_view(d->as<SurfaceMesh>()->lines);
  REQUIRE(lines.count == 1);
  CHECK(d->fields().require("line", Association::cell).array.get(0) == 8);
  CHECK(d->as<SurfaceMesh>()->points.at(size_t(lines.point(0, 1))) == Vec3{1, 50, 0});
}

TEST_CASE("profile: what has no lines or no scalar is refused with what would be right") {
  Context ctx;
  CHECK(test::contains(test::error_of([&] { profile(two_lines({1, 2, 3, 4, 5}), {.field = {"line"}}, ctx); }), "cells, not on the points"));
  DatasetParts bare = two_lines({1, 2, 3, 4, 5})->parts();
  std::get<SurfaceMesh>(bare.mesh).lines = {};
  bare.fields = {};
  CHECK(test::contains(test::error_of([&] { profile(make_dataset(std::move(bare)), {}, ctx); }), "probe_at"));
}
