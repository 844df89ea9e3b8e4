// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/contour_normals.h"

#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "data/cells/cell_topology.h"
#include "filter/scalar/contour/cells/contour_cell_scan.h"
#include "filter/scalar/contour/contour_finder.h"

namespace sg::contouring {

namespace {

struct Sum {
  double g[4] = {};  // integral of the gradient, volume
  void add(const double* v) {
    for (int i = 0; i < 4; ++i) g[i] += v[i];
  }
};

// Cells and the points at which their gradients are wanted, a run of cells at a time. Each run adds to sums of its own, which are
// then joined in the order of the runs: the same bytes for any number of threads, and no lists of cells at points.
class Gradients {
 public:
  Gradients(const Job& job, const UnstructuredMesh& mesh)
      : job_(job), mesh_(mesh), cells_(cells_view(mesh.cells)), points_(mesh.points), f_(job.samples) {
    if (!job.input.cell_ghost().empty()) ghost_ = job.input.cell_ghost().view<uint8_t>();
  }

  using Corners = std::span<const std::array<uint32_t, 8>>;
  Array run(std::span<const EdgePoint> edges, std::span<const InnerPoint> inner, Corners corners) {
    number_points(edges, corners);
    sums_.assign(size_t(count_), Sum{});
    constexpr size_t wave = 32;                                              // runs at once: bounds the memory of their sums
    const size_t grain = std::max<size_t>(1 << 14, cells_.count / 256 + 1);  // read twice: stays in the cache
    for (size_t first = 0; first < cells_.count; first += wave * grain) {
      const size_t end = std::min(cells_.count, first + wave * grain);
      std::vector<Run> runs((end - first + grain - 1) / grain);
      parallel_for(
          runs.size(), 1, [&](size_t r, size_t) { add_cells(first + r * grain, std::min(end, first + (r + 1) * grain), runs[r]); },
          &job_.context);
      parallel_for(sums_.size(), 1 << 13, [&](size_t b, size_t e) {
        for (const Run& r : runs) {
          if (r.sums.empty()) continue;
          for (size_t s = std::max(b, r.first); s < std::min(e, r.first + r.sums.size() - 1); ++s) sums_[s].add(r.sums[s - r.first + 1].g);
        }
      });
    }
    return normals(edges, inner, corners);
  }

 private:
  struct Run {
    size_t first = 0;
    std::vector<Sum> sums;
  };

  Vec3 at(size_t p) const { return points_.offset(p); }

  // Slots for the ends of the edges, in the order of the points.
  void number_points(std::span<const EdgePoint> edges, Corners corners) {
    const size_t n = mesh_.points.count();
    used_.assign(n + 8, 0);
    parallel_for(edges.size(), 1 << 14, [&](size_t b, size_t e) {
      for (size_t i = b; i < e; ++i)
        for (uint32_t p : {edges[i].a, edges[i].b}) std::atomic_ref<uint8_t>(used_[p]).store(1, std::memory_order_relaxed);
    });
    for (const auto& eight : corners)
      for (uint32_t p : eight) used_[p] = 1;
    slot_ = std::make_unique_for_overwrite<uint32_t[]>(n);
    constexpr size_t grain = 1 << 14;
    std::vector<size_t> first(n / grain + 2, 0);
    parallel_for(n, grain, [&](size_t b, size_t e) {
      size_t k = 0;
      for (size_t p = b; p < e; ++p) k += used_[p];
      first[b / grain] = k;
    });
    count_ = exclusive_scan(first);
    parallel_for(n, grain, [&](size_t b, size_t e) {
      uint32_t k = uint32_t(first[b / grain]);
      for (size_t p = b; p < e; ++p) slot_[p] = k, k += used_[p];
    });
  }

  // Sums for the slots of the points that visit(f) names; the first slot. A point that is not wanted has the slot of the next one
  // that is; the first sum absorbs what is not needed, which saves a branch.
  template <class Visit>
  uint32_t range(Run& run, Visit&& visit) const {
    uint32_t lo = UINT32_MAX, hi = 0;
    visit([&](size_t p) { lo = std::min(lo, slot_[p]), hi = std::max(hi, slot_[p]); });
    run.first = lo;
    run.sums.resize(hi - lo + 2);
    return lo;
  }

