// SPDX-License-Identifier: Apache-2.0
// Opening a cell, its forward map, and where a point lies in it.
#include "data/cells/shape/cell_map.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/cells/shape/cell_map_geometry.h"
#include "data/cells/shape/mean_value.h"

namespace sg {

void CellMap::open(size_t cell) {
  reader_.open(cell);
  triangles_known_ = false;
  const CellType type = reader_.type();
  const size_t nodes = reader_.ids().size();
  if (type < CellType::lagrange_curve) {
    FixedShape& fixed = fixed_shapes_[size_t(type)];
    if (!fixed.known) fixed = {true, cell_type_info(type).points >= 0 ? CellShape::find(type, nodes) : nullptr};
    shape_ = fixed.shape;
  } else if (!shape_ || shape_->type() != type || shape_->nodes() != nodes || orders_ != reader_.orders()) {
    orders_ = reader_.orders();
    shape_ = CellShape::find(type, nodes, orders_);
    if (!shape_) {
      const bool pyramid = linear_type(type) == CellType::pyramid;
      fail_data(fmt::format("cell {} is a {} of {} points", cell, cell_type_info(type).name, nodes), {},
                pyramid ? "pyramids have 5, 13, 14 or 19 points (Bezier pyramids 5)" : "that count does not fit any order from 1 to 10");
    }
  }
  if (shape_ && n_.size() < nodes) n_.resize(nodes), dn_.resize(nodes);
}

Vec3 CellMap::position(Vec3 rst) const { return Geometry(*this).position(rst); }

Mat3 CellMap::jacobian(Vec3 rst) const {
  Vec3 column[3];
  Geometry(*this).frame(rst, column);
  Mat3 j;
  for (int a = 0; a < 3; ++a)
    for (int c = 0; c < 3; ++c) j.m[a][c] = column[c][a];
  return j;
}

Vec3 CellMap::center() const {
  if (shape_) return position(shape_->center());
  Vec3 sum;
  for (Vec3 p : reader_.at()) sum += p;
  return sum / double(std::max<size_t>(reader_.at().size(), 1));
}

double CellMap::size() const { return reader_.box().diagonal(); }

namespace {

// What the doubles of a place far from zero leave uncertain, in units of a cell of that size.
double rounding(Vec3 x, double size) {
  const double far = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)});
  return size > 0 ? 4 * std::numeric_limits<double>::epsilon() * far / size : 0;
}

}  // namespace

bool CellMap::locate_tetra(Vec3 x, CellPlace& place, double tolerance) const {
  const Vec3* p = reader_.at().data();
  const Vec3 column[3] = {p[1] - p[0], p[2] - p[0], p[3] - p[0]};
  if (!solve_columns(column, x - p[0], place.rst)) {
    place.rst = shape_->center();
    place.outside = HUGE_VAL;
    return false;
  }
  const Vec3 r = place.rst;
  place.outside = std::max(std::max(-r.x, -r.y), std::max(-r.z, r.x + r.y + r.z - 1));
  return place.outside <= tolerance;
}

// Pixels and voxels with straight parallel sides, in any direction: three dot products, or three equations when they are skew.
bool CellMap::locate_box(Vec3 x, CellPlace& place, double tolerance, bool& affine) const {
  const Vec3* p = reader_.at().data();
  const Vec3 side[3] = {p[1] - p[0], p[2] - p[0], p[4] - p[0]}, d = x - p[0];
  const Vec3 last = p[0] + side[0] + side[1] + side[2] - p[7], middle = p[0] + side[1] + side[2] - p[6];
  const double l[3] = {dot(side[0], side[0]), dot(side[1], side[1]), dot(side[2], side[2])};
  const double small = 1e-24 * (l[0] + l[1] + l[2]) + 1e-30 * dot(p[0], p[0]);
  affine = dot(last, last) <= small && dot(middle, middle) <= small;
  if (!affine) return false;
  const double xy = dot(side[0], side[1]), yz = dot(side[1], side[2]), xz = dot(side[0], side[2]);
  if (xy * xy <= 1e-28 * l[0] * l[1] && yz * yz <= 1e-28 * l[1] * l[2] && xz * xz <= 1e-28 * l[0] * l[2])
    place.rst = {dot(d, side[0]) / l[0], dot(d, side[1]) / l[1], dot(d, side[2]) / l[2]};
  else if (!solve_columns(side, d, place.rst)) place.rst = {HUGE_VAL, 0, 0};
  place.outside = shape_->outside(place.rst);
  return place.outside <= tolerance;
}

