// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/lines/even_streamlines.h"

#include <fmt/core.h>

#include <deque>
#include <unordered_map>

#include "filter/flow/cursors/surface_normal.h"
#include "filter/flow/line_attributes.h"
#include "filter/flow/line_mesh.h"
#include "filter/flow/trace_line.h"

namespace sg {

void describe(Schema& s, EvenStreamlinesParams& p) {
  s("field", p.field, "Velocity: point or cell field of 2 or 3 components; default: the active vectors.").takes(fields::vectors);
  s("spacing", p.spacing, "Distance between lines; default: a 50th of the mesh's diagonal (in 3D a 20th).").unit("length").positive();
  s("test", p.test, "How close a line may come to others before it ends, in spacings.").range(0.05, 1);
  s("min_length", p.min_length, "Minimum length of a line, in spacings.").at_least(0);
  s("min_speed", p.min_speed, "The flow counts as still where its speed is below this fraction of the largest.").range(0, 1);
  describe(s, p.integration);
  s("max_lines", p.max_lines, "Maximum number of lines.").range(1, 1e7);
}

namespace {

// Points of the lines, found by cubes as large as the largest distance queried.
class Places {
 public:
  explicit Places(double edge) : edge_(edge) {}
  void add(Vec3 x) { cubes_[key(x, 0, 0, 0)].push_back(x); }
  /// Whether any point is nearer than `distance` <= edge.
  bool near(Vec3 x, double distance) const {
    for (int k = -1; k <= 1; ++k)
      for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
          const auto cube = cubes_.find(key(x, i, j, k));
          if (cube == cubes_.end()) continue;
          for (const Vec3 p : cube->second)
            if (dot(p - x, p - x) < distance * distance) return true;
        }
    return false;
  }

 private:
  struct Cube {
    int64_t i, j, k;
    friend bool operator==(const Cube&, const Cube&) = default;
  };
  struct Hash {
    size_t operator()(const Cube& c) const { return size_t(c.i) * 73856093 ^ size_t(c.j) * 19349663 ^ size_t(c.k) * 83492791; }
  };
  Cube key(Vec3 x, int i, int j, int k) const {
    return {int64_t(std::floor(x.x / edge_)) + i, int64_t(std::floor(x.y / edge_)) + j, int64_t(std::floor(x.z / edge_)) + k};
  }
  double edge_;
  std::unordered_map<Cube, std::vector<Vec3>, Hash> cubes_;
};

class Filler {
 public:
  Filler(const FlowParts& parts, const EvenStreamlinesParams& p, double spacing, const TraceOptions& options)
      : p_(p),
        spacing_(spacing),
        test_(spacing * p.test),
        options_(options),
        flow_(parts),
        dimension_(parts.dimension()),
        places_(spacing),
        maps_(parts.count()) {}

  TracedLines lines;

  /// A line through the place, unless that is too near to others (nearer than the spacing, less rounding) or the line too short.
  bool try_line(Vec3 seed) {
    if (full()) return false;
    const Vec3 x = flow_.snap(seed);
    Vec3 v;
    if (!flow_(x, v) || length(v) <= options_.min_speed || places_.near(x, spacing_ * 0.999)) return false;
    TracedLines halves[2];
    double arc = 0;
    for (const int side : {0, 1}) {
      TracedLines& h = halves[side];
      h.points = {x}, h.velocity = {v}, h.time = {0}, h.arc = {0}, h.stop = {StopReason::steps};
      if (side == 1 && halves[0].stop[0] == StopReason::closed) break;
      follow(h, side == 0 ? -1 : 1);
      arc += h.arc.back();
    }
    if (arc < p_.min_length * spacing_) return false;
    keep(halves);
    return true;
  }

  /// Seeds on both sides of the line, at every spacing along it.
  void seeds_beside(size_t line, std::deque<Vec3>& queue) {
    double next = -HUGE_VAL;
    for (size_t i = lines.begin[line]; i < lines.begin[line + 1]; ++i) {
      if (lines.arc[i] < next) continue;
      next = lines.arc[i] + spacing_;
      const Vec3 t = normalize(lines.velocity[i]), x = lines.points[i];
      Vec3 a = dimension_ == 2 ? cross(normal_at(x), t) : cross(t, std::abs(t.z) < 0.9 ? Vec3(0, 0, 1) : Vec3(1, 0, 0));
      a = normalize(a);
      const Vec3 b = cross(t, a);
      const int ways = dimension_ == 2 ? 2 : 6;
      for (int k = 0; k < ways; ++k) {
        const double angle = 2 * 3.14159265358979323846 * k / ways;
        queue.push_back(x + (a * std::cos(angle) + b * std::sin(angle)) * spacing_);
      }
    }
  }
  bool full() const { return int64_t(lines.lines()) >= p_.max_lines; }

 private:
  Vec3 normal_at(Vec3 x) {
    Vec3 v;
    flow_(x, v);
    auto& map = maps_[flow_.part()];
    if (!map) map.emplace(flow_.cursor().field().dataset());
    map->open(size_t(std::max<int64_t>(0, flow_.cursor().cell())));
    CellPlace place;
    map->locate(x, place, 1e-3);
    return surface_normal(*map, place.rst);
  }

