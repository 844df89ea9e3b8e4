// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/scalar/contour/contour_support.h"
#include "filter/surface/surfels.h"

using namespace sg;

TEST_CASE("surfels: lie on the sphere, look outward, as many as cells that the contour cuts") {
  Context ctx;
  double h[3], off[3], turned[3];
  for (int l = 0; l < 3; ++l) {
    const size_t n = (size_t(16) << l) + 1;
    const DatasetPtr grid = test::cube(n, 1.3, [](Vec3 p) { return 1 - length(p); });
    const DatasetPtr d = surfels(grid, {.value = 0}, ctx);
    const auto& points = d->as<PointCloud>()->points;
    const Field &normal = d->fields().require("Normals", Association::point), &radius = d->fields().require("radius", Association::point);
    h[l] = 1.0 / double(n), off[l] = turned[l] = 0;
    for (size_t i = 0; i < points.count(); ++i) {
      const Vec3 p = points.at(i), m(normal.array.get(i, 0), normal.array.get(i, 1), normal.array.get(i, 2));
      CHECK(length(p) > 0.9);
      off[l] += std::abs(length(p) - 1), turned[l] += length(m - normalize(p));
    }
    off[l] /= double(points.count()), turned[l] /= double(points.count());
    CHECK(radius.array.get(0) == doctest::Approx(std::sqrt(3.0) / 2 * 2.6 / double(n - 1)));
    size_t cut = 0;  // cells with samples on both sides
    const Field& f = grid->fields().require("f");
    for (size_t k = 0; k + 1 < n; ++k)
      for (size_t j = 0; j + 1 < n; ++j)
        for (size_t i = 0; i + 1 < n; ++i) {
          int in = 0;
          for (size_t c = 0; c < 8; ++c) in += f.array.get(i + (c & 1) + n * (j + (c >> 1 & 1) + n * (k + (c >> 2)))) >= 0;
          cut += in > 0 && in < 8;
        }
    CHECK(points.count() == cut);
  }
  CHECK(test::observed_order(h, off, 3) > 1.7);
  CHECK(test::observed_order(h, turned, 3) > 0.9);
}

TEST_CASE("surfels: fields are carried, types and grids agree, holes are honoured, threads do not matter") {
  Context ctx;
  const Mesh g = test::uniform({20, 18, 16}, {-1, -1, -1}, {1, 1, 1});
  DatasetParts parts;
  parts.mesh = g;
  auto sphere = [](Vec3 p) { return 100 - 100 * length(p); };
  parts.fields.add(test::point_field<float>(g, {20, 18, 16}, sphere, "f"));
  parts.fields.add(test::point_field<double>(
      g, {20, 18, 16}, [](Vec3 p) { return p.x + 2 * p.y; }, "linear"));
  std::vector<int32_t> ids(19 * 17 * 15);
  std::iota(ids.begin(), ids.end(), 0);
  parts.fields.add({"id", Association::cell, Array::from_vector(ids), "", Role::none});
  const DatasetPtr in = make_dataset(parts);
  set_thread_count(1);
  const DatasetPtr d = surfels(in, {.field = {"f"}, .value = 30}, ctx);
  set_thread_count(8);
  const DatasetPtr e = surfels(in, {.field = {"f"}, .value = 30}, ctx);
  set_thread_count(0);
  CHECK(test::same_bytes(d->as<PointCloud>()->points.xyz, e->as<PointCloud>()->points.xyz));
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 p = d->as<PointCloud>()->points.at(i);
    CHECK(d->fields().require("linear").array.get(i) == doctest::Approx(p.x + 2 * p.y).epsilon(1e-5));
  }
  CHECK(d->fields().require("id", Association::point).array.count() == d->point_count());
  DatasetParts bytes;
  bytes.mesh = g;
  bytes.fields.add(test::point_field<uint8_t>(
      g, {20, 18, 16}, [&](Vec3 p) { return std::max(0.0, sphere(p)); }, "f"));
  CHECK(surfels(make_dataset(bytes), {.value = 30.5}, ctx)->point_count() > 100);
  std::vector<uint8_t> ghost(19 * 17 * 15, 0);
  std::fill(ghost.begin(), ghost.begin() + 19 * 17 * 8, ghost_hidden_cell);
  parts.cell_ghost = Array::from_vector(ghost);
  const DatasetPtr half = surfels(make_dataset(parts), {.field = {"f"}, .value = 30}, ctx);
  CHECK(half->point_count() < d->point_count());
  CHECK(half->bounds().lo.z > 0);
  const DatasetPtr nan = surfels(test::cube(8, 1, [](Vec3 p) { return p.x > 0 ? std::nan("") : p.y; }), {.value = 0}, ctx);
  CHECK(nan->bounds().hi.x < 0);
}

TEST_CASE("surfels: bad input") {
  Context ctx;
  const DatasetPtr grid = test::cube(5, 1, [](Vec3 p) { return p.x; });
  CHECK(surfels(grid, {.value = 9}, ctx)->point_count() == 0);
  CHECK(test::error_of([&] { surfels(grid, {.value = HUGE_VAL}, ctx); }).find("isovalue") != std::string::npos);
  CHECK(test::error_of([&] { surfels(grid, {.field = {"g"}}, ctx); }).find("'g'") != std::string::npos);
  CHECK(test::error_of([&] { surfels(test::meshes::solid_box(CellType::tetra, 1), {}, ctx); }).find("grids") != std::string::npos);
  CHECK(test::error_of([&] { surfels(test::meshes::uniform_box(3, 3, 0), {}, ctx); }).find("solid") != std::string::npos);
  CHECK(test::error_of([&] { surfels(test::meshes::uniform_box(3, 3, 3), {.field = {"c"}}, ctx); }).find("not a point field") !=
        std::string::npos);
}
