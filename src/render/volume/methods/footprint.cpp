// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/footprint.h"

#include <cmath>
#include <numbers>

namespace sg::volume {

KernelTable::KernelTable() {
  using std::numbers::pi;
  constexpr double reach = kernel_reach, square = reach * reach;
  const double edge = exp_negative(0.5 * square);
  per_e_ = float(count / square), per_z_ = float(count / (2 * reach));
  across_.resize(count + 2), before_.resize(count + 2);
  const double plane = pi * (2 * (1 - edge) - edge * square);
  for (int i = 0; i < count + 2; ++i)
    across_[size_t(i)] = float(std::max(0.0, exp_negative(0.5 * square * std::min(i, count) / count) - edge) / plane);
  // Simpson's rule between the entries.
  const auto g = [&](double z) { return exp_negative(0.5 * z * z) - edge; };
  std::vector<double> sum(count + 1);
  const double h = 2 * reach / count;
  for (int i = 0; i < count; ++i) {
    const double z = -reach + h * i;
    sum[size_t(i) + 1] = sum[size_t(i)] + h / 6 * (g(z) + 4 * g(z + 0.5 * h) + g(z + h));
  }
  for (int i = 0; i < count + 2; ++i) before_[size_t(i)] = float(sum[size_t(std::min(i, count))] / sum[count]);
}

Footprints::Footprints(const Stage& s) : projection_(s.projection) {
  const Projection& p = s.projection;
  origin_ = p.to_eye(s.volume.origin);
  for (int a = 0; a < 3; ++a) {
    const Vec3 c = s.to_world.column(a);
    columns_[a] = {dot(c, p.right), dot(c, p.up), dot(c, p.forward)};
    depth_[a] = columns_[a].z;
  }
  right_ = s.volume.to_q * p.right, up_ = s.volume.to_q * p.up, forward_ = s.volume.to_q * p.forward;
  eye_ = s.volume.q(p.eye);
  // The depth of the kernel's ellipsoid: its support function.
  reach_ = kernel_sigma * kernel_reach * length(depth_);
  if (p.parallel) shape({0, 0, 1}, same_);
  const double middle = depth((s.volume.lo + s.volume.hi) * 0.5), pixel = (p.parallel ? 1 : std::abs(middle)) / p.scale;
  for (Vec3 c : columns_) resolved_ = resolved_ && length(c) * kernel_sigma >= std::sqrt(least_variance) * pixel;
}

Vec3 Footprints::q_at(double x, double y, double depth) const {
  const double sx = (x - projection_.middle_x()) / projection_.scale, sy = (projection_.middle_y() - y) / projection_.scale;
  const Vec3 across = right_ * sx + up_ * sy;
  return eye_ + (projection_.parallel ? across + forward_ * depth : (across + forward_) * depth);
}

/// A pixel beside the middle moves the place at the middle's depth by vectors in q; what of them lies across the ray counts as
/// distance, what lies along it moves the kernel's middle in depth.
void Footprints::shape(Vec3 eye, Footprint& out) const {
  const double far = length(eye), cosine = projection_.parallel ? 1 : eye.z / far;
  const Vec3 along = projection_.parallel ? forward_ : (right_ * eye.x + up_ * eye.y + forward_ * eye.z) / far;
  const double per_length = length(along), pixel = (projection_.parallel ? 1 : eye.z) / projection_.scale;
  const Vec3 l = along / per_length, px = right_ * pixel, py = -(up_ * pixel);
  const double x = dot(px, l), y = dot(py, l), k = 1 / (kernel_sigma * kernel_sigma);
  double a = k * (dot(px, px) - x * x), b = k * (dot(px, py) - x * y), c = k * (dot(py, py) - y * y);
  double determinant = a * c - b * b, amount = k / per_length;
  // The covariance is the inverse of (a b; b c).
  double xx = c / determinant, yy = a / determinant, xy = -b / determinant;
  // The kernel's middle along the ray: depth per pixel.
  double gx = -x / per_length * cosine, gy = -y / per_length * cosine, variance = kernel_sigma / per_length * cosine;
  variance *= variance;
  const double least = 0.5 * (xx + yy - std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy));
  if (least < least_variance) {
    // Widened on the picture, not in depth: middle and variance given the pixel change, the variance over all pixels does not.
    const double vx = xx * gx + xy * gy, vy = xy * gx + yy * gy;
    variance += gx * vx + gy * vy;
    xx += least_variance - least, yy += least_variance - least;
    const double wide = xx * yy - xy * xy;
    amount /= std::sqrt(determinant * wide);
    a = yy / wide, b = -xy / wide, c = xx / wide;
    gx = a * vx + b * vy, gy = b * vx + c * vy;
    variance -= gx * vx + gy * vy;
  }
  const double deviation = std::sqrt(variance);
  out.a = float(a), out.b = float(b), out.c = float(c), out.amount = float(amount);
  out.deviation = float(deviation), out.slope_x = float(gx / deviation), out.slope_y = float(gy / deviation);
  out.half_x = float(kernel_reach * std::sqrt(xx)), out.half_y = float(kernel_reach * std::sqrt(yy));
}

bool Footprints::at(Vec3 q, Footprint& out) const {
  const Vec3 eye = origin_ + columns_[0] * q.x + columns_[1] * q.y + columns_[2] * q.z;
  double scale = projection_.scale;
  if (projection_.parallel) {
    out = same_;
  } else {
    if (!(eye.z > reach_)) return false;
    shape(eye, out);
    scale /= eye.z;
  }
  out.x = float(projection_.middle_x() + scale * eye.x), out.y = float(projection_.middle_y() - scale * eye.y);
  out.depth = float(eye.z);
  // Far beside the picture numbers may be anything.
  return std::abs(out.x) + out.half_x < 1e8f && std::abs(out.y) + out.half_y < 1e8f;
}

}  // namespace sg::volume
