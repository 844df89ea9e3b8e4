// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/contour/contour.h"

#include <fmt/core.h>

#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/mesh_dimension.h"
#include "data/ranks/over_all.h"
#include "data/ranks/part_ranges.h"
#include "data/trusted.h"
#include "filter/field/automatic_values.h"
#include "filter/field/sampling/point_cell.h"
#include "filter/mesh/select/extract.h"
#include "filter/scalar/contour/cells/contour_curved.h"
#include "filter/scalar/contour/contour_active.h"
#include "filter/scalar/contour/contour_amr.h"

namespace sg {

void describe(Schema& s, ContourParams& p) {
  s("field", p.field, "Point field to contour; default: the active scalar.");
  s("values", p.values, "Isovalues, one surface each; default: the middle of the range, or as many as 'count' says.").unit("@field");
  s("count", p.count, "About how many values, at round numbers, when none are given.").range(1, 10000);
  s("normals", p.normals, "Add unit normals from the field's gradient.");
  s("topology", p.topology,
    "On grids: the surface of the trilinear function in each cell, or a fixed marching cubes table that separates values at or above the "
    "isovalue on every face.");
  s("from_cells", p.from_cells, "Contour a cell field, averaged to the points.");
  s("tolerance", p.tolerance, "Curved cells: largest distance of the triangles from the surface, as a share of the mesh's diagonal.")
      .positive();
  s("component", p.component, "Component of a field with several: 0, 1, ..., x, y, z, or magnitude.");
}

namespace {

using namespace contouring;

constexpr const char* cell_hint = "set from_cells=true to average the values to the points, or name a point field";

const Field& choose_field(const Dataset& input, const FieldName& name) {
  if (!name.empty()) {
    const Field& f = input.fields().require(name.name);
    if (const Field* point = input.fields().find(name.name, Association::point)) return *point;
    if (f.association == Association::cell)
      fail_usage(fmt::format("field '{}' is a cell field; a contour needs values at the points", name.name), "contour", cell_hint);
    fail_usage(fmt::format("field '{}' belongs to the whole mesh; a contour needs values at the points", name.name), "contour");
  }
  const Field* f = input.fields().active(1);
  if (f && f->association == Association::point) return *f;
  for (const Field& p : input.fields())
    if (p.association == Association::point && p.components() == 1) return p;
  for (const Field& p : input.fields())
    if (p.association == Association::point) return p;  // a vector: the next check reports what to do
  if (f) fail_usage(fmt::format("the mesh has no point field to contour, only the cell field '{}'", f->name), "contour", cell_hint);
  fail_usage("the mesh has no point field to contour", "contour");
}

const Field& choose_cell_field(const Dataset& input, const FieldName& name) {
  const Field* f = nullptr;
  if (!name.empty()) {
    const Field& any = input.fields().require(name.name);
    f = input.fields().find(name.name, Association::cell);
    if (!f)
      fail_usage(fmt::format("field '{}' is defined on the {}, not on the cells", name.name,
                             any.association == Association::point ? "points" : "whole mesh"),
                 "contour from_cells", "leave out from_cells for a point field");
  } else {
    f = input.fields().active(1);
    if (!f || f->association != Association::cell) f = nullptr;
    for (const Field& c : input.fields())
      if (!f && c.association == Association::cell && c.components() == 1) f = &c;
    for (const Field& c : input.fields())
      if (!f && c.association == Association::cell) f = &c;
    if (!f) fail_usage("the mesh has no cell field to contour", "contour from_cells", "leave out from_cells");
  }
  return *f;
}

// The mesh with the chosen cell field also at the points, and its name.
std::pair<DatasetPtr, std::string> averaged_to_points(const DatasetPtr& input, const FieldName& name, Context& context) {
  const Field& f = choose_cell_field(*input, name);
  CellToPointParams p;
  p.fields = {f.name};
  return {cell_to_point(input, p, context), f.name};
}

// 0, 1, ... or -1 for the magnitude.
int choose_component(const Field& f, const std::string& word) {
  const int n = f.components();
  const std::string choices = fmt::format("set component=magnitude, or component=0 to {}", n - 1);
  if (word.empty()) {
    if (n > 1) fail_usage(fmt::format("field '{}' has {} components; a contour needs one number per point", f.name, n), "contour", choices);
    return 0;
  }
  if (equal_ignoring_case(word, "magnitude")) return n > 1 ? -1 : 0;
  int64_t c = -1;
  if (const auto number = parse_int(word)) c = *number;
  else if (word.size() == 1) c = int64_t(std::string("xyz").find(to_lower(word)[0]));
  if (c < 0 || c >= n)
    fail_usage(fmt::format("field '{}' has no component '{}'", f.name, word), "contour component",
               n > 1 ? choices : "it has one component: leave out component");
  return int(c);
}

// One packed component in a type that the kernels read as it is.
Array choose_samples(const Field& f, int component) {
  const ElementType t = f.array.type();
  if (component < 0)
    return scalar_of(
        f, -1,
        t == ElementType::f64 || element_size(t) >= 4 ? t == ElementType::f32 ? ElementType::f32 : ElementType::f64 : ElementType::f32);
  const Array a = f.array.component(component);
  switch (t) {
    case ElementType::u32:
    case ElementType::i32:
    case ElementType::u64:
    case ElementType::i64: return a.converted(ElementType::f64);
    default: return a.made_packed();
  }
}

// Zero where single precision serves near the data, else the middle of the box.
Vec3 choose_origin(const Box3& box) {
  if (box.empty()) return {};
  double far = 0;
  for (int a = 0; a < 3; ++a) far = std::max({far, std::abs(box.lo[a]), std::abs(box.hi[a])});
  return far <= 4 * box.diagonal() ? Vec3() : box.center();
}

void check_mesh(const Dataset& input) {
  if (input.point_count() > size_t(UINT32_MAX)) fail_usage("the mesh has more than 2^32 points", "contour", "contour one part at a time");
  if (is_lattice(input.mesh())) {
    int axes = 0;
    for (size_t n : lattice_dims(input.mesh())) axes += n > 1;
    if (axes < 2 && input.point_count() > 0)
      fail_usage(fmt::format("a grid with {} axis of more than one point has no contour", axes), "contour",
                 "use a grid of two or three axes");
  } else if (!input.as<UnstructuredMesh>() && !input.as<SurfaceMesh>()) {
    const bool amr = input.as<AmrGrid>();
    fail_usage(fmt::format("a mesh of kind '{}' cannot be contoured", input.kind()), "contour",
               amr ? "show its outer surface instead: -f faces" : "points alone have no inside");
  }
}

// One behind the other; pieces that already lie so are not copied.
template <class Get>
Array joined(std::vector<Piece>& pieces, int components, Get&& get, bool ids) {
  if (pieces.size() == 1) return get(pieces[0]);
  size_t total = 0;
  const Array* any = nullptr;
  std::vector<Array> arrays;
  for (Piece& p : pieces) arrays.push_back(get(p));
  bool in_place = true;
  size_t before = 0;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const Array& a = arrays[i];
    if (a.count()) {
      if (!any) any = &a;
      in_place = in_place && a.buffer().data == any->buffer().data &&
                 a.raw() == any->buffer().data + total * size_t(components) * element_size(a.type()) &&
                 (!ids || pieces[i].first_point == before);
    }
    total += a.count();
    before += pieces[i].point_count();
  }
  if (!any) return arrays[0];
  if (in_place) return Array(any->buffer(), any->type(), total, components);
  std::byte* out = nullptr;
  const Array r = Array::make_raw(any->type(), total, components, &out);
  before = 0;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const Array& a = arrays[i];
    if (a.count()) std::memcpy(out, a.raw(), a.bytes());  // a piece without any surface has no bytes to point at
    if (ids)
      for (size_t k = 0; k < a.count(); ++k) reinterpret_cast<int32_t*>(out)[k] += int32_t(before - pieces[i].first_point);
    out += a.bytes();
    before += pieces[i].point_count();
  }
  return r;
}

