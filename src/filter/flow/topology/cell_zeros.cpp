// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/cell_zeros.h"

#include <algorithm>

#include "data/cell_topology.h"

namespace sg {

namespace {

constexpr double border = 1e-9;     // zeros that far out are in the cell: neighbours may both miss them by rounding
constexpr double on_border = 1e-6;  // zeros that near to the border may be another cell's too

}  // namespace

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
  bool all = true, some = false, slow = true;
  for (size_t k = 0; k < n; ++k) {
    const Vec3 v = flow_.at_point(size_t(ids[k]));
    if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z))) return Result::none;
    v_[k] = frame_ ? Vec3(dot(v, frame_->e1), dot(v, frame_->e2), 0) : v;
    zero_[k] = v_[k] == Vec3();
    slow = slow && length(v) < min_speed_;
    all = all && zero_[k], some = some || zero_[k];
  }
  if (slow) return Result::none;
  if (all) {
    spread_.insert(spread_.end(), ids.begin(), ids.end());
    return Result::spread;
  }
  known_.clear();
  Result result = Result::isolated;
  if (some && zero_edges(result)) return result;
  const CellType type = map_.reader().type();
  if (type == CellType::triangle || type == CellType::tetra) return find_linear(out);
  if (type == CellType::pixel || type == CellType::quad) return find_bilinear(out);
  if (type == CellType::triangle_strip) return find_strip(out);
  if (const CellShape* shape = CellShape::find(type, n, map_.reader().orders())) return find_polynomial(*shape, out);
  find_by_newton(out);
  return result;
}

// Edges whose ends both are zero: of a linear cell they are lines of zeros. True when no isolated zero is to be expected beside them.
bool CellZeros::zero_edges(Result& result) {
  const CellType type = map_.reader().type();
  const LinearTopology* t = linear_topology(linear_type(type));
  if (!t) return false;
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
  z.border = outside > -on_border;
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
    if (!(outside <= border)) return Result::none;
    add({r, s, 0}, outside, out);
    return Result::isolated;
  }
  const Vec3 d = v_[3] - a, cd = cross(c, d);
  const double det = dot(b, cd);
  if (!(std::abs(det) > 1e-14 * length(b) * length(c) * length(d))) return Result::none;
  const Vec3 rst(-dot(a, cd) / det, -dot(b, cross(a, d)) / det, -dot(b, cross(c, a)) / det);
  const double outside = std::max({-rst.x, -rst.y, -rst.z, rst.x + rst.y + rst.z - 1});
  if (!(outside <= border)) return Result::none;
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
    if (outside <= border) add(u, outside, out);
  }
  return out.size() > before ? Result::isolated : Result::none;
}

CellZeros::Result CellZeros::find_polynomial(const CellShape& shape, std::vector<CellZero>& out) {
  BernsteinBasis& basis = basis_of(shape);
  basis.set(v_, map_.reader().weights());
  found_.clear();
  // Of a pyramid whose apex is zero, all other zeros would lie on lines from there.
  const bool apex = basis.pyramid() && !is_high_order(shape.type()) && zero_[4];
  if (apex) found_.push_back({0.5, 0.5, 1});
  const bool isolated = apex || basis.solve(found_, known_);
  for (const Vec3 u : found_) {
    const Vec3 rst = apex ? Vec3(0.5, 0.5, 1 - 1e-9) : basis.reference(u);
    add(rst, std::max(shape.outside(rst), apex ? 0.0 : -HUGE_VAL), out);
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
    if (!(std::max({-r, -s, r + s - 1}) <= border)) continue;
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
    out.push_back(z);
  }
  return out.size() > before ? Result::isolated : Result::none;
}

