// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/hanging_faces.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/vec.h"
#include "data/cells/cell_topology.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr uint32_t none = UINT32_MAX;
constexpr double off_surface = 1e-4;  // of the larger face's size
constexpr double off_height = 0.1;    // of the smaller face's height: what lies farther away is another face next to the larger one
constexpr double off_border = 1e-3;   // in its parameters

struct OuterFace {
  uint32_t mark, cell, first;  // `first` of its corners in the pool
  float normal[3];             // of unit length, out of the cell
  uint16_t corners;
};

// What lies where on a larger face: x = a + u b + v c + uv d.
class Patch {
 public:
  Patch(std::span<const Vec3> corner, double rounding) : triangle_(corner.size() == 3), corner_(corner) {
    a_ = corner[0], b_ = corner[1] - a_, c_ = corner.back() - a_;
    d_ = triangle_ ? Vec3() : corner[2] - corner[1] - c_;
    const double size = std::max(length(corner[2] - corner[0]), length(corner.back() - corner[1]));
    tolerance_ = off_surface * size + rounding, rounding_ = rounding;
    border_ = off_border + rounding / std::max(size, 1e-300);
  }

  double area() const { return triangle_ ? 0.5 : 1; }

  /// Parameters of x by Gauss and Newton; false when x is not on the patch, or farther off than `most`.
  bool find(Vec3 x, double most, double& u, double& v) const {
    u = v = triangle_ ? 1.0 / 3 : 0.5;
    for (int k = 0; k < 20; ++k) {
      const Vec3 r = x - at(u, v), du = b_ + d_ * v, dv = c_ + d_ * u;
      const double uu = dot(du, du), uv = dot(du, dv), vv = dot(dv, dv), det = uu * vv - uv * uv;
      if (!(det > 1e-12 * uu * vv)) return false;
      const double su = (dot(r, du) * vv - dot(r, dv) * uv) / det, sv = (dot(r, dv) * uu - dot(r, du) * uv) / det;
      u += su, v += sv;
      if (!(std::fabs(u - 0.5) < 3 && std::fabs(v - 0.5) < 3)) return false;
      if (std::fabs(su) + std::fabs(sv) < 1e-9) break;
    }
    if (!(length(x - at(u, v)) <= std::min(tolerance_, most + rounding_))) return false;
    return u >= -border_ && v >= -border_ && (triangle_ ? u + v <= 1 + border_ : u <= 1 + border_ && v <= 1 + border_);
  }

  /// The corner at these parameters; -1 elsewhere.
  int corner_at(double u, double v) const {
    const auto is = [&](double cu, double cv) { return std::fabs(u - cu) <= border_ && std::fabs(v - cv) <= border_; };
    if (is(0, 0)) return 0;
    if (is(1, 0)) return 1;
    if (triangle_) return is(0, 1) ? 2 : -1;
    return is(1, 1) ? 2 : is(0, 1) ? 3 : -1;
  }

 private:
  Vec3 at(double u, double v) const { return a_ + b_ * u + c_ * v + d_ * (u * v); }
  bool triangle_;
  std::span<const Vec3> corner_;
  Vec3 a_, b_, c_, d_;
  double tolerance_, rounding_, border_;
};

class HangingFaces {
 public:
  HangingFaces(const UnstructuredMesh& mesh, FaceMarks& marks, const Context& ctx)
      : mesh_(mesh), marks_(marks), ctx_(ctx), at_(mesh.points), cells_(cells_view(mesh.cells)) {
    for (size_t t = 0; t < 256; ++t)
      if (const CellTypeInfo* info = cell_type_info(uint8_t(t)))
        if (const LinearTopology* l = info->dimension == 3 ? linear_topology(linear_type(CellType(t))) : nullptr)
          count_[t] = l->face_count();
    if (mesh.types.empty()) same_ = count_[size_t(mesh.single_type)];
    if (!mesh.polyhedron_faces.empty()) polyhedron_faces_ = mesh.polyhedron_faces.view<int64_t>().data;
    rounding_ = mesh.points.xyz.type() == ElementType::f32 ? 4e-7 : 1e-14;
  }

  void run() {
    collect();
    if (faces_.size() < 3) return;  // one larger face and two smaller ones
    join_points();
    std::vector<std::vector<uint32_t>> hidden((faces_.size() + per_chunk - 1) / per_chunk);
    parallel_for(
        faces_.size(), per_chunk,
        [&](size_t begin, size_t end) {
          Walk walk;
          for (size_t f = begin; f < end; ++f) cover(uint32_t(f), walk, hidden[begin / per_chunk]);
        },
        &ctx_);
    for (const auto& list : hidden)
      for (const uint32_t mark : list) marks_.external[mark] = 0;
  }

 private:
  static constexpr size_t per_chunk = 4096;

