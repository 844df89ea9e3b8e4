// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/cell_value.h"

#include "data/cells/shape/cell_inverse.h"

namespace sg::volume {

namespace {

constexpr int most_halvings = 5;
// Corner k of a hexahedron lies at the reference place of these bits (x, y, z).
constexpr int hexahedron_bits[8] = {0, 1, 3, 2, 4, 5, 7, 6};

double trilinear(const std::vector<double>& f, Vec3 r) {
  const double x0 = f[0] + r.x * (f[1] - f[0]), x1 = f[3] + r.x * (f[2] - f[3]);
  const double x2 = f[4] + r.x * (f[5] - f[4]), x3 = f[7] + r.x * (f[6] - f[7]);
  const double y0 = x0 + r.y * (x1 - x0), y1 = x2 + r.y * (x3 - x2);
  return y0 + r.z * (y1 - y0);
}

void trilinear_frame(const std::vector<Vec3>& p, Vec3 r, Vec3& at, Vec3 column[3]) {
  const Vec3 e0 = p[1] - p[0], e1 = p[2] - p[3], e2 = p[5] - p[4], e3 = p[6] - p[7];
  const Vec3 x0 = p[0] + e0 * r.x, x1 = p[3] + e1 * r.x, x2 = p[4] + e2 * r.x, x3 = p[7] + e3 * r.x;
  const Vec3 y0 = x0 + (x1 - x0) * r.y, y1 = x2 + (x3 - x2) * r.y;
  at = y0 + (y1 - y0) * r.z;
  const Vec3 d0 = e0 + (e1 - e0) * r.y, d1 = e2 + (e3 - e2) * r.y;
  column[0] = d0 + (d1 - d0) * r.z;
  column[1] = (x1 - x0) + ((x3 - x2) - (x1 - x0)) * r.z;
  column[2] = y1 - y0;
}

}  // namespace

CellCurve::CellCurve(const CellVolume& volume) : volume_(volume), map_(volume.curved ? volume.curved : volume.data), reader_(volume.data) {}

void CellCurve::open(uint32_t cell, float& lowest, float& highest) {
  if (cell != cell_) {
    cell_ = cell;
    map_.open(cell);
    const CellReader& reader = map_.reader();
    const auto ids = reader.ids();
    const auto at = reader.at();
    const size_t n = ids.size();
    at_.resize(n), dn_.resize(n), f_.resize(n), n_.resize(n);
    lowest_ = HUGE_VALF, highest_ = -HUGE_VALF;
    const std::span<const float> values = volume_.curved ? volume_.curved_values : volume_.values;
    const bool voxel = reader.type() == CellType::voxel;
    Box3 box;
    for (size_t k = 0; k < n; ++k) {
      const size_t from = voxel ? size_t(hexahedron_bits[k]) : k;
      at_[k] = at[from] - volume_.mesh->origin;
      const float f = values[size_t(ids[from])];
      f_[k] = double(f);
      lowest_ = std::min(lowest_, f), highest_ = std::max(highest_, f);
      box.add(at_[k]);
    }
    size_ = box.diagonal();
    shape_ = nullptr;
    affine_ = cubic_ = false;
    if (voxel || reader.type() == CellType::hexahedron) {
      kind_ = Kind::hexahedron;
      const Vec3 a = at_[1] - at_[0], b = at_[3] - at_[0], c = at_[4] - at_[0];
      const Vec3 off[4] = {at_[2] - at_[0] - a - b, at_[5] - at_[0] - a - c, at_[7] - at_[0] - b - c, at_[6] - at_[0] - a - b - c};
      double most = 0;
      for (Vec3 o : off) most = std::max(most, length(o));
      const double volume = dot(a, cross(b, c));
      if (most <= 1e-6 * size_ && std::abs(volume) > 0) {
        kind_ = Kind::box;
        rows_[0] = cross(b, c) / volume, rows_[1] = cross(c, a) / volume, rows_[2] = cross(a, b) / volume;
      }
    } else if (!(shape_ = CellShape::find(reader.type(), n, reader.orders()))) {  // polyhedra and prisms of five and six sides
      kind_ = Kind::polyhedron;
      if (volume_.leaves) reader_.open(cell);
      if (volume_.leaves && leaf_.open(
                                at_, f_, [&] { return reader_.face_count(); }, [&](size_t k) { return reader_.face(k); }))
        kind_ = Kind::leaf;
    } else {
      kind_ = Kind::shape;
      weights_.assign(reader.weights().begin(), reader.weights().end());
      affine_ = open_affine();
      // Functions of curved cells reach beyond their nodes.
      if (is_high_order(reader.type())) lowest_ = -3e38f, highest_ = 3e38f;
    }
  }
  guess_ = shape_ ? shape_->center() : Vec3(0.5, 0.5, 0.5);
  lowest = lowest_, highest = highest_;
}

/// Whether every node is where an affine map of the reference element puts it; then there is nothing to search.
bool CellCurve::open_affine() {
  cubic_ = false;
  const size_t n = at_.size();
  // Four nodes that span the element: those of a tetrahedron, base and next to the first above it.
  const size_t third = shape_->base() == CellType::tetra || shape_->base() == CellType::wedge ? 2 : 3;
  size_t up = 3;
  if (shape_->base() != CellType::tetra) {
    for (up = 1; up < n && !(shape_->node(up).z > 0.5); ++up) {
    }
    if (up == n) return false;
  }
  const Vec3 r0 = shape_->node(0), dr[3] = {shape_->node(1) - r0, shape_->node(third) - r0, shape_->node(up) - r0};
  const Vec3 dx[3] = {at_[1] - at_[0], at_[third] - at_[0], at_[up] - at_[0]};
  const double volume = dot(dx[0], cross(dx[1], dx[2]));
  if (!(std::abs(volume) > 0) || !weights_.empty()) return false;
  const Vec3 inverse[3] = {cross(dx[1], dx[2]) / volume, cross(dx[2], dx[0]) / volume, cross(dx[0], dx[1]) / volume};
  for (int a = 0; a < 3; ++a) rows_[a] = inverse[0] * dr[0][a] + inverse[1] * dr[1][a] + inverse[2] * dr[2][a];
  first_ = r0;
  for (size_t k = 0; k < n; ++k) {
    const Vec3 p = at_[k] - at_[0], r = first_ + Vec3(dot(rows_[0], p), dot(rows_[1], p), dot(rows_[2], p));
    if (!(length(r - shape_->node(k)) < 1e-6)) return false;
  }
  const auto orders = shape_->orders();
  const int most = std::max({orders[0], orders[1], orders[2]});
  cubic_ =
      most == 1 ? shape_->base() == CellType::wedge || shape_->base() == CellType::tetra : shape_->base() == CellType::tetra && most <= 3;
  return true;
}

/// Newton's method from the last place found.
bool CellCurve::invert(Vec3 at) {
  if (affine_) {
    const Vec3 p = at - at_[0];
    guess_ = first_ + Vec3(dot(rows_[0], p), dot(rows_[1], p), dot(rows_[2], p));
    return true;
  }
  for (int attempt = 0; attempt < 2; ++attempt) {
    Vec3 r = guess_;
    for (int i = 0; i < 12; ++i) {
      Vec3 x, column[3], step;
      if (shape_) {
        const CellGeometry geometry{shape_, at_, weights_, n_.data(), dn_.data()};
        geometry.functions(r);
        x = column[0] = column[1] = column[2] = Vec3();
        for (size_t k = 0; k < at_.size(); ++k) {
          x += at_[k] * n_[k];
          column[0] += at_[k] * dn_[k].x, column[1] += at_[k] * dn_[k].y, column[2] += at_[k] * dn_[k].z;
        }
      } else {
        trilinear_frame(at_, r, x, column);
      }
      if (!solve_columns(column, at - x, step)) break;
      r += step;
      if (!(dot(r, r) < 100)) break;
      if (dot(step, step) < 1e-14) {
        guess_ = r;
        // A face of straight triangles in place of a twisted one lets a place lie a little outside.
        const double out = shape_ ? shape_->outside(r) : std::max({-r.x, -r.y, -r.z, r.x - 1, r.y - 1, r.z - 1});
        return out < 0.5;
      }
    }
    guess_ = shape_ ? shape_->center() : Vec3(0.5, 0.5, 0.5);
  }
  return false;
}

float CellCurve::value(Vec3 at) {
  double f = 0;
  if (kind_ == Kind::box) {
    const Vec3 p = at - at_[0];
    f = trilinear(f_, {dot(rows_[0], p), dot(rows_[1], p), dot(rows_[2], p)});
  } else if (kind_ == Kind::leaf) {
    f = leaf_.value(at);
  } else if (kind_ == Kind::polyhedron) {
    CellPlace place;
    place.nearest = at + volume_.mesh->origin;
    map_.weights(place, n_);
    for (size_t k = 0; k < f_.size(); ++k) f += n_[k] * f_[k];
  } else if (invert(at)) {
    if (shape_) {
      const CellGeometry geometry{shape_, at_, weights_, n_.data(), dn_.data()};
      geometry.values(guess_);
      for (size_t k = 0; k < f_.size(); ++k) f += n_[k] * f_[k];
    } else {
      f = trilinear(f_, guess_);
    }
  } else {
    // A cell that is folded there: near the corners by their distance.
    double sum = 0;
    for (size_t k = 0; k < f_.size(); ++k) {
      const Vec3 d = at - at_[k];
      const double w = 1 / (dot(d, d) + 1e-12 * size_ * size_);
      f += w * f_[k], sum += w;
    }
    f /= sum;
  }
  return std::min(std::max(float(f), lowest_), highest_);
}

void CellCurve::fit(Vec3 x, Vec3 d, double from, double to, const float ends[2], int depth, uint64_t mark, std::vector<Stretch>& out) {
  const auto at = [&](double s) { return value(x + d * (from + s * (to - from))); };
  const float v[4] = {ends[0], at(1.0 / 3), at(2.0 / 3), ends[1]};
  Stretch s{from, to, {}, mark};
  bernstein_from_thirds(v, s.b);
  if (kind_ != Kind::box && kind_ != Kind::leaf && !cubic_ && depth < most_halvings) {
    const float middle = at(0.5), half[3] = {ends[0], middle, ends[1]};
    const auto wrong = [&](double part, float f) { return !(std::abs(s.value(from + part * (to - from)) - f) <= volume_.fit_error); };
    if (wrong(0.5, middle) || wrong(1.0 / 6, at(1.0 / 6)) || wrong(5.0 / 6, at(5.0 / 6))) {
      const double between = 0.5 * (from + to);
      if (between > from && between < to) {
        fit(x, d, from, between, half, depth + 1, mark, out);
        return fit(x, d, between, to, half + 1, depth + 1, mark, out);
      }
    }
  }
  out.push_back(s);
}

void CellCurve::add(Vec3 x, Vec3 d, double from, double to, uint64_t mark, std::vector<Stretch>& out) {
  float ends[2] = {value(x + d * from), 0};
  if (kind_ == Kind::leaf) {
    leaf_.cuts(x, d, from, to, cuts_);
    for (double t : cuts_) {
      ends[1] = value(x + d * t);
      fit(x, d, from, t, ends, 0, mark, out);
      from = t, ends[0] = ends[1];
    }
  }
  ends[1] = value(x + d * to);
  fit(x, d, from, to, ends, 0, mark, out);
}

}  // namespace sg::volume
