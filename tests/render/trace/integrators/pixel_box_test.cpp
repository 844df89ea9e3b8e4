// SPDX-License-Identifier: Apache-2.0
// The pixels in which something of a box may be seen, and their numbers.
#include <set>
#include <utility>

#include "base/random.h"
#include "render/trace/integrators/picture_camera.h"
#include "render/trace/tree/bvh.h"
#include "support/test.h"

using namespace sg;
using namespace sg::trace;

TEST_CASE("trace: no ray that meets a box starts outside of the pixels that it may be seen in") {
  const Placement placement = Placement::of({{-1, -1, -1}, {1, 1, 1}});
  const Box3f box{{-0.5f, -0.25f, -0.125f}, {0.25f, 0.5f, 0.375f}};
  size_t met = 0, beside = 0;
  for (uint64_t seed = 0; seed < 60; ++seed) {
    const auto unit = [&](uint64_t k) { return 2 * random_unit(seed, k) - 1; };
    Camera camera;
    const double away = 1 + 3 * random_unit(seed, 9);  // some are within the box, or beside it
    camera.position = normalize(Vec3{unit(0), unit(1), unit(2)}) * away, camera.target = Vec3{unit(3), unit(4), unit(5)} * 0.8;
    camera.up = {0, 0.1, 1}, camera.parallel = seed % 3 == 0, camera.near_plane = 0.01, camera.far_plane = 20;
    if (seed % 5 == 0) camera.position = {0, 0, 0.01};
    const PictureCamera eye(make_projection(camera, 61, 43), placement);
    const PixelBox seen = eye.pixels_of(box);
    for (int y = 0; y < 43; ++y)
      for (int x = 0; x < 61; ++x) {
        const BoxRay ray(eye.ray({float(x) + float(random_unit(seed, 100 + uint64_t(x))), float(y) + 0.5f}));
        if (ray.enter(&box.lo.x, &box.hi.x, 100) <= 100) ++met, beside += !seen.overlaps({x, y, 1, 1});
      }
  }
  CHECK(met > 5000);
  CHECK(beside == 0);
  CHECK(PictureCamera(make_projection(Camera(), 8, 8), placement).pixels_of(Box3f()).count() == 0);
}

TEST_CASE("trace: pixels of a box have each a number, and sixteen of a square are a square") {
  for (const PixelBox& box : {PixelBox{16, 24, 8, 8}, PixelBox{16, 24, 5, 8}, PixelBox{0, 0, 8, 3}}) {
    std::set<std::pair<int, int>> all;
    for (int p = 0; p < box.count(); ++p) {
      all.emplace(box.column(p), box.row(p));
      CHECK(box.overlaps({box.column(p), box.row(p), 1, 1}));
    }
    CHECK(int(all.size()) == box.count());
  }
  const PixelBox square{16, 24, 8, 8};
  for (int p = 0; p < 64; ++p) {
    CHECK(square.column(p) / 4 == square.column(p - p % 16) / 4);
    CHECK(square.row(p) / 4 == square.row(p - p % 16) / 4);
  }
}