  // All faces with marks of all cells that are there, chunk after chunk of cells.
  void collect() {
    const size_t chunks = marks_.chunk_start.size();
    std::vector<std::vector<OuterFace>> found(chunks);
    std::vector<std::vector<uint32_t>> corners(chunks);
    parallel_for(
        mesh_.cells.size(), FaceMarks::cells_per_chunk,
        [&](size_t begin, size_t end) {
          const size_t chunk = begin / FaceMarks::cells_per_chunk;
          collect(begin, end, found[chunk], corners[chunk]);
        },
        &ctx_);
    size_t faces = 0, pool = 0;
    for (size_t c = 0; c < chunks; ++c) faces += found[c].size(), pool += corners[c].size();
    faces_.reserve(faces), pool_.reserve(pool);
    for (size_t c = 0; c < chunks; ++c) {
      for (OuterFace f : found[c]) f.first += uint32_t(pool_.size()), faces_.push_back(f);
      pool_.insert(pool_.end(), corners[c].begin(), corners[c].end());
    }
  }

  void collect(size_t begin, size_t end, std::vector<OuterFace>& found, std::vector<uint32_t>& corners) const {
    CellFaceReader reader(mesh_);
    const size_t first = marks_.chunk_start[begin / FaceMarks::cells_per_chunk];
    const uint8_t* external = marks_.external.data() + first;
    if (same_ > 0) {  // from mark to mark
      const size_t n = same_ * (end - begin);
      for (size_t i = 0; i < n;) {
        const void* next = std::memchr(external + i, 1, n - i);
        if (!next) break;
        const size_t c = size_t(static_cast<const uint8_t*>(next) - external) / same_;
        reader.open(begin + c);
        add(reader, begin + c, first + c * same_, same_, found, corners);
        i = (c + 1) * same_;
      }
      return;
    }
    size_t mark = first;
    for (size_t cell = begin; cell < end; ++cell) {
      const CellType type = mesh_.type(cell);
      const size_t n = type == CellType::polyhedron ? size_t(polyhedron_faces_[cell + 1] - polyhedron_faces_[cell]) : count_[size_t(type)];
      if (n > 0 && std::memchr(marks_.external.data() + mark, 1, n)) reader.open(cell), add(reader, cell, mark, n, found, corners);
      mark += n;
    }
  }

  // The marked ones of the n faces of a cell.
  void add(CellFaceReader& reader, size_t cell, size_t mark, size_t n, std::vector<OuterFace>& found,
           std::vector<uint32_t>& corners) const {
    if (cells_.size(cell) == 0) return;
    const Vec3 origin = at_[size_t(cells_.connectivity[cells_.begin(cell)])];
    const auto area_of = [&](std::span<const int64_t> ids, Vec3 o) {
      Vec3 area;
      for (size_t k = 1; k + 1 < ids.size(); ++k) area += cross(at_[size_t(ids[k])] - o, at_[size_t(ids[k + 1])] - o);
      return area;
    };
    // Which way is out: consistently oriented faces sum to zero, and the sign of their volume gives the orientation. Others by the middle
    // of the cell, which need not lie behind each face of a cell that is not convex.
    Vec3 middle, sum;
    double volume = 0, total = 0;
    for (size_t i = cells_.begin(cell); i < cells_.end(cell); ++i) middle += at_[size_t(cells_.connectivity[i])] - origin;
    middle = origin + middle / double(cells_.size(cell));
    for (size_t f = 0; f < n; ++f) {
      const auto ids = reader.corners(f);
      if (ids.size() < 3) continue;
      const Vec3 o = at_[size_t(ids[0])], area = area_of(ids, o);
      sum += area, total += length(area), volume += dot(area, o - origin);
    }
    const bool alike = length(sum) <= 1e-9 * total;
    for (size_t f = 0; f < n; ++f) {
      if (!marks_.external[mark + f]) continue;
      const auto ids = reader.corners(f);
      if (ids.size() < 3 || ids.size() > UINT16_MAX) continue;
      const Vec3 o = at_[size_t(ids[0])];
      Vec3 area = area_of(ids, o);
      const double size = length(area);
      if (!(size > 0)) continue;
      area = area * (((alike ? volume : dot(area, o - middle)) < 0 ? -1 : 1) / size);
      found.push_back({uint32_t(mark + f),
                       uint32_t(cell),
                       uint32_t(corners.size()),
                       {float(area.x), float(area.y), float(area.z)},
                       uint16_t(ids.size())});
      for (const int64_t id : ids) corners.push_back(uint32_t(id));
    }
  }

  // Lists of the places in the pool that hold each point.
  void join_points() {
    head_.resize(mesh_.points.count());
    parallel_for(head_.size(), 1 << 18,
                 [&](size_t begin, size_t end) { std::fill(head_.begin() + ptrdiff_t(begin), head_.begin() + ptrdiff_t(end), none); });
    next_.resize(pool_.size());
    for (uint32_t f = 0; f < faces_.size(); ++f)
      for (uint32_t k = 0; k < faces_[f].corners; ++k) {
        const uint32_t place = faces_[f].first + k;
        next_[place] = {head_[pool_[place]], f};
        head_[pool_[place]] = place;
      }
  }

