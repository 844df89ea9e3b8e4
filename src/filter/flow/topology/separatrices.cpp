// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/separatrices.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/fields/known_looks.h"
#include "filter/flow/packets/packet_lines.h"
#include "filter/flow/topology/zeros/surface_zeros.h"

namespace sg {

namespace {

constexpr double near_limit = 0.1,
                 near_saddle = 0.05;  // distance from a critical point, in diagonals of its cell, within which a line has reached it

double distance_to_segment(Vec3 x, Vec3 a, Vec3 b) {
  const Vec3 d = b - a;
  const double l2 = dot(d, d), t = l2 > 0 ? std::clamp(dot(x - a, d) / l2, 0.0, 1.0) : 0;
  return length(x - a - t * d);
}

// Critical points in order of x, so that those near a line are few.
class Limits {
 public:
  explicit Limits(const CriticalPoints& critical) : points_(critical.points) {
    for (size_t i = 0; i < points_.size(); ++i) {
      order_.push_back(i);
      reach_ = std::max(reach_, near_limit * points_[i].size + 2 * points_[i].moved);
    }
    std::sort(order_.begin(), order_.end(),
              [&](size_t a, size_t b) { return std::pair(points_[a].at.x, a) < std::pair(points_[b].at.x, b); });
  }
  /// The critical point to which a line that moves from a to b has come, -1 for none. `from` does not count while `left` is false.
  int64_t reached(Vec3 a, Vec3 b, double sign, int64_t from, bool left) const {
    const double lo = std::min(a.x, b.x) - reach_, hi = std::max(a.x, b.x) + reach_;
    auto i = std::lower_bound(order_.begin(), order_.end(), lo, [&](size_t p, double x) { return points_[p].at.x < x; });
    int64_t best = -1;
    double nearest = HUGE_VAL;
    for (; i != order_.end() && points_[*i].at.x <= hi; ++i) {
      const CriticalPoint& c = points_[*i];
      if (int64_t(*i) == from && !left) continue;
      const bool ends = sign > 0 ? is_attracting(c.flow.type) : is_repelling(c.flow.type);
      const double within = ends ? near_limit : is_saddle(c.flow.type) ? near_saddle : 0;
      const double d = distance_to_segment(c.at, a, b);
      // Where the interpolant's zero is outside its triangle, lines reach an edge nearby.
      if (d < within * c.size + (within > 0 ? 2 * c.moved : 0) && d < nearest) nearest = d, best = int64_t(*i);
    }
    return best;
  }

 private:
  const std::vector<CriticalPoint>& points_;
  std::vector<size_t> order_;
  double reach_ = 0;
};

/// So many slow points on end of a line are noise; a step is about a cell.
constexpr size_t most_slow = 20;

// Appends a traced line, `at(i, x, v)` its n points from the seed on, to its separatrix, up to a critical point that it reaches.
template <class At>
void follow(size_t n, At&& at, StopReason stop, const CriticalPoints& critical, const Limits& limits, double sign, Separatrix& s) {
  const int64_t from = s.origin == Separatrix::Origin::saddle ? s.from : -1;
  Vec3 x, v;
  if (n == 0) return;
  at(0, x, v);
  const Vec3 start = s.points.empty() ? x : s.points[0];
  bool left = from < 0;
  size_t slow = 0;
  s.stop = stop;
  for (size_t i = 0; i < n; ++i) {
    at(i, x, v);
    left = left || length(x - start) > critical.points[size_t(from)].size;
    if (!s.points.empty()) {
      const int64_t to = limits.reached(s.points.back(), x, sign, from, left);
      if (to >= 0) {
        s.points.push_back(critical.points[size_t(to)].at), s.speed.push_back(0);
        s.to = to, s.stop = StopReason::speed;
        return;
      }
    }
    s.points.push_back(x), s.speed.push_back(length(v));
    slow = length(v) < critical.slow ? slow + 1 : 0;
    if (slow <= most_slow) continue;
    s.points.resize(s.points.size() - slow), s.speed.resize(s.points.size());
    s.stop = StopReason::speed;
    return;
  }
}

// By packets, where the mesh and the numbers are theirs.
bool follow_packets(const FlowField& flow, const CriticalPoints& critical, const Limits& limits, std::span<const Vec3> at,
                    std::span<const size_t> number, double sign, std::vector<LimitSeed>& seeds, const TraceOptions& options,
                    Context& context) {
  const auto lines = packets::trace(flow, at, sign > 0 ? TraceDirection::forward : TraceDirection::backward, options, context);
  if (!lines) return false;
  const auto& pieces = sign > 0 ? lines->forward : lines->backward;
  parallel_for(
      pieces.size(), 64,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          const packets::Piece& piece = pieces[k];
          follow(
              piece.count,
              [&](size_t i, Vec3& x, Vec3& v) {
                const packets::Record& r = piece.first[i];
                x = lines->origin + Vec3(r.x[0], r.x[1], r.x[2]), v = Vec3(r.v[0], r.v[1], r.v[2]);
              },
              piece.stop, critical, limits, sign, seeds[number[k]].line);
        }
      },
      &context);
  return true;
}

}  // namespace

