// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/closed_orbits.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/fields/known_looks.h"

namespace sg {

namespace {

// Where a line that does not end went, and the way it was followed.
struct Candidate {
  Vec3 at;
  double sign;
};

double distance_to(const Orbit& orbit, Vec3 x, Vec3* nearest = nullptr) {
  double best = HUGE_VAL;
  for (size_t i = 1; i < orbit.points.size(); ++i) {
    const Vec3 a = orbit.points[i - 1], d = orbit.points[i] - a;
    const double l2 = dot(d, d), t = l2 > 0 ? std::clamp(dot(x - a, d) / l2, 0.0, 1.0) : 0, l = length(x - a - t * d);
    if (l < best && nearest) *nearest = a + t * d;
    best = std::min(best, l);
  }
  return best;
}

bool endless(const Separatrix& line) { return line.to < 0 && (line.stop == StopReason::steps || line.stop == StopReason::closed); }

class Finder {
 public:
  Finder(const FlowParts& flow, const CriticalPoints& critical, const OrbitOptions& options, Context& context)
      : flow_(flow), critical_(critical), options_(options), context_(context) {
    trace_.tolerance = options.tolerance, trace_.max_steps = options.max_steps;
    trace_.min_speed = 1e-9 * flow.largest_speed();
    trace_.closed = true;
  }

  // Lines that go on without an end come nearer to an orbit: after some steps that is looked for, else they go on.
  void follow(std::vector<LimitSeed> seeds) {
    TraceOptions trace = trace_;
    trace.max_steps = std::max<int64_t>(1, options_.max_steps / rounds);
    for (int round = 0; round < rounds && !seeds.empty(); ++round) {
      trace_to_limits(flow_, critical_, seeds, trace, context_);
      std::vector<Candidate> ends;
      for (const LimitSeed& s : seeds)
        if (endless(s.line)) ends.push_back({s.line.points.back(), s.sign});
      const std::vector<uint8_t> done = test(ends);
      seeds.clear();
      for (size_t i = 0; i < ends.size(); ++i)
        if (!done[i]) seeds.push_back({ends[i].at, ends[i].sign, {}});
    }
  }

  // A few at a time, so that many that approach one orbit cost little more than one; the first finds it. Those that have ended.
  std::vector<uint8_t> test(const std::vector<Candidate>& candidates) {
    std::vector<uint8_t> done(candidates.size(), 0);
    constexpr size_t batch = 8;
    for (size_t begin = 0; begin < candidates.size(); begin += batch) {
      const size_t n = std::min(batch, candidates.size() - begin);
      std::vector<std::optional<Orbit>> found(n);
      std::vector<double> cell(n, 0);
      std::vector<uint8_t> family(n, 0);
      parallel_for(
          n, 1,
          [&](size_t first, size_t last) {
            PartsCursor cursor(flow_);
            for (size_t i = first; i < last; ++i) {
              const Candidate& c = candidates[begin + i];
              Vec3 v;
              done[begin + i] = !cursor(c.at, v);
              if (done[begin + i]) continue;
              ReturnOptions o;
              o.cell = cell[i] = cursor.cell_length();
              o.max_steps = options_.max_steps;
              done[begin + i] =
                  std::any_of(orbits_.begin(), orbits_.end(), [&](const Orbit& r) { return distance_to(r, c.at) < 0.05 * o.cell; });
              if (done[begin + i]) continue;
              bool circles = false;
              found[i] = periodic_orbit(cursor, c.at, critical_.plane->normal, c.sign, o, options_.isolated, &circles);
              family[i] = circles;
              done[begin + i] = found[i] || circles;
            }
          },
          &context_);
      for (size_t i = 0; i < n; ++i) {
        families_ += family[i];
        if (!found[i]) continue;
        const bool known = std::any_of(orbits_.begin(), orbits_.end(),
                                       [&](const Orbit& o) { return distance_to(o, found[i]->points[0]) < 0.1 * cell[i]; });
        if (!known) orbits_.push_back(std::move(*found[i])), cell_.push_back(cell[i]);
      }
    }
    return done;
  }

  std::vector<Orbit> run(const std::vector<Separatrix>& separatrices) {
    std::vector<LimitSeed> seeds;
    for (const CriticalPoint& c : critical_.points) {
      const bool centre = c.flow.type == CriticalType::centre;
      const Vec3 at = c.at + 0.3 * c.size * c.flow.vector[0];
      if (centre || is_repelling(c.flow.type)) seeds.push_back({at, 1, {}});
      if (centre || is_attracting(c.flow.type)) seeds.push_back({at, -1, {}});
    }
    // The saddles' lines part the plane into regions whose lines all begin at one and end at one limit: a line in each region next to a
    // saddle, and one on each stretch of the border, so that no hole and no group of points inside an orbit hides it.
    for (const CriticalPoint& c : critical_.points) {
      if (!is_saddle(c.flow.type)) continue;
      for (const double a : {1.0, -1.0})
        for (const double b : {1.0, -1.0})
          for (const double sign : {1.0, -1.0})
            seeds.push_back({c.at + 0.1 * c.size * normalize(a * c.flow.vector[0] + b * c.flow.vector[1]), sign, {}});
    }
    for (const BorderSeed& b : border_seeds(flow_, *critical_.plane, context_)) seeds.push_back({b.at, b.sign, {}});
    follow(std::move(seeds));
    std::vector<Candidate> ends;
    for (const Separatrix& s : separatrices)
      if (endless(s)) ends.push_back({s.points.back(), s.unstable ? 1.0 : -1.0});
    test(ends);
    // Orbits inside and around orbits.
    for (size_t first = 0, round = 0; first < orbits_.size() && round < 16; ++round) {
      std::vector<LimitSeed> beside;
      for (size_t i = first; i < orbits_.size(); ++i) {
        const Orbit& o = orbits_[i];
        const Vec3 across = normalize(cross(critical_.plane->normal, o.points[1] - o.points[0]));
        for (const double side : {0.5, -0.5}) beside.push_back({o.points[0] + side * cell_[i] * across, o.multiplier > 1 ? 1.0 : -1.0, {}});
      }
      first = orbits_.size();
      follow(std::move(beside));
    }
    families_ += size_t(std::erase_if(orbits_, [](const Orbit& o) { return !o.resolved; }));
    return std::move(orbits_);
  }
  size_t families() const { return families_; }

