// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/zeros/cell_zeros.h"

#include <algorithm>

#include "data/cells/cell_topology.h"

namespace sg {

CellZeros::CellZeros(const FlowField& flow, const PlaneFrame* frame, double min_speed)
    : flow_(flow), frame_(frame), min_speed_(min_speed), map_(flow.dataset()) {}
CellZeros::~CellZeros() = default;

BernsteinBasis& CellZeros::basis_of(const CellShape& shape) {
  for (const auto& b : bases_)
    if (&b->shape() == &shape) return *b;
  return *bases_.emplace_back(std::make_unique<BernsteinBasis>(shape));
}

CellZeros::Result CellZeros::find(size_t cell, std::vector<CellZero>& out) {
  if (map_.reader().hidden(cell)) return Result::none;
  map_.open(cell);
  if (map_.dimension() != (frame_ ? 2 : 3)) return Result::none;
  const auto ids = map_.reader().ids();
  const size_t n = ids.size();
  v_.resize(n), zero_.resize(n);
  bool all = true, some = false;
  double fastest = 0;
  for (size_t k = 0; k < n; ++k) {
    const Vec3 v = flow_.at_point(size_t(ids[k]));
    if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) return Result::none;
    v_[k] = frame_ ? Vec3(dot(v, frame_->e1), dot(v, frame_->e2), 0) : v;
    zero_[k] = v_[k] == Vec3();
    fastest = std::max(fastest, length(v));
    all = all && zero_[k], some = some || zero_[k];
  }
  if (fastest < min_speed_) return Result::none;
  if (all) {
    spread_.insert(spread_.end(), ids.begin(), ids.end());
    return Result::spread;
  }
  const size_t before = out.size();
  const Result result = find_open(some, out);
  for (size_t i = before; i < out.size(); ++i) out[i].speed = fastest;
  return result;
}

// In the open cell; `some`: of its points are at rest.
CellZeros::Result CellZeros::find_open(bool some, std::vector<CellZero>& out) {
  const size_t n = v_.size();
  known_.clear();
  Result result = Result::isolated;
  if (some && zero_edges(result)) return result;
  const CellType type = map_.reader().type();
  if (type == CellType::triangle || type == CellType::tetra) return find_linear(out);
  if (type == CellType::pixel || type == CellType::quad) return find_bilinear(out);
  if (type == CellType::triangle_strip) return find_strip(out);
  if (const CellShape* shape = CellShape::find(type, n, map_.reader().orders())) return find_polynomial(*shape, out);
  return find_sampled(out);
}

// Edges whose ends both are zero: of a linear cell they are lines of zeros. True when no isolated zero is to be expected next to them.
bool CellZeros::zero_edges(Result& result) {
  const CellType type = map_.reader().type();
  const LinearTopology* t = linear_topology(linear_type(type));
  if (!t) return zero_sides(result);
  const auto ids = map_.reader().ids();
  const CellShape* shape = CellShape::find(type, ids.size(), map_.reader().orders());
  for (const auto& e : t->edges) {
    if (!zero_[e[0]] || !zero_[e[1]]) continue;
    spread_.push_back(ids[e[0]]), spread_.push_back(ids[e[1]]);
    result = Result::spread;
    if (shape && shape->base() != CellType::pyramid) known_.push_back({shape->node(e[0]), shape->node(e[1])});
  }
  if (known_.empty() || is_high_order(type)) return false;
  if (t->face_count() == 0) return true;
  // A factor of a face with zeros vanishes at all its points; what is left of a trilinear function has as many unknowns less.
  for (size_t f = 0; f < t->face_count(); ++f) {
    const auto face = t->face(f);
    if (std::all_of(face.begin(), face.end(), [&](uint8_t k) { return zero_[k] != 0; })) return true;
  }
  return type == CellType::tetra;
}

