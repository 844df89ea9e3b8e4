// SPDX-License-Identifier: Apache-2.0
// VolumeItem -> Volume: checks, geometry, samples, index.
#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/memory/memo.h"
#include "render/volume/sources/item_checks.h"
#include "render/volume/sources/lattice/lattice_volume.h"

namespace sg::volume {

namespace {

constexpr uint8_t not_drawn = ghost_duplicate | ghost_refined_cell | ghost_hidden_cell;

/// Geometry of one axis: where the samples lie relative to the points.
struct AxisPlan {
  size_t points, samples;
  bool cells;  // samples are the middles of cells (also the one point of an axis: the middle of a slab)
};

void uniform_geometry(const UniformGrid& g, const AxisPlan plan[3], Volume& v, double& smallest) {
  Mat3 m;
  smallest = HUGE_VAL;
  for (int a = 0; a < 3; ++a)
    if (plan[a].points > 1) smallest = std::min(smallest, length(g.direction.column(a)) * std::abs(g.spacing[a]));
  if (smallest == HUGE_VAL) smallest = 1;
  for (int a = 0; a < 3; ++a) {
    Vec3 edge = g.direction.column(a) * g.spacing[a];
    if (plan[a].points == 1 && length(edge) == 0) edge = normalize(g.direction.column(a)) * smallest;
    smallest = plan[a].points == 1 ? std::min(smallest, length(edge)) : smallest;
    for (int r = 0; r < 3; ++r) m.m[r][a] = edge[r];
    v.lo[a] = plan[a].cells ? -0.5 : 0;
    v.hi[a] = plan[a].points == 1 ? 0.5 : plan[a].cells ? double(plan[a].points) - 1.5 : double(plan[a].points) - 1;
  }
  v.origin = g.origin;
  const double det = determinant(m);
  if (det == 0 || !std::isfinite(det)) {
    v.hi = v.lo - Vec3{1, 1, 1};  // no extent: an empty box
    return;
  }
  // Cells: sample 0 lies half an edge after the first point.
  for (int a = 0; a < 3; ++a)
    if (plan[a].cells && plan[a].points > 1) v.origin += m.column(a) * 0.5;
  v.to_q = inverse(m);
}

void rectilinear_geometry(const RectilinearGrid& g, const AxisPlan plan[3], Volume& v, double& smallest) {
  const Array* arrays[3] = {&g.x, &g.y, &g.z};
  smallest = HUGE_VAL;
  for (const Array* a : arrays)
    for (size_t i = 0; i + 1 < a->count(); ++i)
      if (const double d = std::abs(a->get(i + 1) - a->get(i)); d > 0) smallest = std::min(smallest, d);
  if (smallest == HUGE_VAL) smallest = 1;
  v.affine = false;
  v.to_q = Mat3{};
  for (int a = 0; a < 3; ++a) {
    const size_t n = plan[a].points;
    const double first = arrays[a]->get(0), sign = n > 1 && arrays[a]->get(n - 1) < first ? -1 : 1;
    v.to_q.m[a][a] = sign, v.origin[a] = first;
    auto at = [&](size_t i) { return sign * (arrays[a]->get(i) - first); };
    std::vector<double>& c = v.coordinates[a];
    if (n == 1) {
      v.lo[a] = -0.5 * smallest, v.hi[a] = 0.5 * smallest;
      c = {v.lo[a], v.hi[a]};
    } else {
      v.lo[a] = 0, v.hi[a] = at(n - 1);
      for (size_t i = 0; i < plan[a].samples; ++i) c.push_back(plan[a].cells ? 0.5 * (at(i) + at(i + 1)) : at(i));
      if (c.size() == 1) c = {v.lo[a], v.hi[a]};
    }
    // Slices of equal width, four per cell, each with the cell in which it begins.
    const size_t slices = std::min<size_t>(4 * c.size(), 1 << 20);
    const double extent = c.back() - c.front();
    v.slices_per_q[a] = extent > 0 ? double(slices) / extent : 0;
    v.first_cell[a].resize(slices + 1);
    uint32_t cell = 0;
    for (size_t s = 0; s <= slices; ++s) {
      const double q = c.front() + extent * double(s) / double(slices);
      while (cell + 2 < c.size() && c[cell + 1] <= q) ++cell;
      v.first_cell[a][s] = cell;
    }
  }
}

/// Repeats the only layer of an axis, so that every axis has two samples.
template <class T>
Array doubled(const T* in, std::array<size_t, 3> from, std::array<size_t, 3> to) {
  T* out = nullptr;
  Array r = Array::make<T>(to[0] * to[1] * to[2], 1, &out);
  for (size_t k = 0; k < to[2]; ++k)
    for (size_t j = 0; j < to[1]; ++j)
      for (size_t i = 0; i < to[0]; ++i)
        out[i + to[0] * (j + to[1] * k)] =
            in[std::min(i, from[0] - 1) + from[0] * (std::min(j, from[1] - 1) + from[1] * std::min(k, from[2] - 1))];
  return r;
}

/// NaN where `ghost` has one of `bits`.
Array without_ghosts(const Array& values, const Array& ghost, uint8_t bits) {
  const Array f = values.converted(ElementType::f32);
  const View<float> in = f.view<float>();
  const View<uint8_t> g = ghost.view<uint8_t>();
  float* out = nullptr;
  Array r = Array::make<float>(values.count(), 1, &out);
  parallel_for(values.count(), 65536, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) out[i] = g[i] & bits ? NAN : in[i];
  });
  return r;
}

