// SPDX-License-Identifier: Apache-2.0
// How much rough boundaries reflect and let through in all directions together, as a function of where the light comes from.
#pragma once
#include <array>
#include <cmath>

#include "render/trace/material/ggx.h"

namespace sg::trace {

/// A function of a cosine from 0 to 1: 64 values, linear between them in the root of the cosine, as all of them are steep near 0.
class AlbedoCurve {
 public:
  /// f(cosine) at each of the 64 places.
  template <class F>
  static AlbedoCurve of(F&& f) {
    AlbedoCurve curve;
    for (int i = 0; i <= last; ++i) curve.at_[size_t(i)] = f(float(i) / last * (float(i) / last));
    curve.average_ = curve.mean();
    return curve;
  }
  float operator()(float cosine) const {
    const float x = std::sqrt(std::clamp(cosine, 0.f, 1.f)) * last;
    const int i = std::min(int(x), last - 1);
    return at_[size_t(i)] + (at_[size_t(i + 1)] - at_[size_t(i)]) * (x - float(i));
  }
  /// Integral of 2 cosine f(cosine): of light from everywhere.
  float average() const { return average_; }

 private:
  static constexpr int last = 63;
  float mean() const;
  std::array<float, last + 1> at_{};
  float average_ = 0;
};

/// Of mirrors that reflect everything: 1 less what hits another one, which a single reflection loses. Of anisotropic ones the largest over
/// the directions about the normal.
AlbedoCurve mirror_albedo(const Ggx& ggx);
/// Of mirrors of metal, fresnel_conductor().
AlbedoCurve conductor_albedo(const Ggx& ggx, float eta, float k);
/// Of mirrors that reflect (1 - cosine)^5, Schlick's rise towards grazing angles.
AlbedoCurve grazing_albedo(const Ggx& ggx);

/// Of a boundary of transparent matter, single reflections and refractions.
struct BoundaryAlbedo {
  AlbedoCurve reflected, passed;
};
/// `eta` as in Fresnel; `sheet`: of two parallel boundaries, light leaves it in the direction in which it came or mirrored.
BoundaryAlbedo boundary_albedo(const Ggx& ggx, float eta, bool sheet);

}  // namespace sg::trace
