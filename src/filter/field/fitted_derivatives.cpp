// SPDX-License-Identifier: Apache-2.0
#include "filter/field/fitted_derivatives.h"

#include "base/parallel.h"
#include "data/cell_reader.h"
#include "data/point_cells.h"
#include "data/point_positions.h"
#include "filter/field/quadratic_fit.h"

namespace sg {

namespace {

// Ids without repetition, in the order in which they came: that order depends on the mesh alone.
class IdList {
 public:
  void clear() {
    ids_.clear();
    if (++stamp_ == 0) std::fill(table_.begin(), table_.end(), Entry{}), stamp_ = 1;
  }
  void add(int64_t id) {
    if (2 * ids_.size() >= table_.size()) grow();
    if (claim(id)) ids_.push_back(id);
  }
  const std::vector<int64_t>& ids() const { return ids_; }

 private:
  struct Entry {
    int64_t id = -1;
    uint32_t stamp = 0;
  };
  bool claim(int64_t id) {
    const size_t mask = table_.size() - 1;
    for (size_t at = size_t(uint64_t(id) * 0x9e3779b97f4a7c15u >> 40) & mask;; at = (at + 1) & mask) {
      Entry& e = table_[at];
      if (e.stamp == stamp_ && e.id == id) return false;
      if (e.stamp == stamp_) continue;
      e = {id, stamp_};
      return true;
    }
  }
  void grow() {
    table_.assign(table_.size() * 2, {});
    stamp_ = 1;
    for (const int64_t id : ids_) claim(id);
  }
  std::vector<Entry> table_ = std::vector<Entry>(256);
  std::vector<int64_t> ids_;
  uint32_t stamp_ = 0;
};

// What surrounds a place: other places, the dimension of the cells there, and across surfaces their normal.
class Surroundings {
 public:
  Surroundings(const DatasetPtr& d, Association on, const PointCells& cells, const Array& at)
      : reader_(d), on_(on), cells_(cells), at_(at.view<double>()) {}

  /// Places within `rings` steps, the place itself among them.
  const std::vector<int64_t>& open(size_t i, int rings) {
    found_.clear();
    dimension_ = 0;
    normal_ = {0, 0, 0};
    add_ring(int64_t(i), true);
    for (int r = 1; r < rings; ++r) {
      const std::vector<int64_t> before = found_.ids();
      for (const int64_t p : before) add_ring(p, false);
    }
    return found_.ids();
  }
  int dimension() const { return dimension_; }
  Vec3 normal() const { return normal_; }
  Vec3 position(size_t i) const { return {at_(i, 0), at_(i, 1), at_(i, 2)}; }

 private:
  void look_at(size_t cell) {
    reader_.open(cell);
    if (reader_.dimension() > dimension_) dimension_ = reader_.dimension(), normal_ = {0, 0, 0};
    if (dimension_ != 2 || reader_.dimension() != 2) return;
    const auto at = reader_.at();
    Vec3 n{0, 0, 0};
    for (size_t k = 1; k + 1 < at.size(); ++k) {
      // Points of pixels and strips go to and fro, and so do these triangles.
      const Vec3 t = cross(at[k] - at[0], at[k + 1] - at[0]);
      n = dot(t, n) < 0 ? n - t : n + t;
    }
    normal_ = dot(n, normal_) < 0 ? normal_ - n : normal_ + n;
  }
  void add_ring(int64_t i, bool own) {
    if (on_ == Association::point) {
      for (const uint32_t c : cells_[size_t(i)]) {
        if (own) look_at(c);
        else reader_.open(c);
        for (const int64_t p : reader_.ids()) found_.add(p);
      }
      return;
    }
    if (own) look_at(size_t(i));
    else reader_.open(size_t(i));
    points_.assign(reader_.ids().begin(), reader_.ids().end());
    for (const int64_t p : points_)
      for (const uint32_t c : cells_[size_t(p)]) found_.add(int64_t(c));
  }

  CellReader reader_;
  Association on_;
  const PointCells& cells_;
  View<double> at_;
  IdList found_;
  std::vector<int64_t> points_;
  int dimension_ = 0;
  Vec3 normal_;
};

Array cell_centers(const DatasetPtr& d) {
  double* out = nullptr;
  Array a = Array::make<double>(d->cell_count(), 3, &out);
  const CellReader all(d);
  parallel_for(d->cell_count(), 1 << 12, [&](size_t begin, size_t end) {
    CellReader reader = all;
    for (size_t c = begin; c < end; ++c) {
      reader.open(c);
      Vec3 sum{0, 0, 0};
      for (const Vec3& p : reader.at()) sum = sum + p;
      for (int k = 0; k < 3; ++k) out[3 * c + size_t(k)] = sum[k] / double(std::max<size_t>(reader.at().size(), 1));
    }
  });
  return a;
}

// One place: all components share the geometry unless values are missing.
struct Worker {
  Surroundings around;
  View<double> f;
  QuadraticFit fit;
  std::vector<Vec3> offsets;
  std::vector<int64_t> used, placed;
  std::vector<double> differences;

  // Neighbours whose component c is a number and that do not lie on the place itself.
  void choose(const std::vector<int64_t>& found, size_t i, int c) {
    used.clear();
    for (const int64_t q : found) {
      const Vec3 d = around.position(size_t(q)) - around.position(i);
      if (dot(d, d) > 0 && std::isfinite(f(size_t(q), c))) used.push_back(q);
    }
  }
  void derive(size_t i, double* gradient, double* hessian) {
    const int n = f.components;
    placed.clear();
    for (int c = 0; c < n; ++c) {
      Vec3 g{NAN, NAN, NAN};
      double h[6] = {NAN, NAN, NAN, NAN, NAN, NAN};
      if (std::isfinite(f(i, c))) {
        choose(around.open(i, 1), i, c);
        // A few more than a parabola needs, so that it is a fit; borders and corners of tets have less around them.
        if (used.size() < QuadraticFit::needed(std::max(around.dimension(), 1)) + 3) choose(around.open(i, 2), i, c);
        if (!used.empty() && around.dimension() > 0) {
          if (used != placed) {
            offsets.clear();
            for (const int64_t q : used) offsets.push_back(around.position(size_t(q)) - around.position(i));
            fit.place(offsets, around.dimension(), around.normal());
            placed = used;
          }
          differences.clear();
          for (const int64_t q : used) differences.push_back(f(size_t(q), c) - f(i, c));
          fit.solve(differences, g, h);
        }
      }
      for (int a = 0; a < 3; ++a) gradient[3 * c + a] = g[a];
      if (hessian) std::copy_n(h, 6, hessian + 6 * c);
    }
  }
};

}  // namespace

void fitted_derivatives(const DatasetPtr& d, Association on, const Array& values, double* gradient, double* hessian, Context& context) {
  const PointCells cells(d);
  const Array at = on == Association::point ? point_positions(d->mesh()) : cell_centers(d);
  const auto f = values.view<double>();
  const auto n = size_t(f.components);
  parallel_for(
      values.count(), 512,
      [&](size_t begin, size_t end) {
        Worker w{Surroundings(d, on, cells, at), f, {}, {}, {}, {}, {}};
        for (size_t i = begin; i < end; ++i) w.derive(i, gradient + 3 * n * i, hessian ? hessian + 6 * n * i : nullptr);
      },
      &context);
}

}  // namespace sg
