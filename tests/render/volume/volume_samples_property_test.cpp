// SPDX-License-Identifier: Apache-2.0
// Random volumes whose pixels are made of samples: the largest, the smallest and the mean value of a ray, and fixed steps.
#include <fmt/core.h>

#include "volume_property.h"

using namespace sg;
using namespace sg::test;

// One value a ray: its colour is that of the true value, or of one as near as f32 tells.
TEST_CASE("property: volumes show the largest, the smallest and the mean value of a ray") {
  for (uint64_t seed : property_seeds(60)) {
    CAPTURE(seed);
    Random r(seed);
    RandomVolume v = random_volume(r, kinds, r.magnitude(1e-3, 1e3));
    random_transfer(r, kinds, v.lo, v.hi, v.cell, v);
    v.item.mode = r.one_of({RayFunction::maximum, RayFunction::minimum, RayFunction::average});
    const Shot shot = random_view(r, v.box, 8);
    const Projection& view = shot.view;
    const Scene scene = scene_of({v.item});
    const Frame frame = draw(scene, view, {}, r.chance(0.3) ? by_single_rays(view) : FragmentLists());
    Worst worst;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Projection::Ray ray = view.ray(x + 0.5, y + 0.5);
        const TrueVolume along = v.along(ray.origin, ray.direction);
        std::vector<double> ends = along.ends;
        const double near = view.near_plane * ray.per_depth;
        ends.push_back(near);
        std::sort(ends.begin(), ends.end());
        double most = -HUGE_VAL, least = HUGE_VAL, sum = 0, length = 0;
        for (size_t i = 0; i + 1 < ends.size(); ++i) {
          if (ends[i] < near) continue;
          constexpr int n = 100;
          const double h = (ends[i + 1] - ends[i]) / n;
          if (!(h > 0)) continue;
          // Beside the volume, a hair of it is still within the reach of rounding.
          if (const double f = along.value(0.5 * (ends[i] + ends[i + 1])); f != f) continue;
          for (int k = 0; k <= n; ++k) {
            const double f = along.value(ends[i] + std::clamp(k / double(n), 1e-9, 1 - 1e-9) * (ends[i + 1] - ends[i]));
            if (f != f) continue;
            const double weight = h * (k == 0 || k == n ? 0.5 : 1);
            most = std::max(most, f), least = std::min(least, f), sum += f * weight, length += weight;
          }
        }
        const float* p = &frame.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))];
        if (!(length > 1e-9 * v.box.diagonal())) continue;
        const double value = v.item.mode == RayFunction::maximum ? most : v.item.mode == RayFunction::minimum ? least : sum / length;
        // Beside a knot the medium may be another one.
        const std::vector<double> knots = v.transfer.knots();
        if (std::any_of(knots.begin(), knots.end(), [&](double k) { return std::abs(k - value) < 1e-3 * (v.hi - v.lo); })) continue;
        // A smooth maximum lies a little above the largest of some samples.
        std::array<double, 4> best{};
        double nearest = HUGE_VAL;
        for (const double off : {0.0, 1e-4, -1e-4, 3e-5, -3e-5, 4e-4, -4e-4}) {
          const double u = std::clamp(value + off * (v.hi - v.lo), v.lo, v.hi);
          std::array<double, 4> c{};
          if (v.transfer.opacity_on(u, u) > 0) {
            const Vec3 color = v.transfer.color_on(u, u);
            c = {color.x, color.y, color.z, 1};
          }
          double e = 0;
          for (size_t k = 0; k < 4; ++k) e = std::max(e, std::abs(c[k] - double(p[k])));
          if (!(e >= nearest)) nearest = e, best = c;
        }
        worst.add(x, y, best, p, 0.01);
      }
    check(worst, v.words + shot.words + " " + std::string(word_of(v.item.mode)), 0.01);
  }
}

// Fixed steps are sums over samples in the middle of steps that are counted from where the ray enters; the last has what length is left.
// A fragment begins a new step, so that single rays (which have one before the volume) are not tried from inside.
TEST_CASE("property: volumes in fixed steps are the sum over the middles of the steps") {
  for (uint64_t seed : property_seeds(80)) {
    CAPTURE(seed);
    Random r(seed);
    RandomVolume v = random_lattice(r, kinds, r.chance(0.3), r.magnitude(1e-3, 1e3));
    Kinds smooth = kinds;
    smooth.color_steps = false;  // samples read a table
    random_transfer(r, smooth, v.lo, v.hi, v.cell, v, true);
    v.item.shaded = false;
    const double h = v.item.sampling.step = v.cell * r.magnitude(0.1, 2);
    const Shot shot = random_view(r, v.box, 8);
    const Projection& view = shot.view;
    const Scene scene = scene_of({v.item});
    const bool single = r.chance(0.3) && shot.words != "inside" && shot.words != "grazing";
    const Frame frame = draw(scene, view, {}, single ? by_single_rays(view) : FragmentLists());
    Worst worst;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Projection::Ray ray = view.ray(x + 0.5, y + 0.5);
        const TrueVolume along = v.along(ray.origin, ray.direction);
        std::vector<double> ends = along.ends;
        const double near = view.near_plane * ray.per_depth;
        std::sort(ends.begin(), ends.end());
        // Only inside: planes of samples are crossed beyond the box, too.
        double enter = HUGE_VAL, leave = -HUGE_VAL;
        for (size_t i = 0; i + 1 < ends.size(); ++i)
          if (const double f = along.value(0.5 * (ends[i] + ends[i + 1])); f == f && ends[i + 1] - ends[i] > 1e-9 * v.cell)
            enter = std::min(enter, ends[i]), leave = std::max(leave, ends[i + 1]);
        enter = std::max(enter, near);
        Vec3 color{0, 0, 0};
        double pass = 1;
        bool unsure = false;  // samples read a table of 4096 nodes: beside the end of a scale that is not drawn beyond they may be either
        for (double t = enter; t < leave && pass > 1e-7; t += h) {
          const double end = std::min(leave, t + h), f = along.value(0.5 * (t + end));
          if (f != f) continue;
          const double beside = std::min(std::abs(f - v.transfer.lo), std::abs(f - v.transfer.hi));
          unsure = unsure || (!v.transfer.clamp && beside < (v.hi - v.lo) / 4096);
          const double opacity = v.transfer.opacity_on(f, f);
          if (!(opacity > 0)) continue;
          const double alpha = -std::expm1(std::log1p(-opacity) * (end - t) / v.transfer.unit);
          color += v.transfer.color_on(f, f) * (pass * alpha), pass *= 1 - alpha;
        }
        if (unsure) continue;
        worst.add(x, y, {color.x, color.y, color.z, 1 - pass}, &frame.rgba[4 * (size_t(y) * size_t(view.width) + size_t(x))], 0.004);
      }
    check(worst, fmt::format("{}{} step {:.3g} of a cell", v.words, shot.words, h / v.cell), 0.004);
  }
}
