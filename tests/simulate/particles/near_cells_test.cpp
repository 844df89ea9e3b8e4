// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/near_cells.h"

#include <array>
#include <optional>

#include "base/random.h"
#include "index/cell_locator.h"
#include "simulate/particles/meshes.h"
#include "support/test.h"

using namespace sg;
using namespace sg::swarm;

TEST_CASE("particles: a short way meets the same cell at the same place whether all cells are asked or those near it") {
  Context context;
  for (const int times : {1, 3, 4}) {
    const DatasetPtr mesh = test::ball(times);
    const NearCells near(mesh, 1e-6);
    const CellLocator locator(mesh, context);
    LocatorCursor cursor(locator);
    size_t hits = 0, free = 0;
    for (uint64_t i = 0; i < 20000; ++i) {
      const auto chance = [&](uint64_t k) { return 2 * random_unit(7, 16 * i + k) - 1; };
      // About the surface and at corners of triangles, along axes too.
      Vec3 x = Vec3(chance(0), chance(1), chance(2));
      x = normalize(x) * (1 + 0.02 * chance(3));
      if (i % 4 == 0) x = i % 8 ? Vec3(1, 0, 0) + Vec3(0.01 * chance(0), 0, 0) : Vec3(0, 0, -1) + Vec3(0, 0, 0.01 * chance(0));
      const Vec3 d = i % 3 ? 0.03 * Vec3(chance(4), chance(5), chance(6)) : Vec3(0.03 * chance(4), 0, 0);
      const std::optional<RayHit> all = cursor.first_hit(x, d, 0, 1);
      std::array<uint32_t, 24> cells;
      size_t count = 0;
      if (!near.collect(x, x + d, cells, count)) continue;
      const std::optional<RayHit> some = cursor.first_hit_among({cells.data(), count}, x, d, 0, 1);
      CHECK(near.may_meet(x, x + d) == (count > 0));
      REQUIRE(all.has_value() == some.has_value());
      if (!all) ++free;
      if (!all) continue;
      ++hits;
      REQUIRE((all->cell == some->cell && all->t == some->t && all->normal == some->normal));
    }
    CHECK(hits > 1000);
    CHECK(free > 1000);
  }
}

TEST_CASE("near cells: a mesh whose points all coincide") {
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<double>{5, 5, 5, 5, 5, 5, 5, 5, 5}, 3);
  mesh.polygons.fixed = 3;
  mesh.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2});
  const swarm::NearCells near(make_dataset(mesh), 0);
  CHECK(near.may_meet({4, 5, 5}, {6, 5, 5}));
}
