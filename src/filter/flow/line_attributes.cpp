// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/line_attributes.h"

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/flow/line_mesh.h"
#include "filter/flow/streamlines.h"
#include "filter/mesh/surface_builder.h"

namespace sg {

namespace {

constexpr size_t lines_grain = 8;
constexpr size_t block = 128;

// Some points in a row that lie in one part: their cells, ids and weights.
struct Places {
  size_t first = 0, part = 0;
  std::vector<int64_t> cells;  // -1: none
  std::vector<uint32_t> begin{0};
  std::vector<int64_t> ids;
  std::vector<double> weights;
  void clear() { cells.clear(), begin.assign(1, 0), ids.clear(), weights.clear(); }
};

struct Target {
  Field field;               // without its array
  std::vector<Array> from;   // by part
  std::byte* out = nullptr;  // f32 or f64
  Array to;
  bool wide = false;
};

template <class T, class Out>
void write(const View<T>& v, bool cells, const Places& p, Out* out) {
  const int n = v.components;
  for (size_t i = 0; i < p.cells.size(); ++i)
    for (int c = 0; c < n; ++c) {
      double sum = NAN;
      if (p.cells[i] >= 0) {
        if (cells) {
          sum = double(v(size_t(p.cells[i]), c));
        } else {
          sum = 0;
          for (uint32_t k = p.begin[i]; k < p.begin[i + 1]; ++k) sum += p.weights[k] * double(v(size_t(p.ids[k]), c));
        }
      }
      out[(p.first + i) * size_t(n) + size_t(c)] = Out(sum);
    }
}

void write(const Target& t, const Places& p) {
  dispatch(t.from[p.part], [&](const auto& v) {
    const bool cells = t.field.association == Association::cell;
    if (t.wide) write(v, cells, p, reinterpret_cast<double*>(t.out));
    else write(v, cells, p, reinterpret_cast<float*>(t.out));
  });
}

std::vector<Target> targets_of(const FlowParts& parts, size_t count, const std::string& without) {
  std::vector<Target> out;
  const FieldSet& first = parts.fields().front().dataset()->fields();
  for (const Field& f : first) {
    if (f.association == Association::whole || f.name == without) continue;
    Target t{f.with({}), {}, nullptr, {}, false};
    for (const FlowField& part : parts.fields()) {
      const Field* g = part.dataset()->fields().find(f.name, f.association);
      if (!g || g->components() != f.components()) break;
      t.from.push_back(g->array);
      t.wide = t.wide || element_size(g->array.type()) == 8;
    }
    if (t.from.size() != parts.count()) continue;
    t.to = Array::make_raw(t.wide ? ElementType::f64 : ElementType::f32, count, f.components(), &t.out);
    out.push_back(std::move(t));
  }
  return out;
}

// The points of lines, as the mesh has them.
struct LinePoints {
  CellsView lines;
  PointReader at;
  explicit LinePoints(const Dataset& d) : lines(cells_view(d.as<SurfaceMesh>()->lines)), at(d.as<SurfaceMesh>()->points) {}

