// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "data/field_ops.h"
#include "filter/mesh/extract.h"
#include "filter/mesh/plane_cutter.h"

namespace sg {

namespace {

using detail::PlaneCutter;
using detail::PlaneField;

struct Plane {
  Vec3 origin, normal;
  double snap = 0;    ///< distances below are rounding: the point lies in the plane
  double sign = 1;    ///< -1: the plane touches the mesh from behind, so "in front" and "behind" change places
  double raw(Vec3 p) const {
    const double d = dot(normal, p - origin);
    return std::abs(d) <= snap ? 0.0 : d;
  }
  double operator()(Vec3 p) const { return sign * raw(p); }
};

Plane plane_of(const Dataset& in, const SliceParams& p) {
  Plane r;
  const Box3& box = in.bounds();
  const bool shorthand = p.axis != "none" && !p.axis.empty();
  if (p.position && !shorthand) fail_usage("position needs an axis", "slice", fmt::format("write axis=z position={}", short_number(*p.position)));
  if (shorthand && p.origin) fail_usage("axis and origin say the same thing twice", "slice", "give axis and position, or origin and normal");
  r.origin = p.origin.value_or(box.empty() ? Vec3() : box.center());
  r.normal = p.normal;
  if (shorthand) {
    const int a = p.axis == "x" ? 0 : p.axis == "y" ? 1 : p.axis == "z" ? 2 : -1;
    if (a < 0) fail_usage(fmt::format("'{}' is no axis", p.axis), "slice axis", "x, y, z or none");
    r.normal = {};
    r.normal[a] = 1;
    if (p.position) r.origin[a] = *p.position;
  }
  // Dividing by the largest part first keeps tiny and huge normals from vanishing in the square.
  const double largest = std::max({std::abs(r.normal.x), std::abs(r.normal.y), std::abs(r.normal.z)});
  if (!(largest > 0) || !std::isfinite(largest)) fail_usage("the normal is zero", "slice normal", "give a direction, e.g. normal=0,0,1");
  r.normal = normalize(r.normal / largest);
  double reach = 0;
  for (int a = 0; a < 3; ++a)
    if (!box.empty()) reach = std::max({reach, std::abs(box.lo[a] - r.origin[a]), std::abs(box.hi[a] - r.origin[a]), std::abs(r.origin[a])});
  r.snap = 4 * std::numeric_limits<double>::epsilon() * reach;
  return r;
}

// ---- what the cells give ------------------------------------------------------------------------------------------------

struct Cut {
  std::vector<SurfaceChunk> chunks;  // ids are crossing keys
  PlaneField field;
  std::shared_ptr<const void> keep;  // what `field` refers to
};

// Distances of listed points; turns the plane around when nothing lies behind it.
std::vector<double> distances(size_t n, Plane& plane, const std::function<Vec3(size_t)>& at) {
  std::vector<double> d(n);
  const double lowest = parallel_reduce(n, 1 << 14, HUGE_VAL, [&](size_t begin, size_t end) {
    double low = HUGE_VAL;
    for (size_t i = begin; i < end; ++i) {
      d[i] = plane.raw(at(i));
      low = std::min(low, d[i]);
    }
    return low;
  }, [](double a, double b) { return std::min(a, b); });
  if (lowest == 0) {
    plane.sign = -1;
    for (double& x : d) x = -x;
  }
  return d;
}

bool straddles(const CellsView& v, size_t cell, const std::vector<double>& d) {
  const size_t begin = v.begin(cell), end = v.end(cell);
  if (begin == end) return false;
  bool front = false, behind = false;
  for (size_t i = begin; i < end; ++i) {
    const double x = d[size_t(v.connectivity[i])];
    if (x != x) return false;  // a corner without a position
    front |= x >= 0, behind |= x < 0;
  }
  return front && behind;
}

struct Listed {
  PointReader at;
  std::vector<double> d;
};

std::shared_ptr<Listed> listed(const Points& points, Plane& plane, Cut& cut) {
  auto l = std::make_shared<Listed>(Listed{PointReader(points), {}});
  l->d = distances(points.count(), plane, [&](size_t i) { return l->at[i]; });
  cut.field = {[p = l.get()](size_t i) { return p->d[i]; }, [p = l.get()](size_t i) { return p->at[i]; }, plane.normal};
  cut.keep = l;
  return l;
}

constexpr size_t cells_per_chunk = 1 << 13;

Cut cut_unstructured(const UnstructuredMesh& m, const std::vector<uint8_t>& states, Plane plane, Context& ctx) {
  Cut cut;
  const auto points = listed(m.points, plane, cut);
  const CellsView v = cells_view(m.cells);
  cut.chunks.resize((v.count + cells_per_chunk - 1) / cells_per_chunk);
  std::vector<uint8_t> curved(cut.chunks.size());
  parallel_for(v.count, cells_per_chunk, [&](size_t begin, size_t end) {
    PlaneCutter cutter(cut.field, cut.chunks[begin / cells_per_chunk]);
    CellFaceReader reader(m);
    std::vector<int64_t> ids;
    std::vector<uint32_t> ring;
    for (size_t c = begin; c < end; ++c) {
      if (!states.empty() && states[c] != cell_visible) continue;
      if (!straddles(v, c, points->d)) continue;
      const CellType type = m.type(c), shape = linear_type(type);
      curved[begin / cells_per_chunk] |= is_high_order(type);
      const int dimension = cell_type_info(type).dimension;
      if (dimension == 3) {
        cutter.begin_solid();
        for (size_t f = 0, n = reader.open(c); f < n; ++f) cutter.add_face(reader.corners(f));
        cutter.end_solid(int64_t(c));
        continue;
      }
      ids.clear();
      const int corners = cell_type_info(shape).corners;
      const size_t n = is_high_order(type) ? (shape == CellType::polygon ? v.size(c) / 2 : size_t(corners)) : v.size(c);
      for (size_t k = 0; k < n; ++k) ids.push_back(v.point(c, k));
      if (dimension == 1) cutter.cut_curve(ids, int64_t(c));
      if (dimension != 2) continue;
      if (type == CellType::pixel) std::swap(ids[2], ids[3]);
      if (type != CellType::triangle_strip) cutter.cut_flat(ids, int64_t(c));
      else
        for (size_t k = 0; k + 2 < ids.size(); ++k) cutter.cut_flat(std::span(ids).subspan(k, 3), int64_t(c));
    }
  }, &ctx);
  if (std::find(curved.begin(), curved.end(), 1) != curved.end()) ctx.info("slice: curved cells are cut as their corners span them");
  return cut;
}

Cut cut_surface(const SurfaceMesh& m, const std::vector<uint8_t>& states, Plane plane, Context& ctx) {
  Cut cut;
  const auto points = listed(m.points, plane, cut);
  const CellArray* parts[4] = {&m.vertices, &m.lines, &m.polygons, &m.strips};
  size_t first = 0;
  for (int part = 0; part < 4; ++part) {
    const CellsView v = cells_view(*parts[part]);
    const size_t chunk0 = cut.chunks.size();
    cut.chunks.resize(chunk0 + (v.count + cells_per_chunk - 1) / cells_per_chunk);
    if (part > 0)
      parallel_for(v.count, cells_per_chunk, [&](size_t begin, size_t end) {
        PlaneCutter cutter(cut.field, cut.chunks[chunk0 + begin / cells_per_chunk]);
        std::vector<int64_t> ids;
        for (size_t c = begin; c < end; ++c) {
          const auto id = int64_t(first + c);
          if ((!states.empty() && states[size_t(id)] != cell_visible) || !straddles(v, c, points->d)) continue;
          ids.clear();
          for (size_t i = v.begin(c); i < v.end(c); ++i) ids.push_back(v.connectivity[i]);
          if (part == 1) cutter.cut_curve(ids, id);
          if (part == 2) cutter.cut_flat(ids, id);
          for (size_t k = 0; part == 3 && k + 2 < ids.size(); ++k) cutter.cut_flat(std::span(ids).subspan(k, 3), id);
        }
      }, &ctx);
    first += v.count;
  }
  return cut;
}

// Solid lattices. Affine and separable ones: along a row of points the side changes once at most, so the cut cells of a row are
// found by bisection; curvilinear ones look at every cell.
class LatticeCut {
 public:
  LatticeCut(const Mesh& mesh, Plane& plane) : lattice_(mesh), v_(lattice_.view()), plane_(plane) {
    if (v_.mode == LatticeView::Mode::listed) {
      d_ = distances(v_.points(), plane_, [&](size_t i) { return position(i); });
    } else {
      double lowest = HUGE_VAL;  // at a corner
      for (size_t c = 0; c < 8; ++c) lowest = std::min(lowest, distance(c & 1 ? v_.dims[0] - 1 : 0, c & 2 ? v_.dims[1] - 1 : 0, c & 4 ? v_.dims[2] - 1 : 0));
      if (lowest == 0) plane_.sign = -1;
    }
  }
  Vec3 position(size_t id) const { return v_.position(id % v_.dims[0], id / v_.dims[0] % v_.dims[1], id / (v_.dims[0] * v_.dims[1])); }
  double distance(size_t id) const { return d_.empty() ? plane_(position(id)) : d_[id]; }