void CellZeros::add(Vec3 rst, double outside, std::vector<CellZero>& out) {
  CellZero z;
  z.rst = rst;
  z.at = map_.position(rst);
  z.border = outside > -CellZero::on_border;
  Box3 box;
  for (const Vec3 p : map_.reader().at()) box.add(p);
  z.size = box.diagonal();
  CellPlace place;
  place.rst = rst, place.nearest = z.at;
  slopes_.resize(v_.size());
  map_.gradient_weights(place, slopes_);
  const auto ids = map_.reader().ids();
  for (auto& row : z.gradient.m)
    for (double& e : row) e = 0;
  for (size_t k = 0; k < ids.size(); ++k) {
    const Vec3 u = flow_.at_point(size_t(ids[k]));
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) z.gradient.m[a][b] += u[a] * slopes_[k][b];
    if (zero_[k] && length(map_.reader().at()[k] - z.at) < 1e-7 * z.size) z.node = ids[k];
  }
  for (const auto& row : z.gradient.m)
    for (const double e : row)
      if (!std::isfinite(e)) return;  // a cell without extent
  out.push_back(z);
}

CellZeros::Result CellZeros::find_linear(std::vector<CellZero>& out) {
  const Vec3 a = v_[0], b = v_[1] - a, c = v_[2] - a;
  if (v_.size() == 3) {
    const double det = b.x * c.y - b.y * c.x;
    if (!(std::abs(det) > 1e-14 * length(b) * length(c))) return Result::none;  // parallel: lines of zeros, or none
    const double r = (-a.x * c.y + a.y * c.x) / det, s = (-b.x * a.y + b.y * a.x) / det, outside = std::max({-r, -s, r + s - 1});
    if (!(outside <= zero_margin)) return Result::none;
    add({r, s, 0}, outside, out);
    return Result::isolated;
  }
  const Vec3 d = v_[3] - a, cd = cross(c, d);
  const double det = dot(b, cd);
  if (!(std::abs(det) > 1e-14 * length(b) * length(c) * length(d))) return Result::none;
  const Vec3 rst(-dot(a, cd) / det, -dot(b, cross(a, d)) / det, -dot(b, cross(c, a)) / det);
  const double outside = std::max({-rst.x, -rst.y, -rst.z, rst.x + rst.y + rst.z - 1});
  if (!(outside <= zero_margin)) return Result::none;
  add(rst, outside, out);
  return Result::isolated;
}

// v = (a + b r) + (c + d r) s: where both brackets are parallel, a quadratic equation of r.
CellZeros::Result CellZeros::find_bilinear(std::vector<CellZero>& out) {
  const bool pixel = map_.reader().type() == CellType::pixel;
  const Vec3 a = v_[0], b = v_[1] - a, c = v_[pixel ? 2 : 3] - a, d = v_[pixel ? 3 : 2] - a - b - c;
  auto turn = [](Vec3 p, Vec3 q) { return p.x * q.y - p.y * q.x; };
  double largest = 0;
  for (const Vec3 p : {a, b, c, d}) largest = std::max(largest, length(p));
  const double noise = 1e-14 * largest * largest;
  // Unknown s eliminated, or, where that leaves nothing, r.
  Vec3 bb = b, cc = c;
  double q2 = turn(b, d), q1 = turn(a, d) + turn(b, c), q0 = turn(a, c);
  const bool swapped = std::abs(q2) <= noise && std::abs(q1) <= noise && std::abs(q0) <= noise;
  if (swapped) {
    std::swap(bb, cc);
    q2 = turn(bb, d), q1 = turn(a, d) + turn(bb, cc), q0 = turn(a, cc);
    if (std::abs(q2) <= noise && std::abs(q1) <= noise && std::abs(q0) <= noise) return Result::spread;
  }
  double roots[2];
  int n = 0;
  if (std::abs(q2) <= 1e-14 * (std::abs(q1) + std::abs(q0))) {
    if (q1 != 0) roots[n++] = -q0 / q1;
  } else {
    double square = q1 * q1 - 4 * q0 * q2;
    if (square < 0 && square > -1e-14 * (q1 * q1 + std::abs(4 * q0 * q2))) square = 0;
    if (square >= 0) {
      const double big = -0.5 * (q1 + std::copysign(std::sqrt(square), q1));
      roots[n++] = big / q2;
      if (square > 0 && big != 0) roots[n++] = q0 / big;
    }
  }
  const size_t before = out.size();
  for (int k = 0; k < n; ++k) {
    Vec3 u(roots[k], 0, 0);
    const Vec3 top = a + bb * u.x, slope = cc + d * u.x;
    if (!(dot(slope, slope) > 0)) continue;
    u.y = -dot(top, slope) / dot(slope, slope);
    // Newton's method takes out what the square root has lost.
    for (int round = 0; round < 2; ++round) {
      const Vec3 f = a + bb * u.x + cc * u.y + d * (u.x * u.y), fr = bb + d * u.y, fs = cc + d * u.x;
      const double det = turn(fr, fs);
      if (!(std::abs(det) > 1e-9 * length(fr) * length(fs))) break;
      u.x -= turn(f, fs) / det, u.y -= turn(fr, f) / det;
    }
    if (swapped) std::swap(u.x, u.y);
    const double outside = std::max({-u.x, -u.y, u.x - 1, u.y - 1});
    if (outside <= zero_margin) add(u, outside, out);
  }
  return out.size() > before ? Result::isolated : Result::none;
}

