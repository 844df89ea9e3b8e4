// SPDX-License-Identifier: Apache-2.0
// Footprints of a Gaussian kernel: how a voxel spreads over the picture and over depth, from two tables.
#pragma once
#include <vector>

#include "render/volume/methods/stage.h"

namespace sg::volume {

/// The kernel in voxels: a Gaussian of this deviation, cut off at this many deviations and shifted to zero there. With 0.7 a constant field
/// stays constant to 4e-4 (the sum over a lattice ripples by 4 exp(-2 pi^2 sigma^2)); it blurs a little more than a cubic B-spline.
constexpr double kernel_sigma = 0.7, kernel_reach = 4.3;
/// Splats of smaller variance in square pixels are widened to this, with their sum kept, so that pixels cannot miss them.
constexpr double least_variance = 0.42;

/// The two tables: across the ray by squared distance in deviations, and summed up along the ray by distance in deviations.
class KernelTable {
 public:
  KernelTable();
  /// Density across the ray, with the integral 1 over the plane; e in [0, reach^2).
  float across(float e) const {
    const float at = e * per_e_;
    const int i = int(at);
    return across_[size_t(i)] + (at - float(i)) * (across_[size_t(i) + 1] - across_[size_t(i)]);
  }
  /// Share of the kernel that lies before z, from 0 at -reach to 1 at reach.
  float before(float z) const {
    const float at = (z + float(kernel_reach)) * per_z_;
    if (!(at > 0)) return 0;
    if (at >= float(count)) return 1;
    const int i = int(at);
    return before_[size_t(i)] + (at - float(i)) * (before_[size_t(i) + 1] - before_[size_t(i)]);
  }

 private:
  static constexpr int count = 1024;
  float per_e_, per_z_;
  std::vector<float> across_, before_;
};

/// Where and how one voxel's kernel lies on the picture.
struct Footprint {
  float x, y, depth;       ///< of its middle: pixels, world
  float a, b, c;           ///< squared distance in deviations: a dx^2 + 2 b dx dy + c dy^2
  float slope_x, slope_y;  ///< the kernel's middle along the rays beside: deviations of depth per pixel
  float deviation;         ///< along the ray, in depth
  float amount;            ///< world length of a ray in the middle, per entry of the table
  float half_x, half_y;    ///< of the bounding box, pixels
};

/// The view of an affine lattice as footprints need it.
class Footprints {
 public:
  explicit Footprints(const Stage& stage);
  /// Of the voxel at q. False when it lies (or, in perspective, reaches) behind the eye.
  bool at(Vec3 q, Footprint& out) const;
  double depth(Vec3 q) const { return origin_.z + dot(depth_, q); }
  /// Largest reach of any kernel in depth.
  double reach() const { return reach_; }
  /// Whether voxels in the middle of the box are larger than pixels, so that splats are not widened.
  bool resolved() const { return resolved_; }
  /// q of the place at a depth on the ray through (x, y) in pixels.
  Vec3 q_at(double x, double y, double depth) const;

 private:
  void shape(Vec3 eye, Footprint& out) const;
  const Projection& projection_;
  Vec3 origin_, columns_[3];  // eye coordinates of q
  Vec3 depth_;
  Vec3 right_, up_, forward_;  // q per world length along the camera's axes
  Vec3 eye_;                   // q of the eye
  double reach_ = 0;
  bool resolved_ = true;
  Footprint same_;  // parallel: all except the position
};

/// Calls f(x, dx, share) for the pixels of row y under the footprint, from left to right: dx from its middle, share in world length.
template <class F>
void footprint_row(const KernelTable& table, const Footprint& p, int y, int width, F&& f) {
  constexpr float most = float(kernel_reach * kernel_reach) * 0.99999f;
  const float dy = float(y) + 0.5f - p.y, b = p.b * dy, inside = b * b - p.a * (p.c * dy * dy - most);
  if (!(inside > 0)) return;
  const float root = std::sqrt(inside), middle = p.x - 0.5f;
  const int from = int(std::max(0.0f, std::ceil(middle + (-b - root) / p.a)));
  const int to = int(std::min(float(width - 1), std::floor(middle + (-b + root) / p.a)));
  const float b2 = 2 * b, c = p.c * dy * dy;
  for (int x = from; x <= to; ++x) {
    const float dx = float(x) - middle;
    const float e = std::clamp(c + dx * (p.a * dx + b2), 0.0f, most);
    f(x, dx, p.amount * table.across(e));
  }
}

}  // namespace sg::volume
