// SPDX-License-Identifier: Apache-2.0
// Rough surfaces as microscopic mirrors: the GGX distribution of their normals (Trowbridge, Reitz 1975; Walter et al. 2007) with Smith's
// shadowing. Directions are unit vectors in the local frame with z along the normal.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec.h"

namespace sg::trace {

class Ggx {
 public:
  /// Perfectly smooth.
  Ggx() = default;
  /// alpha along x and y, the root of twice the mean square slope; below 1e-3 in both a surface counts as smooth.
  Ggx(float x, float y) : smooth_(x < least && y < least), x_(std::max(x, least)), y_(std::max(y, least)) {}
  /// As OpenPBR: alpha = roughness^2, stretched along x by an anisotropy from 0 to 1.
  static Ggx of_roughness(float roughness, float anisotropy = 0) {
    const float across = 1 - anisotropy, along = roughness * roughness * std::sqrt(2 / (1 + across * across));
    return {along, along * across};
  }

  bool smooth() const { return smooth_; }
  bool isotropic() const { return x_ == y_; }

  /// Density of normals m, per area of the surface and solid angle: D(m) m.z integrates to 1.
  float normals(Vec3f m) const {
    const float x = m.x / x_, y = m.y / y_, t = x * x + y * y + m.z * m.z;
    return 1 / (pi_ * x_ * y_ * t * t);
  }
  /// Area in shadow by area seen, from direction w.
  float lambda(Vec3f w) const {
    const float x = x_ * w.x, y = y_ * w.y;
    return (std::sqrt(1 + (x * x + y * y) / (w.z * w.z)) - 1) / 2;
  }
  /// The share of normals seen from w, and from both of two directions: heights are correlated (Heitz 2014).
  float seen(Vec3f w) const { return 1 / (1 + lambda(w)); }
  float seen(Vec3f a, Vec3f b) const { return 1 / (1 + lambda(a) + lambda(b)); }
  /// Density per solid angle of the normals that are seen from w, w.z > 0: what visible() samples.
  float visible_pdf(Vec3f w, Vec3f m) const { return normals(m) * seen(w) * std::max(0.f, dot(w, m)) / w.z; }
  /// A normal that is seen from w, w.z > 0, by a cap of the sphere about -w (Dupuy, Benyoub 2023).
  Vec3f visible(Vec3f w, Vec2f u) const {
    const Vec3f stretched = normalize(Vec3f(w.x * x_, w.y * y_, w.z));
    const float angle = 2 * pi_ * u.x, z = (1 - u.y) * (1 + stretched.z) - stretched.z, r = std::sqrt(std::clamp(1 - z * z, 0.f, 1.f));
    const Vec3f m = stretched + Vec3f(r * std::cos(angle), r * std::sin(angle), z);
    return normalize(Vec3f(m.x * x_, m.y * y_, std::max(m.z, 1e-6f)));
  }

 private:
  static constexpr float least = 1e-3f, pi_ = std::numbers::pi_v<float>;
  bool smooth_ = true;
  float x_ = least, y_ = least;
};

inline Vec3f reflected(Vec3f w, Vec3f m) { return m * (2 * dot(w, m)) - w; }

/// The direction on the other side of a microscopic boundary m, dot(w, m) > 0; `eta` and `cosine_through` as in Fresnel.
inline Vec3f refracted(Vec3f w, Vec3f m, float eta, float cosine_through) { return m * (dot(w, m) / eta - cosine_through) - w * (1 / eta); }

}  // namespace sg::trace