bool any_ghost(const Array& ghost, uint8_t bits) {
  if (ghost.empty()) return false;
  const View<uint8_t> g = ghost.view<uint8_t>();
  for (size_t i = 0; i < g.count; ++i)
    if (g[i] & bits) return true;
  return false;
}

/// Wide types as f32 relative to the middle of their range, so that small differences of large values survive.
Array narrowed(const Array& wide, Range range, float& base) {
  base = range.empty() ? 0 : float(0.5 * range.lo + 0.5 * range.hi);
  float* out = nullptr;
  Array r = Array::make<float>(wide.count(), 1, &out);
  dispatch(wide, [&](auto v) {
    parallel_for(v.count, 65536, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = float(double(v[i]) - double(base));
    });
  });
  return r;
}

bool any_nan(const Array& values) {
  if (values.type() != ElementType::f32) return false;
  const View<float> in = values.view<float>();
  const auto among = [&](size_t begin, size_t end) { return std::any_of(in.data + begin, in.data + end, [](float x) { return x != x; }); };
  return parallel_reduce(in.count, 65536, false, among, [](bool a, bool b) { return a || b; });
}

bool native(ElementType t) {
  return t == ElementType::u8 || t == ElementType::i8 || t == ElementType::u16 || t == ElementType::i16 || t == ElementType::f32;
}

bool wants_small_differences(const VolumeItem& item) { return item.color.kind == ScaleKind::linear && item.color.labels.empty(); }