CellZeros::Result CellZeros::find_polynomial(const CellShape& shape, std::vector<CellZero>& out) {
  BernsteinBasis& basis = basis_of(shape);
  basis.set(v_, map_.reader().weights());
  found_.clear();
  // Of a linear pyramid whose apex is zero, all other zeros would lie on lines from there.
  const bool apex = basis.pyramid() && zero_[4];
  if (apex) basis.take_out_apex();
  const bool isolated = (apex && !is_high_order(shape.type())) || basis.solve(found_, known_);
  for (const Vec3 u : found_) {
    const Vec3 rst = basis.reference(u);
    add(rst, shape.outside(rst), out);
  }
  if (apex) {
    found_.push_back({0.5, 0.5, 1});
    const Vec3 rst(0.5, 0.5, 1 - 1e-9);
    add(rst, std::max(shape.outside(rst), 0.0), out);
  }
  return !isolated || !known_.empty() ? Result::spread : found_.empty() ? Result::none : Result::isolated;
}

CellZeros::Result CellZeros::find_strip(std::vector<CellZero>& out) {
  const auto at = map_.reader().at();
  const auto ids = map_.reader().ids();
  const size_t before = out.size();
  for (size_t k = 0; k + 2 < ids.size(); ++k) {
    const Vec3 a = v_[k], b = v_[k + 1] - a, c = v_[k + 2] - a;
    const double det = b.x * c.y - b.y * c.x;
    if (!(std::abs(det) > 1e-14 * length(b) * length(c))) continue;
    const double r = (-a.x * c.y + a.y * c.x) / det, s = (-b.x * a.y + b.y * a.x) / det;
    if (!(std::max({-r, -s, r + s - 1}) <= zero_margin)) continue;
    CellZero z;
    const Vec3 u = at[k + 1] - at[k], w = at[k + 2] - at[k], normal = cross(u, w);
    const double area2 = dot(normal, normal);
    if (!(area2 > 0)) continue;
    z.at = at[k] + r * u + s * w;
    z.border = true;
    z.size = std::max({length(u), length(w), length(u - w)});
    const Vec3 gu = cross(w, normal) / area2, gw = cross(normal, u) / area2;
    const Vec3 va = flow_.at_point(size_t(ids[k])), vb = flow_.at_point(size_t(ids[k + 1])) - va,
               vc = flow_.at_point(size_t(ids[k + 2])) - va;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) z.gradient.m[i][j] = vb[i] * gu[j] + vc[i] * gw[j];
    for (size_t j = k; j < k + 3; ++j)
      if (zero_[j] && length(at[j] - z.at) < 1e-7 * z.size) z.node = ids[j];
    // One on a side between two triangles is found by both.
    if (std::none_of(out.begin() + ptrdiff_t(before), out.end(), [&](const CellZero& o) { return length(o.at - z.at) < 1e-7 * z.size; }))
      out.push_back(z);
  }
  return out.size() > before ? Result::isolated : Result::none;
}

}  // namespace sg
