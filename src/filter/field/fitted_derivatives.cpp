// SPDX-License-Identifier: Apache-2.0
#include "filter/field/fitted_derivatives.h"

#include "base/parallel.h"
#include "data/cell_reader.h"
#include "data/point_cells.h"
#include "data/point_positions.h"
#include "filter/field/quadratic_fit.h"

namespace sg {

namespace {

// What surrounds a place: other places, the dimension of the cells there, and across surfaces their normal.
class Surroundings {
 public:
  Surroundings(const DatasetPtr& d, Association on, const PointCells& cells, const Array& at)
      : reader_(d), on_(on), cells_(cells), at_(at.view<double>()) {}

  /// Other places within `rings` steps, ascending.
  const std::vector<int64_t>& open(size_t i, int rings) {
    found_.clear();
    dimension_ = 0;
    normal_ = {0, 0, 0};
    add_ring(int64_t(i), true);
    for (int r = 1; r < rings; ++r) {
      const std::vector<int64_t> before = found_;
      for (const int64_t p : before) add_ring(p, false);
      tidy();
    }
    tidy();
    found_.erase(std::remove(found_.begin(), found_.end(), int64_t(i)), found_.end());
    return found_;
  }
  int dimension() const { return dimension_; }
  Vec3 normal() const { return normal_; }
  Vec3 position(size_t i) const { return {at_(i, 0), at_(i, 1), at_(i, 2)}; }

 private:
  void tidy() {
    std::sort(found_.begin(), found_.end());
    found_.erase(std::unique(found_.begin(), found_.end()), found_.end());
  }
  void look_at(size_t cell) {
    reader_.open(cell);
    if (reader_.dimension() > dimension_) dimension_ = reader_.dimension(), normal_ = {0, 0, 0};
    if (dimension_ != 2 || reader_.dimension() != 2) return;
    const auto at = reader_.at();
    Vec3 n{0, 0, 0};
    for (size_t k = 1; k + 1 < at.size(); ++k) n = n + cross(at[k] - at[0], at[k + 1] - at[0]);
    normal_ = dot(n, normal_) < 0 ? normal_ - n : normal_ + n;
  }
  void add_ring(int64_t i, bool own) {
    if (on_ == Association::point) {
      for (const uint32_t c : cells_[size_t(i)]) {
        if (own) look_at(c);
        else reader_.open(c);
        found_.insert(found_.end(), reader_.ids().begin(), reader_.ids().end());
      }
      return;
    }
    if (own) look_at(size_t(i));
    else reader_.open(size_t(i));
    points_.assign(reader_.ids().begin(), reader_.ids().end());
    for (const int64_t p : points_)
      for (const uint32_t c : cells_[size_t(p)]) found_.push_back(int64_t(c));
  }

  CellReader reader_;
  Association on_;
  const PointCells& cells_;
  View<double> at_;
  std::vector<int64_t> found_, points_;
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