  struct Walk {
    std::vector<uint32_t> seen, inside, points;
  };

  // Of two cells, and facing each other?
  bool opposite(const OuterFace& a, const OuterFace& b) const {
    return a.cell != b.cell && a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1] + a.normal[2] * b.normal[2] < -0.5f;
  }

  // Twice its area by its longest side or diagonal.
  double height_of(const OuterFace& f) const {
    const auto corner = [&](uint32_t k) { return at_[pool_[f.first + k]]; };
    const Vec3 o = corner(0);
    Vec3 area;
    double longest = 0;
    for (uint32_t k = 1; k < f.corners; ++k) {
      longest = std::max({longest, length(corner(k) - o), length(corner(k) - corner(k - 1))});
      if (k > 1) area += cross(corner(k - 1) - o, corner(k) - o);
    }
    return longest > 0 ? length(area) / longest : 0;
  }

  // The share of `large` that `small` takes when it lies in it; negative when it does not.
  double share(const Patch& patch, const OuterFace& large, const OuterFace& small) const {
    double area = 0, u0 = 0, v0 = 0, u1 = 0, v1 = 0;
    bool all_corners = true;
    const double height = height_of(small);
    for (uint32_t k = 0; k < small.corners; ++k) {
      const uint32_t id = pool_[small.first + k];
      double u = 0, v = 0;
      if (!patch.find(at_[id], off_height * height, u, v)) return -1;
      const int corner = patch.corner_at(u, v);
      if (corner >= 0 && pool_[large.first + uint32_t(corner)] != id) return -1;  // another point at the same place: they only touch
      all_corners = all_corners && corner >= 0;
      if (k == 0) u0 = u, v0 = v;
      else area += u1 * v - v1 * u;
      u1 = u, v1 = v;
    }
    if (all_corners && small.corners >= large.corners) return -1;  // not smaller
    return std::fabs(area + u1 * v0 - v1 * u0) / 2;
  }

  // Follows the smaller faces from the corners of one on, over their points.
  void cover(uint32_t f, Walk& w, std::vector<uint32_t>& hidden) const {
    const OuterFace& large = faces_[f];
    if (large.corners > 4) return;
    const uint32_t* own = pool_.data() + large.first;
    bool any = false;
    for (uint32_t k = 0; k < large.corners && !any; ++k)
      for (uint32_t p = head_[own[k]]; p != none && !any; p = next_[p].place) any = opposite(large, faces_[next_[p].face]);
    if (!any) return;

    Vec3 corner[4];
    double far = 0;
    for (uint32_t k = 0; k < large.corners; ++k) {
      corner[k] = at_[own[k]];
      const Vec3 offset = corner[k] - at_.origin;
      far = std::max({far, std::fabs(offset.x), std::fabs(offset.y), std::fabs(offset.z)});
    }
    const Patch patch(std::span<const Vec3>(corner, large.corners), rounding_ * far);
    w.seen.assign(1, f), w.inside.clear(), w.points.assign(own, own + large.corners);
    double covered = 0;
    for (size_t i = 0; i < w.points.size(); ++i)
      for (uint32_t p = head_[w.points[i]]; p != none; p = next_[p].place) {
        const uint32_t g = next_[p].face;
        if (!opposite(large, faces_[g]) || std::find(w.seen.begin(), w.seen.end(), g) != w.seen.end()) continue;
        w.seen.push_back(g);
        const double part = share(patch, large, faces_[g]);
        if (part <= 0) continue;
        covered += part;
        w.inside.push_back(g);
        for (uint32_t k = 0; k < faces_[g].corners; ++k) {
          const uint32_t id = pool_[faces_[g].first + k];
          if (std::find(w.points.begin(), w.points.end(), id) == w.points.end()) w.points.push_back(id);
        }
      }
    for (const uint32_t g : w.inside) hidden.push_back(faces_[g].mark);
    if (covered > 0.999 * patch.area()) hidden.push_back(large.mark);
  }

  struct Link {
    uint32_t place, face;
  };
  const UnstructuredMesh& mesh_;
  FaceMarks& marks_;
  const Context& ctx_;
  PointReader at_;
  CellsView cells_;
  std::array<size_t, 256> count_{};  // faces of each type
  size_t same_ = 0;                  // of each cell, where all have as many
  const int64_t* polyhedron_faces_ = nullptr;
  double rounding_;
  std::vector<OuterFace> faces_;
  std::vector<uint32_t> pool_;
  Plane<uint32_t> head_;
  std::vector<Link> next_;
};

}  // namespace

void unmark_hanging_faces(const UnstructuredMesh& mesh, FaceMarks& marks, const Context& ctx) {
  if (!marks.external.empty()) HangingFaces(mesh, marks, ctx).run();
}

}  // namespace sg
