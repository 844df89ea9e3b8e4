// SPDX-License-Identifier: Apache-2.0
// Small volumes, parallel views and one-pixel pictures for the tests of the volume ray caster.
#pragma once
#include <cstring>
#include <functional>

#include "base/parallel.h"
#include "base/random.h"
#include "render/scene_support.h"
#include "render/volume/rays/functions.h"
#include "render/volume/sources/lattice/lattice_ray.h"
#include "render/volume/volume.h"
#include "support/test.h"

namespace sg::test {

/// Point field "f" on a uniform grid.
inline DatasetPtr grid(UniformGrid g, const std::function<double(Vec3)>& f, ElementType type = ElementType::f32) {
  std::vector<double> v;
  for (size_t k = 0; k < g.dims[2]; ++k)
    for (size_t j = 0; j < g.dims[1]; ++j)
      for (size_t i = 0; i < g.dims[0]; ++i) v.push_back(f(g.origin + g.direction * (g.spacing * Vec3(double(i), double(j), double(k)))));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v).converted(type), "", Role::scalars});
  return make_dataset(g, fields);
}
/// n points per axis over the box [lo, hi]^3.
inline UniformGrid cube(size_t n, double lo, double hi) {
  UniformGrid g;
  g.dims = {n, n, n}, g.origin = {lo, lo, lo};
  const double h = (hi - lo) / double(n - 1);
  g.spacing = {h, h, h};
  return g;
}

/// A colour map of one colour, given in linear light.
inline ColorScale one_color(Vec3f linear) {
  ColorScale s;
  const Vec3f c{srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z)};
  s.map.name = "one", s.map.colors = {c, c};
  s.below = s.above = c;
  return s;
}
/// Black to white over [lo, hi].
inline ColorScale grey(double lo, double hi) {
  ColorScale s;
  for (int i = 0; i <= 256; ++i) {
    const float c = srgb_encode(float(i) / 256);
    s.map.colors.push_back({c, c, c});
  }
  s.lo = lo, s.hi = hi;
  return s;
}
inline OpacityCurve constant_opacity(double density) {
  OpacityCurve c;
  c.points = {{0, 1 - std::exp(-density)}};
  return c;
}
/// -log(1 - opacity) equal to the value, sampled at n points over [lo, hi].
inline OpacityCurve density_is_value(double lo, double hi, int n = 4000) {
  OpacityCurve c;
  c.points.clear();
  for (int i = 0; i <= n; ++i) {
    const double x = lo + (hi - lo) * i / n;
    c.points.push_back({x, 1 - std::exp(-x)});
  }
  return c;
}

inline VolumeItem item(DatasetPtr data, ColorScale color, OpacityCurve opacity, double step = 0) {
  VolumeItem v;
  v.data = std::move(data), v.field = "f", v.color = std::move(color), v.opacity = std::move(opacity);
  v.unit_distance = 1, v.shaded = false, v.sampling.step = step;
  return v;
}

/// Parallel view along `forward` onto the point `target`, from a distance of 100.
inline Projection parallel_view(int width, int height, double pixels_per_unit, Vec3 forward = {0, 0, -1}, Vec3 up = {0, 1, 0},
                                Vec3 target = {0, 0, 0}) {
  Projection p;
  p.width = width, p.height = height, p.parallel = true;
  p.forward = normalize(forward), p.right = normalize(cross(p.forward, up)), p.up = cross(p.right, p.forward);
  p.eye = target - p.forward * 100.0;
  p.scale = pixels_per_unit, p.near_plane = 0, p.far_plane = 1000;
  return p;
}
inline Projection perspective_view(int width, int height, double scale, Vec3 eye, Vec3 target, Vec3 up = {0, 1, 0}) {
  Projection p = parallel_view(width, height, scale, target - eye, up);
  p.parallel = false, p.eye = eye, p.near_plane = 1e-6;
  return p;
}

inline Frame draw(const Scene& scene, const Projection& p, const volume::Knobs& knobs = {}, const FragmentLists& fragments = {}) {
  Frame frame(p.width, p.height);
  Context context;
  volume::composite_volumes(scene, p, fragments, frame, context, knobs);
  return frame;
}
/// A clear fragment before the volume in every pixel: such pictures go by single rays.
inline FragmentLists by_single_rays(const Projection& view) {
  FragmentLists clear;
  clear.start.push_back(0);
  for (int i = 0; i < view.width * view.height; ++i) {
    clear.fragments.push_back({1e-3f, {0, 0, 0, 0}, 9});
    clear.start.push_back(uint32_t(i + 1));
  }
  return clear;
}
/// The one pixel of a ray along -z through (x, y).
inline Frame look(const Scene& scene, double x = 0.013, double y = 0.017, const volume::Knobs& knobs = {},
                  const FragmentLists& fragments = {}) {
  return draw(scene, parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {x, y, 0}), knobs, fragments);
}
/// The largest value along a ray, as the general way finds it.
inline volume::Found largest_along(const volume::Volume& v, Vec3 origin, Vec3 direction) {
  const auto source = volume::lattice_source(std::make_shared<const volume::Volume>(v));
  const auto walker = source->walker();
  walker->start(origin, direction, 0, 1e9);
  return volume::largest(*walker);
}
inline float largest_difference(const Frame& a, const Frame& b) {
  float most = 0;
  for (size_t i = 0; i < a.rgba.size(); ++i) most = std::max(most, std::abs(a.rgba[i] - b.rgba[i]));
  return most;
}
inline bool same_bytes(const Frame& a, const Frame& b) {
  return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * 4) == 0 &&
         std::memcmp(a.depth.data(), b.depth.data(), a.depth.size() * 4) == 0 && a.ids == b.ids;
}

}  // namespace sg::test
