// SPDX-License-Identifier: Apache-2.0
// How much rough boundaries reflect and let through in all directions together, as a function of where the light comes from.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "render/trace/material/ggx.h"

namespace sg::trace {

/// A function of a cosine from 0 to 1: 64 values, linear between them in the root of the cosine, as all of them are steep near 0.
class AlbedoCurve {
 public:
  static constexpr int places = 64;
  static constexpr float cosine_of(int place) { return float(place) / (places - 1) * (float(place) / (places - 1)); }

  AlbedoCurve() = default;
  explicit AlbedoCurve(const std::array<float, places>& values) : at_(values), average_(mean()) {}
  /// f(cosine) at each place.
  template <class F>
  static AlbedoCurve of(F&& f) {
    std::array<float, places> values;
    for (int i = 0; i < places; ++i) values[size_t(i)] = f(cosine_of(i));
    return AlbedoCurve(values);
  }
  float operator()(float cosine) const {
    const float x = std::sqrt(std::clamp(cosine, 0.f, 1.f)) * (places - 1);
    const int i = std::min(int(x), places - 2);
    return at_[size_t(i)] + (at_[size_t(i + 1)] - at_[size_t(i)]) * (x - float(i));
  }
  /// Integral of 2 cosine f(cosine): of light from everywhere.
  float average() const { return average_; }
  float least() const { return *std::min_element(at_.begin(), at_.end()); }

 private:
  float mean() const;
  std::array<float, places> at_{};
  float average_ = 0;
};

// All of the following are of single reflections and refractions; of anisotropic surfaces the largest over the directions about the normal.

/// Mirrors that reflect everything, which keep 1 less what hits another one; and that reflect (1 - cosine)^5, Schlick's rise.
struct MirrorAlbedo {
  AlbedoCurve white, grazing;
};
MirrorAlbedo mirror_albedo(const Ggx& ggx);
/// Of mirrors that reflect everything, the share that `passes`, by the cosine of the reflected direction.
AlbedoCurve mirror_albedo(const Ggx& ggx, const AlbedoCurve& passes);
/// Mirrors of metal (fresnel_conductor), red, green and blue.
std::array<AlbedoCurve, 3> conductor_albedo(const Ggx& ggx, Vec3f eta, Vec3f k);

/// Of a boundary of transparent matter.
struct BoundaryAlbedo {
  AlbedoCurve reflected, passed;
};
/// `eta` as in Fresnel; `sheet`: of two parallel boundaries, light leaves it in the direction in which it came or mirrored.
BoundaryAlbedo boundary_albedo(const Ggx& ggx, float eta, bool sheet);

}  // namespace sg::trace
