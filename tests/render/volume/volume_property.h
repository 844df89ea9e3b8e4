// SPDX-License-Identifier: Apache-2.0
// What the property tests of volumes share: views drawn at random, and the comparison with the tests' own integral.
#pragma once
#include <fmt/core.h>

#include "render/volume/sources/cells/volume_random_cells.h"
#include "volume_random.h"

namespace sg::test {

/// What is not right yet stays out: turn on what is mended.
inline constexpr Kinds kinds{.steps = true, .color_steps = true, .any_scale = true, .opaque = true, .refined = true};

struct Shot {
  Projection view;
  std::string words;
};

/// A look at a box, or from inside of it.
inline Shot random_view(Random& r, const Box3& box, int pixels) {
  const Vec3 middle = box.lo + box.size() * 0.5;
  const double size = box.diagonal();
  const Vec3 target = middle + box.size() * Vec3{r.in(-0.2, 0.2), r.in(-0.2, 0.2), r.in(-0.2, 0.2)};
  Vec3 forward = normalize(Vec3{r.in(-1, 1), r.in(-1, 1), r.in(-1, 1) + 1e-3}), up{0.1, 1, 0.05};
  const int kind = r.whole(0, 4);
  if (kind == 1 || (kind == 0 && r.chance(0.3))) {
    forward = {0, 0, 0}, forward[r.whole(0, 2)] = r.chance(0.5) ? 1 : -1;
    up = forward.y != 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  }
  Shot s;
  if (kind <= 1) {
    s.view = parallel_view(pixels, pixels, pixels / (size * r.in(0.3, 0.9)), forward, up, target);
    s.view.eye = target - forward * (2 * size), s.view.far_plane = 10 * size;
    s.words = kind == 1 ? "parallel along an axis" : "parallel";
  } else {
    // Grazing: along a face, from a little above or below it.
    Vec3 eye = target - forward * (size * r.in(0.8, 3)), to = target;
    s.words = "perspective";
    if (kind == 3)
      eye = middle + box.size() * Vec3{r.in(-0.4, 0.4), r.in(-0.4, 0.4), r.in(-0.4, 0.4)}, to = eye + forward, s.words = "inside";
    if (kind == 4) {
      const int a = r.whole(0, 2);
      const double face = r.chance(0.5) ? box.lo[a] : box.hi[a];
      eye[a] = face + r.in(-0.02, 0.02) * size, to[a] = face + r.in(-0.02, 0.02) * size, s.words = "grazing";
    }
    if (length(to - eye) < 1e-3 * size) to = eye + forward;
    s.view = perspective_view(pixels, pixels, pixels * r.in(0.8, 2.5), eye, to, up);
    s.view.near_plane = 1e-5 * size, s.view.far_plane = 20 * size;
  }
  return s;
}

inline TrueLight light_of(const RandomVolume& v, const Projection& view, const Scene& scene) {
  const VolumeLight& l = v.item.light;
  TrueLight out{l.ambient, l.diffuse, l.specular, l.power, {}, v.hi > v.lo ? 0.002 * (v.hi - v.lo) / v.edge : 1 / v.edge};
  for (const Light& lamp : lights_of(scene)) {
    const Vec3 d =
        lamp.follows_camera ? view.right * lamp.direction.x + view.up * lamp.direction.y - view.forward * lamp.direction.z : lamp.direction;
    out.lamps.push_back({normalize(d), double(lamp.intensity)});
  }
  return out;
}

/// Of all pixels, beyond what is allowed.
struct Worst {
  double error = 0;
  int x = 0, y = 0;
  uint64_t compared = 0, over = 0, beside = 0;  ///< pixels; `beside`: not over only because of what is true just beside
  std::array<double, 4> truth{}, seen{};
  void add(int px, int py, const std::array<double, 4>& t, const float* p, double allowed) {
    double e = 0;
    for (size_t k = 0; k < 4; ++k) {
      const double d = std::abs(t[k] - double(p[k]));
      e = d <= e ? e : d;  // NaN counts
    }
    ++compared, over += !(e <= allowed);
    if (!(e <= error)) error = e, x = px, y = py, truth = t, seen = {double(p[0]), double(p[1]), double(p[2]), double(p[3])};
  }
  void add(const Worst& other) {
    compared += other.compared, over += other.over, beside += other.beside;
    if (!(other.error <= error)) error = other.error, x = other.x, y = other.y, truth = other.truth, seen = other.seen;
  }
};

/// Composited within the tolerance: at most so far from the truth.
inline Worst compare(const std::vector<RandomVolume>& volumes, const Scene& scene, const Projection& view, bool single, double allowed,
                     int every) {
  const Frame frame = draw(scene, view, {}, single ? by_single_rays(view) : FragmentLists());
  std::vector<TrueLight> lights;
  for (const RandomVolume& v : volumes) lights.push_back(light_of(v, view, scene));
  // With all values so much higher, and surfaces turned so far away.
  const auto truth = [&](const Projection::Ray& ray, double higher, double away) {
    // From the middle of the picture's volumes on, so that lengths keep their digits.
    double from = HUGE_VAL, to = -HUGE_VAL;
    std::vector<TrueVolume> along;
    for (size_t i = 0; i < volumes.size(); ++i) {
      TrueVolume v = volumes[i].along(ray.origin, ray.direction);
      v.transfer = &volumes[i].transfer, v.knots = volumes[i].transfer.knots();
      if (volumes[i].item.shaded) v.light = &lights[i], lights[i].edge_on = away;
      if (higher != 0) v.value = [value = v.value, off = higher * (volumes[i].hi - volumes[i].lo)](double t) { return value(t) + off; };
      for (double t : v.ends) from = std::min(from, t), to = std::max(to, t);
      along.push_back(std::move(v));
    }
    const double near = view.near_plane * ray.per_depth;
    TrueSum sum;
    if (std::max(from, near) < to) sum = TrueRay(std::move(along), ray.direction, 64).integrate(std::max(from, near), to);
    return std::array<double, 4>{sum.color.x, sum.color.y, sum.color.z, 1 - sum.pass};
  };
  Worst worst;
  for (int y = 0; y < view.height; ++y)
    for (int x = y % every; x < view.width; x += every) {
      const Projection::Ray ray = view.ray(x + 0.5, y + 0.5);
      const float* seen = &frame.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
      Worst here;
      here.add(x, y, truth(ray, 0, 0), seen, allowed);
      // A value that just meets a step, or just does not, as near as floats tell; and a surface that is seen from exactly beside it.
      using Beside = std::pair<double, double>;
      for (const auto& [higher, away] : {Beside{-0x1p-22, 0}, {0x1p-22, 0}, {0, -0x1p-20}, {0, 0x1p-20}}) {
        if (here.over == 0) break;
        Worst beside;
        beside.add(x, y, truth(ray, higher, away), seen, allowed);
        if (beside.over == 0) here = beside, here.beside = 1;
      }
      worst.add(here);
    }
  return worst;
}

inline void check(const Worst& worst, const std::string& words, double allowed) {
  INFO(words << ": " << worst.over << " pixels over, the worst " << worst.x << " " << worst.y << ": seen " << worst.seen[0] << " "
             << worst.seen[1] << " " << worst.seen[2] << " " << worst.seen[3] << ", true " << worst.truth[0] << " " << worst.truth[1] << " "
             << worst.truth[2] << " " << worst.truth[3]);
  count_pixels(worst.compared, worst.over, worst.beside);
  CHECK(worst.error <= allowed);
}

inline RandomVolume random_volume(Random& r, const Kinds& kinds, double size) {
  const int mesh = kinds.lattices ? r.whole(0, 9) : r.whole(4, 9);
  if (mesh >= 8) return random_linear(r, kinds);
  if (mesh == 7) return random_bricks(r, kinds, size, r.chance(0.5));
  if (mesh == 6 || !kinds.lattices) return random_tets(r, kinds, size);
  return random_lattice(r, kinds, r.chance(0.3), size);
}

}  // namespace sg::test
