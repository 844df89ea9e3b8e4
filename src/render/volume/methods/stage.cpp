// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/stage.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "base/error.h"
#include "render/shade/blinn_phong.h"
#include "render/volume/effects/effects.h"
#include "render/volume/sources/lattice/derivatives.h"

namespace sg::volume {

namespace {

[[noreturn]] void refuse(const Limits& limits, const std::string& what) {
  fail_usage(fmt::format("method={} cannot draw {}", limits.method, what), "volume", "use method=ray");
}

void check(const LayerInput& input, const Limits& limits) {
  const VolumeItem& item = input.item;
  if (std::find(limits.modes.begin(), limits.modes.end(), item.mode) == limits.modes.end()) {
    std::string can;
    for (const RayFunction f : limits.modes) can += (can.empty() ? "" : ", ") + std::string(word_of(f));
    fail_usage(fmt::format("method={} cannot draw mode={}", limits.method, word_of(item.mode)), "volume",
               fmt::format("it can draw {}; method=ray draws all", can));
  }
  if (item.data && !item.data->as<UniformGrid>() && !item.data->as<RectilinearGrid>())
    fail_usage(fmt::format("method={} draws uniform{} grids, not a {} mesh", limits.method, limits.rectilinear ? " and rectilinear" : "",
                           item.data->kind()),
               "volume", "use method=ray or method=cells for meshes of solid cells, or convert it to a grid with -f resample");
  if (!limits.rectilinear && item.data && item.data->as<RectilinearGrid>()) refuse(limits, "rectilinear grids");
  if (!limits.perspective && !input.projection.parallel)
    fail_usage(fmt::format("method={} supports parallel projection only", limits.method), "camera",
               "use --camera projection=parallel, or method=ray");
  if (!limits.clip && !item.clip.empty()) refuse(limits, "clipped volumes");
  if (!item.detail.plain()) refuse(limits, "transfer functions of two dimensions");
  if (item.sampling.kernel != Kernel::linear) refuse(limits, fmt::format("with kernel={}", word_of(item.sampling.kernel)));
  if (item.sampling.classify == VolumeClassify::table) refuse(limits, "with classify=table");
  if (item.sampling.antialias != VolumeAntialias::none) refuse(limits, "means of cells (antialias)");
  if (item.light.shadows > 0) refuse(limits, "shadows");
  if (scatters_by_map(item)) refuse(limits, "light=map");
  if (item.light.occlusion > 0) refuse(limits, "ambient occlusion");
  if (item.light.style != LightStyle::none) refuse(limits, fmt::format("in style={}", word_of(item.light.style)));
  if (!limits.depth_cue && item.light.depth_cue > 0) refuse(limits, "a depth cue");
  if (input.opaque.width != input.projection.width || input.opaque.height != input.projection.height)
    fail_internal("the opaque frame and the projection differ in size");
}

}  // namespace

Stage make_stage(const LayerInput& input, const Limits& limits) {
  check(input, limits);
  input.context.check();
  Stage s{input.item, input.projection, input.opaque, input.context, prepare(input.item, 1, Knobs{}), false, {}, {}};
  const Volume& v = s.volume;
  s.empty = v.transfer.empty() || !(v.hi.x > v.lo.x && v.hi.y > v.lo.y && v.hi.z > v.lo.z);
  if (s.empty) return s;
  s.to_world = inverse(v.to_q);
  s.lamps = lamps_of(input.lights, input.projection);
  return s;
}

PixelRay Stage::ray(int x, int y) const {
  const Projection::Ray r = projection.ray(x + 0.5, y + 0.5);
  PixelRay out;
  out.per_length = dot(r.direction, projection.forward), out.first_depth = dot(r.origin - projection.eye, projection.forward);
  const double nearest = (projection.near_plane - out.first_depth) / out.per_length;
  const double most = std::min(projection.far_plane, double(opaque.depth[size_t(y) * size_t(projection.width) + size_t(x)]));
  const Course c = course(volume, r.origin, r.direction, nearest, (most - out.first_depth) / out.per_length);
  out.start = c.start, out.along = c.along, out.enter = c.enter, out.leave = c.leave;
  for (const ClipPlane& plane : item.clip) {
    const double slope = dot(plane.normal, r.direction), room = plane.offset - dot(plane.normal, r.origin);
    if (slope > 0) out.leave = std::min(out.leave, room / slope);
    else if (slope < 0) out.enter = std::max(out.enter, room / slope);
    else if (room < 0) out.leave = out.enter - 1;
  }
  return out;
}

LitRay Stage::lit(Vec3 direction) const {
  LitRay l;
  l.material = material_of(item.light);
  light(direction, l);
  return l;
}

void Stage::light(Vec3 direction, LitRay& l) const {
  l.direction = Vec3f(direction);
  seen_along(lamps, direction, l.lights);
}

float value_at(const Volume& v, size_t i, size_t j, size_t k) {
  const size_t at = i + v.voxels.dims[0] * (j + v.voxels.dims[1] * k);
  const void* p = v.voxels.array.raw();
  switch (v.voxels.array.type()) {
    case ElementType::u8: return float(static_cast<const uint8_t*>(p)[at]);
    case ElementType::i8: return float(static_cast<const int8_t*>(p)[at]);
    case ElementType::u16: return float(static_cast<const uint16_t*>(p)[at]);
    case ElementType::i16: return float(static_cast<const int16_t*>(p)[at]);
    default: return static_cast<const float*>(p)[at];
  }
}

Shade shade_sample(const Stage& stage, Vec3f gradient, float per_cell, const LitRay& lit) {
  return shade_normal(world_gradient(stage, gradient), std::min(1.0f, per_cell * stage.volume.shade_plan.per_scale), lit);
}

Shade shade_normal(Vec3f normal, float surface, const LitRay& lit) {
  const float square = dot(normal, normal);
  if (!(square > 0) || !(square < 1e30f)) return {};
  const float side = (dot(normal, lit.direction) > 0 ? -1.0f : 1.0f) / std::sqrt(square);
  const Reflected sum = reflected(lit.lights, normal, side, lit.material.power);
  return {1 + surface * (lit.material.ambient + lit.material.diffuse * sum.diffuse - 1), surface * (lit.material.specular * sum.specular)};
}

float alpha_of(float x) {
  constexpr int count = 16 * 512;  // straight lines between 512 entries per unit
  static const std::vector<float> table = [] {
    std::vector<float> t(count + 2);
    for (int i = 0; i < count + 2; ++i) t[size_t(i)] = float(1 - exp_negative(i / 512.0));
    return t;
  }();
  if (x < 0.0625f) return x * (1 - x * (0.5f - x * (1.0f / 6 - x * (1.0f / 24))));
  if (!(x < 16)) return 1;
  const float at = x * 512;
  const int i = int(at);
  return table[size_t(i)] + (at - float(i)) * (table[size_t(i) + 1] - table[size_t(i)]);
}

Ink::Ink(const VolumeItem& item) : item_(item), table_(color_table(item.color)) {}

void Ink::draw(double value, float rgba[4]) const {
  rgba[0] = rgba[1] = rgba[2] = rgba[3] = 0;
  if (!(value == value)) return;
  const Vec4f c = table_.at(item_.color.position(value));
  if (!(item_.opacity.at(value) > 0) || !(c.w > 0)) return;
  rgba[0] = c.x, rgba[1] = c.y, rgba[2] = c.z, rgba[3] = 1;
}

PointGradient gradient_at_sample(const Volume& v, size_t i, size_t j, size_t k) {
  const std::array<size_t, 3> here{i, j, k};
  PointGradient g{{0, 0, 0}, 0};
  for (int a = 0; a < 3; ++a) {
    const size_t n = v.voxels.dims[size_t(a)], own = here[size_t(a)];
    const auto value = [&](size_t m) {
      std::array<size_t, 3> at = here;
      at[size_t(a)] = m;
      return value_at(v, at[0], at[1], at[2]);
    };
    const auto inside = [&](size_t m) {
      const float at = value(m), back = at - value(m - 1), on = value(m + 1) - at;
      const float slope = 0.5f * (back + on);
      return slope == slope ? slope : back == back ? back : on == on ? on : 0.0f;
    };
    float slope;
    if (own > 0 && own + 1 < n) {
      slope = inside(own);
    } else {
      const float over = own == 0 ? value(1) - value(0) : value(own) - value(own - 1);
      slope = over != over ? 0 : n == 2 ? over : border_slope(over, inside(own == 0 ? 1 : own - 1));
    }
    g.q[a] = slope, g.per_cell += slope * slope;
  }
  g.per_cell = std::sqrt(g.per_cell);
  return g;
}

}  // namespace sg::volume
