// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/tensor_sampler.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "data/lattice.h"
#include "filter/flow/cursors/surface_normal.h"

namespace sg {

namespace {

// Positive tensors become logarithms; what is not positive counts as very small.
void take_logarithms(TensorField& t, std::string_view who, Context& ctx) {
  auto join_max = [](double a, double b) { return std::max(a, b); };
  const double largest = parallel_reduce(
      t.d.size(), 4096, 0.0,
      [&](size_t begin, size_t end) {
        double m = 0;
        for (size_t i = begin; i < end; ++i)
          if (t.d[i].finite()) m = std::max(m, eigen_of(t.d[i]).value[0]);
        return m;
      },
      join_max, &ctx);
  if (!(largest > 0))
    fail_data(fmt::format("no tensor of '{}' has a positive eigenvalue", t.field.name), std::string(who), "use interpolation=components");
  const double floor = 1e-6 * largest;
  const size_t raised = parallel_reduce(
      t.d.size(), 4096, size_t(0),
      [&](size_t begin, size_t end) {
        size_t n = 0;
        for (size_t i = begin; i < end; ++i) {
          if (!t.d[i].finite()) continue;
          n += eigen_of(t.d[i]).value[2] < floor;
          t.d[i] = log_of(t.d[i], floor);
        }
        return n;
      },
      [](size_t a, size_t b) { return a + b; }, &ctx);
  if (raised > 0)
    ctx.warn(fmt::format("{}: {} of {} tensors have no logarithm: their eigenvalues are raised to {:.3g}", who, raised, t.d.size(), floor));
}

// Eigenvectors in the plane across `n`, then n itself.
Eigen3 eigen_across(const SymTensor& d, Vec3 n) {
  const Vec3 least = std::abs(n.x) <= std::abs(n.y) && std::abs(n.x) <= std::abs(n.z) ? Vec3(1, 0, 0)
                     : std::abs(n.y) <= std::abs(n.z)                                 ? Vec3(0, 1, 0)
                                                                                      : Vec3(0, 0, 1);
  // In the xy-plane the axes stay x and y, so that nothing is rounded.
  const Vec3 u = n.x == 0 && n.y == 0 ? Vec3(1, 0, 0) : normalize(cross(n, least)), w = cross(n, u);
  const Eigen3 flat = eigen_in_plane({d.along(u), d.along(w), 0, dot(u, d * w), 0, 0});
  Eigen3 e;
  for (int k = 0; k < 2; ++k) e.value[k] = flat.value[k], e.vector[k] = u * flat.vector[k].x + w * flat.vector[k].y;
  e.value[2] = d.along(n), e.vector[2] = cross(e.vector[0], e.vector[1]);
  return e;
}

}  // namespace

int dimension_of_cells(const DatasetPtr& d) {
  if (const auto* amr = d->as<AmrGrid>()) return amr->dimension;
  if (is_lattice(d->mesh())) {
    int n = 0;
    for (const size_t points : lattice_dims(d->mesh())) n += points > 1;
    return n;
  }
  if (d->as<PointCloud>()) return 0;
  if (const auto* s = d->as<SurfaceMesh>()) return s->polygons.size() + s->strips.size() > 0 ? 2 : s->lines.size() > 0 ? 1 : 0;
  const auto& u = *d->as<UnstructuredMesh>();
  if (u.types.empty()) return u.cells.size() > 0 ? cell_type_info(u.single_type).dimension : 0;
  bool seen[256] = {};
  const auto types = u.types.view<uint8_t>();
  for (size_t i = 0; i < types.count; ++i) seen[types[i]] = true;
  int most = 0;
  for (int t = 0; t < 256; ++t)
    if (seen[t]) most = std::max(most, cell_type_info(CellType(t)).dimension);
  return most;
}

TensorSampler::TensorSampler(const DatasetPtr& dataset, const TensorSource& source, TensorInterpolation interpolation, std::string who,
                             Context& ctx)
    : dataset_(dataset), tensors_(read_point_tensors(dataset, source, who, ctx)), dimension_(dimension_of_cells(dataset)) {
  if (dimension_ < 2)
    fail_usage(fmt::format("a {} mesh with cells of dimension {} has nothing between its points", dataset->kind(), dimension_), who,
               "use a grid, or a mesh with surface or volume cells");
  logarithmic_ = interpolation == TensorInterpolation::log;
  if (logarithmic_) take_logarithms(tensors_, who, ctx);
  locator_ = std::make_unique<const CellLocator>(dataset, ctx);
}

bool TensorCursor::find(Vec3 x) {
  cell_ = locator_.find(x);
  if (cell_ >= 0 || sampler_->dimension() == 3 || measured_ < 0) return cell_ >= 0;
  // Steps leave curved surfaces: the nearest place within a cell.
  const NearestPlace near = locator_.nearest(x, 0.5 * length_);
  if (near.cell >= 0 && near.distance2 > 0) {
    // Beyond the border the nearest place is on it, aside of x; above the surface it is below x.
    cell_ = locator_.find(near.at);
    if (cell_ >= 0) {
      CellMap& map = locator_.map();
      if (map.reader().cell() != size_t(cell_)) map.open(size_t(cell_));
      const Vec3 n = surface_normal(map, locator_.place().rst), off = x - near.at;
      if (std::abs(dot(n, off)) < 0.5 * length(off)) cell_ = -1;
    }
  }
  return cell_ >= 0;
}

void TensorCursor::measure() {
  if (cell_ == measured_) return;
  measured_ = cell_;
  CellMap& map = locator_.map();
  if (map.reader().cell() != size_t(cell_)) map.open(size_t(cell_));
  const Vec3 size = map.reader().box().size();
  const double largest = std::max({size.x, size.y, size.z});
  double product = 1;
  int n = 0;
  for (int a = 0; a < 3; ++a)
    if (size[a] > 1e-6 * largest) product *= size[a], ++n;
  length_ = n > 0 ? std::pow(product, 1.0 / n) : 0;
}

bool TensorCursor::tensor(Vec3 x, SymTensor& d) {
  if (!find(x)) return false;
  const auto ids = locator_.ids();
  const auto weights = locator_.weights();
  const SymTensor* from = sampler_->tensors().d.data();
  d = {};
  for (size_t k = 0; k < ids.size(); ++k)
    if (weights[k] != 0) d = d + from[size_t(ids[k])] * weights[k];
  measure();
  if (!d.finite()) return false;
  if (sampler_->logarithmic()) d = exp_of(d);
  return true;
}

bool TensorCursor::eigen(Vec3 x, Eigen3& e) {
  SymTensor d;
  if (!tensor(x, d)) return false;
  if (sampler_->dimension() == 3) {
    e = eigen_of(d);
    return true;
  }
  CellMap& map = locator_.map();
  if (map.reader().cell() != size_t(cell_)) map.open(size_t(cell_));
  const Vec3 n = surface_normal(map, locator_.place().rst);
  if (!(length(n) > 0)) return false;
  e = eigen_across(d, n);
  return true;
}

Vec3 TensorCursor::snap(Vec3 x) {
  if (sampler_->dimension() == 3) return x;
  const NearestPlace near = locator_.nearest(x, measured_ < 0 ? HUGE_VAL : length_);
  return near.cell >= 0 ? near.at : x;
}

}  // namespace sg