  void cut(Cut& cut, const std::vector<uint8_t>& states, Context& ctx) const {
    const auto n = v_.cell_dims();
    const size_t grain = std::max<size_t>(1, 65536 / n[0]), rows = n[1] * n[2];
    cut.chunks.resize((rows + grain - 1) / grain);
    parallel_for(rows, grain, [&](size_t begin, size_t end) {
      PlaneCutter cutter(cut.field, cut.chunks[begin / grain]);
      for (size_t row = begin; row < end; ++row) {
        const size_t j = row % n[1], k = row / n[1];
        const auto [first, last] = range(j, k);
        for (size_t i = first; i < last; ++i) {
          const size_t cell = i + n[0] * row;
          if (!states.empty() && states[cell] != cell_visible) continue;
          cut_cell(cutter, i, j, k, cell);
        }
      }
    }, &ctx);
  }

 private:
  double distance(size_t i, size_t j, size_t k) const { return d_.empty() ? plane_(v_.position(i, j, k)) : d_[v_.id(i, j, k)]; }

  // Cells of a row that may be cut.
  std::pair<size_t, size_t> range(size_t j, size_t k) const {
    const size_t nx = v_.dims[0];
    if (!d_.empty()) return {0, nx - 1};
    size_t first = nx, last = 0;
    bool any_front = false, any_behind = false;
    for (size_t r = 0; r < 4; ++r) {
      const size_t y = j + (r & 1), z = k + (r >> 1);
      const bool front = distance(0, y, z) >= 0, back_front = distance(nx - 1, y, z) >= 0;
      any_front |= front || back_front;
      any_behind |= !front || !back_front;
      if (front == back_front) continue;
      size_t lo = 0, hi = nx - 1;  // the side changes between lo and hi
      while (hi - lo > 1) {
        const size_t middle = (lo + hi) / 2;
        ((distance(middle, y, z) >= 0) == front ? lo : hi) = middle;
      }
      first = std::min(first, lo), last = std::max(last, hi);
    }
    if (!any_front || !any_behind) return {0, 0};
    if (first >= last) return {0, nx - 1};  // rows on different sides: every cell between them is cut
    bool all[2] = {true, true};             // are the ends of the four rows on one side?
    for (size_t r = 1; r < 4; ++r)
      for (size_t e = 0; e < 2; ++e)
        all[e] = all[e] && (distance(e * (nx - 1), j + (r & 1), k + (r >> 1)) >= 0) == (distance(e * (nx - 1), j, k) >= 0);
    if (!all[0]) first = 0;
    if (!all[1]) last = nx - 1;
    // One cell to spare on each side for rounding of rotated axes; cut_cell looks again.
    return {first > 0 ? first - 1 : 0, std::min(last + 1, nx - 1)};
  }