  // Asks the flow at point i. Rounding may have put the end of a line outside: then a little towards its neighbour.
  template <class Ask>
  bool ask(size_t i, size_t first, size_t end, Ask&& f) const {
    const Vec3 x = at[i];
    if (f(x)) return true;
    if (end - first < 2) return false;
    const Vec3 to = at[i > first ? i - 1 : i + 1];
    for (const double part : {1e-5, 1e-3, 2e-2})
      if (f(lerp(x, to, part))) return true;
    return false;
  }
};

}  // namespace

FieldSet fields_along(const FlowParts& parts, const Dataset& mesh, const std::string& without, Context& context) {
  std::vector<Target> targets = targets_of(parts, mesh.point_count(), without);
  FieldSet out;
  if (targets.empty()) return out;
  const LinePoints points(mesh);
  parallel_for(
      points.lines.count, lines_grain,
      [&](size_t begin, size_t end) {
        PartsCursor cursor(parts);
        Places places;
        places.first = points.lines.begin(begin);
        const auto flush = [&] {
          for (const Target& t : targets) write(t, places);
          places.first += places.cells.size();
          places.clear();
        };
        const auto add = [&](bool found) {
          if (places.cells.size() == block || (!places.cells.empty() && cursor.part() != places.part)) flush();
          places.part = cursor.part();
          places.cells.push_back(found ? cursor.cursor().cell() : -1);
          if (found) {
            const auto ids = cursor.cursor().ids();
            const auto weights = cursor.cursor().weights();
            places.ids.insert(places.ids.end(), ids.begin(), ids.end());
            places.weights.insert(places.weights.end(), weights.begin(), weights.end());
          }
          places.begin.push_back(uint32_t(places.ids.size()));
        };
        for (size_t l = begin; l < end; ++l) {
          const size_t first = points.lines.begin(l), last = points.lines.end(l);
          for (size_t i = first; i < last; ++i) {
            Vec3 v;
            add(points.ask(i, first, last, [&](Vec3 x) { return cursor(x, v); }));
          }
        }
        if (!places.cells.empty()) flush();
      },
      &context);
  for (Target& t : targets) {
    if (t.field.association == Association::cell) {
      if (parts.fields().front().dataset()->fields().find(t.field.name, Association::point)) t.field.name += "_cell";
      t.field.association = Association::point;
    }
    t.field.array = std::move(t.to);
    if (t.field.role == Role::labels || t.field.role == Role::global_ids) t.field.role = Role::none;
    out.add(std::move(t.field));
  }
  return out;
}

FieldSet fields_along(const FlowParts& parts, const TracedLines& lines, const std::string& without, Context& context) {
  return fields_along(parts, *lines_dataset(lines, parts.name(), ""), without, context);
}

FieldSet rotation_along(const FlowParts& parts, const Dataset& mesh, const std::string& velocity, bool vorticity, bool rotation,
                        Context& context) {
  const LinePoints points(mesh);
  const size_t n = mesh.point_count();
  const View<float> time = mesh.fields().require(own_value("time", velocity), Association::point).array.view<float>();
  const View<float> u = mesh.fields().require(velocity, Association::point).array.view<float>();
  float *w = nullptr, *turn = nullptr, *sum = nullptr;
  FieldSet out;
  if (vorticity) out.add({"vorticity", Association::point, Array::make<float>(n, 3, &w), "", Role::none, known_look("vorticity")});
  if (rotation) {
    out.add({"angular velocity", Association::point, Array::make<float>(n, 1, &turn), "", Role::none});
    out.add({"rotation", Association::point, Array::make<float>(n, 1, &sum), "rad", Role::none});
  }
  parallel_for(
      points.lines.count, lines_grain,
      [&](size_t begin, size_t end) {
        PartsCursor cursor(parts);
        std::vector<double> rate;
        for (size_t l = begin; l < end; ++l) {
          const size_t first = points.lines.begin(l), last = points.lines.end(l);
          rate.assign(last - first, 0);
          size_t seed = first;
          for (size_t i = first; i < last; ++i) {
            Vec3 v, curl(NAN, NAN, NAN);
            Mat3 j;
            if (points.ask(i, first, last, [&](Vec3 x) { return cursor.gradient(x, v, j); }))
              curl = {j.m[2][1] - j.m[1][2], j.m[0][2] - j.m[2][0], j.m[1][0] - j.m[0][1]};
            if (w)
              for (int a = 0; a < 3; ++a) w[3 * i + size_t(a)] = float(curl[a]);
            rate[i - first] = dot(curl, normalize(Vec3(double(u(i, 0)), double(u(i, 1)), double(u(i, 2))))) / 2;
            if (turn) turn[i] = float(rate[i - first]);
            if (std::abs(time[i]) < std::abs(time[seed])) seed = i;
          }
          if (!sum) continue;
          // From the seed both ways, by trapezoids; a place without a gradient turns by nothing.
          const auto step = [&](size_t a, size_t b) {
            const double mean = (rate[a - first] + rate[b - first]) / 2;
            return std::isfinite(mean) ? mean * (double(time[b]) - double(time[a])) : 0.0;
          };
          double total = 0;
          sum[seed] = 0;
          for (size_t i = seed + 1; i < last; ++i) sum[i] = float(total += step(i - 1, i));
          total = 0;
          for (size_t i = seed; i-- > first;) sum[i] = float(total -= step(i, i + 1));
        }
      },
      &context);
  return out;
}

}  // namespace sg
