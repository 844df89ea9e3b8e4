// SPDX-License-Identifier: Apache-2.0
// Leaps over empty space: how long they may be for rays of each octant, and that they leave nothing out.
#include "render/volume/sources/lattice/space/space_ahead.h"

#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("space ahead: the largest empty cube from each brick on, in every octant") {
  const std::array<size_t, 3> n{37, 19, 23};
  for (const double density : {0.0, 0.002, 0.05}) {
    volume::Distances drawn;
    drawn.resize(n[0] * n[1] * n[2] + 3);
    for (size_t i = 0; i < drawn.size(); ++i) drawn[i] = random_unit(5, i) < density ? 0 : 1;
    // Drawn bricks of the cube of a size from p on, from the sums over all bricks before each corner.
    const auto at = [&](size_t x, size_t y, size_t z) { return x + (n[0] + 1) * (y + (n[1] + 1) * z); };
    std::vector<int> sums((n[0] + 1) * (n[1] + 1) * (n[2] + 1));
    for (size_t z = 1; z <= n[2]; ++z)
      for (size_t y = 1; y <= n[1]; ++y)
        for (size_t x = 1; x <= n[0]; ++x)
          sums[at(x, y, z)] = (drawn[x - 1 + n[0] * (y - 1 + n[1] * (z - 1))] == 0) + sums[at(x - 1, y, z)] + sums[at(x, y - 1, z)] +
                              sums[at(x, y, z - 1)] - sums[at(x - 1, y - 1, z)] - sums[at(x - 1, y, z - 1)] - sums[at(x, y - 1, z - 1)] +
                              sums[at(x - 1, y - 1, z - 1)];
    const auto any_drawn = [&](const std::array<size_t, 3>& p, const std::array<bool, 3>& up, int size) {
      size_t lo[3], hi[3];
      for (size_t a = 0; a < 3; ++a) {
        lo[a] = up[a] ? p[a] : size_t(std::max(0, int(p[a]) + 1 - size));
        hi[a] = up[a] ? std::min(n[a], p[a] + size_t(size)) : p[a] + 1;
      }
      return sums[at(hi[0], hi[1], hi[2])] - sums[at(lo[0], hi[1], hi[2])] - sums[at(hi[0], lo[1], hi[2])] - sums[at(hi[0], hi[1], lo[2])] +
                 sums[at(lo[0], lo[1], hi[2])] + sums[at(lo[0], hi[1], lo[2])] + sums[at(hi[0], lo[1], lo[2])] -
                 sums[at(lo[0], lo[1], lo[2])] >
             0;
    };
    const volume::SpaceAhead ahead(drawn, n, volume::Ways::all());
    REQUIRE(ahead.octants == 8);
    for (const bool up_x : {false, true})
      for (const bool up_y : {false, true})
        for (const bool up_z : {false, true}) {
          const std::array<bool, 3> up{up_x, up_y, up_z};
          size_t begin = 0, wrong = 0, longest = 0;
          volume::Ways one{};
          for (size_t a = 0; a < 3; ++a) begin += up[a] ? size_t(ahead.up[a]) : 0, one.up[a] = up[a], one.down[a] = !up[a];
          for (size_t z = 0; z < n[2]; ++z)
            for (size_t y = 0; y < n[1]; ++y)
              for (size_t x = 0; x < n[0]; ++x) {
                int size = 0;
                while (size < 15 && !any_drawn({x, y, z}, up, size + 1)) ++size;
                wrong += ahead.bricks[begin + x + n[0] * (y + n[1] * z)] != size, longest = std::max(longest, size_t(size));
              }
          CHECK(wrong == 0);
          CHECK(longest > 3);
          // Asked for alone it is the same.
          const volume::SpaceAhead alone(drawn, n, one);
          CHECK(alone.octants == 1);
          CHECK(std::equal(alone.bricks.begin(), alone.bricks.end() - 3, ahead.bricks.begin() + ptrdiff_t(begin)));
        }
    drawn.pop_back();
    CHECK_THROWS_AS(volume::SpaceAhead(drawn, n, volume::Ways::all()), Error);
  }
}

