// SPDX-License-Identifier: Apache-2.0
// Spectrum: the Fourier transform of a lattice's samples, zero-padded to twice their number, readable between its points.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "base/huge_allocator.h"
#include "render/volume/methods/stage.h"

namespace sg::volume {

/// Kaiser and Bessel's window, cut to `width` points of the spectrum and lowered to zero there, so that it has a slope. Its
/// transform is known in closed form, so that the samples can be divided by it beforehand; with twofold padding the error between the
/// points is 1.3e-4 of the sum of all samples.
class SpectrumFilter {
 public:
  static constexpr int width = 4;
  SpectrumFilter();
  /// At a distance of at most width/2 points, and its derivative.
  void at(double distance, float& value, float& slope) const;
  /// Its transform at a place of the padded axis, from -1/2 to 1/2.
  double window(double place) const;

 private:
  static constexpr int per_point = 2048;
  double beta_, scale_;
  std::vector<float> value_, slope_;
};

class Spectrum {
 public:
  /// F(k) = sum of w f exp(-2 pi i k . (n - centre)), k in turns per voxel; w the voxel's share of the box; voxels without a value add
  /// nothing. Values are those of the field.
  enum class Of { values, ones };  ///< ones: 1 in place of each value, to count the samples
  explicit Spectrum(const Stage& stage, Of what = Of::values);
  /// Kept with the dataset; throws Error(usage) when it would not fit into the context's memory limit.
  static std::shared_ptr<const Spectrum> of(const Stage& stage, Of what = Of::values);
  static size_t bytes_of(const Stage& stage);

  struct Value {
    float re = 0, im = 0;
  };
  /// F at k (periodic).
  Value at(Vec3 k) const;
  /// The same and its derivative along the axes: value, d/dkx, d/dky, d/dkz.
  std::array<Value, 4> with_slopes(Vec3 k) const;
  Vec3 centre() const { return {double(centre_[0]), double(centre_[1]), double(centre_[2])}; }
  std::array<size_t, 3> size() const { return size_; }
  /// A point of the spectrum before it is divided by the filter's window, that is, of the divided samples.
  Value point(size_t x, size_t y, size_t z) const;

 private:
  template <bool slopes>
  std::array<Value, 4> read(Vec3 k) const;
  void transform_x(const Stage& stage, Of what);
  void transform_y();
  void transform_z(const Context& context);
  size_t shifted(int axis, size_t n) const { return (n + size_[size_t(axis)] - centre_[axis]) % size_[size_t(axis)]; }

  std::array<size_t, 3> size_{}, dims_{};
  size_t half_ = 0;  // points along x that are stored: 0 .. size/2
  size_t centre_[3] = {};
  SpectrumFilter filter_;
  std::vector<Value, HugeAllocator<Value>> points_;
};

}  // namespace sg::volume
