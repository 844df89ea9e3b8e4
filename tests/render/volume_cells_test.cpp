// SPDX-License-Identifier: Apache-2.0
// Rays through cells of every kind, by what is known of cubes.
#include "support/test.h"
#include "volume_cells_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double linear(Vec3 p) { return 1 + p.x + 2 * p.y + 3 * p.z; }
double curved(Vec3 p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + p.z * p.z; }

/// A name for messages.
std::string name_of(CellType t) { return std::string(cell_type_info(t).name); }

}  // namespace

TEST_CASE("volume cells: stretches of every kind of cell add up to the chord, and a linear field to its exact integral") {
  for (const Warp& warp : {Warp(straight), Warp(bent)})
    for (CellType kind : linear_kinds()) {
      if (kind == CellType::voxel && warp({.5, .5, .3}).x != .5) continue;
      CAPTURE(name_of(kind));
      const VolumeItem item = item_of(with_field(cube(kind, 3, warp), linear));
      Context context;
      const auto source = volume::cell_source(item, context);
      const auto walker = source->walker();
      for (const TestRay& ray : some_rays(100)) {
        const auto [a, b] = chord(ray.o, ray.d);
        const RaySum r = gather(*source, *walker, ray.o, ray.d);
        CHECK(r.length == doctest::Approx(b - a).epsilon(1e-9));
        CHECK(r.gap < 1e-9);
        CHECK(r.integral == doctest::Approx((b - a) * linear(ray.o + ray.d * (0.5 * (a + b)))).epsilon(3e-6));
      }
    }
}
