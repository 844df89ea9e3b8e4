// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/cells/cell_volume.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"
#include "data/cells/cell_reader.h"
#include "data/field_ops.h"
#include "data/memory/memo.h"
#include "filter/field/derivatives/fitted_derivatives.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/scalar/contour/contour_amr.h"
#include "render/volume/sources/item_checks.h"

namespace sg::volume {

namespace {

constexpr double straight_enough = 1.0 / 512;  // of the mesh's size
constexpr int most_levels = 5;
constexpr size_t most_parts = 1'000'000;

/// How many cells tessellate() makes of the mesh at a level, and how many of the cells are curved.
struct Parts {
  size_t curved = 0;
  std::array<size_t, most_levels + 1> at_level{};
};
Parts count_parts(const UnstructuredMesh& mesh) {
  size_t straight = 0, pyramids = 0, others = 0;
  for (size_t c = 0; c < mesh.cells.size(); ++c) {
    const CellType t = mesh.type(c);
    if (!is_high_order(t) || cell_type_info(t).dimension != 3) ++straight;
    else if (linear_type(t) == CellType::pyramid) ++pyramids;
    else ++others;
  }
  Parts p{pyramids + others, {}};
  for (size_t& n : p.at_level) {
    n = straight + pyramids + others;
    others = 8 * others + 4 * pyramids, pyramids *= 6;
  }
  return p;
}

/// Every curved cell in parts, as many for all: as many as its shape asks for. Fields go along, without asking for more.
DatasetPtr divided(const DatasetPtr& data, const Parts& parts, Context& context) {
  TessellateParams p;
  p.tolerance = straight_enough, p.max_level = 0;
  while (p.max_level < most_levels && parts.at_level[size_t(p.max_level) + 1] <= most_parts) ++p.max_level;
  DatasetParts shape = data->parts();
  shape.fields = {};
  const DatasetPtr shapes = tessellate(make_dataset(std::move(shape)), p, context);
  for (int level = 0; level <= p.max_level; ++level)
    if (parts.at_level[size_t(level)] == shapes->cell_count()) {
      p.tolerance = 1e-30, p.max_level = level;
      break;
    }
  return tessellate(data, p, context);
}

/// The mesh with linear cells only; `field` and `component` follow.
DatasetPtr straightened(const DatasetPtr& data, const Field*& field, int& component, Context& context) {
  if (data->as<AmrGrid>()) {
    if (data->as<AmrGrid>()->dimension < 3)
      fail_usage("an AMR grid of two dimensions has no volume", "volume", "show its surface instead: --show surface");
    const std::string key = fmt::format("volume/leaves/{}/{}/{}", field->name, association_name(field->association), component);
    auto kept = data->memo().find<DatasetPtr>(key);
    if (!kept) {
      DatasetPtr leaves = contouring::amr_cells_near(data, *field, component, {}, context);
      const size_t bytes = leaves->point_count() * 32 + leaves->cell_count() * 80;
      kept = data->memo().keep<DatasetPtr>(key, std::move(leaves), bytes);
    }
    if (field->association == Association::cell) component = 0;
    field = &(*kept)->fields().require(field->name, Association::point);
    return *kept;
  }
  const auto* mesh = data->as<UnstructuredMesh>();
  if (!mesh) return data;
  const Parts parts = count_parts(*mesh);
  if (parts.curved == 0) return data;
  auto kept = data->memo().find<DatasetPtr>("volume/straight");
  if (!kept) {
    DatasetPtr straight = divided(data, parts, context);
    const size_t bytes = straight->point_count() * 32 + straight->cell_count() * 80;
    kept = data->memo().keep<DatasetPtr>("volume/straight", std::move(straight), bytes);
  }
  field = &(*kept)->fields().require(field->name, field->association);
  return *kept;
}

/// As f32, wide types relative to the middle of their range where the scale is linear.
Plane<float> stored_values(const Field& field, int component, bool shift, float& base) {
  const bool wide = field.array.type() != ElementType::f32 && element_size(field.array.type()) >= 4;
  const Array a = scalar_of(field, field.components() == 1 ? 0 : component, wide ? ElementType::f64 : ElementType::f32);
  Plane<float> out;
  out.resize(a.count());
  dispatch(a, [&](auto v) {
    if (wide && shift) {
      Range r;
      for (size_t i = 0; i < v.count; ++i)
        if (const auto x = double(v[i]); std::isfinite(x)) r.add({x, x});
      base = r.empty() ? 0 : float(0.5 * r.lo + 0.5 * r.hi);
    }
    parallel_for(v.count, 65536, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = float(double(v[i]) - double(base));
    });
  });
  return out;
}

/// Whether each point has a finite value and position.
std::vector<uint8_t> missing_points(const DatasetPtr& data, std::span<const float> values, bool& any) {
  const size_t n = data->point_count();
  std::vector<uint8_t> missing(n);
  const Points* points = nullptr;
  if (auto* u = data->as<UnstructuredMesh>()) points = &u->points;
  if (auto* c = data->as<CurvilinearGrid>()) points = &c->points;
  any = parallel_reduce(
      n, 65536, false,
      [&](size_t begin, size_t end) {
        bool found = false;
        for (size_t i = begin; i < end; ++i) {
          missing[i] = !values.empty() && !std::isfinite(values[i]);
          found = found || missing[i];
        }
        return found;
      },
      [](bool a, bool b) { return a || b; });
  if (points)
    dispatch(points->xyz, [&](auto v) {
      if constexpr (std::is_floating_point_v<std::remove_cvref_t<decltype(v[0])>>)
        for (size_t i = 0; i < n; ++i)
          if (!std::isfinite(v(i, 0)) || !std::isfinite(v(i, 1)) || !std::isfinite(v(i, 2))) missing[i] = 1, any = true;
    });
  return missing;
}

std::shared_ptr<const TetMesh> mesh_of(const CellVolume& v, Context& context) {
  bool missing = false;
  const std::vector<uint8_t> no_value = missing_points(v.data, v.by_cell ? std::span<const float>() : v.values, missing);
  bool missing_cells = false;
  if (v.by_cell)
    for (float x : v.values) missing_cells = missing_cells || !std::isfinite(x);
  const std::string key = missing || missing_cells ? "volume/tets/" + v.key : "volume/tets";
  if (auto kept = v.data->memo().find<TetMesh>(key)) return kept;
  const auto draws = [&](const CellReader& open) {
    if (missing_cells && !std::isfinite(v.values[open.cell()])) return false;
    if (missing)
      for (int64_t id : open.ids())
        if (no_value[size_t(id)]) return false;
    return true;
  };
  TetMesh mesh = make_tet_mesh(v.data, draws, context);
  const size_t bytes = mesh.bytes();
  return v.data->memo().keep<TetMesh>(key, std::move(mesh), bytes);
}

/// Values of the middles of polyhedra: the means of their points, as the middles are.
void add_middles(const CellVolume& v, Plane<float>& values) {
  const TetMesh& mesh = *v.mesh;
  values.resize(mesh.at.size());
  CellReader reader(v.data);
  for (size_t k = 0; k < mesh.middle_of.size(); ++k) {
    reader.open(mesh.middle_of[k]);
    double sum = 0;
    for (int64_t id : reader.ids()) sum += double(values[size_t(id)]);
    values[mesh.points + k] = float(sum / double(std::max<size_t>(reader.ids().size(), 1)));
  }
}

Range drawn_range(const CellVolume& v) {
  const TetMesh& mesh = *v.mesh;
  return parallel_reduce(
      mesh.size(), 16384, Range{},
      [&](size_t begin, size_t end) {
        Range r;
        for (size_t t = begin; t < end; ++t) {
          if (v.by_cell) {
            const auto x = double(v.values[mesh.cell(t)]);
            r.add({x, x});
          } else {
            for (uint32_t k : mesh.corners[t]) r.add({double(v.values[k]), double(v.values[k])});
          }
        }
        return r;
      },
      [](Range a, const Range& b) { return a.add(b), a; });
}

/// Of a field of cells: at each vertex by the derivatives at the nearest middle of a cell around, second ones included, so of second order
/// there, too.
Plane<Vec3f> gradients_of_cells(const CellVolume& v) {
  const TetMesh& mesh = *v.mesh;
  constexpr uint32_t none = ~0u;
  struct Nearest {
    uint32_t cell = none;
    double square = HUGE_VAL;
    Vec3 offset;
  };
  std::vector<Nearest> nearest(mesh.at.size());
  CellReader reader(v.data);
  Vec3 middle;
  uint32_t opened = none;
  for (size_t t = 0; t < mesh.size(); ++t) {
    if (const uint32_t cell = mesh.cell(t); cell != opened) {
      reader.open(opened = cell);
      middle = Vec3();
      for (const Vec3& p : reader.at()) middle += p;
      middle = middle / double(std::max<size_t>(reader.at().size(), 1)) - mesh.origin;
    }
    for (uint32_t k : mesh.corners[t]) {
      const Vec3 offset = mesh.at[k] - middle;
      // Of cells as near as each other the first, whatever the rounding.
      if (const double square = dot(offset, offset); square < (1 - 1e-4) * nearest[k].square) nearest[k] = {opened, square, offset};
    }
  }
  std::vector<uint32_t> cells;
  for (const Nearest& n : nearest)
    if (n.cell != none) cells.push_back(n.cell);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  const std::vector<double> values(v.values.begin(), v.values.end());
  std::vector<double> g(3 * cells.size()), h(6 * cells.size());
  Context context;
  fitted_derivatives_at(v.data, Association::cell, cells, Array::from_vector(values), g.data(), h.data(), context);
  Plane<Vec3f> out;
  out.resize(mesh.at.size());
  for (size_t k = 0; k < nearest.size(); ++k) {
    out[k] = Vec3f();
    if (nearest[k].cell == none) continue;
    const size_t i = size_t(std::lower_bound(cells.begin(), cells.end(), nearest[k].cell) - cells.begin());
    const Vec3 d = nearest[k].offset;
    const double* b = &h[6 * i];
    const Vec3 at = Vec3{g[3 * i], g[3 * i + 1], g[3 * i + 2]} +
                    Vec3{b[0] * d.x + b[1] * d.y + b[2] * d.z, b[1] * d.x + b[3] * d.y + b[4] * d.z, b[2] * d.x + b[4] * d.y + b[5] * d.z};
    if (std::isfinite(dot(at, at))) out[k] = Vec3f(at);
  }
  return out;
}

/// Of the mesh's points by gradient(): of second order up to the border, where means over tetrahedra are of first. Middles of polyhedra
/// have the means of their points, as their values are.
Plane<Vec3f> gradients_at_points(const CellVolume& v) {
  const TetMesh& mesh = *v.mesh;
  DatasetParts parts = v.data->parts();
  parts.fields = {};
  float* values = nullptr;
  Field field{"value", Association::point, Array::make<float>(mesh.points, 1, &values), "", Role::scalars};
  std::copy_n(v.values.begin(), mesh.points, values);
  parts.fields.add(std::move(field));
  GradientParams params;
  params.field.name = "value", params.as = "gradient";
  Context context;
  const DatasetPtr with_gradient = gradient(make_dataset(std::move(parts)), params, context);
  const Array g = with_gradient->fields().require("gradient", Association::point).array.converted(ElementType::f32).made_packed();
  const View<float> at = g.view<float>();

  Plane<Vec3f> out;
  out.resize(mesh.at.size());
  for (size_t k = 0; k < mesh.points; ++k) {
    const Vec3f x(at(k, 0), at(k, 1), at(k, 2));
    out[k] = std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z) ? x : Vec3f();
  }
  CellReader reader(v.data);
  for (size_t k = 0; k < mesh.middle_of.size(); ++k) {
    reader.open(mesh.middle_of[k]);
    Vec3 sum;
    for (int64_t id : reader.ids()) sum += Vec3(out[size_t(id)]);
    out[mesh.points + k] = Vec3f(sum / double(std::max<size_t>(reader.ids().size(), 1)));
  }
  return out;
}

}  // namespace

