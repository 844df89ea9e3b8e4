// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/trails.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "data/field_ops.h"

namespace sg {

namespace {

const Field& times_of(const Dataset& d, const TrailsParams& p) {
  const Field* f = p.field.empty() ? nullptr : &d.fields().require(p.field.name, Association::point);
  for (const char* name : {"time", "integration time", "IntegrationTime"})
    if (!f) f = d.fields().find(name, Association::point);
  if (!f) fail_usage("there is no point field of times", "trails", "pathlines have 'time'; name another field with field=");
  if (f->components() != 1)
    fail_usage(fmt::format("field '{}' has {} components", f->name, f->components()), "trails", "times must be single numbers");
  return *f;
}

struct Span {
  double first, last;
};

// From when to when each line runs.
std::vector<Span> spans_of(const CellsView& lines, const View<double>& t) {
  std::vector<Span> spans;
  for (size_t c = 0; c < lines.count; ++c) {
    Range r;
    for (size_t k = 0; k < lines.size(c); ++k)
      if (const double x = t[size_t(lines.point(c, k))]; std::isfinite(x)) r.add({x, x});
    if (!r.empty()) spans.push_back({r.lo, r.hi});
  }
  return spans;
}

// The latest time at which half as many lines run as at the busiest: lines of a steady flow end at all times.
double latest_busy_time(const std::vector<Span>& spans) {
  std::vector<std::pair<double, int>> events;  // a line that ends at a time still runs at it
  for (const Span& s : spans) events.emplace_back(s.first, -1), events.emplace_back(s.last, 1);
  std::sort(events.begin(), events.end());
  int most = 0, running = 0;
  for (const auto& e : events) most = std::max(most, running -= e.second);
  double latest = 0;
  running = 0;
  for (const auto& e : events) {
    if (e.second > 0 && 2 * running >= most) latest = e.first;
    running -= e.second;
  }
  return latest;
}

double usual_length(const std::vector<Span>& spans) {
  std::vector<double> v;
  for (const Span& s : spans) v.push_back(s.last - s.first);
  if (v.empty()) return 0;
  std::nth_element(v.begin(), v.begin() + ptrdiff_t(v.size() / 2), v.end());
  return v[v.size() / 2];
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

// The parts of the lines from `length` before `time` on to it.
Cut cut_lines(const SurfaceMesh& mesh, const View<double>& t, double time, double length) {
  const double from = time - length;
  const CellsView lines = cells_view(mesh.lines);
  Cut out;
  for (size_t c = 0; c < lines.count; ++c) {
    const auto cell = int64_t(mesh.vertices.size() + c);
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
  return out;
}

// The colour, fading with age.
Array faded(const std::vector<double>& color, const std::vector<float>& ages) {
  std::vector<uint8_t> rgba;
  for (const float age : ages) {
    for (const double c : color) rgba.push_back(uint8_t(std::clamp(c, 0.0, 1.0) * 255 + 0.5));
    rgba.push_back(uint8_t((1 - age) * 255 + 0.5f));
  }
  return Array::from_vector(std::move(rgba), 4);
}

}  // namespace

DatasetPtr trails(const DatasetPtr& data, const TrailsParams& p, Context& context) {
  const auto* mesh = data->as<SurfaceMesh>();
  if (!mesh || mesh->lines.size() == 0)
    fail_usage(fmt::format("the mesh ({}) has no lines", data->kind()), "trails", "use pathlines or streamlines to make lines");
  if (p.color.size() != 3)
    fail_usage(fmt::format("{} numbers do not make a colour", p.color.size()), "trails: color", "give red,green,blue");
  const Field& field = times_of(*data, p);
  const Array times = field.array.converted(ElementType::f64).made_packed();
  const std::vector<Span> spans = spans_of(cells_view(mesh->lines), times.view<double>());
  const double time = p.time ? *p.time : latest_busy_time(spans), usual = usual_length(spans);
  const double length = p.length > 0 ? p.length : usual > 0 ? 0.1 * usual : 1;
  if (!p.time) context.info(fmt::format("trails: time={:.5g}", time));
  Cut out = cut_lines(*mesh, times.view<double>(), time, length);
  FieldSet fields;
  carry_interpolated(fields, data->fields(), out.points);
  if (!p.heads) out.heads.clear(), out.head_cells.clear();
  // Points of stretches that were too short stay without a line; heads among them are still where particles are.
  std::vector<int64_t> cells = out.head_cells;
  cells.insert(cells.end(), out.line_cells.begin(), out.line_cells.end());
  carry_gathered(fields, data->fields(), Association::cell, std::span<const int64_t>(cells), Association::cell);
  carry_whole(fields, data->fields());
  const Array rgba = faded(p.color, out.age);
  std::vector<Field> renamed;  // pictures are coloured by the fading unless specified
  for (const Field& f : fields)
    if (f.role == Role::scalars || f.role == Role::colors) renamed.push_back(f), renamed.back().role = Role::none;
  for (Field& f : renamed) fields.add(std::move(f));
  fields.add({"age", Association::point, Array::from_vector(std::move(out.age)), "", Role::none});
  fields.add({"trail", Association::point, rgba, "", Role::colors});
  SurfaceMesh made;
  made.points = {interpolate(mesh->points.xyz, out.points), mesh->points.origin};
  if (!out.heads.empty()) made.vertices.fixed = 1, made.vertices.connectivity = Array::from_vector(std::move(out.heads));
  made.lines = {Array::from_vector(std::move(out.lines)), Array::from_vector(std::move(out.offsets)), 0};
  return make_dataset(Mesh(std::move(made)), std::move(fields));
}

}  // namespace sg
