// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/timelines.h"

#include <fmt/core.h>

#include "base/parallel.h"
#include "filter/flow/unsteady/advance_one.h"

namespace sg {

void describe(Schema& s, TimelinesParams& p) {
  describe(s, p, "Time at which the line starts; default: the first time of the series.",
           "Time of the last line; default: the last time of the series.");
  s("every", p.every, "Time between lines; default: at each time step.").unit("time").positive();
  s("spacing", p.spacing,
    "Largest distance between neighbours before another is put between them; default: 1.5 times the largest gap at the start.")
      .unit("length")
      .positive();
  s("angle", p.angle, "Largest turn of the line before more points are put in.").unit("deg").range(1, 180);
  s("most_points", p.most_points, "Maximum number of points of the line; beyond it, no more are added.").range(2, 1e9);
}

namespace {

class Front {
 public:
  Front(const UnsteadyRun& run, const TimelinesParams& p) : most_(size_t(p.most_points)), turn_(std::cos(p.angle * M_PI / 180)) {
    const size_t n = run.seeds.size();
    double gap = 0;
    for (size_t i = 0; i < n; ++i) {
      Particle q;
      q.x = run.seeds[i], q.t = run.start;
      all.push_back(q);
      position.push_back(double(i) / double(n - 1));
      if (i > 0) gap = std::max(gap, length(run.seeds[i] - run.seeds[i - 1]));
    }
    spacing_ = p.spacing.value_or(1.5 * gap);
  }

  std::vector<Particle> all;
  std::vector<double> position;
  bool full = false;

  /// New particles between those that are too far apart, as often as necessary.
  void refine(const UnsteadyFlow& flow) {
    UnsteadyCursor cursor(flow);
    for (int pass = 0; pass < 12 && insert_between(cursor); ++pass) {
    }
  }

 private:
  bool joined(size_t i) const { return i + 1 < all.size() && !all[i].ended && !all[i + 1].ended; }

  std::vector<char> wanted() const {
    std::vector<char> want(all.size(), 0);
    const double shortest = spacing_ / 64;  // a fold is not followed below this
    for (size_t i = 0; i + 1 < all.size(); ++i) {
      if (!joined(i)) continue;
      const Vec3 a = all[i + 1].x - all[i].x;
      const double la = length(a);
      if (la > spacing_) want[i] = 1;
      if (!joined(i + 1)) continue;
      const Vec3 b = all[i + 2].x - all[i + 1].x;
      const double lb = length(b);
      if (dot(a, b) < turn_ * la * lb) {
        if (la > shortest) want[i] = 1;
        if (lb > shortest) want[i + 1] = 1;
      }
    }
    return want;
  }

  // Direction of the line at i, from the parabola in chord length through its neighbours.
  Vec3 tangent(size_t i) const {
    const bool before = i > 0 && joined(i - 1), after = joined(i);
    const Vec3 a = before ? all[i].x - all[i - 1].x : Vec3(), b = after ? all[i + 1].x - all[i].x : Vec3();
    const double la = length(a), lb = length(b);
    if (!(la > 0)) return lb > 0 ? b / lb : b;
    if (!(lb > 0)) return a / la;
    return (a * (lb / la) + b * (la / lb)) / (la + lb);
  }

  bool insert_between(UnsteadyCursor& cursor) {
    const std::vector<char> want = wanted();
    const size_t more = size_t(std::count(want.begin(), want.end(), 1));
    if (more == 0) return false;
    if (all.size() + more > most_) {
      full = true;
      return false;
    }
    std::vector<Particle> next;
    std::vector<double> next_position;
    next.reserve(all.size() + more), next_position.reserve(all.size() + more);
    bool any = false;
    for (size_t i = 0; i < all.size(); ++i) {
      next.push_back(all[i]), next_position.push_back(position[i]);
      if (!want[i]) continue;
      const double d = length(all[i + 1].x - all[i].x);
      Particle p;
      p.x = (all[i].x + all[i + 1].x) / 2 + (tangent(i) - tangent(i + 1)) * (d / 8);
      p.t = all[i].t, p.steps = all[i].steps;
      if (!detail::start_particle(cursor, p)) continue;
      next.push_back(p), next_position.push_back((position[i] + position[i + 1]) / 2);
      any = true;
    }
    all = std::move(next), position = std::move(next_position);
    return any;
  }