  void cut_cell(PlaneCutter& cutter, size_t i, size_t j, size_t k, size_t cell) const {
    static const LinearTopology& voxel = *linear_topology(CellType::voxel);
    int64_t ids[8];
    bool front = false, behind = false;
    for (size_t c = 0; c < 8; ++c) {
      const size_t x = i + (c & 1), y = j + (c >> 1 & 1), z = k + (c >> 2);
      ids[c] = int64_t(v_.id(x, y, z));
      const double d = distance(x, y, z);
      if (d != d) return;  // a corner without a position
      front |= d >= 0, behind |= d < 0;
    }
    if (!front || !behind) return;
    cutter.begin_solid();
    for (size_t f = 0; f < 6; ++f) {
      int64_t face[4];
      const auto corner = voxel.face(f);
      for (size_t c = 0; c < 4; ++c) face[c] = ids[corner[c]];
      cutter.add_face(face);
    }
    cutter.end_solid(int64_t(cell));
  }

  Lattice lattice_;
  LatticeView v_;
  Plane& plane_;
  std::vector<double> d_;
};

Cut cut_lattice(const Mesh& mesh, const std::vector<uint8_t>& states, Plane plane, Context& ctx) {
  struct Held {
    Plane plane;
    LatticeCut cut;
    Held(const Mesh& m, Plane p) : plane(p), cut(m, plane) {}
  };
  auto held = std::make_shared<Held>(mesh, plane);
  Cut cut;
  cut.field = {[h = held.get()](size_t i) { return h->cut.distance(i); }, [h = held.get()](size_t i) { return h->cut.position(i); }, plane.normal};
  cut.keep = held;
  held->cut.cut(cut, states, ctx);
  return cut;
}

// Cells of an AMR grid, or of a lattice below dimension 3, that the plane may cut; the result is then sliced as any other mesh.
std::vector<int64_t> near_cells(const Dataset& in, const std::vector<uint8_t>& states, const Plane& plane) {
  std::vector<int64_t> r;
  auto visible = [&](size_t c) { return states.empty() || states[c] == cell_visible; };
  const AmrGrid* g = in.as<AmrGrid>();
  if (!g) {
    for (size_t c = 0; c < in.cell_count(); ++c)
      if (visible(c)) r.push_back(int64_t(c));
    return r;
  }
  for (const auto& level : g->levels)
    for (const auto& patch : level.patches) {
      const auto n = patch.cells();
      const double reach = 0.5 * (std::abs(plane.normal.x * level.spacing.x) + std::abs(plane.normal.y * level.spacing.y) + std::abs(plane.normal.z * level.spacing.z));
      size_t c = patch.cell_offset;
      for (size_t k = 0; k < n[2]; ++k)
        for (size_t j = 0; j < n[1]; ++j)
          for (size_t i = 0; i < n[0]; ++i, ++c) {
            const Vec3 index(double(patch.lo[0]) + double(i) + 0.5, double(patch.lo[1]) + double(j) + 0.5, double(patch.lo[2]) + double(k) + 0.5);
            const double d = dot(plane.normal, g->origin + index * level.spacing - plane.origin);
            if (std::abs(d) <= reach * (1 + 1e-9) + plane.snap && visible(c)) r.push_back(int64_t(c));
          }
    }
  std::sort(r.begin(), r.end());
  return r;
}

// ---- putting it together ------------------------------------------------------------------------------------------------

// Distinct keys in ascending order; a bucket per range of first ends, so that sorting and looking up stay small.
class KeyNumbers {
 public:
  KeyNumbers(const std::vector<SurfaceChunk>& chunks, size_t points) : width_(points / buckets + 1), sorted_(buckets), start_(buckets + 1) {
    std::vector<std::vector<int64_t>> found(buckets);
    for (const SurfaceChunk& c : chunks)
      for (const CellList* l : {&c.vertices, &c.lines, &c.polygons})
        for (int64_t k : l->ids) found[detail::key_a(k) / width_].push_back(k);
    parallel_for(buckets, 1, [&](size_t b, size_t) {
      auto& s = sorted_[b] = std::move(found[b]);
      std::sort(s.begin(), s.end(), [](int64_t a, int64_t c) { return uint64_t(a) < uint64_t(c); });
      s.erase(std::unique(s.begin(), s.end()), s.end());
    });
    for (size_t b = 0; b < buckets; ++b) start_[b] = sorted_[b].size();
    exclusive_scan(start_);
  }
  size_t size() const { return start_[buckets]; }
  int32_t operator()(int64_t key) const {
    const size_t b = detail::key_a(key) / width_;
    const auto at = std::lower_bound(sorted_[b].begin(), sorted_[b].end(), key, [](int64_t a, int64_t c) { return uint64_t(a) < uint64_t(c); });
    return int32_t(start_[b] + size_t(at - sorted_[b].begin()));
  }
  std::vector<int64_t> keys() const {
    std::vector<int64_t> r;
    for (const auto& s : sorted_) r.insert(r.end(), s.begin(), s.end());
    return r;
  }