std::shared_ptr<const Plane<Vec3f>> CellVolume::gradients() const {
  const std::string name = "volume/gradients/" + key;
  if (auto kept = data->memo().find<Plane<Vec3f>>(name)) return kept;
  Plane<Vec3f> out = by_cell ? gradients_of_cells(*this) : gradients_at_points(*this);
  const size_t bytes = out.size() * sizeof(Vec3f);
  return data->memo().keep<Plane<Vec3f>>(name, std::move(out), bytes);
}

namespace {

/// What is kept of a field.
struct Kept {
  Plane<float> values;
  float base = 0;
  Range range;
  std::shared_ptr<const TetMesh> mesh;
};

void take_field(CellVolume& v, const Field& field, int component, bool shift, Context& context) {
  const std::string name = fmt::format("volume/field/{}/{}", v.key, int(shift));
  auto kept = v.data->memo().find<Kept>(name);
  if (!kept) {
    Kept k;
    k.values = stored_values(field, component, shift, k.base);
    v.values = k.values;
    v.mesh = k.mesh = mesh_of(v, context);
    if (!v.by_cell) add_middles(v, k.values), v.values = k.values;
    k.range = drawn_range(v);
    const size_t bytes = k.values.size() * 4;
    kept = v.data->memo().keep<Kept>(name, std::move(k), bytes);
  }
  v.values = kept->values, v.base = kept->base, v.range = kept->range, v.mesh = kept->mesh, v.owner = kept;
  v.fit_error = v.range.empty() ? 0 : float((v.range.hi - v.range.lo) / 4096);
}

}  // namespace