TEST_CASE("space ahead: every ray of a picture goes one of its ways") {
  const Mat3 turned = Mat3{{{0.8, 0.6, 0}, {-0.6, 0.8, 0}, {0, 0, 3}}};
  size_t fewer = 0;
  for (const Mat3& to_q : {Mat3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, turned})
    for (const Vec3 eye : {Vec3{0, 0, 3}, Vec3{2, 2, 2}, Vec3{-3, 0.1, 0}, Vec3{1, -2, 4}})
      for (const double scale : {80.0, 12.0})
        for (const bool parallel : {false, true}) {
          Projection p = perspective_view(31, 17, scale, eye, {0, 0, 0});
          p.parallel = parallel;
          for (const Projection& view : {p, window_of(p, 20, 3, 5, 4, 2)}) {
            const volume::Ways ways = volume::Ways::of(view, to_q);
            fewer += ways.octants() < 8;
            for (int y = 0; y < view.height; ++y)
              for (int x = 0; x < view.width; ++x) {
                const Vec3 along = to_q * view.ray(x + 0.5, y + 0.5).direction;
                for (int a = 0; a < 3; ++a) CHECK((along[a] > 0 ? ways.up[size_t(a)] : ways.down[size_t(a)]));
              }
          }
        }
  CHECK(fewer > 30);
  const volume::Ways diagonal =
      volume::Ways::of(perspective_view(31, 17, 80, {2, 2, 2}, {0, 0, 0}), Mat3{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  CHECK(diagonal.octants() == 1);
  CHECK(diagonal.down[0]);
}

TEST_CASE("space ahead: what is leapt over draws nothing, whatever way rays go") {
  const auto blobs = [](Vec3 p) {
    double sum = 0;
    for (const Vec3 at : {Vec3{-0.6, 0.5, 0.3}, Vec3{0.7, -0.7, -0.8}, Vec3{0.1, 0.2, 0.9}, Vec3{-0.9, -0.9, 0.8}})
      sum += std::exp(-60 * dot(p - at, p - at));
    return sum;
  };
  OpacityCurve curve;
  curve.points = {{0.2, 0}, {0.5, 0.8}};
  VolumeItem v = item(grid(cube(61, -1, 1), blobs), grey(0, 1), curve);
  v.unit_distance = 0.1;
  volume::Knobs all;
  all.skip_empty = false;
  for (const bool parallel : {false, true})
    for (const Vec3 eye :
         {Vec3{0, 0, 4}, Vec3{0, 0, -4}, Vec3{4, 0, 0}, Vec3{0, -4, 0}, Vec3{2, 3, 1}, Vec3{-2, 1, -3}, Vec3{0.2, 0.1, 0.3}})
      for (const double step : {0.0, 0.02}) {
        Projection view = perspective_view(41, 33, 40, eye, {0, 0, 0.01});
        if (parallel) view.parallel = true, view.scale = 14;
        v.sampling.step = step;
        const Scene scene = scene_of({v});
        const Frame with = draw(scene, view), without = draw(scene, view, all);
        INFO("eye " << eye.x << " " << eye.y << " " << eye.z << " parallel " << parallel << " step " << step);
        // Strides begin elsewhere after leaps, within the tolerance.
        CHECK(largest_difference(with, without) < (step > 0 ? 1e-6f : 1.0f / 512));
        if (length(eye) > 1) CHECK(*std::max_element(with.rgba.begin(), with.rgba.end()) > 0.1f);
      }
}

TEST_CASE("space ahead: long strides stop at places without a value") {
  const auto slow = [](Vec3 p) { return 0.5 + 0.1 * p.x + 0.05 * p.y; };
  OpacityCurve even;
  even.points = {{0, 0.3}, {1, 0.3}};
  const auto picture = [&](const std::function<double(Vec3)>& f, bool singly) {
    VolumeItem v = item(grid(cube(97, -1, 1), f), grey(0, 1), even);
    v.unit_distance = 0.5;
    const Projection view = perspective_view(48, 48, 40, {0.4, 0.7, 3.5}, {0, 0, 0});
    return singly ? draw(scene_of({v}), view, {}, by_single_rays(view)) : draw(scene_of({v}), view);
  };
  const auto holed = [&](Vec3 p) { return length(p) < 0.3 ? NAN : slow(p); };
  const Frame full = picture(slow, false), holes = picture(holed, false), exact = picture(holed, true);
  CHECK(largest_difference(full, holes) > 0.03f);
  CHECK(largest_difference(holes, exact) < 1.0f / 512);
}