  size_t most_;
  double turn_, spacing_ = 0;
};

struct Snapshots {
  LinePoints lines;
  std::vector<double> time, position;  // per point
  std::vector<double> line_time;
  CarriedFields carried;

  void add(const UnsteadyRun& run, const Front& front, double t, int64_t number, Context& context) {
    const size_t first = lines.x.size();
    auto close = [&] {
      if (lines.x.size() > lines.begin.back()) lines.begin.push_back(lines.x.size()), lines.seed.push_back(number), line_time.push_back(t);
    };
    for (size_t i = 0; i < front.all.size(); ++i) {
      const Particle& p = front.all[i];
      if (p.ended) close();
      else lines.x.push_back(p.x), lines.v.push_back(p.v), position.push_back(front.position[i]), time.push_back(t);
    }
    close();
    if (run.carries) carried.sample(run.flow, std::span(lines.x).subspan(first), std::span(time).subspan(first), context);
  }
};

// After the start, when lines are shown.
std::vector<double> line_times(const UnsteadyRun& run, std::optional<double> every) {
  std::vector<double> out;
  if (!every) {
    for (const double t : run.flow.times())
      if (t > run.start && t < run.time) out.push_back(t);
    if (run.time > run.start) out.push_back(run.time);
    return out;
  }
  const double count = (run.time - run.start) / *every * (1 + 1e-12);
  if (!(count < 1e6)) fail_usage(fmt::format("every={} means {:.3g} lines", *every, count), "timelines", "at most 1000000 are allowed");
  for (int64_t i = 1; double(i) <= count; ++i) out.push_back(std::min(run.start + double(i) * *every, run.time));
  return out;
}

}  // namespace

DatasetPtr timelines(const Series& series, const std::vector<Data>& others, const TimelinesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "timelines", false, context);
  if (run.seeds.size() < 2) fail_usage(fmt::format("{} seed does not make a line", run.seeds.size()), "timelines", "from=x,y,z to=x,y,z");
  if (seed_kind(p.seeds, !others.empty()) == SeedKind::random)
    fail_usage("random seeds do not make a line", "timelines", "from=x,y,z to=x,y,z");
  const std::vector<double> shown = line_times(run, p.every);
  Front front(run, p);
  Snapshots out;
  size_t next = 0;
  advance(run.flow, front.all, run.start, 1, run.options, context);  // starts them
  front.refine(run.flow);
  out.add(run, front, run.start, 0, context);
  run.require_some(out.lines.x.size());
  run.each_interval([&](double until) {
    for (; next < shown.size() && shown[next] <= until; ++next) {
      advance(run.flow, front.all, shown[next], 1, run.options, context);
      front.refine(run.flow);
      out.add(run, front, shown[next], int64_t(next) + 1, context);
    }
    advance(run.flow, front.all, until, 1, run.options, context);
    front.refine(run.flow);
  });
  if (front.full) context.warn(fmt::format("timelines: the line has {} points; no more are added (most_points)", front.all.size()));

  FieldSet more;
  std::vector<size_t> order(out.lines.x.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  more.add({"position", Association::point, Array::from_vector(std::move(out.position)), "", Role::none});
  for (const Field& f : out.carried.take(order)) more.add(f);
  std::vector<Field> per_line;
  per_line.push_back({"time", Association::cell, Array::from_vector(std::move(out.line_time)), "", Role::none});
  return run.finished(lines_of(out.lines, {"time", Association::point, Array::from_vector(std::move(out.time)), "", Role::scalars},
                               run.velocity(), run.time, std::move(more), std::move(per_line), "line"));
}

}  // namespace sg
