// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/trails.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "data/field_ops.h"

namespace sg {

namespace {

const Field& times_of(const Dataset& d, const TrailsParams& p) {
  const Field* f = p.field.empty() ? nullptr : &d.fields().require(p.field.name, Association::point);
  for (const char* name : {"time", "integration time", "IntegrationTime"})
    if (!f) f = d.fields().find(name, Association::point);
  if (!f) fail_usage("there is no point field of times", "trails", "pathlines have 'time'; name another with field=");
  if (f->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f->name, f->components()), "trails", "a time is one number");
  return *f;
}

struct Cut {
  std::vector<EdgePoint> points;
  std::vector<float> age;
  std::vector<int64_t> heads, head_cells, lines, offsets{0}, line_cells;

  int64_t add(EdgePoint p, double t, double time, double length) {
    points.push_back(p);
    age.push_back(float(std::clamp((time - t) / length, 0.0, 1.0)));
    return int64_t(points.size()) - 1;
  }
  void end_line(int64_t cell) {
    if (int64_t(lines.size()) - offsets.back() >= 2) offsets.push_back(int64_t(lines.size())), line_cells.push_back(cell);
    else lines.resize(size_t(offsets.back()));
  }
};

}  // namespace

DatasetPtr trails(const DatasetPtr& data, const TrailsParams& p, Context&) {
  const auto* mesh = data->as<SurfaceMesh>();
  if (!mesh || mesh->lines.size() == 0)
    fail_usage(fmt::format("the mesh ({}) has no lines", data->kind()), "trails", "pathlines and streamlines have lines");
  if (p.color.size() != 3) fail_usage(fmt::format("{} numbers are no colour", p.color.size()), "trails: color", "give red,green,blue");
  const Field& field = times_of(*data, p);
  const Range all = data->range(field, 0);
  const double time = p.time.value_or(all.empty() ? 0 : all.hi);
  const double length = p.length > 0 ? p.length : all.empty() || !(all.hi > all.lo) ? 1 : 0.1 * (all.hi - all.lo);
  const double from = time - length;
  const CellsView lines = cells_view(mesh->lines);
  const Array times = field.array.converted(ElementType::f64).made_packed();
  const View<double> t = times.view<double>();
  Cut out;
  for (size_t c = 0; c < lines.count; ++c) {
    const auto cell = int64_t(mesh->vertices.size() + c);
    bool open = false;
    for (size_t k = 0; k < lines.size(c); ++k) {
      const auto b = uint32_t(lines.point(c, k));
      const double tb = t[b];
      const bool inside = tb >= from && tb <= time;
      auto add = [&](EdgePoint q, double at) {
        const int64_t id = out.add(q, at, time, length);
        out.lines.push_back(id);
        if (at == time) out.heads.push_back(id), out.head_cells.push_back(cell);
      };
      if (k > 0) {
        const auto a = uint32_t(lines.point(c, k - 1));
        const double ta = t[a];
        // Places of this segment where the interval begins and ends.
        double cut[2];
        int cuts = 0;
        for (const double edge : ta < tb ? std::array{from, time} : std::array{time, from})
          if ((ta < edge && edge < tb) || (tb < edge && edge < ta)) cut[cuts++] = edge;
        for (int i = 0; i < cuts; ++i) {
          add({a, b, float((cut[i] - ta) / (tb - ta))}, cut[i]);
          if (open) out.end_line(cell);
          open = !open;
        }
      }
      if (inside) add({b, b, 0}, tb), open = true;
      else if (open) out.end_line(cell), open = false;
    }
    if (open) out.end_line(cell);
  }
  FieldSet fields;
  carry_interpolated(fields, data->fields(), out.points);
  if (!p.heads) out.heads.clear(), out.head_cells.clear();
  // Points of stretches that were too short stay without a line; heads among them are still where particles are.
  std::vector<int64_t> cells = out.head_cells;
  cells.insert(cells.end(), out.line_cells.begin(), out.line_cells.end());
  carry_gathered(fields, data->fields(), Association::cell, std::span<const int64_t>(cells), Association::cell);
  carry_whole(fields, data->fields());
  std::vector<uint8_t> rgba;
  for (const float age : out.age) {
    for (const double c : p.color) rgba.push_back(uint8_t(std::clamp(c, 0.0, 1.0) * 255 + 0.5));
    rgba.push_back(uint8_t((1 - age) * 255 + 0.5f));
  }
  std::vector<Field> renamed;  // pictures colour by what fades unless they are told
  for (const Field& f : fields)
    if (f.role == Role::scalars || f.role == Role::colors) renamed.push_back(f), renamed.back().role = Role::none;
  for (Field& f : renamed) fields.add(std::move(f));
  fields.add({"age", Association::point, Array::from_vector(std::move(out.age)), "", Role::none});
  fields.add({"trail", Association::point, Array::from_vector(std::move(rgba), 4), "", Role::colors});
  SurfaceMesh made;
  made.points = {interpolate(mesh->points.xyz, out.points), mesh->points.origin};
  if (!out.heads.empty()) made.vertices.fixed = 1, made.vertices.connectivity = Array::from_vector(std::move(out.heads));
  made.lines = {Array::from_vector(std::move(out.lines)), Array::from_vector(std::move(out.offsets)), 0};
  return make_dataset(Mesh(std::move(made)), std::move(fields));
}

}  // namespace sg
