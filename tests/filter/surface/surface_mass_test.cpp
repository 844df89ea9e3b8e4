// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include "base/parallel.h"
#include "filter/mesh/append.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/mass_properties.h"
#include "filter/surface/polygons.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;
using namespace sg::test::shapes;

TEST_CASE("mass_properties: a box has its area, volume, centroid and inertia, far from the origin too") {
  Context ctx;
  for (double shift : {0.0, 1e6}) {
    Builder b = box(2, 3, 4);
    for (size_t i = 0; i < b.xyz.size(); i += 3) b.xyz[i] += shift;
    const TablePtr t = mass_properties(b.dataset(), {.density = 2}, ctx);
    const double tolerance = shift == 0 ? 1e-14 : 1e-9;
    CHECK(number(*t, "closed") == 1);
    CHECK(number(*t, "area") == doctest::Approx(52).epsilon(tolerance));
    CHECK(number(*t, "volume") == doctest::Approx(24).epsilon(tolerance));
    CHECK(number(*t, "mass") == doctest::Approx(48).epsilon(tolerance));
    CHECK(number(*t, "x") == doctest::Approx(1 + shift).epsilon(tolerance));
    CHECK(number(*t, "z") == doctest::Approx(2).epsilon(tolerance));
    CHECK(number(*t, "xx") == doctest::Approx(48 * (9 + 16) / 12.0).epsilon(tolerance));
    CHECK(number(*t, "yy") == doctest::Approx(48 * (4 + 16) / 12.0).epsilon(tolerance));
    CHECK(number(*t, "zz") == doctest::Approx(48 * (4 + 9) / 12.0).epsilon(tolerance));
    CHECK(std::abs(number(*t, "xy")) < 1e-6);
  }
}

