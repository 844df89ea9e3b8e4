// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/topology/closed_orbits.h"

#include <algorithm>

#include "base/parallel.h"

namespace sg {

namespace {

// Where a line that does not end went, and the way it was followed.
struct Candidate {
  Vec3 at;
  double sign;
};

double distance_to(const Orbit& orbit, Vec3 x) {
  double best = HUGE_VAL;
  for (size_t i = 1; i < orbit.points.size(); ++i) {
    const Vec3 a = orbit.points[i - 1], d = orbit.points[i] - a;
    const double l2 = dot(d, d), t = l2 > 0 ? std::clamp(dot(x - a, d) / l2, 0.0, 1.0) : 0;
    best = std::min(best, length(x - a - t * d));
  }
  return best;
}

bool endless(const Separatrix& line) { return line.to < 0 && (line.stop == StopReason::steps || line.stop == StopReason::closed); }

class Finder {
 public:
  Finder(const FlowField& flow, const CriticalPoints& critical, const OrbitOptions& options, Context& context)
      : flow_(flow), critical_(critical), options_(options), context_(context) {
    trace_.tolerance = options.tolerance, trace_.max_steps = options.max_steps;
    trace_.min_speed = 1e-9 * flow.largest_speed();
    trace_.closed = false;
  }

  void follow(std::vector<LimitSeed> seeds) {
    trace_to_limits(flow_, critical_, seeds, trace_, context_);
    std::vector<Candidate> found;
    for (const LimitSeed& s : seeds)
      if (endless(s.line)) found.push_back({s.line.points.back(), s.sign});
    test(found);
  }

  // The first of those that are one orbit stays.
  void test(const std::vector<Candidate>& candidates) {
    std::vector<std::optional<Orbit>> found(candidates.size());
    std::vector<double> cell(candidates.size(), 0);
    parallel_for(
        candidates.size(), 1,
        [&](size_t begin, size_t end) {
          FlowCursor cursor(flow_);
          for (size_t i = begin; i < end; ++i) {
            Vec3 v;
            if (!cursor(candidates[i].at, v)) continue;
            ReturnOptions o;
            o.cell = cell[i] = cursor.cell_length();
            o.max_steps = options_.max_steps;
            const bool known = std::any_of(orbits_.begin(), orbits_.end(),
                                           [&](const Orbit& r) { return distance_to(r, candidates[i].at) < 0.01 * o.cell; });
            if (!known)
              found[i] = periodic_orbit(cursor, candidates[i].at, critical_.plane->normal, candidates[i].sign, o, options_.isolated);
          }
        },
        &context_);
    for (size_t i = 0; i < found.size(); ++i) {
      if (!found[i]) continue;
      const bool known =
          std::any_of(orbits_.begin(), orbits_.end(), [&](const Orbit& o) { return distance_to(o, found[i]->points[0]) < 0.1 * cell[i]; });
      if (!known) orbits_.push_back(std::move(*found[i])), cell_.push_back(cell[i]);
    }
  }

  std::vector<Orbit> run(const std::vector<Separatrix>& separatrices) {
    std::vector<LimitSeed> seeds;
    for (const CriticalPoint& c : critical_.points) {
      const bool centre = c.flow.type == CriticalType::centre;
      const Vec3 at = c.at + 0.3 * c.size * c.flow.vector[0];
      if (centre || is_repelling(c.flow.type)) seeds.push_back({at, 1, {}});
      if (centre || is_attracting(c.flow.type)) seeds.push_back({at, -1, {}});
    }
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
    return std::move(orbits_);
  }

 private:
  const FlowField& flow_;
  const CriticalPoints& critical_;
  OrbitOptions options_;
  Context& context_;
  TraceOptions trace_;
  std::vector<Orbit> orbits_;
  std::vector<double> cell_;
};

}  // namespace

std::vector<Orbit> find_closed_orbits(const FlowField& flow, const CriticalPoints& critical, const std::vector<Separatrix>& separatrices,
                                      const OrbitOptions& options, Context& context) {
  if (!critical.plane) return {};
  return Finder(flow, critical, options, context).run(separatrices);
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
  parts.fields.add({"speed", Association::point, Array::from_vector(std::move(speed)), "", Role::none});
  parts.fields.add({"repelling", Association::cell, Array::from_vector(std::move(repelling)), "", Role::labels});
  parts.fields.add({"period", Association::cell, Array::from_vector(std::move(period)), "", Role::none});
  parts.fields.add({"multiplier", Association::cell, Array::from_vector(std::move(multiplier)), "", Role::none});
  parts.fields.add({"length", Association::cell, Array::from_vector(std::move(lengths)), "", Role::none});
  parts.notes.emplace_back("labels of repelling", "0=attracting\n1=repelling");
  return make_dataset(std::move(parts));
}

void describe(Schema& s, ClosedOrbitsParams& p) {
  s("field", p.field, "Velocity; default: the active vectors.");
  s("max_steps", p.max_steps, "Most steps of the lines that look for orbits.").range(1, 1e9);
  s("tolerance", p.tolerance, "Error of one step of these lines, in sizes of the local cell.").positive();
  s("isolated", p.isolated,
    "Orbits that their neighbours approach or leave by less than this part in a turn belong to a centre and are left out.")
      .range(0, 1);
}

DatasetPtr closed_orbits(const DatasetPtr& in, const ClosedOrbitsParams& p, Context& context) {
  const FlowField flow(in, p.field.name, context);
  const CriticalPoints critical = find_critical_points(flow, {}, context);
  if (!critical.plane)
    fail_usage("periodic orbits are found in flat meshes of 2D cells", "closed_orbits", "slice a solid, or flatten the surface");
  SeparatrixOptions options;
  options.trace.max_steps = p.max_steps, options.trace.tolerance = p.tolerance, options.trace.min_speed = 1e-9 * flow.largest_speed();
  const auto lines = find_separatrices(flow, critical, {}, options, context);
  const auto orbits = find_closed_orbits(flow, critical, lines, {p.max_steps, p.tolerance, p.isolated}, context);
  const auto repelling = std::count_if(orbits.begin(), orbits.end(), [](const Orbit& o) { return o.multiplier > 1; });
  context.info(fmt::format("closed_orbits: {} attracting, {} repelling", orbits.size() - size_t(repelling), repelling));
  return orbits_dataset(orbits);
}

}  // namespace sg
