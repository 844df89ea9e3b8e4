// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/isolines.h"

#include <fmt/core.h>

#include "base/error.h"
#include "data/cells/cell_reader.h"
#include "data/field_ops.h"
#include "data/lattice.h"
#include "data/ranks/over_all.h"
#include "filter/field/automatic_values.h"
#include "filter/scalar/contour/contour.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

struct Segments {
  std::vector<std::array<int64_t, 2>> ends;
  std::vector<int64_t> cell;
};

Segments segments_of(const DatasetPtr& in, size_t& other_cells) {
  Segments s;
  CellReader reader(in);
  std::vector<uint32_t> order;
  for (size_t c = 0; c < reader.count(); ++c) {
    reader.open(c);
    if (reader.dimension() != 1) ++other_cells;
    if (reader.dimension() != 1 || reader.hidden(c)) continue;
    const auto ids = reader.ids();
    order.clear();
    if (reader.type() == CellType::poly_line || reader.type() == CellType::line)
      for (uint32_t k = 0; k < ids.size(); ++k) order.push_back(k);
    else curve_order(reader.type(), ids.size(), order);
    for (size_t k = 0; k + 1 < order.size(); ++k)
      if (ids[order[k]] != ids[order[k + 1]]) s.ends.push_back({ids[order[k]], ids[order[k + 1]]}), s.cell.push_back(int64_t(c));
  }
  return s;
}

// Which segments come together at a point.
class Joints {
 public:
  Joints(const Segments& s, size_t points, const std::vector<const Field*>& fields) : s_(s), fields_(fields), start_(points + 1, 0) {
    for (const auto& e : s.ends) ++start_[size_t(e[0])], ++start_[size_t(e[1])];
    size_t sum = 0;
    for (size_t& n : start_) sum += std::exchange(n, sum);
    list_.resize(sum);
    std::vector<size_t> next = start_;
    for (size_t i = 0; i < s.ends.size(); ++i)
      for (int64_t p : s.ends[i]) list_[next[size_t(p)]++] = i;
  }
  /// The one segment that continues `segment` at its end `point`; -1 where the line ends.
  int64_t beyond(size_t segment, int64_t point) const {
    const size_t b = start_[size_t(point)];
    if (start_[size_t(point) + 1] - b != 2) return -1;
    const size_t other = list_[b] == segment ? list_[b + 1] : list_[b];
    if (other == segment) return -1;
    for (const Field* f : fields_)
      for (int c = 0; c < f->components(); ++c)
        if (f->array.get(size_t(s_.cell[segment]), c) != f->array.get(size_t(s_.cell[other]), c)) return -1;
    return int64_t(other);
  }

 private:
  const Segments& s_;
  const std::vector<const Field*>& fields_;
  std::vector<size_t> start_, list_;
};

struct Lines {
  std::vector<int64_t> ids, offsets{0}, cells;
  std::vector<uint8_t> closed;
};

Lines join(const Segments& s, const Joints& joints) {
  Lines out;
  std::vector<uint8_t> done(s.ends.size(), 0);
  for (size_t first = 0; first < s.ends.size(); ++first) {
    if (done[first]) continue;
    // Back to where the line begins, or once round.
    size_t segment = first;
    int64_t tail = s.ends[first][0];
    bool loop = false;
    for (int64_t n = joints.beyond(segment, tail); n >= 0; n = joints.beyond(segment, tail)) {
      segment = size_t(n);
      if (segment == first) {
        loop = true;
        break;
      }
      tail = s.ends[segment][0] == tail ? s.ends[segment][1] : s.ends[segment][0];
    }
    if (loop) tail = s.ends[first][0];
    out.ids.push_back(tail);
    int64_t at = tail;
    for (auto n = int64_t(segment); n >= 0 && !done[size_t(n)]; n = joints.beyond(size_t(n), at)) {
      done[size_t(n)] = 1;
      at = s.ends[size_t(n)][0] == at ? s.ends[size_t(n)][1] : s.ends[size_t(n)][0];
      out.ids.push_back(at);
    }
    out.offsets.push_back(int64_t(out.ids.size()));
    out.cells.push_back(s.cell[first]);
    out.closed.push_back(at == tail);
  }
  return out;
}

}  // namespace