template <class T, class Get>
std::vector<T> joined_list(const std::vector<Piece>& pieces, Get&& get) {
  std::vector<T> r;
  for (const Piece& p : pieces) r.insert(r.end(), get(p).data, get(p).data + get(p).count);
  return r;
}

// One number for each of counts[i] places, one list behind the other.
template <class T>
Array repeated(const std::vector<size_t>& counts, const std::vector<double>& numbers) {
  size_t total = 0;
  for (size_t n : counts) total += n;
  T* out = nullptr;
  const Array a = Array::make<T>(total, 1, &out);
  for (size_t i = 0; i < counts.size(); ++i) {
    parallel_for(counts[i], 1 << 16, [&](size_t begin, size_t end) { std::fill(out + begin, out + end, T(numbers[i])); });
    out += counts[i];
  }
  return a;
}

// One isovalue per point; integer fields become f32, since 0.5 is not an integer.
Array isovalues(const std::vector<Piece>& pieces, const std::vector<double>& values, ElementType type) {
  std::vector<size_t> counts;
  for (const Piece& p : pieces) counts.push_back(p.point_count());
  return type == ElementType::f64 ? repeated<double>(counts, values) : repeated<float>(counts, values);
}

// A point field on all points: linear along edges, trilinear inside cells.
Array carried(const Array& a, const std::vector<Piece>& pieces) {
  if (pieces.size() == 1 && pieces[0].inner.count == 0) return interpolate(a, pieces[0].points.span());
  size_t total = 0;
  for (const Piece& p : pieces) total += p.point_count();
  std::byte* out = nullptr;
  const Array r = Array::make_raw(a.type(), total, a.components(), &out);
  for (const Piece& p : pieces) {
    const Array edges = interpolate(a, p.points.span());
    if (edges.count()) std::memcpy(out, edges.raw(), edges.bytes());
    out += edges.bytes();
    interpolate_inner(a, p, out);
    out += p.inner.count * size_t(a.components()) * element_size(a.type());
  }
  return r;
}

