// SPDX-License-Identifier: Apache-2.0
#include "render/trace/media/participating_medium.h"

#include <algorithm>
#include <cmath>

#include "render/shade/exp.h"

namespace sg::trace {

ParticipatingMedium::ParticipatingMedium(volume::CastVolume volume, uint32_t item, double length)
    : volume_(std::move(volume)), depth_(volume_.extinction()), phase_(volume_.item->scattering), item_(item), length_(length) {
  if (volume_.step > 0) tracking_ = Tracking::march;
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

Collision ParticipatingMedium::collision(Vec3f color) const {
  const VolumeScattering& s = volume_.item->scattering;
  const VolumeLighting light = s.light.value_or(VolumeLighting::path);
  Collision c;
  c.item = item_, c.phase = phase_;
  if (light == VolumeLighting::emission) {
    c.emission = color, c.last = true;
  } else {
    c.albedo = color * float(s.albedo), c.emission = color * float(s.glow), c.last = light != VolumeLighting::path;
  }
  return c;
}

float ParticipatingMedium::surface(float tau, Vec3f gradient) const {
  const auto edge = float(volume_.source->edge);
  const float opacity = 1 - exp_minus(tau * edge);
  return opacity * std::min(1.f, length(gradient) * edge * volume_.per_scale);
}

}  // namespace sg::trace
