// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/ridges.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/cells/mesh_dimension.h"
#include "data/field_ops.h"
#include "filter/field/derivatives/derivatives.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/field/sampling/gaussian_smooth.h"
#include "filter/flow/vortex/keep_large.h"
#include "filter/mesh/select/components.h"
#include "filter/mesh/select/extract.h"
#include "filter/scalar/contour/contour.h"
#include "filter/scalar/isolines.h"
#include "filter/tensor/sym_tensor.h"

namespace sg {

void describe(Schema& s, RidgesParams& p) {
  s("field", p.field, "Scalar point field; default: the active scalar.").takes(fields::point_scalars);
  s("kind", p.kind, "Find crests (ridges) or troughs (valleys).");
  s("limit", p.limit, "Ridges: smallest value of the field; valleys: largest. Default: no limit.").unit("@field");
  s("smooth", p.smooth, "Standard deviation, in cells, of the Gaussian with which uniform and rectilinear grids are smoothed first.")
      .range(0, 100);
  s("strength", p.strength, "Minimum curvature across the ridge, as a fraction of the largest.").range(0, 1);
  s("min_length", p.min_length, "Minimum extent of a connected piece, as a fraction of the mesh's diagonal.").range(0, 1);
}

namespace {

constexpr const char *slope_name = "ridge slope of it", *bend_name = "ridge bend of it", *zero_name = "ridge condition of it";

struct Height {
  Vec3 g;
  SymTensor h;
};

Height height_at(const View<double>& g, const View<double>& h, size_t i, double sign) {
  return {Vec3(g(i, 0), g(i, 1), g(i, 2)) * sign, SymTensor{h(i, 0), h(i, 4), h(i, 8), h(i, 1), h(i, 5), h(i, 2)} * sign};
}

// The axis along which a 2D mesh has no extent: its normal.
int flat_axis(const DatasetPtr& in) {
  const Vec3 size = in->bounds().size();
  for (int a = 0; a < 3; ++a)
    if (size[a] <= 1e-9 * in->bounds().diagonal()) return a;
  fail_usage("this mesh is a curved or tilted surface; ridges can be found only in flat meshes along two axes and in volumes", "ridges",
             "resample it to a grid");
}

double mean_cell(const Dataset& d, int dimension, int flat) {
  const Vec3 size = d.bounds().size();
  double measure = 1;
  for (int a = 0; a < 3; ++a) measure *= a == flat ? 1 : size[a];
  return std::pow(measure / double(std::max<size_t>(1, d.cell_count())), 1.0 / dimension);
}

// How strong the ridge is at a place where the condition holds; 0 when it is one of the other zeros.
// `off`: how far, by Newton's step, a place on the crest may be from it.
double strength_at(const Height& x, int flat, double off) {
  const Eigen3 e = eigen_of(x.h);
  int least = 2;
  if (flat >= 0) {  // the normal is not a direction of the mesh
    double lowest = HUGE_VAL;
    for (int k = 0; k < 3; ++k)
      if (std::abs(e.vector[k][flat]) < 0.5 && e.value[k] < lowest) lowest = e.value[k], least = k;
  }
  if (!(e.value[least] < 0)) return 0;
  // The gradient must be free of this eigenvector: Newton's step to the crest is short. (Where it is separated from another one, the step
  // is long, except next to a peak, where all meet.)
  if (std::abs(dot(x.g, e.vector[least])) > -off * e.value[least]) return 0;
  return -e.value[least];
}

// Where the lines of two directions cross, stumps of the wrong one are left: lines that short with a free end.
DatasetPtr without_hairs(const DatasetPtr& in, double shortest) {
  const SurfaceMesh& mesh = *in->as<SurfaceMesh>();
  const CellsView lines = cells_view(mesh.lines);
  const Field& length = in->fields().require("length", Association::cell);
  std::vector<int> ends(mesh.points.count(), 0);
  for (size_t c = 0; c < lines.count; ++c) ++ends[size_t(lines.point(c, 0))], ++ends[size_t(lines.connectivity[lines.end(c) - 1])];
  std::vector<int64_t> stay;
  for (size_t c = 0; c < lines.count; ++c) {
    const int a = ends[size_t(lines.point(c, 0))], b = ends[size_t(lines.connectivity[lines.end(c) - 1])];
    const bool hair = length.array.get(c) < shortest && (a == 1) != (b == 1);
    if (!hair) stay.push_back(int64_t(c));
  }
  return extract_cells(in, stay, "ridges");
}

// Peaks and passes along a crest each leave a gap where the zeros of the other direction cross: free ends that are each other's nearest
// within `gap` are joined.
DatasetPtr with_joined_ends(const DatasetPtr& in, double gap) {
  const SurfaceMesh& mesh = *in->as<SurfaceMesh>();
  const CellsView lines = cells_view(mesh.lines);
  std::vector<int> used(mesh.points.count(), 0);
  std::vector<int64_t> ends;
  for (size_t c = 0; c < lines.count; ++c)
    for (const int64_t id : {lines.point(c, 0), int64_t(lines.connectivity[lines.end(c) - 1])}) ++used[size_t(id)], ends.push_back(id);
  std::erase_if(ends, [&](int64_t id) { return used[size_t(id)] != 1; });
  const auto at = [&](int64_t id) { return mesh.points.at(size_t(id)); };
  std::sort(ends.begin(), ends.end(), [&](int64_t a, int64_t b) { return at(a).x != at(b).x ? at(a).x < at(b).x : a < b; });
  std::vector<size_t> nearest(ends.size(), SIZE_MAX);
  for (size_t i = 0; i < ends.size(); ++i) {
    double least = gap;
    const auto look = [&](size_t j) {
      const double d = length(at(ends[i]) - at(ends[j]));
      if (d < least) least = d, nearest[i] = j;
    };
    for (size_t j = i; j-- > 0 && at(ends[i]).x - at(ends[j]).x < gap;) look(j);
    for (size_t j = i + 1; j < ends.size() && at(ends[j]).x - at(ends[i]).x < gap; ++j) look(j);
  }
  std::vector<int64_t> connectivity, offsets{0};
  for (size_t c = 0; c < lines.count; ++c) {
    for (size_t k = lines.begin(c); k < lines.end(c); ++k) connectivity.push_back(lines.connectivity[k]);
    offsets.push_back(int64_t(connectivity.size()));
  }
  for (size_t i = 0; i < ends.size(); ++i) {
    const size_t j = nearest[i];
    if (j == SIZE_MAX || j < i || nearest[j] != i) continue;
    connectivity.insert(connectivity.end(), {ends[i], ends[j]});
    offsets.push_back(int64_t(connectivity.size()));
  }
  DatasetParts parts = in->parts();
  SurfaceMesh joined;
  joined.points = mesh.points;
  joined.lines.connectivity = Array::from_vector(std::move(connectivity)), joined.lines.offsets = Array::from_vector(std::move(offsets));
  parts.mesh = std::move(joined);
  FieldSet points;
  for (const Field& f : in->fields())
    if (f.association != Association::cell) points.add(f);
  parts.fields = std::move(points), parts.cell_ghost = {};
  return make_dataset(std::move(parts));
}

// Lines (of a flat mesh) or surfaces where the gradient is free of some eigenvector of the Hessian, with both as fields. `smooth`: the
// width of the Gaussian that grids are smoothed with before.
DatasetPtr where_free(const DatasetPtr& in, const Field& field, double smooth, int flat, double sign, Context& context) {
  const bool smoothed = smooth > 0 && (in->as<UniformGrid>() || in->as<RectilinearGrid>());
  const DatasetPtr even = smoothed ? gaussian_smooth(in, {{field.name}, {smooth}, ""}, context) : in;
  const DatasetPtr first = gradient(even, {{field.name}, slope_name}, context);
  const DatasetPtr second = hessian(first, {{field.name}, bend_name}, context);
  const Array slopes = second->fields().require(slope_name).array.converted(ElementType::f64);
  const Array bends = second->fields().require(bend_name).array.converted(ElementType::f64);
  const View<double> g = slopes.view<double>(), h = bends.view<double>();
  double* zero = nullptr;
  Array condition = Array::make<double>(g.count, 1, &zero);
  parallel_for(g.count, 1 << 13, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Height x = height_at(g, h, i, sign);
      const Vec3 hg = x.h * x.g;
      const double size = length(x.g) * x.h.norm();
      zero[i] = flat >= 0 ? cross(x.g, hg)[flat] : dot(cross(x.g, hg), x.h * hg) / (size > 0 ? size : 1);
    }
  });
  DatasetParts parts = in->parts();
  parts.fields.add({slope_name, Association::point, slopes, "", Role::none});
  parts.fields.add({bend_name, Association::point, bends, "", Role::none});
  // The contour keeps 32 bits: the largest value is 1.
  const Range range = field_stats(condition).range[0];
  const double most = std::max(std::abs(range.lo), std::abs(range.hi));
  for (size_t i = 0; i < g.count && most > 0; ++i) zero[i] /= most;
  parts.fields.add({zero_name, Association::point, std::move(condition), "", Role::none});
  ContourParams c;
  c.field = {zero_name}, c.values = {0}, c.normals = false;
  return contour(make_dataset(std::move(parts)), c, context);
}

