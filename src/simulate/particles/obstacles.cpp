// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/obstacles.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"

namespace sg::swarm {

namespace {

constexpr int most_bounces = 12;  // of a particle in a step

}  // namespace

void Obstacles::add(const DatasetPtr& data, const std::string& who, Context& context) {
  if (data->cell_count() == 0 || data->as<PointCloud>()) fail_usage("there is no surface to bounce off", who, "give a mesh with cells");
  const double size = std::max(data->bounds().diagonal(), 1e-300);
  gap_ = std::max(gap_, 1e-9 * size);
  surfaces_.push_back({std::make_unique<CellLocator>(data, context), NearCells(data, 1e-6 * size)});
}

Obstacles::Walker::Walker(const Obstacles& obstacles) : all_(obstacles) {
  for (const Surface& s : obstacles.surfaces_) cursors_.emplace_back(*s.locator);
}

bool Obstacles::free(const Box3& box) const {
  if (box_)
    for (int a = 0; a < 3; ++a)
      if (!(box.lo[a] >= box_->lo[a] && box.hi[a] <= box_->hi[a])) return false;
  for (const Surface& s : surfaces_)
    if (s.near.may_meet(box.lo, box.hi, 4096)) return false;
  return true;
}

Obstacles::Walker::Hit Obstacles::Walker::first(Vec3 x, Vec3 d) {
  Hit best;
  if (all_.box_)
    for (int a = 0; a < 3; ++a) {
      const double to = x[a] + d[a], lo = all_.box_->lo[a], hi = all_.box_->hi[a];
      if (!(to < lo || to > hi)) continue;
      const double wall = to < lo ? lo : hi, t = std::max(0.0, (wall - x[a]) / d[a]);
      if (t < best.t) best.t = t, best.normal = {}, best.normal[a] = to < lo ? 1 : -1;
    }
  for (size_t k = 0; k < cursors_.size(); ++k) {
    std::array<uint32_t, 24> cells;
    size_t count = 0;
    const bool all = all_.surfaces_[k].near.collect(x, x + d, cells, count);
    if (all && count == 0) continue;
    const double end = std::min(1.0, best.t);
    const auto hit = all ? cursors_[k].first_hit_among({cells.data(), count}, x, d, 0, end) : cursors_[k].first_hit(x, d, 0, end);
    if (hit && hit->t < best.t) best = {hit->t, hit->normal};
  }
  return best;
}

bool Obstacles::Walker::walk(Vec3 x, Vec3 v, Vec3& x1, Vec3& v1, double h) {
  Vec3 d = x1 - x;
  Hit hit = first(x, d);
  if (!(hit.t <= 1)) return false;
  Vec3 pull = (v1 - v) * (1 / h);
  double left = h;
  for (int bounces = 0; bounces < most_bounces; ++bounces) {
    Vec3 n = hit.normal;
    double across = dot(d, n);
    if (across > 0) n = -n, across = -across;
    // Stop short of it, by the gap along the normal: all of the way up to there was found free.
    const double back = std::min(hit.t, across < 0 ? all_.gap_ / -across : hit.t);
    x += (hit.t - back) * d;
    v += (hit.t * left) * pull;
    left *= 1 - hit.t;
    double vn = dot(v, n);
    if (vn > 0) v = d * (1 / h), vn = dot(v, n);  // of paths that curve away from their chord
    const Vec3 along = v - vn * n;
    double up = -all_.bounce_.restitution * std::min(vn, 0.0), pressed = std::max(0.0, up - vn);
    // What would come back at once rests: from here on the surface bears it.
    if (const double weight = dot(pull, n); weight < 0 && up <= -weight * left * 0.1) {
      pressed += -weight * left - up;
      up = 0, pull -= weight * n;
    }
    const double speed = length(along);
    const double kept = speed > 0 ? std::max(0.0, 1 - all_.bounce_.friction * pressed / speed) : 0;
    v = kept * along + up * n;
    if (kept == 0 && up == 0) pull = {};  // friction holds it for the rest of the step
    v1 = v + left * pull;
    d = left * v + (left * left / 2) * pull;
    hit = first(x, d);
    if (!(hit.t <= 1)) {
      x1 = x + d;
      return true;
    }
  }
  // In a corner: it stays.
  x1 = x, v1 = {};
  return true;
}

}  // namespace sg::swarm
