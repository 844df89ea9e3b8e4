// SPDX-License-Identifier: Apache-2.0
// What every kind of mesh turns a ray into: stretches on which the field is a cubic. Ray functions and the integral read nothing else.
#pragma once
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>

#include "base/vec.h"
#include "color/transfer_function.h"

namespace sg::volume {

/// A part of a ray on which the field is a cubic polynomial of the length t (exactly so in a trilinear cell or a tetrahedron; in
/// curved cells up to the error that its source states).
struct Stretch {
  double from, to;    ///< world length from the ray's origin, from < to
  float b[4];         ///< Bernstein coefficients of the stored value over [from, to]: b[0] at from, b[3] at to, all within the hull
  uint64_t cell = 0;  ///< for the source's own use (gradients, other fields)

  /// Value at t by de Casteljau's scheme.
  float value(double t) const {
    const float f = float((t - from) / (to - from)), g = 1 - f;
    const float b01 = g * b[0] + f * b[1], b12 = g * b[1] + f * b[2], b23 = g * b[2] + f * b[3];
    return g * (g * b01 + f * b12) + f * (g * b12 + f * b23);
  }
  float lowest() const { return std::min(std::min(b[0], b[1]), std::min(b[2], b[3])); }
  float highest() const { return std::max(std::max(b[0], b[1]), std::max(b[2], b[3])); }
};

/// Bernstein coefficients of the cubic with values v[i] at from + i/3 (to - from).
inline void bernstein_from_thirds(const float v[4], float b[4]) {
  b[0] = v[0], b[3] = v[3];
  b[1] = (-5 * v[0] + 18 * v[1] - 9 * v[2] + 2 * v[3]) / 6;
  b[2] = (2 * v[0] - 9 * v[1] + 18 * v[2] - 5 * v[3]) / 6;
}

/// Values of the field that draw nothing whatever happens there: a source may leave out stretches that lie wholly in such values.
/// Bit-compatible with "no knowledge": an empty one leaves out nothing.
struct Invisible {
  bool (*clear)(const void* what, float lo, float hi) = nullptr;  ///< whether all values in [lo, hi] may be left out
  const void* what = nullptr;
  bool operator()(float lo, float hi) const { return clear && clear(what, lo, hi); }
};

/// One thread's walker through one volume.
class RayField {
 public:
  virtual ~RayField() = default;
  /// The ray origin + t direction (unit length), t in [from, to].
  virtual void start(Vec3 origin, Vec3 direction, double from, double to) = 0;
  /// The next stretches from near to far, at most out.size(); 0 = no more. Between two stretches there may be a gap, which draws
  /// nothing (no cell, no value, or left out as invisible).
  virtual size_t next(std::span<Stretch> out) = 0;
  /// t at which the ray that was started enters the shape of the volume: fixed steps are counted from there.
  virtual double entry() const = 0;
  /// World gradient of the stored value at t of a stretch that `next` gave last or before.
  virtual Vec3f gradient(const Stretch& stretch, double t) = 0;
  /// Value of the second field there (TransferDetail::second_field); NaN where the source has none.
  virtual float second(const Stretch&, double) { return NAN; }
  /// Values of the samples between which the value there is interpolated, and their shares: for classification before interpolation.
  /// Returns how many (at most 8); 0 where the source cannot say.
  virtual int samples(const Stretch&, double, float[8], float[8]) { return 0; }
  /// World second derivatives of the stored value there; false where the source has none.
  virtual bool bend(const Stretch&, double, SecondDerivatives&) { return false; }
};

/// A part of a ray, and bounds of the field on it.
struct Span {
  double from, to;
  float lo, hi;  ///< of the stored values on it
};

/// One thread's walker through one volume by parts that are longer than stretches, for those that ask for the field at a few places only.
class RaySpans {
 public:
  virtual ~RaySpans() = default;
  virtual void start(Vec3 origin, Vec3 direction, double from, double to) = 0;
  /// The next part from near to far; false = no more. Between two parts there may be a gap, which draws nothing.
  virtual bool next_span(Span& out) = 0;
  /// Stored value at t of the part that next_span gave last; NaN where nothing is drawn.
  virtual float value(double t) = 0;
};

/// A prepared volume of any mesh kind; walkers share it.
class RaySource {
 public:
  virtual ~RaySource() = default;
  virtual std::unique_ptr<RayField> walker() const = 0;
  /// Null where the source has no parts longer than its stretches.
  virtual std::unique_ptr<RaySpans> spans() const { return nullptr; }
  /// value = stored + base
  float base = 0;
  /// World box of what is drawn.
  Box3 bounds;
  /// Smallest edge that matters: the step of fixed sampling is half of it by default.
  double edge = 1;
  /// Set before walkers are made.
  Invisible invisible;
};

}  // namespace sg::volume
