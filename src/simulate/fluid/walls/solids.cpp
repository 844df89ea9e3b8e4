// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/walls/solids.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"

namespace sg::fluid {

namespace {

constexpr double slit = 0.01;  // shares below carry nothing and make the pressure hard to find

}  // namespace

Solids::Solids(const SmokeParams& p, TriangleSoup surface, const MacGrid& g)
    : grid_(g),
      balls_(balls_of(p.obstacle, g, "obstacle")),
      surface_(std::move(surface)),
      velocity_(p.obstacle_velocity),
      spin_(p.obstacle_spin) {
  if (g.flat()) velocity_.z = 0, spin_.x = spin_.y = 0;
  moves_ = !none() && (length(velocity_) > 0 || length(spin_) > 0);
  Box3 box;
  for (const Ball& b : balls_) box.add(b.middle - b.radius * Vec3(1, 1, 1)), box.add(b.middle + b.radius * Vec3(1, 1, 1));
  for (const Vec3& v : surface_) box.add(v);
  if (none()) return;
  middle_ = box.center();
  speed_ = length(velocity_) + length(spin_) * length(box.size()) / 2;
}

Vec3 Solids::turned(Vec3 p, double time) const {
  // Rodrigues' formula.
  const double speed = length(spin_);
  Vec3 r = p - middle_;
  if (speed > 0) {
    const Vec3 axis = spin_ * (1 / speed);
    const double c = std::cos(speed * time), s = std::sin(speed * time);
    r = c * r + s * cross(axis, r) + (1 - c) * dot(axis, r) * axis;
  }
  return middle_ + time * velocity_ + r;
}

bool Solids::keep_out(Vec3& x, Vec3& v, double time) const {
  bool met = false;
  for (const Ball& b : balls_) {
    const Vec3 middle = moves_ ? turned(b.middle, time) : b.middle;
    Vec3 way = x - middle;
    if (grid_.flat()) way.z = 0;
    const double l = length(way);
    if (!(l < b.radius) || !(l > 0)) continue;
    const Vec3 n = way * (1 / l), solid = velocity_ + cross(spin_, x - (middle_ + time * velocity_));
    met = true, x += (b.radius - l) * n;
    if (const double into = dot(v - solid, n); into < 0) v -= into * n;
  }
  return met;
}

template <class T>
Walls<T> Solids::walls(const Sides& sides, double time, const Context& context) const {
  Walls<T> walls;
  for (size_t s = 0; s < 6; ++s) {
    const bool there = int(s / 2) < grid_.axes();
    walls.sides[s] = there && sides[s].kind == SideKind::open;
    walls.through[s] = there && sides[s].kind == SideKind::inflow ? T(sides[s].velocity[int(s / 2)]) : T(0);
  }
  if (none()) return walls;
  const bool moved = move();
  std::vector<Ball> balls = balls_;
  TriangleSoup surface = surface_;
  if (moved) {
    for (Ball& b : balls) b.middle = turned(b.middle, time);
    for (Vec3& v : surface) v = turned(v, time);
  }
  const Vec3 now = middle_ + time * velocity_;
  Faces<T> open = make_faces<T>(grid_), solid;
  bool any = false;
  for (int a = 0; a < 3; ++a) {
    const auto s = MacGrid::shift(a);
    Lattice<T>& l = open[size_t(a)];
    if (moved) solid[size_t(a)] = Lattice<T>(l.n);
    const Lattice<T> inside = surface.empty() || a >= grid_.axes() ? Lattice<T>() : shares_inside<T>(surface, grid_, a, context);
    for (size_t k = 0; k < l.n[2]; ++k)
      for (size_t j = 0; j < l.n[1]; ++j)
        for (size_t i = 0; i < l.n[0]; ++i) {
          Vec3 at = grid_.origin + grid_.h * Vec3(double(i) + s[0], double(j) + s[1], double(k) + s[2]);
          if (grid_.flat()) at.z = now.z;
          double share = walls.share(grid_.cells, a, i, j, k);
          if (!inside.values.empty()) share = std::min(share, 1 - double(inside(i, j, k)));
          // Outside of a ball by the distance of the face's middle: exact for the flat walls that large balls are.
          for (const Ball& b : balls) {
            Vec3 way = at - b.middle;
            if (grid_.flat()) way.z = 0;
            share = std::min(share, std::clamp((length(way) - b.radius) / grid_.h + 0.5, 0.0, 1.0));
          }
          share = share < slit ? 0 : share > 1 - slit ? 1 : share;
          l(i, j, k) = T(share), any = any || share > 0;
          if (moved) solid[size_t(a)](i, j, k) = T((velocity_ + sg::cross(spin_, at - now))[a]);
        }
  }
  if (!any) fail_data("the obstacles fill the box: nothing is left for the flow", "smoke obstacle", "make them smaller, or the box larger");
  walls.open = std::move(open);
  if (moved) walls.solid = std::move(solid);
  return walls;
}

template Walls<float> Solids::walls(const Sides&, double, const Context&) const;
template Walls<double> Solids::walls(const Sides&, double, const Context&) const;

}  // namespace sg::fluid