DatasetPtr assemble(const Dataset& input, const Field& field, const std::vector<double>& values, std::vector<Piece> pieces, const Job& job,
                    bool wants_normals) {
  size_t total = 0;
  for (const Piece& p : pieces) total += p.point_count();
  if (total > size_t(INT32_MAX)) fail_usage("the surfaces have more than 2^31 points", "contour", "use fewer values at a time");
  SurfaceMesh mesh;
  mesh.points.xyz = joined(
      pieces, 3, [](Piece& p) { return p.xyz; }, false);
  mesh.points.origin = job.origin;
  mesh.lines.connectivity = joined(
      pieces, 1, [](Piece& p) { return p.lines; }, true);
  mesh.polygons.connectivity = joined(
      pieces, 1, [](Piece& p) { return p.triangles; }, true);
  if (mesh.lines.connectivity.count()) mesh.lines.fixed = 2;
  else mesh.lines = {};
  mesh.polygons.fixed = 3;
  if (mesh.polygons.connectivity.empty()) mesh.polygons.connectivity = Array::from_vector(std::vector<int32_t>());

  FieldSet out;
  for (const Field& f : input.fields()) {
    if (f.association != Association::point) continue;
    // On its own contour the field has the isovalue itself, free of the rounding of an interpolation.
    const bool itself = f.name == field.name && f.components() == 1;
    out.add(f.with(itself ? isovalues(pieces, values, f.array.type()) : carried(f.array, pieces)));
  }
  if (wants_normals) {
    float* none = nullptr;
    for (Piece& p : pieces)
      if (p.normals.empty()) p.normals = Array::make<float>(p.point_count(), 3, &none), std::fill(none, none + 3 * p.point_count(), 0.0f);
    out.add({"Normals", Association::point,
             joined(
                 pieces, 3, [](Piece& p) { return p.normals; }, false),
             "", Role::normals});
  }
  if (job.cells) {
    auto cells = joined_list<uint32_t>(pieces, [](const Piece& p) -> const Block<uint32_t>& { return p.line_cells; });
    const auto triangles = joined_list<uint32_t>(pieces, [](const Piece& p) -> const Block<uint32_t>& { return p.triangle_cells; });
    cells.insert(cells.end(), triangles.begin(), triangles.end());
    carry_gathered(out, input.fields(), Association::cell, std::span<const uint32_t>(cells), Association::cell);
  }
  if (values.size() > 1) {
    std::vector<size_t> counts;
    std::vector<double> numbers = values;
    for (const Piece& p : pieces) counts.push_back(p.lines.count() / 2);
    for (const Piece& p : pieces) counts.push_back(p.triangles.count() / 3);
    numbers.insert(numbers.end(), values.begin(), values.end());
    out.add({"contour value", Association::cell, repeated<double>(counts, numbers), field.unit, Role::none});
  }
  carry_whole(out, input.fields());
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.fields = std::move(out);
  parts.notes = input.notes();
  parts.time = input.time();
  return make_trusted_dataset(std::move(parts));
}

// 3: solids to cut, 2: faces.
int dimension_to_cut(const Dataset& input) {
  const int dimension = mesh_dimension(input);
  if (dimension < 2 && input.cell_count() > 0 && !is_lattice(input.mesh()))
    fail_usage("the mesh has only points and lines; a contour needs faces or solids", "contour");
  return dimension;
}

