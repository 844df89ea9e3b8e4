// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/slice/slice.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/cell_reader.h"
#include "data/field_ops.h"
#include "data/ranks/over_all.h"
#include "filter/mesh/append.h"
#include "filter/mesh/clip/clip_cases.h"
#include "filter/mesh/clip/corner_bits.h"
#include "filter/mesh/clip/cut_numbers.h"
#include "filter/mesh/select/extract.h"
#include "filter/mesh/slice/slice_impl.h"
#include "filter/mesh/tessellate_cells.h"

namespace sg {

namespace {

using namespace detail;

// ---- what the cells give ------------------------------------------------------------------------------------------------

struct Listed {
  PointReader at;
  std::vector<double> d;
  std::vector<uint8_t> side;  // 1 in front, 2 behind, 4 in the surface (too), 8 no position
};

// What cuts: a plane, or any function with its values at the points.
struct Cutter {
  SlicePlane plane;
  const ImplicitFunction* function = nullptr;  // null: the plane
  Array values;                                // of the function
  double step = 0;                             // for its gradient
};

std::shared_ptr<Listed> listed(const Points& points, Cutter& cutter, Cut& cut) {
  auto l = std::make_shared<Listed>(Listed{PointReader(points), {}, {}});
  if (cutter.function) {
    const auto v = cutter.values.view<double>();
    l->d.assign(v.data, v.data + v.count);
  } else {
    l->d = distances(points.count(), cutter.plane, [&](size_t i) { return l->at[i]; });
  }
  l->side.resize(l->d.size());
  parallel_for(l->d.size(), 1 << 15, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) l->side[i] = uint8_t((l->d[i] >= 0 ? 1 : l->d[i] < 0 ? 2 : 8) | (l->d[i] == 0 ? 4 : 0));
  });
  cut.field = {[p = l.get()](size_t i) { return p->d[i]; }, [p = l.get()](size_t i) { return p->at[i]; }, cutter.plane.normal};
  if (const ImplicitFunction* f = cutter.function)
    cut.field.normal_at = [f, step = cutter.step](Vec3 x) { return f->evaluate ? f->gradient(x, step) : Vec3(); };
  cut.keep = l;
  return l;
}

constexpr size_t cells_per_chunk = 1 << 13;

bool straddles(uint8_t sides) { return (sides & 11) == 3; }

// A tetrahedron, pyramid, wedge or hexahedron that a plane crosses away from its corners: loops from a table. False when faces need a
// decision, or when the cell is inside out.
bool cut_by_table(const clipping::ClipTable& table, const int64_t* ids, const Listed& points, Vec3 normal, int64_t cell,
                  SurfaceChunk& out) {
  uint32_t pattern = 0;
  const auto n = size_t(table.topology().corners);
  for (size_t c = 0; c < n; ++c) pattern |= uint32_t(points.side[size_t(ids[c])] & 1) << c;
  if (table.ambiguous(pattern)) return false;
  const auto& loops = table.loops(pattern);
  const auto& edges = table.topology().edges;
  int64_t ring[12];
  for (const auto& loop : loops) {
    Vec3 at[3];
    for (size_t k = 0; k < loop.size(); ++k) {
      const auto [a, b] = edges[size_t(loop[k] - clipping::first_cut)];
      const auto p = uint32_t(ids[a]), q = uint32_t(ids[b]);
      ring[k] = crossing_key(p, q);
      if (k < 3) {
        const double da = points.d[std::min(p, q)], db = points.d[std::max(p, q)];
        at[k] = lerp(points.at[std::min(p, q)], points.at[std::max(p, q)], da / (da - db));
      }
    }
    if (dot(cross(at[1] - at[0], at[2] - at[0]), normal) < 0) std::reverse(ring, ring + loop.size());
    out.polygons.add({ring, loop.size()}, cell);
  }
  return true;
}

