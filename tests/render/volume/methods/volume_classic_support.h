// SPDX-License-Identifier: Apache-2.0
// One item drawn by a classic algorithm, and how far that is from the ray caster.
#pragma once
#include "base/error.h"
#include "render/volume/methods/options.h"
#include "render/volume/volume_support.h"

namespace sg::test {

using Method = std::function<volume::Layer(const volume::LayerInput&)>;

/// Lamps of these tests: distances between methods depend on how steep the light is.
inline std::vector<Light> classic_lights() { return {{{-0.35, 0.45, 1.0}, true, 0.85f}, {{0.9, 0.1, 0.5}, true, 0.22f}}; }

inline volume::Layer draw_layer(const VolumeItem& item, const Projection& p, const Method& method, const Frame* opaque = nullptr) {
  const Frame nothing(p.width, p.height);
  Context context;
  const std::vector<Light> lights = classic_lights();
  return method({item, p, opaque ? *opaque : nothing, lights, context});
}

inline Method splats(volume::SplatOptions::Order order = volume::SplatOptions::Order::sheets,
                     volume::SplatOptions::Classify classify = volume::SplatOptions::Classify::as_item) {
  return [=](const volume::LayerInput& in) { return volume::splat(in, {order, classify}); };
}
inline Method sliced(volume::SliceOptions::Stack stack = volume::SliceOptions::Stack::view, bool front_to_back = true) {
  return [=](const volume::LayerInput& in) { return volume::slices(in, {stack, front_to_back}); };
}
inline Method sheared(double resolution = 1) {
  return [=](const volume::LayerInput& in) { return volume::shear_warp(in, volume::ShearWarpOptions{resolution}); };
}

struct Distance {
  double rms = 0, most = 0;
};
/// Over all channels of all pixels, of full scale.
template <class A, class B>
Distance distance(const A& a, const B& b) {
  Distance d;
  for (size_t i = 0; i < a.size(); ++i) {
    const double e = std::abs(double(a[i]) - double(b[i]));
    d.rms += e * e, d.most = std::max(d.most, e);
  }
  d.rms = std::sqrt(d.rms / double(a.size()));
  return d;
}

/// The ray caster's picture of the same item with fine steps.
inline Frame ray_cast(VolumeItem item, const Projection& p, double step) {
  item.sampling.step = step;
  volume::Knobs knobs;
  knobs.stop_below = 0;
  Scene scene = scene_of({item});
  scene.lights = classic_lights();
  return draw(scene, p, knobs);
}
inline Distance from_rays(const VolumeItem& item, const Projection& p, const Method& method, double step) {
  return distance(draw_layer(item, p, method).rgba, ray_cast(item, p, step).rgba);
}

/// A smooth scene: five soft blobs, a transfer function without jumps.
inline VolumeItem smooth_item(size_t n = 49, bool shaded = false) {
  const auto blobs = [](Vec3 p) {
    double sum = 0;
    for (int i = 0; i < 5; ++i) {
      const Vec3 c{0.55 * std::sin(2.0 * i), 0.55 * std::cos(3.0 * i), 0.5 * std::sin(5.0 * i)};
      sum += std::exp(-9 * dot(p - c, p - c));
    }
    return sum;
  };
  OpacityCurve curve;
  curve.points = {{0.1, 0}, {0.5, 0.3}, {0.9, 0.15}, {1.3, 0.6}};
  VolumeItem v = item(grid(cube(n, -1, 1), blobs), grey(0, 1.2), curve);
  v.unit_distance = 0.2, v.shaded = shaded;
  return v;
}
inline std::vector<Projection> some_views(int size = 48) {
  return {parallel_view(size, size, size / 3.2, {0.3, -0.5, -1}), parallel_view(size, size, size / 3.2, {1, 0.4, 0.2}, {0, 0, 1}),
          perspective_view(size, size, size * 1.4, {2.0, 1.5, 3.4}, {0, 0, 0})};
}

/// An error of that kind whose text holds the word.
inline bool refused(const VolumeItem& item, const Projection& p, const Method& method, const std::string& word) {
  try {
    draw_layer(item, p, method);
  } catch (const Error& e) {
    if (e.kind() == ErrorKind::usage && std::string(e.what()).find(word) != std::string::npos) return true;
    MESSAGE(e.what());
  }
  return false;
}

}  // namespace sg::test
