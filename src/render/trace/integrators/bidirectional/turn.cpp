// SPDX-License-Identifier: Apache-2.0
#include "render/trace/integrators/bidirectional/turn.h"

#include <cmath>

namespace sg::trace {

namespace {

// What the shading normal calls one side and the surface the other is no way for light.
bool is_way(const Vertex& v, Vec3f local, Vec3f direction) { return (dot(direction, v.point.face_normal) > 0) == (local.z > 0); }

Turn in_matter(const PathVertex& v, Vec3f direction, Transport transport) {
  const Collision& c = *v.matter;
  const float density = c.density(-v.to_parent, direction);
  Turn t{c.albedo * density, double(density), c.on_surface ? 0 : double(density)};
  // Where light is scattered once only, paths from the camera end.
  if (c.last) (transport == Transport::radiance ? t.onward : t.backward) = 0;
  return t;
}

Turn at_surface(const PathVertex& v, Vec3f direction, Transport transport) {
  if (v.at.bsdf.delta_only()) return {};
  const Vec3f wo = v.local_parent(), wi = v.at.frame.to_local(direction);
  if (!is_way(v.at, wi, direction)) return {};
  Turn t;
  t.scattered = v.at.bsdf.evaluate(wo, wi, transport) * std::abs(wi.z);
  if (transport == Transport::importance) t.scattered *= rounded_normal_factor(v.at, wo, v.to_parent, wi, direction);
  t.onward = double(v.at.bsdf.pdf(wo, wi)), t.backward = double(v.at.bsdf.pdf(wi, wo));
  return t;
}

}  // namespace

std::optional<Turn> turn(const PathVertex& v, Vec3f direction, Transport transport) {
  const Turn t = v.matter ? in_matter(v, direction, transport) : at_surface(v, direction, transport);
  if (!shines(t.scattered)) return {};
  return t;
}

}  // namespace sg::trace