Cut cut_unstructured(const UnstructuredMesh& m, const std::vector<uint8_t>& states, Cutter with, Context& ctx) {
  Cut cut;
  const auto points = listed(m.points, with, cut);
  const CellsView v = cells_view(m.cells);
  cut.chunks.resize((v.count + cells_per_chunk - 1) / cells_per_chunk);
  parallel_for(
      v.count, cells_per_chunk,
      [&](size_t begin, size_t end) {
        PlaneCutter cutter(cut.field, cut.chunks[begin / cells_per_chunk]);
        CellFaceReader reader(m);
        std::vector<int64_t> ids;
        std::vector<uint8_t> joined(end - begin);
        any_of_corners(v, begin, end, points->side.data(), joined.data());
        for (size_t c = begin; c < end; ++c) {
          const uint8_t sides = joined[c - begin];
          if (!straddles(sides) || (!states.empty() && states[c] != cell_visible)) continue;
          const CellType type = m.type(c), shape = linear_type(type);
          if (!with.function && !(sides & 4)) {
            if (const clipping::ClipTable* table = clipping::clip_table(type)) {
              ids.clear();
              for (size_t k = v.begin(c); k < v.end(c); ++k) ids.push_back(v.connectivity[k]);
              if (cut_by_table(*table, ids.data(), *points, with.plane.normal, int64_t(c), cut.chunks[begin / cells_per_chunk])) continue;
            }
          }
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
      },
      &ctx);
  return cut;
}

Cut cut_surface(const SurfaceMesh& m, const std::vector<uint8_t>& states, Cutter with, Context& ctx) {
  Cut cut;
  const auto points = listed(m.points, with, cut);
  const CellArray* parts[4] = {&m.vertices, &m.lines, &m.polygons, &m.strips};
  size_t first = 0;
  for (int part = 0; part < 4; ++part) {
    const CellsView v = cells_view(*parts[part]);
    const size_t chunk0 = cut.chunks.size();
    cut.chunks.resize(chunk0 + (v.count + cells_per_chunk - 1) / cells_per_chunk);
    if (part > 0)
      parallel_for(
          v.count, cells_per_chunk,
          [&](size_t begin, size_t end) {
            PlaneCutter cutter(cut.field, cut.chunks[chunk0 + begin / cells_per_chunk]);
            std::vector<int64_t> ids;
            std::vector<uint8_t> joined(end - begin);
            any_of_corners(v, begin, end, points->side.data(), joined.data());
            for (size_t c = begin; c < end; ++c) {
              const auto id = int64_t(first + c);
              if ((!states.empty() && states[size_t(id)] != cell_visible) || !straddles(joined[c - begin])) continue;
              ids.clear();
              for (size_t i = v.begin(c); i < v.end(c); ++i) ids.push_back(v.connectivity[i]);
              if (part == 1) cutter.cut_curve(ids, id);
              if (part == 2) cutter.cut_flat(ids, id);
              for (size_t k = 0; part == 3 && k + 2 < ids.size(); ++k) cutter.cut_flat(std::span(ids).subspan(k, 3), id);
            }
          },
          &ctx);
    first += v.count;
  }
  return cut;
}

// Cells of an AMR grid, or of a lattice below dimension 3, that the plane may cut; the result is then sliced as any other mesh.
std::vector<int64_t> near_cells(const Dataset& in, const std::vector<uint8_t>& states, const SlicePlane& plane) {
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
      const double reach = 0.5 * (std::abs(plane.normal.x * level.spacing.x) + std::abs(plane.normal.y * level.spacing.y) +
                                  std::abs(plane.normal.z * level.spacing.z));
      size_t c = patch.cell_offset;
      for (size_t k = 0; k < n[2]; ++k)
        for (size_t j = 0; j < n[1]; ++j)
          for (size_t i = 0; i < n[0]; ++i, ++c) {
            const Vec3 index(double(patch.lo[0]) + double(i) + 0.5, double(patch.lo[1]) + double(j) + 0.5,
                             double(patch.lo[2]) + double(k) + 0.5);
            const double d = dot(plane.normal, g->origin + index * level.spacing - plane.origin);
            if (std::abs(d) <= reach * (1 + 1e-9) + plane.snap && visible(c)) r.push_back(int64_t(c));
          }
    }
  std::sort(r.begin(), r.end());
  return r;
}