LatticeSamples take_samples(const VolumeItem& item, const Field& field, std::array<size_t, 3> dims) {
  LatticeSamples v;
  const Dataset& d = *item.data;
  const bool cells = field.association == Association::cell;
  const bool magnitude = item.component < 0 && field.components() > 1;
  Array a = magnitude
                ? scalar_of(field, -1,
                            is_float(field.array.type()) && element_size(field.array.type()) == 8 ? ElementType::f64 : ElementType::f32)
                : field.array.component(std::max(item.component, 0));
  if (!native(a.type()))
    a = wants_small_differences(item) ? narrowed(a, d.range(field, item.component), v.base) : a.converted(ElementType::f32);
  a = a.made_packed();
  const Array& ghost = cells ? d.cell_ghost() : d.point_ghost();
  const uint8_t bits = cells ? not_drawn : uint8_t(ghost_hidden_point);
  if (any_ghost(ghost, bits)) a = without_ghosts(a, ghost, bits);
  if (!cells && any_ghost(d.cell_ghost(), not_drawn)) {
    const View<uint8_t> g = d.cell_ghost().view<uint8_t>();
    v.hidden.resize(g.count);
    for (size_t i = 0; i < g.count; ++i) v.hidden[i] = g[i] & not_drawn;
  }
  v.voxels.dims = dims;
  for (size_t& n : v.voxels.dims) n = std::max<size_t>(n, 2);
  if (v.voxels.dims != dims) a = dispatch(a, [&](auto view) { return doubled(view.data, dims, v.voxels.dims); });
  v.voxels.array = a, v.holes = cells && any_nan(a);
  v.fine = fine_bricks(v.voxels.array, v.voxels.dims);
  v.bricks = coarse_bricks(v.fine);
  for (const MinMaxBricks::Range& r : v.bricks.ranges) {
    if (std::isfinite(r.lo)) v.lo = std::min(v.lo, double(r.lo));
    if (std::isfinite(r.hi)) v.hi = std::max(v.hi, double(r.hi));
    v.infinite = v.infinite || (r.lo <= r.hi && !(std::isfinite(r.lo) && std::isfinite(r.hi)));
  }
  return v;
}

std::string key_of(const VolumeItem& item, const Field& field, const char* what) {
  return fmt::format("volume {}: {} {} {} {}", what, int(field.association), item.component, wants_small_differences(item), field.name);
}

/// Taken once for all pictures of the field.
std::shared_ptr<const LatticeSamples> kept_samples(const VolumeItem& item, const Field& field, std::array<size_t, 3> dims) {
  const std::string key = key_of(item, field, "lattice");
  Memo& memo = item.data->memo();
  if (auto kept = memo.find<LatticeSamples>(key)) return kept;
  LatticeSamples s = take_samples(item, field, dims);
  const size_t own = s.voxels.array.raw() == field.array.raw() ? 0 : s.voxels.array.bytes();
  const size_t bytes = own + s.hidden.size() + (s.bricks.size() + s.fine.size()) * sizeof(MinMaxBricks::Range);
  return memo.keep(key, std::move(s), bytes);
}

/// q of the sides of `bricks` cubes of so many cells. Beyond the outermost samples values are clamped: those half cells belong to the
/// outermost bricks.
std::vector<double> sides(const Volume& v, size_t axis, size_t bricks, size_t edge) {
  std::vector<double> q(bricks + 1);
  for (size_t i = 0; i <= bricks; ++i) {
    const size_t s = std::min(i * edge, v.voxels.dims[axis] - 1);
    q[i] = v.affine ? double(s) : v.coordinates[axis][s];
  }
  q.front() = -HUGE_VAL, q.back() = HUGE_VAL;
  return q;
}

void lay_borders(Volume& v) {
  for (int a = 0; a < 3; ++a) {
    const size_t axis = size_t(a), samples = v.voxels.dims[axis];
    v.border[a] = sides(v, axis, v.bricks().dims[axis], MinMaxBricks::edge);
    v.fine_border[a] = sides(v, axis, v.fine().dims[axis], FineBricks::edge);
    // Places are floats in u: some units in the last place of the largest.
    v.margin[a] = v.affine ? std::max(1e-3, 1e-6 * double(samples)) : 1e-7 * (v.hi[a] - v.lo[a]);
  }
}

}  // namespace

bool Volume::within_samples() const {
  constexpr size_t most = 1 << 20;  // of numbers with 24 bits, which some roundings add up
  for (size_t a = 0; a < 3; ++a)
    if (lo[int(a)] < 0 || hi[int(a)] > double(voxels.dims[a] - 1) || voxels.dims[a] > most) return false;
  return affine;
}

float Volume::u(int a, double q) const {
  if (affine) return float(std::clamp(q, 0.0, double(voxels.dims[size_t(a)] - 1)));
  const std::vector<double>& c = coordinates[a];
  if (!(q > c.front())) return 0;
  if (q >= c.back()) return float(c.size() - 1);
  size_t i = first_cell[a][size_t((q - c.front()) * slices_per_q[a])];
  while (i > 0 && c[i] > q) --i;
  while (i + 2 < c.size() && c[i + 1] <= q) ++i;
  const double edge = c[i + 1] - c[i];
  return float(double(i) + (edge > 0 ? (q - c[i]) / edge : 0));
}