// The cells whose points are all on ridges that are strong and high enough. `strength`: of all points.
std::vector<int64_t> cells_on_ridges(const DatasetPtr& all, const RidgesParams& p, const Field& field, int flat, double sign, double cell,
                                     std::vector<double>& strength) {
  const View<double> ga = all->fields().require(slope_name, Association::point).array.view<double>();
  const View<double> ha = all->fields().require(bend_name, Association::point).array.view<double>();
  const Array values = scalar_of(all->fields().require(field.name, Association::point), 0, ElementType::f64);
  const View<double> v = values.view<double>();
  // A third of a cell off is on the crest; up to half of one counts next to such a point, so that a line does not break where it is sharp.
  strength.resize(all->point_count());
  std::vector<uint8_t> on(strength.size());
  parallel_for(strength.size(), 1 << 12, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Height x = height_at(ga, ha, i, sign);
      strength[i] = strength_at(x, flat, cell / 2), on[i] = strength_at(x, flat, 0.3 * cell) > 0;
    }
  });
  double strongest = 0;
  for (size_t i = 0; i < on.size(); ++i) strongest = std::max(strongest, on[i] ? strength[i] : 0);
  std::vector<uint8_t> good(strength.size());
  for (size_t i = 0; i < good.size(); ++i)
    good[i] = strength[i] > 0 && strength[i] >= p.strength * strongest && (!p.limit || sign * v(i) >= sign * *p.limit);
  const SurfaceMesh& mesh = *all->as<SurfaceMesh>();
  const CellsView cells = cells_view(flat >= 0 ? mesh.lines : mesh.polygons);
  std::vector<int64_t> stay;
  for (size_t k = 0; k < cells.count; ++k) {
    bool every = true, any = false;
    for (size_t m = cells.begin(k); m < cells.end(k); ++m) {
      const auto id = size_t(cells.connectivity[m]);
      every = every && good[id], any = any || on[id];
    }
    if (every && any) stay.push_back(int64_t(k));
  }
  return stay;
}

}  // namespace

