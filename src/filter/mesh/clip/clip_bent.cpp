// SPDX-License-Identifier: Apache-2.0
// Cells whose faces are not flat. A face of four corners is the bilinear patch between them, and triangles on one of its diagonals enclose
// another volume; the four triangles over its middle enclose the same as the patch. So a cell with such a face, crossed by a level, falls
// into tetrahedra over the middles of these faces (both cells of a face do so) and pyramids and tetrahedra over its other faces, all with
// the middle of the cell for their apex. Their faces are flat or not crossed, and their parts add up.
#include <algorithm>
#include <unordered_map>

#include "filter/mesh/clip/clip_cell.h"
#include "filter/mesh/clip/clip_pieces.h"

namespace sg::clipping {

namespace {

// Whether the corners are coplanar, up to rounding of the coordinates. The same from both sides.
bool is_flat(std::array<std::pair<int64_t, Vec3>, 4> p, double rounding) {
  std::sort(p.begin(), p.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const Vec3 a = p[1].second - p[0].second, b = p[2].second - p[0].second, c = p[3].second - p[0].second;
  const double size2 = std::max({dot(a, a), dot(b, b), dot(c, c)});
  return std::fabs(dot(a, cross(b, c))) <= size2 * (4 * rounding + 1e-15 * std::sqrt(size2));
}

bool crosses(const Keep& keep, std::span<const double> values) {
  const auto between = [&](double level, double sign) {
    bool in = false, out = false;
    for (const double v : values) (sign * (v - level) >= 0 ? in : out) = true;
    return in && out;
  };
  return between(keep.level, keep.sign) || (keep.between && between(keep.upper, -1));
}

}  // namespace

uint32_t CellClipper::bent_faces(const ClipTable& table, const int64_t* ids, const double* values, const Vec3* places, const Keep& keep,
                                 double rounding) {
  const LinearTopology& topology = table.topology();
  uint32_t bent = 0;
  for (size_t f = 0; f < topology.face_count(); ++f) {
    const auto c = topology.face(f);
    if (c.size() != 4) continue;
    const double v[4] = {values[c[0]], values[c[1]], values[c[2]], values[c[3]]};
    if (!crosses(keep, v)) continue;
    std::array<std::pair<int64_t, Vec3>, 4> corners;
    for (size_t k = 0; k < 4; ++k) corners[k] = {ids[c[k]], places[c[k]]};
    bent |= uint32_t(!is_flat(corners, rounding)) << f;
  }
  return bent;
}

// The mean of corners; its value is summed in the order of their ids, so that neighbours find the same.
uint16_t CellClipper::mean_of(std::vector<uint16_t> of) {
  std::vector<uint16_t> order = of;
  std::sort(order.begin(), order.end(), [&](uint16_t a, uint16_t b) { return out_.names[a] < out_.names[b]; });
  double value = 0;
  for (const uint16_t v : order) value += value_[v];
  value /= double(of.size());
  out_.inner.push_back({std::move(of), -1});
  return add(CellPieces::inner_name + out_.inner.size() - 1, value);
}

void CellClipper::split_solid(const ClipTable& table, uint32_t bent) {
  split_ = true;
  const LinearTopology& topology = table.topology();
  std::vector<uint16_t> all;
  for (uint16_t c = 0; c < topology.corners; ++c) all.push_back(c);
  const uint16_t middle = mean_of(std::move(all));
  waiting_.clear();
  for (size_t f = 0; f < topology.face_count(); ++f) {
    const auto c = topology.face(f);  // counter-clockwise from outside: turned round it looks at the middle
    if (bent >> f & 1) {
      const uint16_t over = mean_of({c.begin(), c.end()});
      for (size_t k = 0; k < 4; ++k) waiting_.push_back({CellType::tetra, {c[(k + 1) % 4], c[k], over, middle}});
    } else if (c.size() == 4) {
      waiting_.push_back({CellType::pyramid, {c[3], c[2], c[1], c[0], middle}});
    } else {
      waiting_.push_back({CellType::tetra, {c[2], c[1], c[0], middle}});
    }
  }
  const std::vector<Waiting> parts = std::move(waiting_);
  waiting_ = {};
  for (const Waiting& w : parts) add_region(*clip_table(w.type), w.v, 0, !keep_.between);
  for (size_t i = 0; i < waiting_.size(); ++i) {
    const Waiting w = waiting_[i];
    add_region(*clip_table(w.type), w.v, 1, true);
  }
  folded_ = false;
}

// Faces of polyhedra that a level crosses and that are not flat, as the triangles by which their volume is measured.
std::vector<CellClipper::Ring> CellClipper::flat_faces(std::vector<Ring> faces) const {
  if (!position_) return faces;
  std::vector<Ring> out;
  std::vector<double> values;
  std::vector<Vec3> at;
  std::vector<uint32_t> triangles;
  for (Ring& f : faces) {
    values.clear(), at.clear(), triangles.clear();
    for (const uint16_t v : f) values.push_back(value_[v]);
    bool flat = f.size() < 4 || !crosses(keep_, values);
    if (!flat) {
      std::rotate(f.begin(), std::min_element(f.begin(), f.end(), [&](uint16_t a, uint16_t b) { return out_.names[a] < out_.names[b]; }),
                  f.end());
      const bool turned = out_.names[f.back()] < out_.names[f[1]];
      if (turned) std::reverse(f.begin() + 1, f.end());
      for (const uint16_t v : f) at.push_back(place(v));
      Vec3 area;
      double size2 = 0;
      for (size_t k = 1; k + 1 < at.size(); ++k) area += cross(at[k] - at[0], at[k + 1] - at[0]);
      for (size_t k = 1; k < at.size(); ++k) size2 = std::max(size2, dot(at[k] - at[0], at[k] - at[0]));
      flat = true;
      for (const Vec3& p : at) flat = flat && std::fabs(dot(p - at[0], area)) <= size2 * (4 * rounding_ + 1e-15 * std::sqrt(size2));
      if (!flat) {
        triangulate_polygon(at, triangles);
        for (size_t k = 0; k + 2 < triangles.size(); k += 3) {
          Ring t{f[triangles[k]], f[triangles[k + 1]], f[triangles[k + 2]]};
          if (turned) std::swap(t[1], t[2]);
          out.push_back(std::move(t));
        }
        continue;
      }
      if (turned) std::reverse(f.begin() + 1, f.end());
    }
    out.push_back(std::move(f));
  }
  return out;
}

double rounding_of(const Points& points, const Dataset& mesh) {
  const Box3& box = mesh.bounds();
  if (box.empty()) return 0;
  const bool narrow = points.xyz.type() == ElementType::f32;
  const Vec3 lo = narrow ? box.lo - points.origin : box.lo, hi = narrow ? box.hi - points.origin : box.hi;
  double far = 0;
  for (int a = 0; a < 3; ++a) far = std::max({far, std::fabs(lo[a]), std::fabs(hi[a])});
  return far * (narrow ? 6e-8 : 1.2e-16);
}

void merge_shared(Build& b, size_t first_inner, std::span<const std::span<int32_t>> ids) {
  struct Key {
    std::array<std::pair<uint32_t, double>, 4> of;
    bool operator==(const Key& o) const { return of == o.of; }
  };
  struct Hash {
    size_t operator()(const Key& k) const {
      uint64_t h = 0;
      for (const auto& [id, w] : k.of) h = (h ^ id ^ std::bit_cast<uint64_t>(w)) * 0x9E3779B97F4A7C15u, h ^= h >> 29;
      return size_t(h);
    }
  };
  const size_t n = b.inner_first.size() - 1;
  std::unordered_map<Key, int32_t, Hash> known;
  std::vector<int32_t> number(n);
  int32_t kept = 0;
  size_t to = 0;
  for (size_t i = 0; i < n; ++i) {
    const size_t first = b.inner_first[i], last = b.inner_first[i + 1];
    if (last - first == 4) {
      Key key;
      for (size_t k = 0; k < 4; ++k) key.of[k] = {b.inner_points[first + k], b.inner_weights[first + k]};
      std::sort(key.of.begin(), key.of.end());
      const auto [it, fresh] = known.try_emplace(key, kept);
      if (!fresh) {
        number[i] = it->second;
        continue;
      }
    }
    for (size_t k = first; k < last; ++k, ++to) b.inner_points[to] = b.inner_points[k], b.inner_weights[to] = b.inner_weights[k];
    number[i] = kept++;
    b.inner_first[size_t(kept)] = to;
  }
  b.inner_first.resize(size_t(kept) + 1);
  b.inner_points.resize(to), b.inner_weights.resize(to);
  for (const auto& list : ids)
    for (int32_t& id : list)
      if (size_t(id) >= first_inner) id = int32_t(first_inner) + number[size_t(id) - first_inner];
}

}  // namespace sg::clipping