namespace {

/// The field as it is in the curved cells themselves.
void take_curved(CellVolume& v, const VolumeItem& item, Context& context) {
  context.check();
  const Field* part_of = v.data->fields().find("original_cell", Association::cell);
  // A field of that name may have come with the file: then nothing tells what is part of what.
  if (!part_of || part_of->array.type() != ElementType::i64 || item.data->fields().find("original_cell", Association::cell)) return;
  const std::string name = fmt::format("volume/curved/{}/{}", v.key, v.base);
  auto kept = item.data->memo().find<Plane<float>>(name);
  if (!kept) {
    float none = 0;
    Plane<float> values = stored_values(field_of(item), item.component, false, none);
    // f32 fields keep their digits; others were narrowed about the base.
    if (v.base != 0) {
      const Array wide = scalar_of(field_of(item), field_of(item).components() == 1 ? 0 : item.component, ElementType::f64);
      for (size_t i = 0; i < values.size(); ++i) values[i] = float(wide.get(i) - double(v.base));
    }
    const size_t bytes = values.size() * 4;
    kept = item.data->memo().keep<Plane<float>>(name, std::move(values), bytes);
  }
  v.curved = item.data, v.curved_values = *kept, v.curved_owner = kept;
  const View<int64_t> parts = part_of->array.view<int64_t>();
  v.part_of = {parts.data, parts.count};
}

/// As the first field: of points, of cells, or of cells at the corners of an AMR grid's leaves.
void take_second(CellVolume& v, const VolumeItem& item, Context& context) {
  const std::string& name = item.detail.second_field;
  const Field* second = v.by_cell ? nullptr : v.data->fields().find(name, Association::point);
  DatasetPtr leaves;
  if (const Field* of_cells = item.data->fields().find(name, Association::cell); !second && v.leaves && of_cells) {
    int component = -1;
    leaves = straightened(item.data, of_cells, component, context);
    if (leaves->point_count() == v.data->point_count()) second = of_cells;  // else each leaves out other cells
  }
  v.second_by_cell = !second;
  if (!second) second = v.data->fields().find(name, Association::cell);
  if (!second) return;
  float none = 0;
  v.seconds = stored_values(*second, -1, false, none);
  if (!v.second_by_cell) add_middles(v, v.seconds);
}

}  // namespace