 private:
  static constexpr int rounds = 5;
  const FlowParts& flow_;
  const CriticalPoints& critical_;
  OrbitOptions options_;
  Context& context_;
  TraceOptions trace_;
  std::vector<Orbit> orbits_;
  std::vector<double> cell_;
  size_t families_ = 0;
};

}  // namespace

std::vector<Orbit> find_closed_orbits(const FlowParts& flow, const CriticalPoints& critical, const std::vector<Separatrix>& separatrices,
                                      const OrbitOptions& options, Context& context, size_t* in_families) {
  if (!critical.plane) return {};
  Finder finder(flow, critical, options, context);
  auto orbits = finder.run(separatrices);
  if (in_families) *in_families = finder.families();
  return orbits;
}

void end_at_orbits(std::vector<Separatrix>& lines, const std::vector<Orbit>& orbits, Context& context) {
  parallel_for(
      lines.size(), 1,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) {
          Separatrix& s = lines[k];
          for (size_t n = 0; n < orbits.size() && endless(s); ++n) {
            const double near = 0.02 * orbits[n].cell;
            if (!(distance_to(orbits[n], s.points.back()) < near)) continue;
            // From where on it is there.
            size_t i = s.points.size() - 1;
            while (i > 1 && distance_to(orbits[n], s.points[i - 1]) < near) --i;
            distance_to(orbits[n], s.points[i], &s.points[i]);
            s.points.resize(i + 1), s.speed.resize(i + 1);
            s.orbit = int64_t(n), s.stop = StopReason::closed;
            break;
          }
        }
      },
      &context);
}

DatasetPtr orbits_dataset(const std::vector<Orbit>& orbits) {
  std::vector<double> xyz, speed, period, multiplier, lengths;
  std::vector<int64_t> ids, offsets{0};
  std::vector<int32_t> repelling;
  for (const Orbit& o : orbits) {
    const auto first = int64_t(xyz.size() / 3);
    double l = 0;
    for (size_t i = 0; i + 1 < o.points.size(); ++i) {
      ids.push_back(first + int64_t(i));
      xyz.insert(xyz.end(), {o.points[i].x, o.points[i].y, o.points[i].z});
      speed.push_back(o.speed[i]);
      l += length(o.points[i + 1] - o.points[i]);
    }
    ids.push_back(first);
    offsets.push_back(int64_t(ids.size()));
    repelling.push_back(o.multiplier > 1), period.push_back(o.period), multiplier.push_back(o.multiplier), lengths.push_back(l);
  }
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  mesh.lines.offsets = Array::from_vector(std::move(offsets));
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  parts.fields.add({"speed", Association::point, Array::from_vector(std::move(speed)), "", Role::none, known_look("speed")});
  parts.fields.add({"repelling", Association::cell, Array::from_vector(std::move(repelling)), "", Role::labels});
  parts.fields.add({"period", Association::cell, Array::from_vector(std::move(period)), "", Role::none});
  parts.fields.add({"multiplier", Association::cell, Array::from_vector(std::move(multiplier)), "", Role::none});
  parts.fields.add({"length", Association::cell, Array::from_vector(std::move(lengths)), "", Role::none});
  parts.notes.emplace_back("labels of repelling", "0=attracting\n1=repelling");
  return make_dataset(std::move(parts));
}

void describe(Schema& s, ClosedOrbitsParams& p) {
  s("field", p.field, "Velocity field; default: the active vectors.").takes(fields::vectors);
  s("max_steps", p.max_steps, "Maximum number of steps of the lines that search for orbits.").range(1, 1e9);
  s("tolerance", p.tolerance, "Error per step of these lines, in local cell sizes.").positive();
  s("isolated", p.isolated,
    "Orbits whose neighbours approach or leave them by less than this fraction per turn belong to a centre and are left out.")
      .range(0, 1);
}

DatasetPtr closed_orbits(const Data& in, const ClosedOrbitsParams& p, Context& context) {
  const FlowParts flow(in, p.field.name, "closed_orbits", context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  if (!critical.plane)
    fail_usage("periodic orbits can be found only in flat meshes of 2D cells", "closed_orbits", "slice the solid, or flatten the surface");
  SeparatrixOptions options;
  options.trace.max_steps = p.max_steps, options.trace.tolerance = p.tolerance, options.trace.min_speed = 1e-9 * flow.largest_speed();
  const auto lines = find_separatrices(flow, critical, {}, options, context);
  size_t families = 0;
  const auto orbits = find_closed_orbits(flow, critical, lines, {p.max_steps, p.tolerance, p.isolated}, context, &families);
  const auto repelling = std::count_if(orbits.begin(), orbits.end(), [](const Orbit& o) { return o.multiplier > 1; });
  context.info(fmt::format("closed_orbits: {} attracting, {} repelling{}", orbits.size() - size_t(repelling), repelling,
                           families > 0 ? "; the others belong to families around centres, whose neighbours are closed too" : ""));
  return orbits_dataset(orbits);
}

}  // namespace sg
