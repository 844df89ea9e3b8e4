// SPDX-License-Identifier: Apache-2.0
// Translucent surfaces: fragments in order, and what comes of them.
#include "raster_support.h"

using namespace sg;
using namespace sg::test;

namespace {

SurfaceItem glass(DatasetPtr data, Vec3f color, double opacity) {
  SurfaceItem s = item(std::move(data), color, false);
  s.opacity = opacity;
  return s;
}

void check_order(const Picture& p) {
  if (p.fragments.empty()) return;
  REQUIRE(p.fragments.start.size() == p.frame.pixels() + 1);
  size_t wrong = 0;
  for (size_t i = 0; i < p.frame.pixels(); ++i)
    for (uint32_t k = p.fragments.start[i]; k < p.fragments.start[i + 1]; ++k) {
      const Fragment& f = p.fragments.fragments[k];
      wrong += !(f.depth < p.frame.depth[i] * 1.0001f);
      if (k == p.fragments.start[i]) continue;
      const Fragment& before = p.fragments.fragments[k - 1];
      wrong += before.depth > f.depth || (before.depth == f.depth && before.id > f.id);
    }
  CHECK(wrong == 0);
}

}  // namespace

TEST_CASE("raster: translucent layers drawn in any order give the analytic over") {
  // red at z=2 (nearest), green at z=1, blue at z=0 in front of a grey wall at z=-1
  const double a[3] = {0.3, 0.5, 0.8};
  const Vec3f colors[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const float wall = 0.25f;
  int order[3] = {0, 1, 2};
  do {
    Scene s;
    s.background = {0, 0, 0};
    s.items.push_back(item(quad(3, -1), {srgb_encode(wall), srgb_encode(wall), srgb_encode(wall)}, false));
    for (int k : order) s.items.push_back(glass(quad(1, float(2 - k)), colors[k], a[k]));
    const Picture p = draw(s, front_parallel(4), 64, 64);
    check_order(p);
    REQUIRE(p.fragments.start[32 * 64 + 33] - p.fragments.start[32 * 64 + 32] == 3);
    Context context;
    const Frame f = render(s, front_parallel(4), {64, 64, 1}, context);
    const float* q = &f.rgba[4 * (32 * 64 + 32)];
    double rest = 1;
    for (int k = 0; k < 3; ++k) {
      CHECK(q[k] == doctest::Approx(rest * a[k] + (1 - a[0]) * (1 - a[1]) * (1 - a[2]) * double(wall)).epsilon(1e-5));
      rest *= 1 - a[k];
    }
    CHECK(q[3] == doctest::Approx(1));
  } while (std::next_permutation(order, order + 3));
}

TEST_CASE("raster: translucent triangles that pass through each other are sorted per pixel") {
  Scene s;
  s.items = {glass(surface({-1, -1, -1, 1, -1, 1, 1, 1, 1, -1, 1, -1}, {0, 1, 2, 0, 2, 3}), {1, 0, 0}, 0.5),
             glass(surface({-1, -1, 1, 1, -1, -1, 1, 1, -1, -1, 1, 1}, {0, 1, 2, 0, 2, 3}), {0, 1, 0}, 0.5)};
  const Picture p = draw(s, front_parallel(2), 64, 64);
  check_order(p);
  CHECK(p.fragments.fragments.size() == 2 * 64 * 64);
  CHECK(p.fragments.fragments[p.fragments.start[32 * 64 + 10]].id == 2);  // left: green is nearer
  CHECK(p.fragments.fragments[p.fragments.start[32 * 64 + 50]].id == 1);
}

TEST_CASE("raster: translucent fragments behind opaque surfaces are dropped, inside a mesh every pixel has one per layer") {
  Scene s;
  s.items = {glass(quad(1, -1), {1, 0, 0}, 0.5), item(quad(1, 0)), glass(quad(1, 1), {0, 1, 0}, 0.5)};
  const Picture p = draw(s, front_parallel(2), 64, 64);
  CHECK(p.fragments.fragments.size() == 64 * 64);
  for (const Fragment& f : p.fragments.fragments) CHECK(f.id == 3);
  // A closed torus: an even number of layers wherever it is seen.
  s.items = {glass(torus(90, 50), {1, 1, 1}, 0.4)};
  const Picture q = draw(s, fit_camera(scene_bounds(s), {1, 2, 3}, {0, 0, 1}, 1.5), 300, 200);
  check_order(q);
  CHECK(q.covered() == 0);
  size_t odd = 0, layers = 0;
  for (size_t i = 0; i < q.frame.pixels(); ++i) {
    const uint32_t n = q.fragments.start[i + 1] - q.fragments.start[i];
    odd += n % 2, layers += n;
  }
  CHECK(odd == 0);
  CHECK(layers > 20000);
}

TEST_CASE("raster: alpha of direct colours makes fragments; opacity 0 draws nothing") {
  FieldSet f;
  f.add({"rgba", Association::point, Array::from_vector<float>({1, 0, 0, 0.25f, 1, 0, 0, 0.25f, 1, 0, 0, 0.25f, 1, 0, 0, 0.25f}, 4), "",
         Role::colors});
  Scene s;
  SurfaceItem q = item(quad(1, 0, f), {}, false);
  q.color_by = FieldColor{}, q.color_by->field = "rgba", q.color_by->direct = true, q.opacity = 0.5;
  s.items = {q};
  const Picture p = draw(s, front_parallel(2), 16, 16);
  REQUIRE(p.fragments.fragments.size() == 256);
  CHECK(p.fragments.fragments[100].rgba[3] == doctest::Approx(0.125));
  CHECK(p.fragments.fragments[100].rgba[0] == doctest::Approx(0.125));  // premultiplied
  q.opacity = 0, s.items = {q};
  CHECK(draw(s, front_parallel(2), 16, 16).fragments.empty());
}