bool CellMap::locate_solid(Vec3 x, CellPlace& place, double tolerance) {
  auto inside = [&] {
    place.nearest = x, place.distance2 = 0;
    return true;
  };
  bool solved = false;
  if (shape_->nodes() == 4) {
    solved = true;
    if (locate_tetra(x, place, tolerance)) return inside();
  } else if (shape_->type() == CellType::voxel) {
    if (locate_box(x, place, tolerance, solved)) return inside();
  }
  // Near misses only: rounding far from zero must not open cracks between cells.
  const double eased = solved && place.outside > 1e-3 ? tolerance : tolerance + rounding(x, size());
  if (!solved) {
    const InverseResult r = invert_solid(Geometry(*this), x, eased);
    place.rst = r.rst;
    place.outside = r.found ? r.outside : HUGE_VAL;
  }
  if (place.outside <= eased) return inside();
  const Vec3 q = shape_->clamped(place.rst), *p = reader_.at().data();
  place.nearest = shape_->nodes() == 4 ? p[0] + (p[1] - p[0]) * q.x + (p[2] - p[0]) * q.y + (p[3] - p[0]) * q.z : position(q);
  place.distance2 = dot(place.nearest - x, place.nearest - x);
  if (!(place.outside < HUGE_VAL)) place.outside = std::sqrt(place.distance2) / size();
  return false;
}

bool CellMap::locate_flat(Vec3 x, CellPlace& place, double tolerance) {
  const Geometry g(*this);
  place.rst = nearest_reference(g, x);
  place.nearest = g.position(place.rst);
  place.distance2 = dot(place.nearest - x, place.nearest - x);
  place.outside = std::min(shape_->outside(place.rst), 0.0);
  const double extent = size(), distance = std::sqrt(place.distance2);
  if (distance <= (tolerance + rounding(x, extent)) * extent) return true;
  place.outside = extent > 0 ? distance / extent : HUGE_VAL;
  return false;
}

bool CellMap::locate_pieces(Vec3 x, CellPlace& place, double tolerance) {
  const auto at = reader_.at();
  double best = HUGE_VAL;
  place = {};
  auto take = [&](Vec3 p, Vec3 rst) {
    const double d2 = dot(p - x, p - x);
    if (d2 < best) best = d2, place.nearest = p, place.rst = rst;
  };
  if (dimension() == 0) {
    for (size_t i = 0; i < at.size(); ++i) take(at[i], {0, 0, double(i)});
  } else if (dimension() == 1) {
    for (size_t i = 0; i + 1 < at.size(); ++i) {
      double t;
      const Vec3 p = nearest_on_segment(at[i], at[i + 1], x, t);
      take(p, {t, 0, double(i)});
    }
    if (at.size() == 1) take(at[0], {0, 0, 0});
  } else {
    Vec3 p, l;
    if (const int64_t t = nearest_triangle(at, triangles(), x, p, l); t >= 0) take(p, {l.y, l.z, double(t)});
  }
  place.distance2 = best;
  const double extent = size(), distance = std::sqrt(best);
  if (distance <= (tolerance + rounding(x, extent)) * extent) return true;
  place.outside = extent > 0 ? distance / extent : HUGE_VAL;
  return false;
}

bool CellMap::locate_polyhedron(Vec3 x, CellPlace& place, double tolerance) {
  place = {};
  Vec3 l;
  const double extent = size();
  const auto at = reader_.at();
  place.nearest = x;
  // Outside the box there is no need to look at the faces, but the nearest point is promised: it costs the same.
  if (nearest_triangle(at, triangles(), x, place.nearest, l) < 0) {
    place.outside = HUGE_VAL;
    return false;
  }
  place.distance2 = dot(place.nearest - x, place.nearest - x);
  const double distance = std::sqrt(place.distance2);
  const bool within = std::abs(winding_number(at, triangles(), x)) > 0.5;
  place.outside = (within ? -distance : distance) / extent;
  if (!(place.outside <= tolerance + rounding(x, extent))) return false;
  place.nearest = x, place.distance2 = 0;
  return true;
}