CellVolume make_cell_volume(const VolumeItem& item, Context& context) {
  if (!item.data) fail_usage("a volume item has no dataset", "volume");
  const Dataset& d = *item.data;
  if (d.as<SurfaceMesh>() || d.as<PointCloud>())
    fail_usage(fmt::format("a {} mesh cannot be shown as a volume", d.kind()), "volume", "show its surface instead: --show surface");
  const Field* field = &field_of(item);
  int component = item.component;
  CellVolume v;
  v.data = straightened(item.data, field, component, context);
  v.leaves = d.as<AmrGrid>() != nullptr;
  v.by_cell = field->association == Association::cell;
  v.key = fmt::format("{}/{}/{}", field->name, association_name(field->association), component);
  take_field(v, *field, component, item.color.kind == ScaleKind::linear && item.color.labels.empty(), context);
  if (v.data != item.data && !v.leaves && !v.by_cell) take_curved(v, item, context);
  if (item.detail.second == SecondAxis::field) take_second(v, item, context);
  return v;
}

Medium make_medium(const VolumeItem& item, const CellVolume& volume) {
  const double diagonal = item.data->bounds().diagonal();
  Medium::Plan plan;
  plan.unit = item.unit_distance > 0 ? item.unit_distance : 0.01 * diagonal;
  const Range& r = volume.range;
  plan.lo = r.empty() ? item.color.lo : r.lo + double(volume.base), plan.hi = r.empty() ? item.color.hi : r.hi + double(volume.base);
  plan.base = volume.base;
  plan.accuracy = 0.25 * item.sampling.within(), plan.faint = 0.5 / diagonal;
  plan.most_tau = 1e6 / (volume.mesh->edge > 0 ? volume.mesh->edge : diagonal);
  return Medium(item.color, item.opacity, plan);
}

}  // namespace sg::volume