void trace_to_limits(const FlowParts& flow, const CriticalPoints& critical, std::vector<LimitSeed>& seeds, const TraceOptions& options,
                     Context& context) {
  const Limits limits(critical);
  for (const double sign : {1.0, -1.0}) {
    std::vector<Vec3> at;
    std::vector<size_t> number;
    for (size_t i = 0; i < seeds.size(); ++i)
      if (seeds[i].sign == sign) at.push_back(seeds[i].at), number.push_back(i);
    if (at.empty()) continue;
    if (flow.count() == 1 && follow_packets(flow.fields()[0], critical, limits, at, number, sign, seeds, options, context)) continue;
    const TracedLines traced = trace_lines(flow, at, sign > 0 ? TraceDirection::forward : TraceDirection::backward, options, context);
    parallel_for(
        traced.lines(), 64,
        [&](size_t begin, size_t end) {
          for (size_t k = begin; k < end; ++k) {
            // Backward lines have their seed last.
            const size_t first = traced.begin[k], last = traced.begin[k + 1] - 1;
            const auto place = [&](size_t i, Vec3& x, Vec3& v) {
              const size_t p = sign > 0 ? first + i : last - i;
              x = traced.points[p], v = traced.velocity[p];
            };
            follow(last + 1 - first, place, traced.stop[k], critical, limits, sign, seeds[number[size_t(traced.seed[k])]].line);
          }
        },
        &context);
  }
  std::erase_if(seeds, [](const LimitSeed& s) { return s.line.points.size() < 2; });
}

std::vector<Separatrix> find_separatrices(const FlowParts& flow, const CriticalPoints& critical, const std::vector<SwitchPoint>& border,
                                          const SeparatrixOptions& options, Context& context) {
  // On curved surfaces the velocity jumps at edges by what their bend leaves: no need to follow that in small steps.
  const bool curved = critical.dimension == 2 && !critical.plane;
  TraceOptions trace = options.trace;
  if (curved) trace.tolerance = std::max(trace.tolerance, 1e-3);
  const double offset = options.offset;
  std::vector<LimitSeed> seeds;
  auto seed = [&](Vec3 from_at, Vec3 at, double sign, Separatrix::Origin origin, size_t from) {
    LimitSeed s{at, sign, {}};
    s.line.origin = origin, s.line.from = int64_t(from), s.line.unstable = sign > 0;
    s.line.points = {from_at}, s.line.speed = {0};
    seeds.push_back(std::move(s));
  };
  for (size_t i = 0; i < critical.points.size(); ++i) {
    const CriticalPoint& c = critical.points[i];
    if (!is_saddle(c.flow.type)) continue;
    int in = 0;
    for (size_t k = 0; k < size_t(c.flow.count); ++k) in += c.flow.re[k] < 0;
    for (size_t k = 0; k < size_t(c.flow.count); ++k) {
      const double sign = c.flow.re[k] > 0 ? 1 : -1;
      if (c.flow.count == 3 && (sign > 0 ? 3 - in : in) != 1) continue;  // one of two: they span a surface
      for (const double side : {1.0, -1.0})
        seed(c.at, c.at + side * (offset * c.size + 2 * c.moved) * c.flow.vector[k], sign, Separatrix::Origin::saddle, i);
    }
  }
  for (size_t i = 0; i < border.size(); ++i) {
    const SwitchPoint& p = border[i];
    const bool touch = p.type == SwitchType::inner;
    const Vec3 at = p.at + (touch ? 1e-3 : 0.1) * p.size * p.inward;
    if (touch || p.type == SwitchType::detachment) seed(p.at, at, 1, Separatrix::Origin::border, i);
    if (touch || p.type == SwitchType::attachment) seed(p.at, at, -1, Separatrix::Origin::border, i);
  }
  if (curved) trace_to_limits(tangential_flow(flow, context), critical, seeds, trace, context);
  else trace_to_limits(flow, critical, seeds, trace, context);
  std::vector<Separatrix> out;
  for (LimitSeed& s : seeds) out.push_back(std::move(s.line));
  return out;
}

