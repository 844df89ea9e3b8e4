// SPDX-License-Identifier: Apache-2.0
// What the evaluation of a Bsdf and the drawing of its directions share: microscopic boundaries between two directions.
#pragma once
#include <cmath>
#include <optional>

#include "base/vec.h"

namespace sg::trace {

/// The microscopic boundary that refracts i into o (Walter et al. 2007).
struct Refraction {
  Vec3f m;         ///< its normal, on the side of o
  float cosine_o;  ///< of o to m, above 0
  float spread;    ///< solid angle of m by that of i

  /// o.z > 0 > i.z, `eta` the index of refraction on the side of i, by that of o. Nothing where no boundary does.
  static std::optional<Refraction> between(Vec3f o, Vec3f i, float eta) {
    Vec3f m = normalize(o + i * eta);
    if (m.z < 0) m = -m;
    const float cosine_o = dot(o, m), cosine_i = dot(i, m);
    if (!(m.z > 0) || cosine_o <= 0 || cosine_i >= 0) return std::nullopt;
    const float d = cosine_i + cosine_o / eta;
    return Refraction{m, cosine_o, -cosine_i / (d * d)};
  }
};

/// Turned by half a turn about the normal: retroreflectors are mirrors of this direction.
inline Vec3f turned_back(Vec3f w) { return {-w.x, -w.y, w.z}; }

/// Reflectance of what is reflected twice or more between mirrors, relative to what a single reflection loses of white light, where mirrors
/// reflect `average` in all directions together and a single reflection keeps `kept` of white light (Kulla, Conty 2017).
inline Vec3f multiple_mirrors(Vec3f average, float kept) {
  Vec3f r;
  for (int i = 0; i < 3; ++i) r[i] = average[i] * average[i] * kept / (1 - average[i] * (1 - kept));
  return r;
}

}  // namespace sg::trace