// Where levels meet, a cell is cut as its neighbours ask for it, though they belong to other pieces: all are cut, the own ones stay.
DatasetPtr contour_own_amr(const DatasetPtr& given, const ContourParams& params, Context& context) {
  constexpr const char* mark = "cell of this piece";
  const View<uint8_t> ghost = given->cell_ghost().empty() ? View<uint8_t>{} : given->cell_ghost().view<uint8_t>();
  std::vector<uint8_t> rest, own;
  for (size_t c = 0; c < ghost.count; ++c) rest.push_back(ghost[c] & ~ghost_duplicate), own.push_back(!(ghost[c] & ghost_duplicate));
  if (std::find(own.begin(), own.end(), uint8_t(0)) == own.end()) return contour_amr(given, params, choose_component, context);
  DatasetParts parts = given->parts();
  parts.cell_ghost = Array::from_vector(std::move(rest));
  parts.fields.add({mark, Association::cell, Array::from_vector(std::move(own)), "", Role::none});
  const DatasetPtr all = contour_amr(make_dataset(std::move(parts)), params, choose_component, context);
  const Array& kept = all->fields().require(mark, Association::cell).array;
  std::vector<int64_t> cells;
  for (size_t c = 0; c < kept.count(); ++c)
    if (kept.get(c) != 0) cells.push_back(int64_t(c));
  DatasetParts out = extract_cells(all, cells, "contour")->parts();
  out.fields.remove(mark, Association::cell);
  return make_dataset(std::move(out));
}

}  // namespace

std::vector<double> choose_isovalues(const Dataset& input, const ContourParams& params, const Context& context) {
  const Field& field = input.as<AmrGrid>() ? field_of_amr(input, params.field)
                       : params.from_cells ? choose_cell_field(input, params.field)
                                           : choose_field(input, params.field);
  return automatic_values(input, field, choose_component(field, params.component), params.count, "contour", context);
}

DatasetPtr contour(const DatasetPtr& given, const ContourParams& params, Context& context) {
  if (given->as<AmrGrid>()) return contour_own_amr(given, params, context);
  check_mesh(*given);
  DatasetPtr input = given;
  FieldName name = params.field;
  if (params.from_cells) std::tie(input, name.name) = averaged_to_points(given, params.field, context);
  const Field& field = choose_field(*input, name);
  const int component = choose_component(field, params.component);
  const int dimension = dimension_to_cut(*input);
  std::vector<double> values = params.values;
  if (values.empty()) values = automatic_values(*input, field, component, params.count, "contour", context);
  for (double v : values)
    if (!std::isfinite(v)) fail_usage(fmt::format("{} is not a valid isovalue", v), "contour values", "give finite numbers");

  const bool trilinear = params.topology == ContourTopology::trilinear;
  Job job{*input, choose_samples(field, component), params.normals, false, trilinear, true, choose_origin(input->bounds()), context};
  for (const Field& f : input->fields()) job.cells = job.cells || f.association == Association::cell;
  if (has_curved_cells(*input))
    return contour_curved(input, field, job.samples, values, params.tolerance, params.normals && dimension == 3, job.origin, context);
  const std::string key = fmt::format("{} {}", field.name, component);
  job.edges = false;
  for (const Field& f : input->fields())
    job.edges = job.edges || (f.association == Association::point && !(f.name == field.name && f.components() == 1));
  std::vector<Piece> pieces;
  if (is_lattice(input->mesh()) && input->point_count() > 0) {
    pieces = LatticeContour(job, lattice_index(job, key)).run(values);
  } else if (is_lattice(input->mesh())) {
    Piece none;
    float* p = nullptr;
    none.xyz = Array::make<float>(0, 3, &p);
    pieces.assign(values.size(), none);
  } else {
    const auto index = cell_index(job, key, values.size());
    for (double v : values) pieces.push_back(contour_cells(job, v, index.get()));
  }
  for (size_t i = 0; i < pieces.size(); ++i) {
    if (pieces[i].lines.count() + pieces[i].triangles.count() > 0 || context.communicator) continue;
    // Not before: it is a pass over all samples.
    if (met_in_a_part(field, component, values[i], context)) continue;
    const Range range = range_over_all(*input, field, component, context);
    context.info(range.empty() ? fmt::format("contour: field '{}' has no values", field.name)
                               : fmt::format("contour: nothing at {} = {}; the field ranges from {} to {}{}", field.name,
                                             short_number(values[i]), short_number(range.lo), short_number(range.hi),
                                             range.lo == range.hi ? " (that of a contour before? on=input takes the data as read)" : ""));
  }
  return assemble(*input, field, values, std::move(pieces), job, params.normals && dimension == 3);
}

}  // namespace sg
