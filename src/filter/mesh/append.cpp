// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/append.h"

#include <fmt/core.h>

#include <cstring>
#include <unordered_set>

#include "base/error.h"
#include "data/field_ops.h"
#include "data/memory/memory_budget.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/to_unstructured.h"

namespace sg {

namespace {

// One array after the other; `have[i]` may be null (filled with NaN or 0). Empty arrays do not affect the type and the components unless
// all are empty: an input without points need not name either.
Array joined(const std::vector<const Array*>& have, const std::vector<size_t>& counts) {
  const Array *first = nullptr, *empty = nullptr;
  bool one_type = true, whole = true;
  size_t n = 0;
  for (size_t i = 0; i < have.size(); ++i) {
    n += counts[i];
    if (counts[i] == 0) empty = empty ? empty : have[i];
    else if (!have[i]) whole = false;
    else if (!first) first = have[i];
    else one_type = one_type && have[i]->type() == first->type();
  }
  if (!first) first = empty;
  const ElementType type = one_type ? first->type() : ElementType::f64;
  std::byte* out = nullptr;
  Array result = Array::make_raw(type, n, first->components(), &out);
  const size_t tuple = size_t(first->components()) * element_size(type);
  std::vector<std::byte> missing(tuple, std::byte{0});
  if (!whole)
    for (int c = 0; c < first->components(); ++c) {
      const float f = std::nanf("");
      const double d = std::nan("");
      if (type == ElementType::f32) std::memcpy(missing.data() + 4 * size_t(c), &f, 4);
      if (type == ElementType::f64) std::memcpy(missing.data() + 8 * size_t(c), &d, 8);
    }
  for (size_t i = 0; i < have.size(); ++i) {
    if (counts[i] == 0) continue;
    if (have[i]) {
      const Array a = have[i]->converted(type).made_packed();
      std::memcpy(out, a.raw(), a.bytes());
      out += a.bytes();
    } else {
      for (size_t k = 0; k < counts[i]; ++k, out += tuple) std::memcpy(out, missing.data(), tuple);
    }
  }
  return result;
}

void append_cells(const CellArray& from, size_t point_begin, std::vector<int64_t>& ids, std::vector<int64_t>& offsets) {
  const CellsView v = cells_view(from);
  for (size_t c = 0; c < v.count; ++c) {
    for (size_t k = v.begin(c); k < v.end(c); ++k) ids.push_back(v.connectivity[k] + int64_t(point_begin));
    offsets.push_back(int64_t(ids.size()));
  }
}

CellArray cell_array(std::vector<int64_t> ids, std::vector<int64_t> offsets) {
  return {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
}

const Points& points_of(const DatasetPtr& d) {
  if (auto* u = d->as<UnstructuredMesh>()) return u->points;
  if (auto* s = d->as<SurfaceMesh>()) return s->points;
  return d->as<PointCloud>()->points;
}

// f32 offsets of one origin stay so; else f64 about the first origin. Inputs without points do not count.
Points joined_points(const std::vector<DatasetPtr>& parts) {
  Points out;
  out.origin = points_of(parts[0]).origin;
  bool plain = true;
  for (size_t i = parts.size(); i-- > 0;)
    if (parts[i]->point_count() > 0) out.origin = points_of(parts[i]).origin;
  for (const DatasetPtr& d : parts) plain = plain && (d->point_count() == 0 || points_of(d).origin == out.origin);
  std::vector<Array> kept;
  std::vector<const Array*> arrays;
  std::vector<size_t> counts;
  for (const DatasetPtr& d : parts) {
    const Points& p = points_of(d);
    counts.push_back(p.count());
    if (plain) {
      kept.push_back(p.xyz);
      continue;
    }
    double* w = nullptr;
    Array moved = Array::make<double>(p.count(), 3, &w);
    for (size_t i = 0; i < p.count(); ++i) {
      const Vec3 at = p.at(i) - out.origin;
      w[3 * i] = at.x, w[3 * i + 1] = at.y, w[3 * i + 2] = at.z;
    }
    kept.push_back(std::move(moved));
  }
  for (const Array& a : kept) arrays.push_back(&a);
  out.xyz = joined(arrays, counts);
  return out;
}

Mesh joined_unstructured(const std::vector<DatasetPtr>& parts) {
  UnstructuredMesh m;
  std::vector<int64_t> ids, offsets{0}, face_ids, face_offsets{0}, cell_faces{0};
  std::vector<uint8_t> types, degrees;
  std::vector<double> weights;
  bool polyhedra = false, any_degrees = false, any_weights = false;
  size_t points = 0;
  for (const DatasetPtr& d : parts) {
    const auto& u = *d->as<UnstructuredMesh>();
    append_cells(u.cells, points, ids, offsets);
    const size_t face_begin = face_offsets.size() - 1, n = u.cells.size();
    append_cells(u.faces, points, face_ids, face_offsets);
    polyhedra = polyhedra || !u.polyhedron_faces.empty();
    for (size_t c = 0; c < n; ++c) {
      types.push_back(uint8_t(u.type(c)));
      const int64_t end = u.polyhedron_faces.empty() ? 0 : int64_t(u.polyhedron_faces.get(c + 1));
      cell_faces.push_back(u.polyhedron_faces.empty() ? cell_faces.back() : int64_t(face_begin) + end);
      for (int a = 0; a < 3; ++a) degrees.push_back(u.degrees.empty() ? 0 : uint8_t(u.degrees.get(c, a)));
    }
    for (size_t i = 0; i < u.points.count(); ++i) weights.push_back(u.weights.empty() ? 1 : u.weights.get(i));
    any_degrees = any_degrees || !u.degrees.empty(), any_weights = any_weights || !u.weights.empty();
    points += u.points.count();
  }
  m.points = joined_points(parts);
  m.cells = cell_array(std::move(ids), std::move(offsets));
  m.types = Array::from_vector(std::move(types));
  if (polyhedra) {
    m.faces = cell_array(std::move(face_ids), std::move(face_offsets));
    m.polyhedron_faces = Array::from_vector(std::move(cell_faces));
  }
  if (any_degrees) m.degrees = Array::from_vector(std::move(degrees), 3);
  if (any_weights) m.weights = Array::from_vector(std::move(weights));
  return m;
}

// `order` receives the cells of the concatenated parts in the order of the joined surface.
Mesh joined_surface(const std::vector<DatasetPtr>& parts, std::vector<int64_t>& order) {
  SurfaceMesh m;
  CellArray SurfaceMesh::*kinds[4] = {&SurfaceMesh::vertices, &SurfaceMesh::lines, &SurfaceMesh::polygons, &SurfaceMesh::strips};
  for (int kind = 0; kind < 4; ++kind) {
    std::vector<int64_t> ids, offsets{0};
    size_t points = 0, cells = 0;
    for (const DatasetPtr& d : parts) {
      const auto& s = *d->as<SurfaceMesh>();
      size_t before = 0;
      for (int k = 0; k < kind; ++k) before += (s.*kinds[k]).size();
      for (size_t c = 0; c < (s.*kinds[kind]).size(); ++c) order.push_back(int64_t(cells + before + c));
      append_cells(s.*kinds[kind], points, ids, offsets);
      points += d->point_count(), cells += d->cell_count();
    }
    if (offsets.size() > 1) m.*kinds[kind] = cell_array(std::move(ids), std::move(offsets));
  }
  m.points = joined_points(parts);
  return m;
}

void join_fields(const std::vector<DatasetPtr>& parts, Association on, const std::vector<int64_t>& order, bool all, FieldSet& out,
                 Context& ctx) {
  std::vector<std::string> names;
  std::unordered_set<std::string> known;
  for (const DatasetPtr& d : parts)
    for (const Field& f : d->fields())
      if (f.association == on && known.insert(f.name).second) names.push_back(f.name);
  std::vector<size_t> counts;
  for (const DatasetPtr& d : parts) counts.push_back(on == Association::point ? d->point_count() : d->cell_count());
  for (const std::string& name : names) {
    std::vector<const Array*> have;
    const Field *first = nullptr, *empty = nullptr;
    bool everywhere = true, fits = true;
    for (size_t i = 0; i < parts.size(); ++i) {
      const Field* f = parts[i]->fields().find(name, on);
      have.push_back(f ? &f->array : nullptr);
      if (counts[i] == 0) {  // without tuples nothing is missing, and nothing can disagree
        if (f && !empty) empty = f;
        continue;
      }
      everywhere = everywhere && f;
      if (f && !first) first = f;
      fits = fits && (!f || f->components() == first->components());
    }
    if (!first) first = empty;
    if (!fits || (!everywhere && !all)) {
      ctx.info(fmt::format("append: field '{}' was dropped: {}", name, fits ? "not every input has it" : "its components differ"));
      continue;
    }
    Field f = *first;
    f.array = joined(have, counts);
    for (const DatasetPtr& d : parts)  // numbers of one list of materials are not those of another
      if (const Field* g = d->fields().find(name, on); g && g->materials != f.materials) f.materials = nullptr;
    if (on == Association::cell && !order.empty()) f.array = gather(f.array, order);
    out.add(std::move(f));
  }
}

// Before anything is made: points, cells and fields of all parts together.
void check_memory(const std::vector<DatasetPtr>& parts) {
  double bytes = 0;
  for (const DatasetPtr& d : parts) {
    bytes += 12 * double(d->point_count()) + 17 * double(d->cell_count());
    for (const Field& f : d->fields()) bytes += double(f.array.bytes());
    if (const auto* u = d->as<UnstructuredMesh>()) bytes += 8 * double(u->cells.connectivity.count() + u->faces.connectivity.count());
    else if (const auto* s = d->as<SurfaceMesh>())
      for (const CellArray* c : {&s->vertices, &s->lines, &s->polygons, &s->strips}) bytes += 8 * double(c->connectivity.count());
    else if (!d->as<PointCloud>()) bytes += 64 * double(d->cell_count());  // of a lattice
  }
  constexpr double growing = 2.5;  // lists of cells grow by doubling
  need_memory(growing * bytes, fmt::format("{} meshes as one", parts.size()), "append", "append fewer or smaller parts");
}

Array joined_ghosts(const std::vector<DatasetPtr>& parts, bool of_points) {
  bool any = false;
  std::vector<uint8_t> out;
  for (const DatasetPtr& d : parts) {
    const Array& g = of_points ? d->point_ghost() : d->cell_ghost();
    any = any || !g.empty();
    const size_t n = of_points ? d->point_count() : d->cell_count();
    for (size_t i = 0; i < n; ++i) out.push_back(g.empty() ? 0 : uint8_t(g.get(i)));
  }
  return any ? Array::from_vector(std::move(out)) : Array();
}

}  // namespace

DatasetPtr append(const std::vector<Data>& inputs, const AppendParams& p, Context& ctx) {
  std::vector<DatasetPtr> parts;
  for (const Data& d : inputs) for_each_dataset(d, [&](const std::string&, const DatasetPtr& one) { parts.push_back(one); });
  if (parts.empty()) fail_usage("none of the inputs is a mesh", "append");
  check_memory(parts);
  bool surfaces = true, clouds = true;
  for (const DatasetPtr& d : parts) surfaces = surfaces && d->as<SurfaceMesh>(), clouds = clouds && d->as<PointCloud>();
  if (!surfaces && !clouds)
    for (DatasetPtr& d : parts)
      if (!d->as<UnstructuredMesh>()) d = to_unstructured(d);
  std::vector<int64_t> order;
  DatasetParts out;
  if (clouds) out.mesh = PointCloud{joined_points(parts)};
  else out.mesh = surfaces ? joined_surface(parts, order) : joined_unstructured(parts);
  join_fields(parts, Association::point, {}, p.all, out.fields, ctx);
  join_fields(parts, Association::cell, order, p.all, out.fields, ctx);
  for (const DatasetPtr& d : parts)
    for (const Field& f : d->fields())
      if (f.association == Association::whole && !out.fields.find(f.name, Association::whole)) out.fields.add(f);
  out.point_ghost = joined_ghosts(parts, true);
  out.cell_ghost = joined_ghosts(parts, false);
  if (!out.cell_ghost.empty() && !order.empty()) out.cell_ghost = gather(out.cell_ghost, order);
  if (p.part) {
    std::vector<int32_t> part;
    for (size_t i = 0; i < parts.size(); ++i)
      part.insert(part.end(), clouds ? parts[i]->point_count() : parts[i]->cell_count(), int32_t(i));
    Array a = Array::from_vector(std::move(part));
    if (!order.empty()) a = gather(a, order);
    out.fields.add({"part", clouds ? Association::point : Association::cell, std::move(a), "", Role::labels});
  }
  out.time = parts[0]->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
