// SPDX-License-Identifier: Apache-2.0
// Moved copies of a surface share its tree and are met where they lie.
#include <cmath>

#include "filter/mesh/transform/transform.h"
#include "render/raster/raster_support.h"
#include "trace_scene.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;

namespace {

Affine some_place(uint64_t i) {
  Affine a{turn_about({uniform(1, i, -1, 1), uniform(2, i, -1, 1), uniform(3, i, -1, 1)}, uniform(4, i, 0, 360)),
           {uniform(5, i, -8, 8), uniform(6, i, -8, 8), uniform(7, i, -8, 8)}};
  const double stretch = uniform(8, i, 0.3, 2);
  for (auto& row : a.linear.m) row[0] *= stretch, row[1] *= 1.3;
  return a;
}

// Copies of a torus, as copies or each with a tree of its own.
Scene copies(size_t n, bool shared, const DatasetPtr& original) {
  Scene scene;
  Context context;
  for (size_t i = 0; i < n; ++i) {
    const Affine a = some_place(i);
    TransformParams p;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c) p.matrix.push_back(r == 3 ? double(c == 3) : c == 3 ? a.shift[r] : a.linear.m[r][c]);
    SurfaceItem item = std::get<SurfaceItem>(Item(sg::test::item(transform(original, p, context))));
    if (shared) item.copy_of = std::make_shared<SurfaceCopy>(SurfaceCopy{original, a});
    scene.items.emplace_back(std::move(item));
  }
  return scene;
}

}  // namespace

TEST_CASE("trace copies: rays meet the same triangles at the same places as those of surfaces with their own trees") {
  const DatasetPtr torus = sg::test::torus(40, 24, false, {5, 0, 0});
  for (const size_t n : {size_t(3), size_t(40)}) {  // objects one by one, and by a tree of their boxes
    CAPTURE(n);
    const Geometry shared = geometry_of(copies(n, true, torus)), own = geometry_of(copies(n, false, torus));
    CHECK(shared.bytes() < own.bytes() / 10 + 1);
    size_t met = 0, other = 0;
    for (uint64_t i = 0; i < 4000; ++i) {
      const Vec3f from = any_place(11, i, 1.5f);
      const Vec3f d = normalize(any_place(12, i, 0.7f) - from);
      const Ray a{from, d}, b{own.placement().traced(shared.placement().world(from)), d};
      Hit ha, hb;
      const bool ma = shared.nearest(a, ha), mb = own.nearest(b, hb);
      if (ma != mb || (ma && (ha.object != hb.object || ha.primitive != hb.primitive))) {
        ++other;  // by a hair beside an edge
        continue;
      }
      CHECK(shared.blocked(a) == ma);
      if (!ma) continue;
      ++met;
      const SurfacePoint pa = shared.at(a, ha), pb = own.at(b, hb);
      const Vec3 wa = shared.placement().world(pa.position), wb = own.placement().world(pb.position);
      CHECK(length(wa - wb) < 2e-4);
      CHECK(length(pa.face_normal - pb.face_normal) < 1e-3f);
      CHECK(length(pa.shading_normal - pb.shading_normal) < 2e-2f);
      // What leaves the surface does not meet the triangle that it leaves.
      Hit again;
      const Vec3f out = dot(pa.face_normal, d) > 0 ? -pa.face_normal : pa.face_normal;
      if (shared.nearest({leave(pa, out), out}, again)) CHECK_FALSE((again.object == ha.object && again.primitive == ha.primitive));
    }
    CHECK(met > 100);
    CHECK(other < 40);
  }
}

TEST_CASE("trace copies: mirrored ones, and ones whose polygons are others, have trees of their own") {
  const DatasetPtr torus = sg::test::torus(20, 12, false);
  Scene scene = copies(1, true, torus);
  auto& item = std::get<SurfaceItem>(scene.items[0]);
  item.copy_of = std::make_shared<SurfaceCopy>(SurfaceCopy{sg::test::torus(30, 12, false), Affine()});
  CHECK(geometry_of(scene).bytes() > 0);
  item.copy_of = std::make_shared<SurfaceCopy>(SurfaceCopy{torus, {{{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {}}});
  CHECK(geometry_of(scene).bytes() > 0);
}

TEST_CASE("trace: among many objects a packet of rays finds what each ray finds alone") {
  const Geometry g = geometry_of(copies(20, true, sg::test::sphere(12, 1)));
  Ray rays[16];
  Hit at_once[16];
  for (int k = 0; k < 16; ++k) rays[k] = {{-1.4f, 0.1f * float(k) - 0.8f, 0}, {1, 0, 0}};
  const uint64_t bits = g.nearest(rays, 16, at_once);
  for (int k = 0; k < 16; ++k) {
    Hit one;
    const bool met = g.nearest(rays[k], one);
    CHECK(met == bool(bits >> k & 1));
    if (met) CHECK((one.t == at_once[k].t && one.object == at_once[k].object && one.primitive == at_once[k].primitive));
  }
}
