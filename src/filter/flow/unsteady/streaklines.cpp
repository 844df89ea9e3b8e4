// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/streaklines.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "filter/flow/unsteady/streak_front.h"

namespace sg {

namespace {

constexpr size_t most_releases = 10'000'000;
constexpr double most_on_a_line = 1e6;

// Times of release, ascending, the first at the start.
std::vector<double> release_times(const UnsteadyRun& run, std::optional<double> every, const char* who) {
  std::vector<double> out{run.start};
  if (!every) {
    for (const double t : run.flow.times())
      if (t > run.start && t <= run.time) out.push_back(t);
    return out;
  }
  if (!(*every > 0)) return out;
  const double count = (run.time - run.start) / *every * (1 + 1e-12);
  if (!(count < double(most_releases)))
    fail_usage(fmt::format("every={} means {:.3g} releases", *every, count), who, fmt::format("at most {} are allowed", most_releases));
  for (int64_t i = 1; double(i) <= count; ++i) out.push_back(std::min(run.start + double(i) * *every, run.time));
  return out;
}

StreakFront release(const UnsteadyRun& run, std::optional<double> every, const char* who) {
  const std::vector<double> times = release_times(run, every, who);
  const size_t seeds = run.seeds.size(), releases = times.size();
  if (double(releases) * double(seeds) > double(size_t(1) << 31))
    fail_usage(fmt::format("{} seeds and {} releases make {} particles", seeds, releases, releases * seeds), who,
               "use fewer seeds or a larger every");
  return {run.seeds, times};
}

// Lines of one seed after the other, the newest particle first. Gaps that refinement could not fill (wider than `torn`: what stretches by
// thousands in one interval) are not lines, and isolated particles are left out.
LinePoints streaks(const StreakFront& r, std::vector<double>& age, double time, double torn) {
  constexpr size_t grain = 64;
  const size_t seeds = r.seeds();
  std::vector<size_t> points(seeds, 0), lines(seeds, 0);
  const bool refined = torn < HUGE_VAL;
  const auto joined = [&](std::span<const Particle> p, size_t k) {  // with the next
    return k + 1 < p.size() && !p[k].ended && !p[k + 1].ended && !(length(p[k].x - p[k + 1].x) > torn);
  };
  const auto each = [&](auto&& f) {  // f(seed, release, particle, whether a line begins with it)
    parallel_for(seeds, grain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const std::span<const Particle> p = r.of(i);
        const bool several = refined && std::count_if(p.begin(), p.end(), [](const Particle& q) { return !q.ended; }) > 1;
        for (size_t k = p.size(); k-- > 0;) {
          if (p[k].ended) continue;
          const bool begins = !joined(p, k), alone = begins && !(k > 0 && joined(p, k - 1));
          if (!(alone && several)) f(i, k, p[k], begins);
        }
      }
    });
  };
  each([&](size_t i, size_t, const Particle&, bool begins) { ++points[i], lines[i] += begins; });
  LinePoints out;
  const size_t n = exclusive_scan(points), m = exclusive_scan(lines);
  out.x.resize(n), out.v.resize(n), age.resize(n);
  out.begin.resize(m + 1), out.seed.resize(m);
  out.begin[m] = n;
  each([&](size_t i, size_t k, const Particle& p, bool begins) {
    if (begins) out.begin[lines[i]] = points[i], out.seed[lines[i]++] = int64_t(i);
    const size_t at = points[i]++;
    out.x[at] = p.x, out.v[at] = p.v, age[at] = time - r.born(i)[k];
  });
  return out;
}

struct Streaks {
  LinePoints lines;
  Array age;
  FieldSet more;
};

Streaks streaks_with_fields(UnsteadyRun& run, const StreakFront& r, double torn, Context& context) {
  Streaks out;
  std::vector<double> age;
  out.lines = streaks(r, age, run.time, torn);
  if (run.carries) {
    CarriedFields carried;
    carried.open(run.flow);
    if (!carried.empty()) {
      const size_t n = out.lines.x.size();
      const std::vector<double> now(n, run.time);
      carried.sample(run.flow, out.lines.x, now, context);
      std::vector<size_t> order(n);
      for (size_t i = 0; i < n; ++i) order[i] = i;
      out.more = carried.take(order);
    }
  }
  out.age = Array::from_vector(std::move(age));
  return out;
}

}  // namespace

void describe(Schema& s, StreaklinesParams& p) {
  describe(s, p, "Time of the first release; default: the first time of the series.",
           "Time at which lines are shown; default: the last time of the series.");
  s("every", p.every, "Time between releases; default: at each time step.").unit("time").positive();
  s("refine", p.refine, "Release more particles where a line stretches or bends.");
  s("spacing", p.spacing,
    "When refining: largest distance between neighbours before another is put between them; default: a hundredth of the mesh's diagonal.")
      .unit("length")
      .positive();
  s("angle", p.angle, "When refining: largest turn of a line before more particles are put in.").unit("deg").range(1, 180);
  s("most_points", p.most_points, "Maximum number of particles; beyond it, lines are no longer refined.").range(2, 1e9);
}

DatasetPtr streaklines(const Series& series, const std::vector<Data>& others, const StreaklinesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "streaklines", false, context);
  StreakFront front = release(run, p.every, "streaklines");
  StreakFront::Refinement finer;
  const double diagonal = length(run.flow.steps()[0].dataset()->bounds().size());
  finer.spacing = p.spacing.value_or(0.01 * diagonal);
  if (p.refine && diagonal > finer.spacing * most_on_a_line)
    fail_usage(fmt::format("with spacing={:.4g}, a line through the mesh, {:.4g} long, would have more than {:g} particles", finer.spacing,
                           diagonal, most_on_a_line),
               "streaklines", "use a larger spacing");
  finer.angle = p.angle * M_PI / 180, finer.shortest = finer.spacing / 16;  // a fold is not followed below this
  finer.most = std::max(size_t(p.most_points), front.size());
  run.each_interval([&](double until) { front.advance(run.flow, until, run.options, p.refine ? &finer : nullptr, context); });
  run.require_some(front.started());
  if (front.full()) context.warn(fmt::format("streaklines: {} particles; lines are not refined further (most_points)", front.size()));
  Streaks s = streaks_with_fields(run, front, p.refine && !front.full() ? 2 * finer.spacing : HUGE_VAL, context);
  return run.finished(
      lines_of(s.lines, {"age", Association::point, s.age, "", Role::scalars}, run.velocity(), run.time, std::move(s.more), {}));
}

void describe(Schema& s, ParticlesParams& p) {
  describe(s, p, "Time of the first release; default: the first time of the series.",
           "Time at which particles are shown; default: the last time of the series.");
  s("every", p.every, "Time between releases; 0: one release, at the start; default: at each time step.").unit("time").at_least(0);
  s("lifetime", p.lifetime, "Maximum age of particles; default: no limit.").unit("time").positive();
}

DatasetPtr particles(const Series& series, const std::vector<Data>& others, const ParticlesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "particles", false, context);
  StreakFront front = release(run, p.every, "particles");
  run.each_interval([&](double until) {
    if (p.lifetime) front.bury(run.flow.begin() - *p.lifetime);
    front.advance(run.flow, until, run.options, nullptr, context);
  });
  const size_t started = front.started();
  if (p.lifetime) front.bury(run.time - *p.lifetime);
  run.require_some(started);
  Streaks s = streaks_with_fields(run, front, HUGE_VAL, context);
  return run.finished(
      points_of(s.lines, {"age", Association::point, s.age, "", Role::scalars}, run.velocity(), run.time, std::move(s.more)));
}

}  // namespace sg