 private:
  static constexpr size_t buckets = 1024;
  size_t width_;
  std::vector<std::vector<int64_t>> sorted_;
  std::vector<size_t> start_;
};

DatasetPtr finish(const Dataset& in, const Cut& cut) {
  const KeyNumbers number(cut.chunks, in.point_count());
  SurfaceMesh mesh;
  std::vector<int64_t> cells;
  auto join = [&](CellList SurfaceChunk::*member) {
    std::vector<const CellList*> lists;
    for (const SurfaceChunk& c : cut.chunks) {
      if ((c.*member).sizes.empty()) continue;
      lists.push_back(&(c.*member));
      cells.insert(cells.end(), (c.*member).sources.begin(), (c.*member).sources.end());
    }
    return cell_array(lists, [&](int64_t key) { return number(key); });
  };
  mesh.vertices = join(&SurfaceChunk::vertices);
  mesh.lines = join(&SurfaceChunk::lines);
  mesh.polygons = join(&SurfaceChunk::polygons);
  const std::vector<int64_t> keys = number.keys();
  std::vector<EdgePoint> edges(keys.size());
  double* xyz = nullptr;
  mesh.points.xyz = Array::make<double>(keys.size(), 3, &xyz);
  parallel_for(keys.size(), 1 << 12, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      edges[i] = {detail::key_a(keys[i]), detail::key_b(keys[i]), float(cut.field.share(keys[i]))};
      const Vec3 p = cut.field.place(keys[i]);
      xyz[3 * i] = p.x, xyz[3 * i + 1] = p.y, xyz[3 * i + 2] = p.z;
    }
  });
  DatasetParts out;
  carry_interpolated(out.fields, in.fields(), edges);
  carry_gathered(out.fields, in.fields(), Association::cell, cells, Association::cell);
  carry_whole(out.fields, in.fields());
  if (!in.fields().find("original_cell", Association::cell)) out.fields.add(id_field("original_cell", Association::cell, std::move(cells)));
  out.mesh = std::move(mesh);
  out.notes = in.notes();
  out.time = in.time();
  return make_dataset(std::move(out));
}

