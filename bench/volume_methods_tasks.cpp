// SPDX-License-Identifier: Apache-2.0
// The classic ways to draw a volume beside the ray caster: time, memory and error on the same scenes (docs/volume_methods.md).
#include <cmath>

#include <fmt/core.h>

#include "bench.h"
#include "color/colormap.h"
#include "image/image.h"
#include "inputs.h"
#include "render/volume/methods/options.h"
#include "render/volume/volume.h"
#include "scene/scene.h"

namespace sg::bench {

namespace {

constexpr int side = 512;  // pixels

struct Look {
  const char* name;
  RayFunction mode;
  bool shaded, parallel;
};
constexpr Look looks[] = {{"soft", RayFunction::composite, false, true},
                          {"shells", RayFunction::composite, true, false},
                          {"maximum", RayFunction::maximum, false, true},
                          {"sum", RayFunction::sum, false, true}};

VolumeItem item_of(const Look& look, const DatasetPtr& data, size_t n) {
  VolumeItem item;
  item.data = data, item.field = "f", item.mode = look.mode, item.shaded = look.shaded;
  item.color.map = find_colormap("sight");
  item.color.lo = -3, item.color.hi = 4;
  item.opacity.points = {{-1, 0}, {1, .01}, {3, .08}};
  item.unit_distance = 2.0 / 255;
  if (look.shaded) item.opacity.points = {{-3, 0}, {-.9, 0}, {-.6, .15}, {-.3, 0}, {.2, 0}, {.5, .3}, {.8, 0}, {1.6, 0}, {2, .8}, {4, .8}};
  if (look.mode != RayFunction::composite) {
    // A straight scale: differences of the colour are differences of the value.
    item.opacity.points = {{0, 1}};
    item.color.map.colors.clear();
    for (int i = 0; i < 1024; ++i) {
      const float c = srgb_encode(float(i) / 1023);
      item.color.map.colors.push_back({c, c, c});
    }
    item.color.lo = -2, item.color.hi = 5;
  }
  item.sampling.step = 1.0 / double(n - 1);  // half a voxel
  return item;
}

Projection view_of(const Look& look, double turn) {
  Camera c;
  const double a = turn * 3.14159265358979323846 / 180;
  c.position = {2.2 * std::cos(a) + 3.6 * std::sin(a), 2.6, 3.6 * std::cos(a) - 2.2 * std::sin(a)};
  c.view_angle = 40, c.parallel = look.parallel, c.parallel_height = 3.4;
  Box3 box;
  box.add({-1, -1, -1}), box.add({1, 1, 1});
  fit_planes(c, box);
  return make_projection(c, side, side);
}

using Draw = std::function<volume::Layer(const volume::LayerInput&)>;

volume::Layer rays(const volume::LayerInput& in) {
  Scene scene;
  scene.items.emplace_back(in.item);
  Frame frame(in.projection.width, in.projection.height);
  composite_volumes(scene, in.projection, {}, frame, in.context);
  return {std::vector<float>(frame.rgba.begin(), frame.rgba.end())};
}

/// By the tolerance instead of the item's steps.
volume::Layer within_tolerance(const volume::LayerInput& in) {
  VolumeItem item = in.item;
  item.sampling.step = 0;
  return rays({item, in.projection, in.opaque, in.lights, in.context});
}

volume::Layer drawn(const Draw& draw, const VolumeItem& item, const Projection& p) {
  const Frame nothing(p.width, p.height);
  const std::vector<Light> lights = lights_of(Scene{});
  Context context;
  return draw({item, p, nothing, lights, context});
}

/// Millionths of full scale from rays with 40 steps per voxel (line integrals: slices as thin).
struct Error {
  double rms = 0, most = 0;
};
Error error_of(const Look& look, const Draw& draw, const VolumeItem& item, size_t n) {
  VolumeItem fine = item;
  fine.sampling.step = 0.05 / double(n - 1);
  const Projection p = view_of(look, 0);
  const volume::Layer a = drawn(draw, item, p);
  const volume::Layer b =
      drawn(look.mode == RayFunction::sum ? Draw([](const auto& in) { return volume::slices(in); }) : Draw(rays), fine, p);
  Error e;
  for (size_t i = 0; i < a.rgba.size(); ++i) {
    const double d = 1e6 * std::abs(double(a.rgba[i]) - double(b.rgba[i]));
    e.rms += d * d, e.most = std::max(e.most, d);
  }
  e.rms = std::sqrt(e.rms / double(a.rgba.size()));
  return e;
}

/// A frame after the camera turned by two degrees; or (first) of data that nothing is known of yet. The error is found off the clock.
Task method(const Look& look, size_t n, const char* name, const Draw& draw, double steps, bool first) {
  return {first ? "volume_methods_first" : "volume_methods", fmt::format("{} {}^3, {}x{}", look.name, n, side, side),
          fmt::format("sightglass:{}", name), first ? "largest error, millionths" : "RMS error, millionths", [=] {
            const DatasetPtr kept = field_grid(n);
            auto error = std::make_shared<double>(-1);
            auto turn = std::make_shared<double>(0);
            return [=] {
              VolumeItem item = item_of(look, first ? make_dataset(kept->parts()) : kept, n);
              item.sampling.step *= steps;
              if (*error < 0) {
                const Error e = error_of(look, draw, item, n);
                *error = first ? e.most : e.rms;
                return *error;
              }
              *turn += first ? 0 : 2;
              drawn(draw, item, view_of(look, *turn));
              return *error;
            };
          }};
}

}  // namespace

void add_volume_methods_tasks(std::vector<Task>& tasks) {
  using volume::LayerInput, volume::SliceOptions, volume::SplatOptions;
  const auto sliced = [](SliceOptions::Stack stack) {
    return [=](const LayerInput& in) { return volume::slices(in, SliceOptions{stack}); };
  };
  const auto splat = [](SplatOptions::Order order, SplatOptions::Classify c) {
    return [=](const LayerInput& in) { return volume::splat(in, SplatOptions{order, c}); };
  };
  const auto sheared = [](double resolution) {
    return [=](const LayerInput& in) { return volume::shear_warp(in, volume::ShearWarpOptions{resolution}); };
  };
  for (const size_t n : {128, 256})
    for (const Look& look : looks)
      for (const bool first : {false, true}) {
        const auto add = [&](const char* name, const Draw& draw, double steps = 1) {
          tasks.push_back(method(look, n, name, draw, steps, first));
        };
        const bool sum = look.mode == RayFunction::sum, composite = look.mode == RayFunction::composite;
        if (composite) add("ray(within 1/512)", within_tolerance);
        if (composite) add("ray(half-voxel steps)", rays);
        else add("ray(exact)", rays);
        add("slices(view)", sliced(SliceOptions::Stack::view));
        add("slices(axis)", sliced(SliceOptions::Stack::axis));
        // Sheets of a voxel.
        add("splat(sheets)", splat(SplatOptions::Order::sheets, SplatOptions::Classify::after), 2);
        if (composite) {
          add("splat(sheets, classified before)", splat(SplatOptions::Order::sheets, SplatOptions::Classify::before), 2);
          add("splat(whole)", splat(SplatOptions::Order::whole, SplatOptions::Classify::before), 2);
        }
        if (!sum) {
          add("shear_warp", sheared(1));
          add("shear_warp(twice as fine)", sheared(2));
        } else {
          add("fourier", [](const LayerInput& in) { return volume::fourier(in); });
        }
        // Five tetrahedra a voxel: those of 256^3 would take gigabytes.
        if (composite && n <= 128) add("cells", [](const LayerInput& in) { return volume::project_cells(in); });
      }
}

}  // namespace sg::bench