DatasetPtr polylines(const DatasetPtr& in, const PolylinesParams& p, Context& ctx) {
  std::vector<const Field*> fields;
  for (const std::string& name : p.fields)
    fields.push_back(with_context("polylines", [&] { return &in->fields().require(name, Association::cell); }));
  if (p.fields.empty())
    for (const char* name : {"contour value", "edge type"})
      if (const Field* f = in->fields().find(name, Association::cell)) fields.push_back(f);
  size_t other_cells = 0;
  const Segments s = segments_of(in, other_cells);
  if (s.ends.empty() && other_cells > 0)
    fail_usage("the mesh has no lines", "polylines",
               "make lines first with isolines, contour of a flat mesh, feature_edges or slice of a surface");
  const Joints joints(s, in->point_count(), fields);
  Lines lines = join(s, joints);
  std::vector<int64_t> number(in->point_count(), -1), points;
  for (int64_t id : lines.ids) number[size_t(id)] = 0;
  for (size_t i = 0; i < number.size(); ++i)
    if (number[i] == 0) number[i] = int64_t(points.size()), points.push_back(int64_t(i));
  DatasetParts out;
  SurfaceMesh mesh;
  mesh.points = points_of(in->mesh(), points);
  std::vector<double> length_of(lines.closed.size(), 0);
  const std::vector<Vec3> at = surface::positions(mesh.points);
  for (int64_t& id : lines.ids) id = number[size_t(id)];
  for (size_t l = 0; l < length_of.size(); ++l)
    for (auto k = size_t(lines.offsets[l]); k + 1 < size_t(lines.offsets[l + 1]); ++k)
      length_of[l] += length(at[size_t(lines.ids[k + 1])] - at[size_t(lines.ids[k])]);
  mesh.lines = {surface::id_array(lines.ids), surface::id_array(lines.offsets), 0};
  out.mesh = std::move(mesh);
  carry_gathered(out.fields, in->fields(), Association::point, points, Association::point);
  size_t dropped = 0;
  for (const Field& f : in->fields()) dropped += f.association == Association::cell;
  for (const Field* f : fields) out.fields.add(f->with(gather(f->array, std::span<const int64_t>(lines.cells))));
  carry_whole(out.fields, in->fields());
  if (dropped > fields.size())
    ctx.info(fmt::format("polylines: {} cell fields that vary along a line were left out", dropped - fields.size()));
  if (other_cells > 0) ctx.info(fmt::format("polylines: {} cells that are not lines were left out", other_cells));
  out.fields.add({"closed", Association::cell, Array::from_vector(std::move(lines.closed)), "", Role::labels});
  out.fields.add({"length", Association::cell, Array::from_vector(std::move(length_of)), "", Role::none});
  out.notes = in->notes();
  out.time = in->time();
  return make_dataset(std::move(out));
}

std::vector<double> choose_line_values(const Dataset& s, const IsolinesParams& p, const Context& ctx) {
  // The range of what is contoured, as contour chooses it: ask it for its middle and look the field up by name.
  const Field* f = p.field.empty() ? s.fields().active(1) : s.fields().find(p.field.name, Association::point);
  int component = f && f->components() > 1 ? -1 : 0;
  if (p.component.size() == 1 && p.component[0] >= 'x' && p.component[0] <= 'z') component = p.component[0] - 'x';
  else if (p.component.size() == 1 && p.component[0] >= '0' && p.component[0] <= '9') component = p.component[0] - '0';
  if (!f || f->association != Association::point || component >= f->components()) return {};
  return even_values(range_over_all(s, *f, component, ctx), p.count);
}

DatasetPtr isolines(const DatasetPtr& in, const IsolinesParams& p, Context& ctx) {
  DatasetPtr s = in;
  bool flat = is_lattice(in->mesh());
  if (flat) {
    int axes = 0;
    for (size_t n : lattice_dims(in->mesh())) axes += n > 1;
    flat = axes < 3;
  }
  if (!flat) s = surface::polygon_surface(in, "isolines", ctx);
  ContourParams c{.field = p.field, .values = p.values, .normals = false, .component = p.component};
  if (c.values.empty()) c.values = choose_line_values(*s, p, ctx);
  DatasetParts lines = contour(s, c, ctx)->parts();
  const auto& mesh = std::get<SurfaceMesh>(lines.mesh);
  if (c.values.size() == 1) {  // in the place of a field of the input's that may be called so
    lines.fields.add(
        {"contour value", Association::cell, Array::from_vector(std::vector<double>(mesh.cell_count(), c.values[0])), "", Role::none});
  }
  // A line crosses many cells: their fields are not expected on it, so polylines need not report them as dropped.
  FieldSet kept;
  for (const Field& f : lines.fields)
    if (f.association != Association::cell || f.name == "contour value") kept.add(f);
  lines.fields = std::move(kept);
  return polylines(make_dataset(std::move(lines)), {.fields = {"contour value"}}, ctx);
}

}  // namespace sg
