// SPDX-License-Identifier: Apache-2.0
// Frames of smoke: unlit, and with the light of one lamp that is scattered once, by a map of its shadow.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "bench.h"
#include "render/render.h"

namespace sg::bench {

namespace {

/// Puffs that wind upwards and grow on their way, in a box of 1 x 1 x 1; the air around them is clear.
DatasetPtr smoke(size_t n) {
  constexpr int puffs = 400;
  struct Puff {
    Vec3 middle;
    double radius, density;
  };
  std::vector<Puff> all;
  for (uint64_t i = 0; i < puffs; ++i) {
    const double way = (double(i) + 0.5) / puffs, r = 0.02 + 0.09 * way, turn = 21 * way;
    const auto anywhere = [&](uint64_t k) { return 2 * random_unit(31, 4 * i + k) - 1; };
    const double reach = 0.04 + 0.24 * way;
    all.push_back({{0.5 + 0.12 * way * std::cos(turn) + reach * anywhere(0), 0.5 + 0.12 * way * std::sin(turn) + reach * anywhere(1),
                    0.08 + 0.8 * way + 0.05 * anywhere(2)},
                   r * (0.6 + 0.6 * random_unit(31, 4 * i + 3)),
                   1 - 0.6 * way});
  }
  float* f = nullptr;
  Array values = Array::make<float>(n * n * n, 1, &f);
  const double h = 1 / double(n - 1);
  parallel_for(n, 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      float* const slice = f + n * n * k;
      std::fill(slice, slice + n * n, 0.0f);
      for (const Puff& p : all) {
        const double z = double(k) * h - p.middle.z, across = p.radius * p.radius - z * z;
        if (across <= 0) continue;
        const auto first = [&](double middle) { return size_t(std::max(0.0, std::ceil((middle - std::sqrt(across)) / h))); };
        const auto last = [&](double middle) { return size_t(std::clamp((middle + std::sqrt(across)) / h + 1, 0.0, double(n))); };
        for (size_t j = first(p.middle.y); j < last(p.middle.y); ++j)
          for (size_t i = first(p.middle.x); i < last(p.middle.x); ++i) {
            const double x = double(i) * h - p.middle.x, y = double(j) * h - p.middle.y;
            const double inside = std::max(0.0, across - x * x - y * y) / (p.radius * p.radius);
            slice[i + n * j] += float(p.density * inside * inside);
          }
      }
    }
  });
  UniformGrid g;
  g.dims = {n, n, n}, g.spacing = Vec3(h, h, h);
  FieldSet fields;
  fields.add({"density", Association::point, values, "", Role::scalars});
  return make_dataset(g, fields);
}

enum class Lit { no, once, anew };

// The camera turns by two degrees a frame; with `anew` the lamp does, too, so that each frame makes its map.
Task frame(Lit lit) {
  const char* peer = lit == Lit::no ? "sightglass:unlit" : lit == Lit::once ? "sightglass:light=map" : "sightglass:light=map,lamp moves";
  return {"light_map", "smoke 256^3, 1280x720", peer, "pixels", [=] {
            VolumeItem item;
            item.data = smoke(256);
            item.field = "density";
            item.color.map = find_colormap("gray"), item.color.lo = 0, item.color.hi = 1;
            item.opacity.points = {{0, 0}, {0.05, 0}, {1, 0.12}};
            item.unit_distance = 0.01, item.shaded = false;
            if (lit != Lit::no) item.scattering.light = VolumeLighting::map;
            auto scene = std::make_shared<Scene>();
            scene->items.emplace_back(std::move(item));
            auto turn = std::make_shared<double>(0);
            return [=] {
              Context context;
              *turn += 2;
              const double lamp = lit == Lit::anew ? *turn * 3.14159265358979323846 / 180 : 0.7;
              scene->lights = {{{std::cos(lamp), std::sin(lamp), 0.8}, false, 1}};
              Camera c;
              const double a = *turn * 3.14159265358979323846 / 180;
              c.target = {0.5, 0.5, 0.5}, c.up = {0, 0, 1}, c.view_angle = 30;
              c.position = c.target + Vec3(2.2 * std::sin(a), -2.2 * std::cos(a), 0.4);
              Box3 box;
              box.add({0, 0, 0}), box.add({1, 1, 1});
              fit_planes(c, box);
              RenderOptions o;
              o.width = 1280, o.height = 720, o.samples = 1;
              return double(render(*scene, c, o, context).pixels());
            };
          }};
}

}  // namespace

void add_light_map_tasks(std::vector<Task>& tasks) {
  for (const Lit lit : {Lit::no, Lit::once, Lit::anew}) tasks.push_back(frame(lit));
}

}  // namespace sg::bench
