// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/clip.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/field/automatic_values.h"
#include "filter/mesh/clip/clip_box.h"
#include "filter/mesh/clip/clip_impl.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/surface_builder.h"
#include "filter/mesh/tessellate_cells.h"
#include "filter/mesh/to_unstructured.h"

namespace sg {

namespace {

using clipping::Job;
using clipping::Keep;

bool has_curved_cells(const UnstructuredMesh& m) {
  if (m.types.empty()) return is_high_order(m.single_type);
  const auto types = m.types.view<uint8_t>();
  bool seen[256] = {};
  for (size_t i = 0; i < types.count; ++i) seen[types[i]] = true;
  for (size_t t = 0; t < 256; ++t)
    if (seen[t] && is_high_order(CellType(t))) return true;
  return false;
}

// The input as clip takes it: lattices of three axes, unstructured meshes of linear cells, and clouds stay; others become unstructured.
DatasetPtr prepared(const DatasetPtr& in, double tolerance, std::string_view who, Context& ctx) {
  if (in->as<PointCloud>()) return in;
  const auto d = lattice_dims(in->mesh());
  if (is_lattice(in->mesh()) && d[0] > 1 && d[1] > 1 && d[2] > 1) return in;
  if (auto* m = in->as<UnstructuredMesh>()) {
    if (!has_curved_cells(*m)) return in;
    ctx.info(fmt::format("{}: curved cells are linearised first", who));
    return tessellate(in, {.tolerance = tolerance, .max_level = 7}, ctx);
  }
  if (in->as<AmrGrid>()) {
    const std::vector<uint8_t> states = cell_states(*in);
    std::vector<int64_t> leaves;
    for (size_t c = 0; c < in->cell_count(); ++c)
      if (states.empty() || states[c] == cell_visible) leaves.push_back(int64_t(c));
    DatasetParts parts = extract_cells(in, leaves, who)->parts();
    parts.cell_ghost = {};
    if (!parts.fields.find("original_cell", Association::cell)) parts.fields.add(id_field("original_cell", Association::cell, leaves));
    return make_dataset(std::move(parts));
  }
  return to_unstructured(in);
}

// Unstructured cells of up to two dimensions as a surface: vertices, lines, polygons, strips.
DatasetPtr as_surface(const DatasetPtr& in) {
  const UnstructuredMesh& m = *in->as<UnstructuredMesh>();
  const CellsView v = cells_view(m.cells);
  std::vector<int64_t> order;
  SurfaceMesh s;
  s.points = m.points;
  CellArray* parts[4] = {&s.vertices, &s.lines, &s.polygons, &s.strips};
  for (int part = 0; part < 4; ++part) {
    CellList list;
    std::vector<int64_t> ids;
    for (size_t c = 0; c < v.count; ++c) {
      const CellType type = m.type(c);
      const int belongs = type == CellType::triangle_strip ? 3 : cell_type_info(type).dimension;
      if (belongs != part) continue;
      ids.clear();
      for (size_t k = v.begin(c); k < v.end(c); ++k) ids.push_back(v.connectivity[k]);
      if (type == CellType::pixel) std::swap(ids[2], ids[3]);
      list.add(ids, int64_t(c));
    }
    if (list.sizes.empty()) continue;
    *parts[part] = cell_array({&list}, [](int64_t id) { return int32_t(id); });
    order.insert(order.end(), list.sources.begin(), list.sources.end());
  }
  DatasetParts out;
  out.mesh = std::move(s);
  for (const Field& f : in->fields()) {
    Field g = f;
    if (f.association == Association::cell) g.array = gather(f.array, std::span<const int64_t>(order));
    out.fields.add(std::move(g));
  }
  out.notes = in->notes();
  out.time = in->time();
  return make_dataset(std::move(out));
}

DatasetPtr clip_cloud(const Job& job) {
  const clipping::Values values = job.values();
  std::vector<int64_t> kept;
  for (size_t i = 0; i < job.in->point_count(); ++i)
    if (clipping::fate_of(clipping::side_of(values(i), job.keep), job.keep.outside) == clipping::Fate::whole) kept.push_back(int64_t(i));
  return extract_cells(job.in, kept, "clip");
}

DatasetPtr clip_mesh(const Job& job) {
  if (job.in->as<PointCloud>()) return clip_cloud(job);
  if (job.in->as<UnstructuredMesh>()) return finish(job, clip_lists(job));
  if (!job.keep.between) return finish(job, clip_lattice(job));
  Job lists = job;
  lists.in = to_unstructured(job.in);
  return finish(lists, clip_lists(lists));
}

// `part`: what the input becomes.
template <class Part>
DatasetPtr result(const DatasetPtr& in, bool surface, std::string_view who, Context& ctx, Part&& part) {
  if (in->point_count() > size_t(INT32_MAX)) fail_usage("the mesh has more than 2^31 points", std::string(who), "take a part of it first");
  DatasetPtr out = part();
  if (surface) out = as_surface(out);
  if (out->cell_count() == 0 && out->point_count() == 0) ctx.info(fmt::format("{}: nothing is left", who));
  return out;
}

// A scalar of the points as packed f32 or f64.
Array numbers_of(const Dataset& in, const FieldName& name, int component, std::string_view who, const Field** chosen) {
  const Field* f = nullptr;
  if (name.empty()) {
    f = in.fields().active(1);
    if (!f) fail_usage("the mesh has no scalar field", std::string(who), "name one: field=NAME");
  } else {
    f = with_context(who, [&] {
      return in.fields().find(name.name, Association::point) ? in.fields().find(name.name, Association::point)
                                                             : &in.fields().require(name.name);
    });
  }
  if (f->association != Association::point)
    fail_usage(
        fmt::format("field '{}' is not a point field", f->name), std::string(who),
        f->association == Association::cell ? "convert it with cell_to_point, or keep whole cells with threshold" : "use a point field");
  *chosen = f;
  const bool wide = f->array.type() == ElementType::f64 || element_size(f->array.type()) > 2;
  return with_context(
      who, [&] { return scalar_of(*f, component, wide && f->array.type() != ElementType::f32 ? ElementType::f64 : ElementType::f32); });
}

// `part(outside)`: one side.
template <class Part>
Data both_sides(const DatasetPtr& in, ClipSide keep, bool surface, Context& ctx, Part&& part) {
  auto side = [&](bool outside) { return result(in, surface, "clip", ctx, [&] { return part(outside); }); };
  if (keep != ClipSide::both) return side(keep == ClipSide::outside);
  auto r = std::make_shared<Collection>();
  r->parts.push_back({"inside", side(false)});
  r->parts.push_back({"outside", side(true)});
  return CollectionPtr(r);
}

Data both_sides(Job job, ClipSide keep, bool surface) {
  return both_sides(job.in, keep, surface, job.context, [&](bool outside) {
    job.keep.outside = outside;
    return clip_mesh(job);
  });
}

Job job_of(const DatasetPtr& mesh, const ImplicitFunction& f, Context& ctx) {
  Job job{mesh, values_at_points(f, mesh, ctx), {}, {}, ctx};
  job.keep.sign = -1;
  job.keep.flat = f.plane;
  if (!f.plane && f.evaluate)
    job.curved = {f.evaluate,
                  [&f](std::span<const Vec3> from, std::span<const Vec3> to, std::span<double> t) { find_zeros(f, from, to, t); }};
  return job;
}

}  // namespace

Data clip(const DatasetPtr& in, const DatasetPtr& surface, const ClipParams& p, Context& ctx) {
  const bool flat = in->as<SurfaceMesh>() != nullptr;
  const DatasetPtr mesh = prepared(in, p.tolerance, "clip", ctx);
  if (!p.field.empty() || p.value) {
    const bool shape = surface || p.origin || p.position || p.axis != CutAxis::none || names_shape(p);
    if (shape) fail_usage("both a shape and a field are given", "clip", "give only one of them");
    const Field* field = nullptr;
    Job job{mesh, numbers_of(*mesh, p.field, p.component, "clip", &field), {}, {}, ctx};
    job.keep.level = p.value ? *p.value : middle_value(*mesh, *field, p.component, "clip", ctx);
    if (!std::isfinite(job.keep.level)) fail_usage("the value is not finite", "clip value");
    return both_sides(job, p.keep, flat);
  }
  const ImplicitFunction f = implicit_function(p, mesh, surface, "clip", ctx);
  if (p.box.empty() || mesh->as<PointCloud>()) return both_sides(job_of(mesh, f, ctx), p.keep, flat);
  const Box3 box{{p.box[0], p.box[2], p.box[4]}, {p.box[1], p.box[3], p.box[5]}};
  return both_sides(mesh, p.keep, flat, ctx, [&](bool outside) {
    return clipping::clip_box(mesh, box, outside, [&](const DatasetPtr& in, const ImplicitFunction& plane, bool behind) {
      Job job = job_of(in, plane, ctx);
      job.keep.outside = behind;
      return clip_mesh(job);
    });
  });
}

DatasetPtr isovolume(const DatasetPtr& in, const IsovolumeParams& p, Context& ctx) {
  if (p.min && p.max && *p.min > *p.max)
    fail_usage(fmt::format("min {} is above max {}", short_number(*p.min), short_number(*p.max)), "isovolume", "swap them");
  if ((p.min && std::isnan(*p.min)) || (p.max && std::isnan(*p.max)))
    fail_usage("a limit is not a number", "isovolume", "give min, max, or both");
  const DatasetPtr mesh = prepared(in, p.tolerance, "isovolume", ctx);
  const Field* field = nullptr;
  Job job{mesh, numbers_of(*mesh, p.field, p.component, "isovolume", &field), {}, {}, ctx};
  // Values that belong to other pieces are cut here, too.
  const bool alone = mesh->point_ghost().empty();
  const Range range = over_all(alone ? mesh->range(*field, p.component) : field_stats(job.numbers).range[0], ctx);
  const double lo = std::max(p.min.value_or(-HUGE_VAL), -1.7e308), hi = std::min(p.max.value_or(HUGE_VAL), 1.7e308);
  if (!range.empty() && lo <= range.lo) job.keep.level = hi, job.keep.sign = -1;  // one limit is enough
  else if (!range.empty() && hi >= range.hi) job.keep.level = lo;
  else job.keep.level = lo, job.keep.upper = hi, job.keep.between = true;
  return result(mesh, in->as<SurfaceMesh>() != nullptr, "isovolume", ctx, [&] { return clip_mesh(job); });
}

}  // namespace sg