double Volume::cell_length(int a, double q) const {
  if (affine) return 1;
  const std::vector<double>& c = coordinates[a];
  const size_t i = std::min(size_t(u(a, q)), c.size() - 2);
  return c[i + 1] - c[i];
}

std::shared_ptr<const Bends> bends_of(const VolumeItem& item, const Volume& v) {
  const std::string key = key_of(item, field_of(item), "bends");
  Memo& memo = item.data->memo();
  if (auto kept = memo.find<Bends>(key)) return kept;
  Bends b = find_bends(v.voxels.array, v.voxels.dims, float(v.samples->hi - v.samples->lo), v.dual);
  const size_t bytes = b.codes.size();
  return memo.keep(key, std::move(b), bytes);
}

Volume prepare(const VolumeItem& item, uint32_t id, const Knobs& knobs) {
  check(item);
  const Field& field = field_of(item);
  const Mesh& mesh = item.data->mesh();
  const bool cells = field.association == Association::cell;
  const std::array<size_t, 3> points = lattice_dims(mesh);
  Volume v;
  v.id = id, v.mode = item.mode, v.shaded = item.shaded, v.dual = cells;
  v.nearest = !item.color.labels.empty();
  AxisPlan plan[3];
  std::array<size_t, 3> samples{};
  for (size_t a = 0; a < 3; ++a) {
    samples[a] = cells ? std::max<size_t>(points[a], 2) - 1 : points[a];
    plan[a] = {points[a], samples[a], cells || points[a] == 1};
    if (points[a] == 0) v.hi = {-1, -1, -1};
  }
  if (v.hi.x < v.lo.x) return v;
  double smallest = 1;
  if (auto* u = item.data->as<UniformGrid>()) uniform_geometry(*u, plan, v, smallest);
  else rectilinear_geometry(*item.data->as<RectilinearGrid>(), plan, v, smallest);
  if (!(v.hi.x > v.lo.x && v.hi.y > v.lo.y && v.hi.z > v.lo.z)) return v;
  v.edge = smallest, v.bounds = item.data->bounds();
  v.samples = kept_samples(item, field, samples);
  v.voxels = v.samples->voxels, v.base = v.samples->base;
  lay_borders(v);

  // Lengths: step and the length to which opacity refers.
  const double diagonal = std::max(item.data->bounds().diagonal(), smallest);
  v.step = item.sampling.step > 0 ? item.sampling.step : 0.5 * smallest;
  const double unit = item.unit_distance > 0 ? item.unit_distance : 0.01 * diagonal;
  if (diagonal / v.step > 1e7)
    fail_usage(fmt::format("a step of {} takes {:.3g} samples through a volume of size {}", v.step, diagonal / v.step, diagonal), "volume",
               "use a longer step");

  const double lo = v.samples->lo, hi = v.samples->hi;
  v.transfer.emplace_back(item.color, item.opacity, unit, v.step, lo + double(v.base), hi + double(v.base), double(v.base));
  if (item.mode != VolumeItem::Mode::maximum) v.distance = distance_to_drawn(v.fine(), v.transfer[0], v.any_empty);
  v.kernels = knobs.simd ? best_kernels(v.voxels) : scalar_kernels(v.voxels);
  v.direct = !v.nearest && v.hidden().empty() && v.transfer[0].linear() && !v.samples->holes;
  v.spanned = !v.samples->infinite && v.transfer[0].spans(float(lo), float(hi));
  // A gradient in q becomes one in the world by the transpose of world -> q.
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) v.shade_plan.to_world[r][c] = float(v.to_q.m[c][r]);
  v.shade_plan.per_scale = float(lo < hi ? 1 / (0.002 * (hi - lo)) : 1);
  return v;
}

}  // namespace sg::volume
