// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/obstacles.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "data/cells/cell_reader.h"

namespace sg::swarm {

namespace {

constexpr int most_bounces = 12;  // of a particle in a step
constexpr double cells_along = 96;

}  // namespace

void Obstacles::add(const DatasetPtr& data, const std::string& who, Context& context) {
  if (data->cell_count() == 0 || data->as<PointCloud>()) fail_usage("there is no surface to bounce off", who, "give a mesh with cells");
  Surface s;
  s.locator = std::make_unique<CellLocator>(data, context);
  s.box = data->bounds();
  const double size = std::max(s.box.diagonal(), 1e-300);
  const Vec3 margin = Vec3(1, 1, 1) * (1e-6 * size);
  s.box.lo -= margin, s.box.hi += margin;
  const Vec3 extent = s.box.size();
  const double most = std::max({extent.x, extent.y, extent.z});
  for (int a = 0; a < 3; ++a) {
    s.n[size_t(a)] = std::max(1, int(std::ceil(cells_along * extent[a] / most)));
    s.scale[a] = s.n[size_t(a)] / extent[a];
  }
  s.filled.assign(size_t(s.n[0]) * size_t(s.n[1]) * size_t(s.n[2]), 0);
  CellReader reader(data);
  for (size_t c = 0; c < data->cell_count(); ++c) {
    reader.open(c);
    Box3 nodes;
    for (const Vec3& p : reader.at()) nodes.add(p);
    const Box3 box = reader.box();
    if (box.empty()) continue;
    // Flat cells fill only what their plane comes near.
    Vec3 normal{};
    double off = HUGE_VAL;
    if (reader.at().size() >= 3 && box == nodes) {
      const auto& at = reader.at();
      normal = normalize(cross(at[1] - at[0], at[2] - at[0]));
      off = length(normal) > 0 ? 0 : HUGE_VAL;
      for (const Vec3& p : at) off = std::max(off, std::abs(dot(p - at[0], normal)));
    }
    int lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      lo[a] = std::clamp(int((box.lo[a] - margin[a] - s.box.lo[a]) * s.scale[a]), 0, s.n[size_t(a)] - 1);
      hi[a] = std::clamp(int((box.hi[a] + margin[a] - s.box.lo[a]) * s.scale[a]), 0, s.n[size_t(a)] - 1);
    }
    const Vec3 half{0.5 / s.scale.x, 0.5 / s.scale.y, 0.5 / s.scale.z};
    const double reach = off + std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z + length(margin);
    for (int k = lo[2]; k <= hi[2]; ++k)
      for (int j = lo[1]; j <= hi[1]; ++j)
        for (int i = lo[0]; i <= hi[0]; ++i) {
          const Vec3 middle = s.box.lo + Vec3(2 * i + 1, 2 * j + 1, 2 * k + 1) * half;
          if (off == HUGE_VAL || std::abs(dot(middle - reader.at()[0], normal)) <= reach)
            s.filled[size_t(i) + size_t(s.n[0]) * (size_t(j) + size_t(s.n[1]) * size_t(k))] = 1;
        }
  }
  gap_ = std::max(gap_, 1e-9 * size);
  surfaces_.push_back(std::move(s));
}

bool Obstacles::Surface::may_meet(Vec3 a, Vec3 b, int most_cells) const {
  int lo[3], hi[3];
  for (int c = 0; c < 3; ++c) {
    const double p = (std::min(a[c], b[c]) - box.lo[c]) * scale[c], q = (std::max(a[c], b[c]) - box.lo[c]) * scale[c];
    if (!(q >= 0 && p <= n[size_t(c)])) return false;
    lo[c] = std::max(0, int(p)), hi[c] = std::min(n[size_t(c)] - 1, int(std::min(q, double(n[size_t(c)]))));
  }
  if ((hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1) > most_cells) return true;
  for (int k = lo[2]; k <= hi[2]; ++k)
    for (int j = lo[1]; j <= hi[1]; ++j)
      for (int i = lo[0]; i <= hi[0]; ++i)
        if (filled[size_t(i) + size_t(n[0]) * (size_t(j) + size_t(n[1]) * size_t(k))]) return true;
  return false;
}

Obstacles::Walker::Walker(const Obstacles& obstacles) : all_(obstacles) {
  for (const Surface& s : obstacles.surfaces_) cursors_.emplace_back(*s.locator);
}

bool Obstacles::free(const Box3& box) const {
  if (box_)
    for (int a = 0; a < 3; ++a)
      if (!(box.lo[a] >= box_->lo[a] && box.hi[a] <= box_->hi[a])) return false;
  for (const Surface& s : surfaces_)
    if (s.may_meet(box.lo, box.hi, 4096)) return false;
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
    if (!all_.surfaces_[k].may_meet(x, x + d)) continue;
    if (const auto hit = cursors_[k].first_hit(x, d, 0, std::min(1.0, best.t)); hit && hit->t < best.t) best = {hit->t, hit->normal};
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