DatasetPtr slice_with(const DatasetPtr& in, const Plane& plane, Context& ctx) {
  const std::vector<uint8_t> states = cell_states(*in);
  if (auto* m = in->as<UnstructuredMesh>()) return finish(*in, cut_unstructured(*m, states, plane, ctx));
  if (auto* m = in->as<SurfaceMesh>()) return finish(*in, cut_surface(*m, states, plane, ctx));
  const auto d = lattice_dims(in->mesh());
  if (is_lattice(in->mesh()) && d[0] > 1 && d[1] > 1 && d[2] > 1) return finish(*in, cut_lattice(in->mesh(), states, plane, ctx));
  const std::vector<int64_t> cells = near_cells(*in, states, plane);
  DatasetParts part = extract_cells(in, cells, "slice")->parts();
  part.fields.add(id_field("original_cell", Association::cell, cells));
  part.cell_ghost = {};
  return slice_with(make_dataset(std::move(part)), plane, ctx);
}

}  // namespace

DatasetPtr slice(const DatasetPtr& in, const SliceParams& p, Context& ctx) {
  if (in->as<PointCloud>()) fail_usage("a plane cuts no cells of a point cloud", "slice", "keep points by value with threshold, or show the points as they are");
  if (in->point_count() >= UINT32_MAX) fail_usage("the mesh has more than 2^32 points", "slice", "take a part of it first");
  const DatasetPtr out = slice_with(in, plane_of(*in, p), ctx);
  if (out->cell_count() == 0) ctx.info("slice: the plane cuts no cell");
  return out;
}

}  // namespace sg