  // The same as add_cells for a mesh of only tetrahedra, without a type check in the loop.
  bool add_tetrahedra(std::span<const uint32_t> list, Run& run) const {
    const ElementType t = job_.samples.type();
    if (!mesh_.types.empty() || mesh_.single_type != CellType::tetra || cells_.fixed != 4 || ghost_.count || !is_float(t)) return false;
    auto with_ids = [&]<class X, class F>(const X* xyz, const F* f) {
      if (cells_.connectivity.wide) add_tetrahedra(static_cast<const int64_t*>(cells_.connectivity.data), xyz, f, list, run);
      else add_tetrahedra(static_cast<const int32_t*>(cells_.connectivity.data), xyz, f, list, run);
    };
    auto with_places = [&]<class X>(const X* xyz) {
      if (t == ElementType::f32) with_ids(xyz, reinterpret_cast<const float*>(job_.samples.raw()));
      else with_ids(xyz, reinterpret_cast<const double*>(job_.samples.raw()));
    };
    if (points_.floats()) with_places(points_.floats());
    else with_places(points_.doubles());
    return true;
  }

  template <class I, class X, class F>
  void add_tetrahedra(const I* ids, const X* xyz, const F* f, std::span<const uint32_t> list, Run& run) const {
    const uint32_t lo = range(run, [&](auto&& each) {
      for (uint32_t c : list)
        for (size_t k = 0; k < 4; ++k) each(size_t(ids[4 * size_t(c) + k]));
    });
    const uint8_t* used = used_.data();
    const uint32_t* slot = slot_.get();
    Sum* sums = run.sums.data();
    auto place = [&](size_t p) { return Vec3(double(xyz[3 * p]), double(xyz[3 * p + 1]), double(xyz[3 * p + 2])); };
    for (uint32_t c : list) {
      size_t p[4];
      for (size_t k = 0; k < 4; ++k) p[k] = size_t(ids[4 * size_t(c) + k]);
      double v[4];
      tetra(place(p[0]), place(p[1]), place(p[2]), place(p[3]), double(f[p[0]]), double(f[p[1]]), double(f[p[2]]), double(f[p[3]]), v);
      const double sign = v[3] < 0 ? -1 : 1;  // a cell turned inside out
      for (double& x : v) x *= sign;
      if (!std::isfinite(v[0] + v[1] + v[2])) [[unlikely]]
        continue;
      for (size_t q : p) sums[(slot[q] - lo + 1) & (0u - used[q])].add(v);
    }
  }

  void add_cells(size_t begin, size_t end, Run& run) const {
    thread_local std::vector<uint32_t> touched;
    touched.resize(end - begin + 1);
    const size_t n =
        scan_cells(cells_, begin, end, used_.data(), touched.data(), [](uint32_t any, uint32_t) { return uint32_t(any != 0); });
    if (n == 0) return;
    const std::span<const uint32_t> list(touched.data(), n);
    if (add_tetrahedra(list, run)) return;
    const uint32_t lo = range(run, [&](auto&& each) {
      for (uint32_t c : list)
        for (size_t k = cells_.begin(c); k < cells_.end(c); ++k) each(size_t(cells_.connectivity[k]));
    });
    CellFaceReader faces(mesh_);
    for (size_t i = 0; i < n; ++i) {
      const size_t c = touched[i];
      if (ghost_.count && (ghost_[c] & (ghost_hidden_cell | ghost_refined_cell))) continue;
      double v[4];
      const CellType type = mesh_.type(c);
      if (type == CellType::tetra) tetra(c, v);
      else if (!solid(c, faces, v)) continue;
      if (v[3] < 0)
        for (double& x : v) x = -x;  // a cell turned inside out
      if (!std::isfinite(v[0] + v[1] + v[2])) continue;
      for (size_t k = cells_.begin(c); k < cells_.end(c); ++k) {
        const size_t p = size_t(cells_.connectivity[k]);
        run.sums[(slot_[p] - lo + 1) & (0u - used_[p])].add(v);
      }
    }
  }

  static void tetra(Vec3 o, Vec3 a, Vec3 b, Vec3 c, double f, double fa, double fb, double fc, double v[4]) {
    const Vec3 x = a - o, y = b - o, z = c - o, yz = cross(y, z);
    const Vec3 g = yz * (fa - f) + cross(z, x) * (fb - f) + cross(x, y) * (fc - f);
    v[0] = g.x, v[1] = g.y, v[2] = g.z, v[3] = dot(x, yz);
  }
  void tetra(size_t c, double v[4]) const {
    size_t p[4];
    for (size_t k = 0; k < 4; ++k) p[k] = size_t(cells_.point(c, k));
    tetra(at(p[0]), at(p[1]), at(p[2]), at(p[3]), f_(p[0]), f_(p[1]), f_(p[2]), f_(p[3]), v);
  }

