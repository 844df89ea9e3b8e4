// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/streaklines.h"

#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t most_releases = 10'000'000;

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
    fail_usage(fmt::format("every={} means {:.3g} releases", *every, count), who, fmt::format("at most {}", most_releases));
  for (int64_t i = 1; double(i) <= count; ++i) out.push_back(std::min(run.start + double(i) * *every, run.time));
  return out;
}

struct Released {
  std::vector<Particle> all;  // those of a seed together, in the order of release; seeds so that neighbours follow each other
  std::vector<double> times;  // of release
  std::vector<size_t> slot;   // of a seed: where its particles are, in units of releases
  std::span<const Particle> of(size_t seed) const { return std::span(all).subspan(slot[seed] * times.size(), times.size()); }
};

Released release_and_advance(UnsteadyRun& run, std::optional<double> every, std::optional<double> lifetime, const char* who,
                             Context& context) {
  Released r;
  r.times = release_times(run, every, who);
  const size_t seeds = run.seeds.size(), releases = r.times.size();
  if (double(releases) * double(seeds) > double(size_t(1) << 31))
    fail_usage(fmt::format("{} seeds and {} releases make {} particles", seeds, releases, releases * seeds), who,
               "fewer seeds, or a larger every");
  const std::vector<size_t> order = space_order(run.seeds);
  r.slot.resize(seeds);
  r.all.resize(releases * seeds);
  for (size_t i = 0; i < seeds; ++i) {
    r.slot[order[i]] = i;
    for (size_t k = 0; k < releases; ++k) r.all[i * releases + k].x = run.seeds[order[i]], r.all[i * releases + k].t = r.times[k];
  }
  const auto bury = [&](double before) {
    const size_t old = size_t(std::lower_bound(r.times.begin(), r.times.end(), before) - r.times.begin());
    for (size_t i = 0; i < seeds; ++i)
      for (size_t k = 0; k < old; ++k) r.all[i * releases + k].ended = true;
  };
  run.each_interval([&](double until) {
    if (lifetime) bury(run.flow.begin() - *lifetime);
    advance(run.flow, r.all, until, 1, run.options, context);
  });
  size_t started = 0;
  for (const Particle& p : r.all) started += p.started;
  if (lifetime) bury(run.time - *lifetime);
  run.require_some(started);
  return r;
}

// Lines of one seed after the other, the newest particle first.
LinePoints streaks(const Released& r, std::vector<double>& age, double time) {
  constexpr size_t grain = 64;
  const size_t releases = r.times.size(), seeds = r.slot.size();
  std::vector<size_t> points(seeds, 0), lines(seeds, 0);
  const auto each = [&](auto&& f) {  // f(seed, release, particle, whether a line begins with it)
    parallel_for(seeds, grain, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const std::span<const Particle> p = r.of(i);
        for (size_t k = releases; k-- > 0;)
          if (!p[k].ended) f(i, k, p[k], k + 1 == releases || p[k + 1].ended);
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
    out.x[at] = p.x, out.v[at] = p.v, age[at] = time - r.times[k];
  });
  return out;
}

struct Streaks {
  LinePoints lines;
  Array age;
  FieldSet more;
};

Streaks streaks_with_fields(UnsteadyRun& run, const Released& r, Context& context) {
  Streaks out;
  std::vector<double> age;
  out.lines = streaks(r, age, run.time);
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
  describe(s, p, "First release; default: the first time of the series.", "Moment of the lines; default: the last time of the series.");
  s("every", p.every, "Time between releases; default: at each time step.").unit("time").positive();
}

DatasetPtr streaklines(const Series& series, const std::vector<Data>& others, const StreaklinesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "streaklines", false, context);
  const Released r = release_and_advance(run, p.every, {}, "streaklines", context);
  Streaks s = streaks_with_fields(run, r, context);
  return lines_of(s.lines, {"age", Association::point, s.age, "", Role::scalars}, run.velocity(), run.time, std::move(s.more), {});
}

void describe(Schema& s, ParticlesParams& p) {
  describe(s, p, "First release; default: the first time of the series.", "Moment of the picture; default: the last time of the series.");
  s("every", p.every, "Time between releases; 0: all at the start; default: at each time step.").unit("time").at_least(0);
  s("lifetime", p.lifetime, "Older particles are gone; default: none.").unit("time").positive();
}

DatasetPtr particles(const Series& series, const std::vector<Data>& others, const ParticlesParams& p, Context& context) {
  UnsteadyRun run(series, others, p, "particles", false, context);
  const Released r = release_and_advance(run, p.every, p.lifetime, "particles", context);
  Streaks s = streaks_with_fields(run, r, context);
  return points_of(s.lines, {"age", Association::point, s.age, "", Role::scalars}, run.velocity(), run.time, std::move(s.more));
}

}  // namespace sg