DatasetPtr ridges(const DatasetPtr& in, const RidgesParams& p, Context& context) {
  const Field* found = p.field.empty() ? in->fields().active(1) : &in->fields().require(p.field.name);
  if (!found) fail_usage("the data has no scalar field", "ridges");
  const Field field = *found;
  if (field.components() != 1 || field.association != Association::point)
    fail_usage(fmt::format("field '{}' is not a scalar point field", field.name), "ridges",
               "magnitude, component or cell_to_point can make one");
  const int dimension = mesh_dimension(*in);
  if (dimension < 2) fail_usage("a mesh of lines or points has no ridges", "ridges");
  const int flat = dimension == 2 ? flat_axis(in) : -1;
  const double sign = p.kind == RidgeKind::ridges ? 1 : -1;
  const double cell = mean_cell(*in, dimension, flat);
  const DatasetPtr all = where_free(in, field, p.smooth * cell, flat, sign, context);
  std::vector<double> strength;
  const std::vector<int64_t> stay = cells_on_ridges(all, p, field, flat, sign, cell, strength);
  DatasetParts out = all->parts();
  for (const char* scratch : {slope_name, bend_name, zero_name}) out.fields.remove(scratch, Association::point);
  // polylines would take these of the input for kinds of lines, and end lines where they change.
  for (const char* kind : {"contour value", "edge type"}) out.fields.remove(kind, Association::cell);
  out.fields.add({"ridge strength", Association::point, Array::from_vector(std::move(strength)), "", Role::none});
  const DatasetPtr kept = extract_cells(make_dataset(std::move(out)), stay, "ridges");
  if (stay.empty()) return kept;
  const double shortest = p.min_length * in->bounds().diagonal();
  if (flat < 0) return large_parts(components(kept, {}, context), shortest, "ridges", context);
  const DatasetPtr whole = with_joined_ends(without_hairs(polylines(kept, {}, context), 1.5 * cell), 3 * cell);
  const DatasetPtr large = large_parts(components(whole, {}, context), shortest, "ridges", context);  // crossing lines end each other
  return large->cell_count() > 0 ? polylines(large, {}, context) : large;
}

}  // namespace sg
