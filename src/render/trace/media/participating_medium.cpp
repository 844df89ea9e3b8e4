// SPDX-License-Identifier: Apache-2.0
#include "render/trace/media/participating_medium.h"

#include <algorithm>
#include <cmath>

#include "render/shade/black_body.h"
#include "render/shade/exp.h"
#include "render/shade/scatter_albedo.h"

namespace sg::trace {

namespace {

constexpr int glow_steps = 1024;

const ColorScale& coloring_scale(const VolumeItem& item) { return item.detail.color_by_second ? item.detail.second_color : item.color; }

}  // namespace

ParticipatingMedium::ParticipatingMedium(volume::CastVolume volume, uint32_t item, double length, Range shown)
    : volume_(std::move(volume)), depth_(volume_.extinction()), phase_(volume_.item->scattering), item_(item), length_(length) {
  if (volume_.step > 0) tracking_ = Tracking::march;
  if (!volume_.item->scattering.black_body) return;
  const ColorScale& scale = coloring_scale(*volume_.item);
  glow_lo_ = scale.lo, glow_per_ = scale.hi > scale.lo ? glow_steps / (scale.hi - scale.lo) : 0;
  for (int i = 0; i <= glow_steps; ++i) {
    const Vec3 c = black_body(shown.lo + (shown.hi - shown.lo) * i / glow_steps, shown.hi);
    glow_.push_back({float(std::max(0.0, c.x)), float(std::max(0.0, c.y)), float(std::max(0.0, c.z))});
  }
}

Box3 ParticipatingMedium::bounds() const {
  Box3 b = volume_.source->bounds;
  b.lo = b.lo / length_, b.hi = b.hi / length_;
  return b;
}

volume::DepthRay ParticipatingMedium::inward(const Ray& ray, const Placement& placement) const {
  volume::DepthRay inner{placement.world(ray.origin) * length_, normalize(Vec3(ray.direction)), 0, double(ray.t_max)};
  if (std::isfinite(ray.t_max)) inner.to = double(ray.t_max) / placement.scale * length_;
  inner.clip(volume_.item->clip);
  return inner;
}

Collision ParticipatingMedium::collision(Vec3f color, float coloring) const {
  const VolumeScattering& s = volume_.item->scattering;
  const VolumeLighting light = s.light.value_or(VolumeLighting::path);
  Collision c;
  c.item = item_, c.phase = phase_;
  if (light == VolumeLighting::emission) {
    c.emission = color, c.last = true;
  } else {
    c.albedo = color * float(s.albedo), c.last = light != VolumeLighting::path;
    if (s.glow > 0) c.emission = (glow_.empty() ? surface_albedo(color, phase_.mean_cosine()) : black_body_at(coloring)) * float(s.glow);
  }
  return c;
}

Vec3f ParticipatingMedium::black_body_at(float coloring) const {
  const double place = (double(coloring) - glow_lo_) * glow_per_ + 0.5;
  return place >= 0 ? glow_[size_t(std::min(place, double(glow_steps)))] : Vec3f();
}

float ParticipatingMedium::surface(float tau, Vec3f gradient) const {
  const auto edge = float(volume_.source->edge);
  const float opacity = 1 - exp_minus(tau * edge);
  return opacity * std::min(1.f, length(gradient) * edge * volume_.per_scale);
}

}  // namespace sg::trace