// ---- putting it together ------------------------------------------------------------------------------------------------

DatasetPtr finish(const Dataset& in, const Cut& cut, const ImplicitFunction* function = nullptr) {
  std::vector<std::span<const uint64_t>> lists;
  CellList SurfaceChunk::*const members[3] = {&SurfaceChunk::vertices, &SurfaceChunk::lines, &SurfaceChunk::polygons};
  for (auto member : members)
    for (const SurfaceChunk& c : cut.chunks)
      lists.emplace_back(reinterpret_cast<const uint64_t*>((c.*member).ids.data()), (c.*member).ids.size());
  const CutNumbers numbers = number_names(lists, in.point_count());
  if (numbers.names.size() > size_t(INT32_MAX)) fail_usage("the cut has more than 2^31 points", "slice", "take a part of the mesh first");
  SurfaceMesh mesh;
  CellArray* arrays[3] = {&mesh.vertices, &mesh.lines, &mesh.polygons};
  std::vector<int64_t> cells;
  size_t at = 0;
  for (int kind = 0; kind < 3; ++kind) {
    size_t count = 0, ids = 0, first = 0;
    bool same = true;
    uint32_t size = 0;
    for (const SurfaceChunk& c : cut.chunks) {
      const CellList& l = c.*members[kind];
      count += l.sizes.size(), ids += l.ids.size();
      for (const uint32_t n : l.sizes) same = same && (size == 0 || n == size), size = n;
      cells.insert(cells.end(), l.sources.begin(), l.sources.end());
    }
    if (count == 0) continue;
    int32_t *to = nullptr, *offset = nullptr;
    arrays[kind]->connectivity = Array::make<int32_t>(ids, 1, &to);
    std::copy_n(numbers.number.begin() + ptrdiff_t(at), ids, to);
    at += ids;
    if (same) {
      arrays[kind]->fixed = int(size);
      continue;
    }
    arrays[kind]->offsets = Array::make<int32_t>(count + 1, 1, &offset);
    for (const SurfaceChunk& c : cut.chunks)
      for (const uint32_t n : (c.*members[kind]).sizes) *offset++ = int32_t(first), first += n;
    *offset = int32_t(first);
  }
  const Plane<uint64_t>& keys = numbers.names;
  std::vector<EdgePoint> edges(keys.size());
  double* xyz = nullptr;
  mesh.points.xyz = Array::make<double>(keys.size(), 3, &xyz);
  parallel_for(keys.size(), 1 << 12, [&](size_t begin, size_t end) {
    std::vector<Vec3> from(end - begin), to(end - begin);
    std::vector<double> t(end - begin);
    for (size_t i = begin; i < end; ++i) {
      const auto key = int64_t(keys[i]);
      from[i - begin] = cut.field.position(key_a(key)), to[i - begin] = cut.field.position(key_b(key));
      t[i - begin] = cut.field.share(key);
    }
    if (function) find_zeros(*function, from, to, t);
    for (size_t i = begin; i < end; ++i) {
      const auto key = int64_t(keys[i]);
      edges[i] = {key_a(key), key_b(key), float(t[i - begin])};
      const Vec3 p = key_a(key) == key_b(key) ? from[i - begin] : lerp(from[i - begin], to[i - begin], t[i - begin]);
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

DatasetPtr slice_with(const DatasetPtr& in, const SlicePlane& plane, Context& ctx) {
  const std::vector<uint8_t> states = cell_states(*in);
  if (auto* m = in->as<UnstructuredMesh>()) return finish(*in, cut_unstructured(*m, states, {plane, nullptr, {}, 0}, ctx));
  if (auto* m = in->as<SurfaceMesh>()) return finish(*in, cut_surface(*m, states, {plane, nullptr, {}, 0}, ctx));
  const auto d = lattice_dims(in->mesh());
  if (is_lattice(in->mesh()) && d[0] > 1 && d[1] > 1 && d[2] > 1) {
    if (states.empty())
      if (const DatasetPtr r = slice_rows(*in, plane, ctx)) return r;
    return finish(*in, cut_lattice(in->mesh(), states, plane, ctx));
  }
  const std::vector<int64_t> cells = near_cells(*in, states, plane);
  DatasetParts part = extract_cells(in, cells, "slice")->parts();
  part.fields.add(id_field("original_cell", Association::cell, cells));
  part.cell_ghost = {};
  return slice_with(make_dataset(std::move(part)), plane, ctx);
}

// A shape that is not a plane: lists of cells, whatever the mesh was.
DatasetPtr slice_shape(const DatasetPtr& in, const ImplicitParams& p, const DatasetPtr& surface, Context& ctx) {
  DatasetPtr mesh = in;
  if (!in->as<UnstructuredMesh>() && !in->as<SurfaceMesh>()) {
    // Only cells near the surface become lists.
    const std::vector<uint8_t> states = cell_states(*in);
    std::vector<int64_t> cells;
    if (in->as<AmrGrid>()) {
      for (size_t c = 0; c < in->cell_count(); ++c)
        if (states.empty() || states[c] == cell_visible) cells.push_back(int64_t(c));
    } else {
      const ImplicitFunction f = implicit_function(p, in, surface, "slice", ctx);
      const Array values = values_at_points(f, in, ctx);
      const auto d = values.view<double>();
      CellReader reader(in);
      for (size_t c = 0; c < in->cell_count(); ++c) {
        if (!states.empty() && states[c] != cell_visible) continue;
        reader.open(c);
        bool front = false, behind = false;
        for (const int64_t id : reader.ids()) front |= d[size_t(id)] >= 0, behind |= d[size_t(id)] < 0;
        if (front && behind) cells.push_back(int64_t(c));
      }
    }
    DatasetParts part = extract_cells(in, cells, "slice")->parts();
    part.fields.add(id_field("original_cell", Association::cell, cells));
    part.cell_ghost = {};
    mesh = make_dataset(std::move(part));
  }
  const ImplicitFunction f = implicit_function(p, mesh, surface, "slice", ctx);
  Cutter cutter;
  cutter.function = &f;
  cutter.values = values_at_points(f, mesh, ctx);
  cutter.step = 1e-6 * std::max(mesh->bounds().diagonal(), 1e-300);
  const std::vector<uint8_t> states = cell_states(*mesh);
  if (auto* m = mesh->as<UnstructuredMesh>()) return finish(*mesh, cut_unstructured(*m, states, cutter, ctx), &f);
  return finish(*mesh, cut_surface(*mesh->as<SurfaceMesh>(), states, cutter, ctx), &f);
}

bool has_curved_cells(const Dataset& in) {
  const auto* m = in.as<UnstructuredMesh>();
  if (!m) return false;
  if (m->types.empty()) return is_high_order(m->single_type);
  const auto types = m->types.view<uint8_t>();
  for (size_t i = 0; i < types.count; ++i)
    if (is_high_order(CellType(types[i]))) return true;
  return false;
}

// The curved cells that a plane may cut, and all others, made linear: what lies away from it costs nothing.
DatasetPtr straight_near(const DatasetPtr& in, const SlicePlane& plane, double tolerance, Context& ctx) {
  const std::vector<uint8_t> states = cell_states(*in);
  std::vector<int64_t> cells;
  CellReader reader(in);
  for (size_t c = 0; c < in->cell_count(); ++c) {
    if (c % 1024 == 0) ctx.check();
    if (!states.empty() && states[c] != cell_visible) continue;
    reader.open(c);
    const Box3 box = reader.box();
    const Vec3 half = 0.5 * box.size();
    const double reach = std::abs(plane.normal.x) * half.x + std::abs(plane.normal.y) * half.y + std::abs(plane.normal.z) * half.z;
    if (!(std::abs(dot(plane.normal, box.center() - plane.origin)) > reach * (1 + 1e-9) + plane.snap)) cells.push_back(int64_t(c));
  }
  if (cells.size() == in->cell_count()) return tessellate(in, {.tolerance = tolerance, .max_level = 7}, ctx);
  DatasetParts part = extract_cells(in, cells, "slice")->parts();
  if (!part.fields.find("original_cell", Association::cell))
    part.fields.add(id_field("original_cell", Association::cell, std::move(cells)));
  part.cell_ghost = {};
  return tessellate(make_dataset(std::move(part)), {.tolerance = tolerance, .max_level = 7}, ctx);
}

DatasetPtr slice_one(const DatasetPtr& in, const DatasetPtr& surface, const ImplicitParams& p, Context& ctx) {
  const bool curved = has_curved_cells(*in);
  if (curved) ctx.info("slice: curved cells are linearised first");
  if (surface || (names_shape(p) && p.box.empty()))
    return slice_shape(curved ? tessellate(in, {.tolerance = p.tolerance, .max_level = 7}, ctx) : in, p, surface, ctx);
  const ImplicitFunction f = implicit_function(p, in, nullptr, "slice", ctx);
  const auto along = [&](const SlicePlane& plane) {
    return slice_with(curved ? straight_near(in, plane, p.tolerance, ctx) : in, plane, ctx);
  };
  if (p.box.empty()) return along({f.origin, f.normal, f.snap, 1});
  return slice_box(in, {Vec3(p.box[0], p.box[2], p.box[4]), Vec3(p.box[1], p.box[3], p.box[5])}, along, ctx);
}

// The planes that the parameters request, one after the other.
std::vector<ImplicitParams> planes_of(const Dataset& in, const SliceParams& p, const Context& ctx) {
  std::vector<ImplicitParams> r;
  const bool several = p.planes != CutPlanes::none;
  if (several && !p.positions.empty()) fail_usage("both planes and positions are given", "slice", "give only one of them");
  if (!p.positions.empty()) {
    if (p.axis == CutAxis::none) fail_usage("positions need an axis", "slice", "write e.g. axis=z positions=1,2,3");
    if (p.position) fail_usage("both position and positions are given", "slice", "give only one of them");
    for (const double x : p.positions) r.emplace_back(p).position = x;
  } else if (several) {
    if (p.axis != CutAxis::none) fail_usage("both planes and axis are given", "slice", "give only one of them");
    const Box3 box = p.origin ? in.bounds() : bounds_over_all(in, ctx);
    const Vec3 middle = p.origin.value_or(box.empty() ? Vec3() : box.center());
    for (const char a : word_of(p.planes)) {
      ImplicitParams& plane = r.emplace_back(p);
      plane.origin.reset();
      plane.axis = CutAxis(1 + a - 'x');
      plane.position = middle[a - 'x'];
    }
  }
  return r;
}

}  // namespace

DatasetPtr slice(const DatasetPtr& in, const DatasetPtr& surface, const SliceParams& p, Context& ctx) {
  if (in->as<PointCloud>())
    fail_usage("a point cloud has no cells to cut", "slice", "select points by value with threshold, or show the points themselves");
  if (in->point_count() >= UINT32_MAX) fail_usage("the mesh has more than 2^32 points", "slice", "take a part of it first");
  const std::vector<ImplicitParams> planes = planes_of(*in, p, ctx);
  DatasetPtr out;
  if (planes.empty()) {
    out = slice_one(in, surface, p, ctx);
  } else {
    std::vector<Data> parts;
    for (size_t i = 0; i < planes.size(); ++i) {
      DatasetParts part = slice_one(in, surface, planes[i], ctx)->parts();
      const size_t n = cell_count(part.mesh);
      part.fields.add({"plane", Association::cell, Array::from_vector(std::vector<int32_t>(n, int32_t(i))), {}, Role::labels});
      parts.emplace_back(make_dataset(std::move(part)));
    }
    AppendParams join;
    join.part = false;
    out = append(parts, join, ctx);
  }
  if (out->cell_count() == 0) {
    const Box3 b = in->bounds();
    ctx.info(fmt::format("slice: the surface cuts no cell; the mesh extends over x {} .. {}, y {} .. {}, z {} .. {}", short_number(b.lo.x),
                         short_number(b.hi.x), short_number(b.lo.y), short_number(b.hi.y), short_number(b.lo.z), short_number(b.hi.z)));
  };
  return out;
}

}  // namespace sg