  // Faces as fans around the mean of their corners; six times everything, as above.
  bool solid(size_t c, CellFaceReader& faces, double v[4]) const {
    const bool polyhedron = mesh_.type(c) == CellType::polyhedron;
    PolyhedronFaces own;
    if (polyhedron) own = outward_faces(mesh_, c);
    const size_t n = polyhedron ? own.size() : faces.open(c);
    if (n == 0) return false;
    const size_t first = size_t(cells_.connectivity[cells_.begin(c)]);
    const Vec3 base = at(first);
    const double zero = f_(first);
    v[0] = v[1] = v[2] = v[3] = 0;
    for (size_t k = 0; k < n; ++k) {
      const std::span<const int64_t> face = polyhedron ? std::span<const int64_t>(own[k]) : faces.corners(k);
      if (face.size() < 3) continue;
      Vec3 middle;
      double mean = 0;
      for (int64_t p : face) middle += at(size_t(p)) - base, mean += f_(size_t(p)) - zero;
      middle = middle * (1.0 / double(face.size())), mean /= double(face.size());
      Vec3 a = at(size_t(face.back())) - base;
      double fa = f_(size_t(face.back())) - zero;
      for (int64_t p : face) {
        const Vec3 b = at(size_t(p)) - base, area = cross(a - middle, b - middle);
        const double fb = f_(size_t(p)) - zero, f = fa + fb + mean;
        v[0] += area.x * f, v[1] += area.y * f, v[2] += area.z * f;
        v[3] += dot(area, middle);
        a = b, fa = fb;
      }
    }
    return true;
  }

  static void put(Vec3 g, float* out) {
    const double square = dot(g, g);
    const double scale = square > 0 && std::isfinite(square) ? -1 / std::sqrt(square) : 0;
    for (int c = 0; c < 3; ++c) out[c] = scale != 0 ? float(g[c] * scale) : 0.0f;
  }

  Array normals(std::span<const EdgePoint> edges, std::span<const InnerPoint> inner, Corners corners) const {
    float* out = nullptr;
    Array a = Array::make<float>(edges.size() + inner.size(), 3, &out);
    parallel_for(edges.size(), 1 << 13, [&](size_t b, size_t e) {
      for (size_t i = b; i < e; ++i) {
        const EdgePoint edge = edges[i];
        const double *from = sums_[slot_[edge.a]].g, *to = sums_[slot_[edge.b]].g;
        // A point all of whose cells are flat or lack values: only the other end.
        const double s = from[3] > 0 ? (1 - double(edge.t)) / from[3] : 0, t = to[3] > 0 ? double(edge.t) / to[3] : 0;
        put(Vec3(from[0], from[1], from[2]) * s + Vec3(to[0], to[1], to[2]) * t, out + 3 * i);
      }
    });
    for (size_t i = 0; i < inner.size(); ++i) {
      Vec3 g;
      for (size_t c = 0; c < 8; ++c) {
        double w = 1;
        for (size_t k = 0; k < 3; ++k) w *= c >> k & 1 ? double(inner[i].at[k]) : 1 - double(inner[i].at[k]);
        const double* at = sums_[slot_[corners[i][c]]].g;
        if (at[3] > 0) g += Vec3(at[0], at[1], at[2]) * (w / at[3]);
      }
      put(g, out + 3 * (edges.size() + i));
    }
    return a;
  }

  const Job& job_;
  const UnstructuredMesh& mesh_;
  CellsView cells_;
  Positions points_;
  Sample f_;
  View<uint8_t> ghost_;
  std::vector<uint8_t> used_;
  std::unique_ptr<uint32_t[]> slot_;
  size_t count_ = 0;
  std::vector<Sum> sums_;
};

}  // namespace

Array cell_normals(const Job& job, const UnstructuredMesh& mesh, std::span<const EdgePoint> edges, std::span<const InnerPoint> inner,
                   std::span<const std::array<uint32_t, 8>> corners) {
  return Gradients(job, mesh).run(edges, inner, corners);
}

}  // namespace sg::contouring
