// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/tet_walk.h"

namespace sg::volume {

namespace {

bool left(const auto& a, const auto& b) { return turns_left(a.x, a.y, b.x, b.y); }

/// ax by - ay bx, right to the last bits (Kahan).
double area(const double a[2], const double b[2]) {
  const double q = a[1] * b[0], rest = std::fma(a[1], b[0], -q);
  return std::fma(a[0], b[1], -q) - rest;
}

}  // namespace

void weights_in_face(const double v[3][2], double weights[3]) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) weights[k] = std::abs(area(v[(k + 1) % 3], v[(k + 2) % 3])), sum += weights[k];
  if (sum > 0) {
    for (int k = 0; k < 3; ++k) weights[k] /= sum;
    return;
  }
  // All on one straight line: between the two that have the point between them.
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (v[i][0] * v[j][0] + v[i][1] * v[j][1] > 0) continue;
    const double a = std::sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1]), b = std::sqrt(v[j][0] * v[j][0] + v[j][1] * v[j][1]);
    weights[i] = a + b > 0 ? b / (a + b) : 0.5, weights[j] = 1 - weights[i], weights[3 - i - j] = 0;
    return;
  }
  weights[0] = weights[1] = weights[2] = 1.0 / 3;
}

TetWalk::Corner TetWalk::corner(uint32_t id) const {
  const Vec3 p = mesh_.at[id] - origin_;
  return {id, dot(p, across_[0]), dot(p, across_[1]), dot(p, direction_), volume_.by_cell ? 0.0f : volume_.values[id]};
}

/// Place and value where the line crosses v_.
double TetWalk::interpolate(float& f) const {
  const Corner &a = v_[0], &b = v_[1], &c = v_[2];
  const double pa = b.x * c.y, qa = b.y * c.x, pb = c.x * a.y, qb = c.y * a.x, pc = a.x * b.y, qc = a.y * b.x;
  double wa = std::max(pa - qa, 0.0), wb = std::max(pb - qb, 0.0), wc = std::max(pc - qc, 0.0);
  const double sum = wa + wb + wc, size = std::max({pa, pb, pc, -qa, -qb, -qc});
  if (sum > 0x1p-30 * size) {
    wa /= sum, wb /= sum, wc /= sum;
  } else {
    const double corners[3][2] = {{a.x, a.y}, {b.x, b.y}, {c.x, c.y}};
    double w[3];
    weights_in_face(corners, w);
    wa = w[0], wb = w[1], wc = w[2];
  }
  // Rounding must not carry a value beyond those of the corners.
  f = float(wa * double(a.f) + wb * double(b.f) + wc * double(c.f));
  return wa * a.t + wb * b.t + wc * c.t;
}

/// Sets v_ to the corners of a face of the boundary; false when the line does not cross it.
bool TetWalk::enter(uint32_t face, double& t) {
  for (size_t k = 0; k < 3; ++k) v_[k] = corner(mesh_.boundary[face].v[k]);
  const bool ab = left(v_[0], v_[1]), bc = left(v_[1], v_[2]), ca = left(v_[2], v_[0]);
  if (ab != bc || bc != ca) return false;
  if (!ab) std::swap(v_[1], v_[2]);
  t = interpolate(f_);
  return true;
}

void TetWalk::start(Vec3 origin, Vec3 direction, double to) {
  origin_ = origin - mesh_.origin, direction_ = direction, to_ = to, tet_ = -1;
  const Vec3 m(std::abs(direction.x), std::abs(direction.y), std::abs(direction.z));
  const Vec3 axis = m.x <= m.y && m.x <= m.z ? Vec3(1, 0, 0) : m.y <= m.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  across_[0] = normalize(cross(direction, axis)), across_[1] = cross(direction, across_[0]);
  hits_.clear();
  mesh_.tree->along_ray(origin, direction, -HUGE_VAL, to, [&](uint32_t face) {
    if (double t; enter(face, t)) hits_.push_back({t, face, false});
    return to;
  });
  std::sort(hits_.begin(), hits_.end(), [](const Hit& a, const Hit& b) { return a.t < b.t || (a.t == b.t && a.face < b.face); });
  entry_ = hits_.empty() ? HUGE_VAL : hits_.front().t;
}

bool TetWalk::begin_path() {
  for (Hit& h : hits_) {
    if (h.t >= to_) return false;
    if (h.used) continue;
    h.used = true;
    enter(h.face, t_);
    tet_ = int32_t(mesh_.boundary[h.face].tet), steps_ = 0;
    return true;
  }
  return false;
}

void TetWalk::end_path(uint32_t tet, uint32_t apex) {
  for (Hit& h : hits_)
    if (mesh_.boundary[h.face].tet == tet && mesh_.boundary[h.face].apex == apex) h.used = true;
}

bool TetWalk::next(Piece& piece) {
  if (tet_ < 0 && !begin_path()) return false;
  const TetLink& link = mesh_.links[size_t(tet_)];
  const Corner d = corner(link.all ^ v_[0].id ^ v_[1].id ^ v_[2].id);
  // In which third around the line does the way back from d lie? The corner opposite to it is left behind.
  const bool a = left(d, v_[0]), b = left(d, v_[1]), c = left(d, v_[2]);
  Corner& out = v_[a && !b ? 2 : b && !c ? 0 : c && !a ? 1 : 0];
  const uint32_t gone = out.id;
  out = d;
  int rank = d.id < gone;
  for (const Corner& v : v_) rank += &v != &out && v.id < gone;
  piece = {t_, 0, f_, 0, uint32_t(tet_)};
  t_ = piece.to = interpolate(f_);
  piece.leave = f_;
  const int32_t next = link.next[rank];
  if (next < 0 || ++steps_ > mesh_.size()) {
    end_path(uint32_t(tet_), gone);
    tet_ = -1;
  } else if (t_ >= to_ && piece.from < t_) {
    tet_ = -1, hits_.clear();  // in front of what is left nothing is asked for
  } else {
    tet_ = next;
  }
  return true;
}

}  // namespace sg::volume