bool CellMap::locate(Vec3 x, CellPlace& place, double tolerance) {
  if (!shape_) return dimension() == 3 ? locate_polyhedron(x, place, tolerance) : locate_pieces(x, place, tolerance);
  return dimension() == 3 ? locate_solid(x, place, tolerance) : locate_flat(x, place, tolerance);
}

void CellMap::nearest(Vec3 x, CellPlace& place) {
  if (locate(x, place) || !shape_ || dimension() < 3) return;
  nearest_of_faces(x, place);
  place.outside = std::sqrt(place.distance2) / size();
  const InverseResult r = invert_solid(Geometry(*this), place.nearest, 1e-6);
  if (r.found) place.rst = shape_->clamped(r.rst);
}

void CellMap::nearest_outside(Vec3 x, CellPlace& place) {
  if (shape_ && dimension() == 3) nearest_of_faces(x, place);
  else locate(x, place);
}

void CellMap::nearest_of_faces(Vec3 x, CellPlace& place) {
  const auto at = reader_.at();
  const auto weight = reader_.weights();
  const CellFaces& faces = cell_faces(reader_.type(), at.size(), reader_.orders());
  std::vector<Vec3> corner, dn;
  std::vector<double> w, n;
  double best = HUGE_VAL;
  // A face lies in the box of its nodes; a curved one bulges beyond it by less than a quarter, as CellReader::box has it. The faces with
  // the nearest boxes come first, most others need no look.
  std::vector<std::pair<double, size_t>> order;
  for (size_t f = 0; f < faces.size(); ++f) {
    Box3 box;
    for (uint32_t k : faces.face(f)) box.add(at[k]);
    const double bulge = is_high_order(faces.type[f]) ? 0.25 * box.diagonal() : 0;
    double apart2 = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = std::max({box.lo[a] - bulge - x[a], x[a] - box.hi[a] - bulge, 0.0});
      apart2 += d * d;
    }
    order.emplace_back(apart2, f);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [apart2, f] : order) {
    if (apart2 > best) break;
    corner.clear(), w.clear();
    for (uint32_t k : faces.face(f)) {
      corner.push_back(at[k]);
      if (!weight.empty()) w.push_back(weight[k]);
    }
    n.resize(corner.size()), dn.resize(corner.size());
    const CellShape* shape = CellShape::find(faces.type[f], corner.size(), faces.orders[f]);
    if (!shape) continue;
    const CellGeometry g{shape, corner, w, n.data(), dn.data()};
    const Vec3 p = g.position(nearest_reference(g, x));
    if (const double d2 = dot(p - x, p - x); d2 < best) best = d2, place.nearest = p;
  }
  place.distance2 = best;
}

const std::vector<uint32_t>& CellMap::triangles() {
  if (triangles_known_) return triangles_;
  triangles_known_ = true;
  triangles_.clear();
  const auto at = reader_.at();
  if (dimension() == 2) {
    tessellate_face(reader_.type(), at, triangles_);
    return triangles_;
  }
  // Each face from its smallest id towards the smaller neighbour: both cells of a face cut it into the same triangles.
  const auto ids = reader_.ids();
  std::vector<uint32_t> face_of, ring, local;
  std::vector<Vec3> p;
  for (size_t f = 0, count = reader_.face_count(); f < count; ++f) {
    const auto face = reader_.face(f);
    ring.assign(face.begin(), face.end());
    if (ring.size() < 3) continue;
    std::rotate(ring.begin(), std::min_element(ring.begin(), ring.end(), [&](uint32_t a, uint32_t b) { return ids[a] < ids[b]; }),
                ring.end());
    const bool turned = ids[ring.back()] < ids[ring[1]];
    if (turned) std::reverse(ring.begin() + 1, ring.end());
    p.clear(), local.clear();
    for (uint32_t i : ring) p.push_back(at[i]);
    triangulate_polygon(p, local);
    for (size_t i = 0; i + 2 < local.size(); i += 3) {
      if (turned) std::swap(local[i + 1], local[i + 2]);
      for (size_t c = 0; c < 3; ++c) triangles_.push_back(ring[local[i + c]]);
      face_of.push_back(uint32_t(f));
    }
  }
  orient_outward(at, triangles_, face_of);
  return triangles_;
}

}  // namespace sg
