// SPDX-License-Identifier: Apache-2.0
// Polygons and polyhedra: their generalised barycentric coordinates have no reference map.
#include <algorithm>

#include "data/cells/cell_topology.h"
#include "filter/flow/topology/zeros/cell_zeros.h"
#include "filter/flow/topology/zeros/simplex_zeros.h"

namespace sg {

// Sides of polygons and faces of polyhedra whose ends both are zero: lines of zeros.
bool CellZeros::zero_sides(Result& result) {
  CellReader reader = map_.reader();
  const auto ids = reader.ids();
  bool any = false;
  auto ring_of = [&](std::span<const uint32_t> ring) {
    for (size_t k = 0; k < ring.size(); ++k) {
      const uint32_t a = ring[k], b = ring[(k + 1) % ring.size()];
      if (!zero_[a] || !zero_[b]) continue;
      spread_.push_back(ids[a]), spread_.push_back(ids[b]);
      any = true;
    }
  };
  std::vector<uint32_t> ring;
  if (reader.dimension() == 3) {
    for (size_t f = 0, n = reader.face_count(); f < n; ++f) ring_of(reader.face(f));
  } else if (reader.type() != CellType::triangle_strip) {
    face_outline(reader.type(), ids.size(), ring, reader.orders());
    ring_of(ring);
  }
  if (any) result = Result::spread;
  return any;
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
  Box3 box;
  for (const Vec3 p : map_.reader().at()) box.add(p);
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

// Simplices between the middle and the sides: a ray from there to any point of the cell continues to a side, so that they cover it.
void CellZeros::fan_of_cell(Vec3 middle, std::vector<Vec3>& out) {
  CellReader reader = map_.reader();
  const auto at = reader.at();
  std::vector<uint32_t> ring;
  auto local = [&](Vec3 p) { return Vec3(dot(p - middle, frame_->e1), dot(p - middle, frame_->e2), 0); };
  if (frame_) {
    face_outline(reader.type(), at.size(), ring, reader.orders());
    for (size_t k = 0; k < ring.size(); ++k) {
      const Vec3 a = local(at[ring[k]]), b = local(at[ring[(k + 1) % ring.size()]]);
      if (cross(a, b).z != 0) out.insert(out.end(), {Vec3(), a, b});
    }
    return;
  }
  for (size_t f = 0, n = reader.face_count(); f < n; ++f) {
    const auto face = reader.face(f);
    // From each corner in turn where the face is bent: how it is cut into triangles is the map's affair.
    Vec3 area;
    for (size_t k = 1; k + 1 < face.size(); ++k) area += cross(at[face[k]] - at[face[0]], at[face[k + 1]] - at[face[0]]);
    const Vec3 normal = normalize(area);
    bool bent = false;
    for (const uint32_t k : face) bent = bent || std::abs(dot(normal, at[k] - at[face[0]])) > 1e-7 * std::sqrt(length(area));
    for (size_t first = 0; first < (bent ? face.size() - 2 : 1); ++first)
      for (size_t k = 1; k + 1 < face.size(); ++k) {
        const Vec3 a = at[face[first]], b = at[face[(first + k) % face.size()]], c = at[face[(first + k + 1) % face.size()]];
        if (dot(a - middle, cross(b - middle, c - middle)) != 0) out.insert(out.end(), {middle, a, b, c});
      }
  }
}

CellZeros::Result CellZeros::find_sampled(std::vector<CellZero>& out) {
  const auto at = map_.reader().at();
  Box3 box;
  Vec3 middle;
  for (const Vec3 p : at) box.add(p), middle += p / double(at.size());
  auto place = [&](Vec3 x) { return frame_ ? middle + x.x * frame_->e1 + x.y * frame_->e2 : x; };
  auto local = [&](Vec3 p) { return frame_ ? Vec3(dot(p - middle, frame_->e1), dot(p - middle, frame_->e2), 0) : p; };
  Mat3 ignored;
  SimplexZeros search(
      frame_ ? 2 : 3, [&](Vec3 x, Vec3& v) { return at_place(place(x), v); },
      [&](Vec3 start, Vec3& zero) {
        if (!newton_from(place(start), zero, ignored)) return false;
        zero = local(zero);
        return true;
      });
  std::vector<Vec3> simplices, corners;
  fan_of_cell(middle, simplices);
  for (size_t k = 0; k < at.size(); ++k)
    if (zero_[k]) corners.push_back(local(at[k]));
  found_.clear();
  const bool isolated = search.solve(simplices, corners, found_);
  const size_t before = out.size();
  for (const Vec3 x : found_) add_sampled(place(x), before, out);
  add_corners(box.diagonal(), out);
  return !isolated ? Result::spread : out.size() > before ? Result::isolated : Result::none;
}

void CellZeros::add_sampled(Vec3 x, size_t before, std::vector<CellZero>& out) {
  const auto at = map_.reader().at();
  Box3 box;
  for (const Vec3 p : at) box.add(p);
  CellZero z;
  z.size = box.diagonal();
  Mat3 g;
  CellPlace place;
  if (!newton_from(x, z.at, g) || !map_.locate(z.at, place, 1e-7)) return;
  z.border = place.outside > -CellZero::on_border || frame_;
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
  for (size_t k = 0; k < at.size(); ++k)
    if (zero_[k] && length(at[k] - z.at) < 1e-7 * z.size) return;  // add_corners() does it
  for (size_t i = before; i < out.size(); ++i)
    if (length(out[i].at - z.at) < 1e-7 * z.size) return;
  out.push_back(z);
}

// At a corner the weights are quotients of zeros, and Newton's method does not get there: the gradient of the cell's best fit.
void CellZeros::add_corners(double size, std::vector<CellZero>& out) {
  const auto at = map_.reader().at();
  const auto ids = map_.reader().ids();
  for (size_t k = 0; k < at.size(); ++k) {
    if (!zero_[k]) continue;
    CellZero z;
    z.at = at[k], z.node = ids[k], z.border = true, z.size = size;
    CellPlace place;
    place.nearest = at[k];
    slopes_.resize(v_.size());
    map_.gradient_weights(place, slopes_);
    for (int p = 0; p < 3; ++p)
      for (int q = 0; q < 3; ++q) {
        z.gradient.m[p][q] = 0;
        for (size_t i = 0; i < ids.size(); ++i) z.gradient.m[p][q] += flow_.at_point(size_t(ids[i]))[p] * slopes_[i][q];
      }
    out.push_back(z);
  }
}

}  // namespace sg