bool CellZeros::at_place(Vec3 x, Vec3& v) {
  CellPlace place;
  place.nearest = x;
  weights_.resize(v_.size());
  map_.weights(place, weights_);
  v = {};
  for (size_t k = 0; k < v_.size(); ++k) v += weights_[k] * v_[k];
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Newton's method with differences; `gradient` that of the last step, in the frame's components or in space.
bool CellZeros::newton_from(Vec3 x, Vec3& found, Mat3& gradient) {
  const auto at = map_.reader().at();
  Box3 box;
  for (const Vec3 p : at) box.add(p);
  const double size = box.diagonal(), h = 1e-5 * size;
  const Vec3 axis[3] = {frame_ ? frame_->e1 : Vec3(1, 0, 0), frame_ ? frame_->e2 : Vec3(0, 1, 0), frame_ ? frame_->normal : Vec3(0, 0, 1)};
  double largest = 0;
  for (const Vec3 v : v_) largest = std::max(largest, length(v));
  for (int round = 0; round < 30; ++round) {
    Vec3 v, slope[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (!at_place(x, v)) return false;
    for (int a = 0; a < (frame_ ? 2 : 3); ++a) {
      Vec3 up, down;
      if (!at_place(x + h * axis[a], up) || !at_place(x - h * axis[a], down)) return false;
      slope[a] = (up - down) / (2 * h);
    }
    const Vec3 cd = cross(slope[1], slope[2]);
    const double det = dot(slope[0], cd);
    if (!(std::abs(det) > 1e-12 * length(slope[0]) * length(slope[1]) * length(slope[2]))) return false;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) gradient.m[i][j] = slope[j][i];
    const Vec3 move(-dot(v, cd) / det, -dot(slope[0], cross(v, slope[2])) / det, -dot(slope[0], cross(slope[1], v)) / det);
    const double far = length(move);
    Vec3 step = move.x * axis[0] + move.y * axis[1] + (frame_ ? Vec3() : move.z * axis[2]);
    if (far > 0.5 * size) step *= 0.5 * size / far;
    x += step;
    if (!(length(x - box.center()) < size)) return false;
    if (far < 1e-12 * size) {
      found = x;
      Vec3 rest;
      return at_place(x, rest) && length(rest) < 1e-9 * largest;
    }
  }
  return false;
}

void CellZeros::find_by_newton(std::vector<CellZero>& out) {
  const auto at = map_.reader().at();
  const auto ids = map_.reader().ids();
  Box3 box;
  Vec3 middle;
  for (const Vec3 p : at) box.add(p), middle += p / double(at.size());
  std::vector<Vec3> starts{middle};
  for (size_t k = 0; k < at.size(); ++k) starts.push_back(0.4 * middle + 0.6 * at[k]);
  const size_t before = out.size();
  auto keep = [&](CellZero z) {
    for (size_t i = before; i < out.size(); ++i)
      if (length(out[i].at - z.at) < 1e-7 * z.size) return;
    out.push_back(z);
  };
  CellZero z;
  z.size = box.diagonal();
  for (const Vec3 start : starts) {
    Mat3 g;
    if (!newton_from(start, z.at, g)) continue;
    CellPlace place;
    if (!map_.locate(z.at, place, 1e-7)) continue;
    z.border = place.outside > -on_border || frame_;
    // Rows back from the frame: dv/dx = sum of axis_i g_ij axis_j.
    z.gradient = g;
    if (frame_) {
      const Vec3 axis[2] = {frame_->e1, frame_->e2};
      for (auto& row : z.gradient.m)
        for (double& e : row) e = 0;
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j)
          for (int p = 0; p < 3; ++p)
            for (int q = 0; q < 3; ++q) z.gradient.m[p][q] += axis[i][p] * g.m[i][j] * axis[j][q];
    }
    z.node = -1;
    for (size_t k = 0; k < at.size(); ++k)
      if (zero_[k] && length(at[k] - z.at) < 1e-7 * z.size) z.node = ids[k];
    keep(z);
  }
  // At a corner the weights are quotients of zeros, and Newton's method does not get there: the gradient of the cell's best fit.
  for (size_t k = 0; k < at.size(); ++k) {
    if (!zero_[k]) continue;
    z.at = at[k], z.node = ids[k], z.border = true;
    CellPlace place;
    place.nearest = at[k];
    slopes_.resize(v_.size());
    map_.gradient_weights(place, slopes_);
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q) {
        z.gradient.m[p][q] = 0;
        for (size_t i = 0; i < ids.size(); ++i) z.gradient.m[p][q] += flow_.at_point(size_t(ids[i]))[p] * slopes_[i][q];
      }
    keep(z);
  }
}

}  // namespace sg