  // Goes on in stretches until the line ends or comes too near to another one, or to itself further along.
  void follow(TracedLines& h, double sign) {
    Places own(spacing_);
    size_t trailing = 0;  // places of its own are added once they are far behind
    while (h.stop[0] == StopReason::steps) {
      TracedLines more;
      more.points = {h.points.back()}, more.velocity = {h.velocity.back()}, more.time = {0}, more.arc = {0};
      Vec3 v;
      if (!flow_(more.points[0], v)) return;
      const StopReason stop = trace_line(flow_, 0, sign, options_, more);
      const double t = h.time.back(), arc = h.arc.back();
      for (size_t i = 1; i < more.points.size(); ++i) {
        const Vec3 x = more.points[i];
        while (trailing < h.points.size() && arc + more.arc[i] - h.arc[trailing] > 2 * test_) own.add(h.points[trailing]), ++trailing;
        if (places_.near(x, test_) || (stop != StopReason::closed && own.near(x, 0.5 * test_))) {
          h.stop[0] = StopReason::length;
          return;
        }
        h.points.push_back(x), h.velocity.push_back(more.velocity[i]), h.time.push_back(t + more.time[i]),
            h.arc.push_back(arc + more.arc[i]);
      }
      h.stop[0] = stop;
      if (stop == StopReason::steps && more.arc.back() < test_) h.stop[0] = StopReason::speed;  // stuck
    }
  }

  void keep(TracedLines h[2]) {
    const auto line = uint32_t(lines.lines());
    const auto push = [&](const TracedLines& from, size_t i, double sign) {
      lines.points.push_back(from.points[i]), lines.velocity.push_back(from.velocity[i]);
      lines.time.push_back(from.time[i]), lines.arc.push_back(sign * from.arc[i]);
      places_.add(from.points[i]);
    };
    for (size_t i = h[0].points.size(); i-- > 1;) push(h[0], i, -1);
    for (size_t i = 0; i < h[1].points.size(); ++i) push(h[1], i, 1);
    lines.begin.push_back(lines.points.size());
    lines.seed.push_back(int64_t(line)), lines.stop.push_back(h[1].stop[0]);
  }

  const EvenStreamlinesParams& p_;
  double spacing_, test_;
  TraceOptions options_;
  PartsCursor flow_;
  int dimension_;
  Places places_;
  std::vector<std::optional<CellMap>> maps_;
};

}  // namespace

Data even_streamlines(const Data& in, const EvenStreamlinesParams& p, Context& context) {
  const FlowParts parts(in, p.field.name, "even_streamlines", context);
  const Box3 box = parts.bounds();
  if (!(box.diagonal() > 0) || !std::isfinite(box.diagonal())) fail_usage("the mesh has no finite extent", "even_streamlines");
  const double spacing = p.spacing.value_or(box.diagonal() / (parts.dimension() == 2 ? 50 : 20));
  const double expected = parts.dimension() == 2 ? std::pow(box.diagonal() / spacing, 1.0) : std::pow(box.diagonal() / spacing, 2.0);
  if (!(expected <= 10 * double(p.max_lines)))
    fail_usage(fmt::format("a spacing of {:.4g} would need far more than {} lines", spacing, p.max_lines), "even_streamlines",
               fmt::format("the mesh's diagonal is {:.6g}", box.diagonal()));
  StopParams stop;
  stop.min_speed = p.min_speed;
  stop.max_steps = 64;  // a stretch
  TraceOptions options = trace_options(p.integration, stop, parts.largest_speed());
  // Lines are compared by their points, which must lie closer than the distance of the test.
  if (options.unit != StepUnit::length || options.max_step > spacing * p.test / 2) {
    options.unit = StepUnit::length;
    options.max_step = options.step = spacing * p.test / 2, options.min_step = options.max_step / 100;
  }
  Filler filler(parts, p, spacing, options);
  std::deque<Vec3> queue;
  size_t spread = 0;
  const auto spread_out = [&] {
    while (!filler.full()) {
      while (!queue.empty()) {
        filler.try_line(queue.front());
        queue.pop_front();
      }
      if (spread == filler.lines.lines()) return;
      filler.seeds_beside(spread++, queue);
      context.check();
    }
  };
  // The first line through the middle; then a grid of places for what is left.
  filler.try_line(box.center());
  spread_out();
  const Vec3 size = box.size();
  size_t n[3];
  for (int a = 0; a < 3; ++a) n[a] = std::min<size_t>(400, size_t(size[a] / spacing) + 1);
  for (size_t k = 0; k < n[2] && !filler.full(); ++k)
    for (size_t j = 0; j < n[1] && !filler.full(); ++j)
      for (size_t i = 0; i < n[0] && !filler.full(); ++i) {
        const Vec3 f((double(i) + 0.5) / double(n[0]), (double(j) + 0.5) / double(n[1]), (double(k) + 0.5) / double(n[2]));
        if (filler.try_line(box.lo + f * size)) spread_out();
      }
  if (filler.lines.lines() == 0)
    fail_usage("no line of this flow is long enough", "even_streamlines", "use a smaller spacing, or min_length=0");
  const DatasetPtr plain = lines_dataset(filler.lines, parts.name(), parts.fields().front().field().unit);
  DatasetParts out = plain->parts();
  out.time = parts.fields().front().dataset()->time();
  for (const Field& f : fields_along(parts, filler.lines, parts.name(), context))
    if (!out.fields.find(f.name, f.association)) out.fields.add(f);
  return make_dataset(std::move(out));
}

}  // namespace sg