std::vector<Separatrix> separatrix_circles(const CriticalPoints& critical, double radius, int points) {
  std::vector<Separatrix> out;
  for (size_t i = 0; i < critical.points.size(); ++i) {
    const CriticalPoint& c = critical.points[i];
    if (c.flow.count != 3 || !is_saddle(c.flow.type)) continue;
    int in = 0;
    for (const double re : c.flow.re) in += re < 0;
    std::vector<Vec3> span;
    for (size_t k = 0; k < 3; ++k)
      if ((c.flow.re[k] < 0) == (in == 2)) span.push_back(c.flow.vector[k]);
    if (span.size() != 2) continue;
    const Vec3 u = normalize(span[0]), w = normalize(span[1] - u * dot(u, span[1]));
    Separatrix s;
    s.origin = Separatrix::Origin::circle, s.from = int64_t(i), s.unstable = in == 1;
    for (int k = 0; k <= points; ++k) {
      const double angle = 2 * M_PI * (k % points) / points;
      s.points.push_back(c.at + radius * c.size * (std::cos(angle) * u + std::sin(angle) * w));
      s.speed.push_back(length(c.gradient * (s.points.back() - c.at)));
    }
    out.push_back(std::move(s));
  }
  return out;
}

DatasetPtr separatrices_dataset(const std::vector<Separatrix>& lines) {
  std::vector<double> xyz, speed;
  std::vector<int64_t> ids, offsets{0};
  std::vector<int32_t> origin, from, to, orbit, unstable;
  for (const Separatrix& s : lines) {
    for (size_t i = 0; i < s.points.size(); ++i) {
      ids.push_back(int64_t(xyz.size() / 3));
      xyz.insert(xyz.end(), {s.points[i].x, s.points[i].y, s.points[i].z});
      speed.push_back(s.speed[i]);
    }
    offsets.push_back(int64_t(ids.size()));
    origin.push_back(int32_t(s.origin)), from.push_back(int32_t(s.from)), to.push_back(int32_t(s.to)), orbit.push_back(int32_t(s.orbit)),
        unstable.push_back(s.unstable);
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  mesh.lines.offsets = Array::from_vector(std::move(offsets));
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.fields.add({"speed", Association::point, Array::from_vector(std::move(speed)), "", Role::none, known_look("speed")});
  auto add = [&](const char* name, std::vector<int32_t> v) {
    parts.fields.add({name, Association::cell, Array::from_vector(std::move(v)), "", Role::labels});
  };
  if (std::any_of(orbit.begin(), orbit.end(), [](int32_t k) { return k >= 0; })) add("orbit", std::move(orbit));
  add("unstable", std::move(unstable)), add("origin", std::move(origin)), add("from", std::move(from)), add("to", std::move(to));
  parts.notes.emplace_back("labels of unstable", "0=stable\n1=unstable");
  parts.notes.emplace_back("labels of origin", "0=saddle\n1=border\n2=circle");
  return make_dataset(std::move(parts));
}

void describe(Schema& s, SeparatricesParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  describe(s, p.critical);
  s("offset", p.offset, "Distance from the saddle at which tracing begins, in diagonals of its cell.").positive();
  s("border", p.border, "Also start where the flow touches the border from inside, or separates from or attaches to a wall (flat meshes).");
  s("max_steps", p.max_steps, "Maximum number of steps of a line.").range(1, 1e9);
  s("tolerance", p.tolerance, "Error per step, in local cell sizes.").positive();
}

DatasetPtr separatrices(const Data& in, const SeparatricesParams& p, Context& context) {
  const FlowParts flow(in, p.field.name, "separatrices", context);
  const CriticalPoints critical = find_critical_points(flow, p.critical, context);
  std::vector<SwitchPoint> border;
  if (p.border && critical.plane) border = find_switch_points(flow, *critical.plane, context);
  SeparatrixOptions options;
  options.offset = p.offset;
  options.trace.tolerance = p.tolerance, options.trace.max_steps = p.max_steps, options.trace.min_speed = 1e-9 * flow.largest_speed();
  const auto lines = find_separatrices(flow, critical, border, options, context);
  context.info(fmt::format("separatrices: {} line{} from {}", lines.size(), lines.size() == 1 ? "" : "s", summary(critical)));
  return separatrices_dataset(lines);
}

}  // namespace sg
