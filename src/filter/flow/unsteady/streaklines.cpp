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
  std::vector<Particle> all;  // release by release, each in the order of the seeds
  std::vector<double> times;  // of release
  size_t seeds = 0, started = 0;
};

Released release_and_advance(UnsteadyRun& run, std::optional<double> every, std::optional<double> lifetime, const char* who,
                             Context& context) {
  Released r;
  r.times = release_times(run, every, who);
  r.seeds = run.seeds.size();
  if (double(r.times.size()) * double(r.seeds) > double(size_t(1) << 31))
    fail_usage(fmt::format("{} seeds and {} releases make {} particles", r.seeds, r.times.size(), r.times.size() * r.seeds), who,
               "fewer seeds, or a larger every");
  r.all.reserve(r.times.size() * r.seeds);
  size_t released = 0, oldest = 0;
  run.each_interval([&](double until) {
    for (; released < r.times.size() && r.times[released] <= until; ++released)
      for (const Vec3& x : run.seeds) {
        Particle p;
        p.x = x, p.t = r.times[released];
        r.all.push_back(p);
      }
    if (lifetime)
      while (oldest < released && r.times[oldest] < run.flow.begin() - *lifetime) ++oldest;
    advance(run.flow, std::span(r.all).subspan(oldest * r.seeds), until, run.options, context);
  });
  for (const Particle& p : r.all) r.started += p.started;
  if (lifetime)
    for (size_t k = 0; k < released && r.times[k] < run.time - *lifetime; ++k)
      for (size_t i = 0; i < r.seeds; ++i) r.all[k * r.seeds + i].ended = true;
  run.require_some(r.started);
  return r;
}

// Lines of one seed after the other, the newest particle first. Some seeds at a time, whose particles lie together in each release.
LinePoints streaks(const Released& r, std::vector<double>& age, double time) {
  constexpr size_t grain = 64;
  const size_t releases = r.times.size();
  std::vector<size_t> points(r.seeds, 0), lines(r.seeds, 0);
  const auto each = [&](auto&& f) {  // f(seed, release, particle), release by release
    parallel_for(r.seeds, grain, [&](size_t begin, size_t end) {
      for (size_t k = releases; k-- > 0;)
        for (size_t i = begin; i < end; ++i) f(i, k, r.all[k * r.seeds + i]);
    });
  };
  each([&](size_t i, size_t k, const Particle& p) {
    if (p.ended) return;
    ++points[i];
    lines[i] += k + 1 == releases || r.all[(k + 1) * r.seeds + i].ended;  // a newer one is gone: a new line
  });
  std::vector<size_t> point = points, line = lines;
  LinePoints out;
  const size_t n = exclusive_scan(point), m = exclusive_scan(line);
  out.x.resize(n), out.v.resize(n), age.resize(n);
  out.begin.resize(m + 1), out.seed.resize(m);
  out.begin[m] = n;
  each([&](size_t i, size_t k, const Particle& p) {
    if (p.ended) return;
    if (k + 1 == releases || r.all[(k + 1) * r.seeds + i].ended) out.begin[line[i]] = point[i], out.seed[line[i]++] = int64_t(i);
    const size_t at = point[i]++;
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