TEST_CASE("mass_properties: sphere and torus converge with order 2") {
  Context ctx;
  double h[4], area[4], volume[4], inertia[4], tv[4];
  for (int l = 2; l < 6; ++l) {
    const TablePtr t = mass_properties(sphere(l).dataset(), {}, ctx);
    h[l - 2] = std::pow(0.5, l);
    area[l - 2] = std::abs(number(*t, "area") - 4 * pi);
    volume[l - 2] = std::abs(number(*t, "volume") - 4 * pi / 3);
    inertia[l - 2] = std::abs(number(*t, "xx") - 8 * pi / 15);
    const int n = 8 << (l - 2);
    tv[l - 2] = std::abs(number(*mass_properties(torus(2 * n, n, 1, 0.4).dataset(), {}, ctx), "volume") - 2 * pi * pi * 0.16);
  }
  CHECK(test::observed_order(h, area, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(test::observed_order(h, volume, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(test::observed_order(h, inertia, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(test::observed_order(h, tv, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("mass_properties: polygons the wrong way round and doubled points do not matter; an open surface has no volume") {
  Context ctx;
  Builder b = box();
  std::swap(b.ids[0], b.ids[2]);  // one quad turned round
  CHECK(number(*mass_properties(b.dataset(), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-14));
  Builder apart;
  for (size_t c = 0; c < 6; ++c) {
    std::vector<int64_t> q;
    for (size_t k = 0; k < 4; ++k) {
      const auto p = size_t(box().ids[4 * c + k]);
      q.push_back(apart.point({b.xyz[3 * p], b.xyz[3 * p + 1], b.xyz[3 * p + 2]}));
    }
    apart.polygon(q);
  }
  CHECK(number(*mass_properties(apart.dataset(), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-14));
  std::string warned;
  ctx.on_log = [&](LogLevel, std::string_view text) { warned += text; };
  const TablePtr open = mass_properties(cylinder(12, 1, false).dataset(), {}, ctx);
  CHECK(number(*open, "closed") == 0);
  CHECK(std::isnan(number(*open, "volume")));
  CHECK(number(*open, "area") == doctest::Approx(12 * 2 * std::sin(pi / 12)).epsilon(1e-13));
  CHECK(number(*open, "area_z") == doctest::Approx(0.5));
  CHECK(warned.find("24 edges") != std::string::npos);
  CHECK(test::error_of([&] { mass_properties(cylinder(12, 1, false).dataset(), {.must_be_closed = true}, ctx); }).find("open") !=
        std::string::npos);
}

TEST_CASE("mass_properties: a hollow ball loses its cavity") {
  Context ctx;
  Builder inner = sphere(3, 0.5), outer = sphere(3);
  for (size_t i = 0; i < inner.ids.size(); i += 3) std::swap(inner.ids[i], inner.ids[i + 1]);
  const DatasetPtr both = append({Data(outer.dataset()), Data(inner.dataset())}, {}, ctx);
  const double whole = number(*mass_properties(outer.dataset(), {}, ctx), "volume");
  CHECK(number(*mass_properties(both, {}, ctx), "volume") == doctest::Approx(whole * 7 / 8).epsilon(1e-13));
}

TEST_CASE("mass_properties: every mesh kind of the unit cube; a collection has a row a part") {
  Context ctx;
  using namespace test::meshes;
  for (CellType t :
       {CellType::tetra, CellType::hexahedron, CellType::wedge, CellType::pyramid, CellType::polyhedron, CellType::quadratic_tetra})
    CHECK(number(*mass_properties(solid_box(t, 2), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-12));
  CHECK(number(*mass_properties(uniform_box(3, 2, 4), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-12));
  const TablePtr flat = mass_properties(uniform_box(3, 2, 0), {}, ctx);
  CHECK(number(*flat, "area") == doctest::Approx(1).epsilon(1e-12));
  CHECK(number(*flat, "closed") == 0);
  AmrGrid amr;
  amr.levels.resize(2);
  amr.levels[0].spacing = {0.5, 0.5, 0.5};
  amr.levels[0].patches = {{{0, 0, 0}, {1, 1, 1}, 0, 0}};
  amr.levels[1].spacing = {0.25, 0.25, 0.25};
  amr.levels[1].patches = {{{0, 0, 0}, {1, 1, 1}, 8, 27}};
  DatasetParts parts;
  parts.mesh = amr;
  std::vector<uint8_t> ghost(16, 0);
  ghost[0] = ghost_refined_cell;
  parts.cell_ghost = Array::from_vector(ghost);
  CHECK(number(*mass_properties(make_dataset(parts), {}, ctx), "volume") == doctest::Approx(1).epsilon(1e-12));
  auto both = std::make_shared<Collection>();
  both->parts.push_back({"a", box().dataset()});
  both->parts.push_back({"b", box(2).dataset()});
  const TablePtr t = mass_properties(CollectionPtr(both), {}, ctx);
  CHECK(number(*t, "volume", 1) == doctest::Approx(2));
  CHECK((*t->words(0))[1] == "b");
}

TEST_CASE("mass_properties: bad input: clouds are refused, empty and degenerate surfaces have no volume") {
  Context ctx;
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { mass_properties(make_dataset(Mesh(cloud)), {}, ctx); }).find("no faces") != std::string::npos);
  SurfaceMesh empty;
  empty.points.xyz = Array::from_vector(std::vector<float>{}, 3);
  CHECK(number(*mass_properties(make_dataset(Mesh(empty)), {}, ctx), "area") == 0);
  Builder flat;
  for (int i = 0; i < 3; ++i) flat.point({double(i), 0, 0});
  flat.polygon({0, 1, 2});
  CHECK(number(*mass_properties(flat.dataset(), {}, ctx), "area") == 0);
}

TEST_CASE("mass_properties: the same bytes for any number of threads") {
  Context ctx;
  const DatasetPtr s = sphere(6).dataset();
  set_thread_count(1);
  const TablePtr one = mass_properties(s, {}, ctx);
  set_thread_count(8);
  const TablePtr eight = mass_properties(s, {}, ctx);
  set_thread_count(0);
  for (const char* c : {"area", "volume", "x", "xx", "xy"}) CHECK(number(*one, c) == number(*eight, c));
}
