// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/unsteady_surfaces.h"

#include "base/text.h"
#include "filter/flow/fronts/front.h"
#include "filter/flow/fronts/sheet.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

void describe_shared(Schema& s, UnsteadySurfaceParams& p) {
  s("field", p.field, "Velocity: a point or cell field of 2 or 3 components; default: the active vectors.");
  s("times", p.times, "Time steps, FIRST:LAST:COUNT or a list; default: those of the file.").unit("time");
  s("start", p.start, "When it begins; default: the first time of the series.").unit("time");
  s("time", p.time, "When it ends; default: the last time of the series.").unit("time");
  s("interpolation", p.interpolation, "Between time steps.").choices({"linear", "cubic"});
  describe(s, p.integration);
  s("spacing", p.spacing, "Longest edge of the surface; default: a 100th of the mesh's diagonal.").unit("length").positive();
  s("tear", p.tear, "A gap wider than this many spacings that cannot be filled is left open.").range(1, 1e6);
  s("max_points", p.max_points, "Most points of the surface.").range(4, 1e9);
}

UnsteadyParams run_params(const UnsteadySurfaceParams& p, const std::vector<Vec3>& seeds) {
  UnsteadyParams u;
  u.field = p.field, u.times = p.times, u.start = p.start, u.time = p.time, u.interpolation = p.interpolation;
  u.integration = p.integration;
  for (const Vec3& x : seeds) u.seeds.points.insert(u.seeds.points.end(), {x.x, x.y, x.z});
  return u;
}

DatasetPtr seed_lines(const std::vector<Data>& others, const char* who) {
  return others.empty() ? nullptr : single_dataset(others[0], who);
}

// Points of a surface as they are collected.
struct Collected {
  std::vector<Vec3> x, v;
  std::vector<double> time, s, born;
  std::vector<int64_t> triangles;

  int64_t add(const Particle& p, double seed_parameter, double release) {
    x.push_back(p.x), v.push_back(p.v), time.push_back(p.t), s.push_back(seed_parameter), born.push_back(release);
    return int64_t(x.size() - 1);
  }
};

DatasetPtr surface_dataset(Collected c, const Field& velocity, double start, double end, bool releases) {
  const size_t n = c.x.size();
  Box3 box;
  for (const Vec3& x : c.x) box.add(x);
  SurfaceMesh mesh;
  mesh.points.origin = box.empty() ? Vec3() : box.center();
  float *xyz = nullptr, *v = nullptr, *speed = nullptr, *s = nullptr, *st = nullptr, *age = nullptr;
  mesh.points.xyz = Array::make<float>(n, 3, &xyz);
  FieldSet fields;
  fields.add({"speed", Association::point, Array::make<float>(n, 1, &speed), velocity.unit, Role::scalars});
  fields.add({velocity.name, Association::point, Array::make<float>(n, 3, &v), velocity.unit, Role::vectors});
  fields.add({"seed parameter", Association::point, Array::make<float>(n, 1, &s), "", Role::none});
  fields.add({"age", Association::point, Array::make<float>(n, 1, &age), "", Role::none});
  fields.add({"texture coordinates", Association::point, Array::make<float>(n, 2, &st), "", Role::tcoords});
  for (size_t i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = float(c.x[i][a] - mesh.points.origin[a]), v[3 * i + size_t(a)] = float(c.v[i][a]);
    speed[i] = float(length(c.v[i])), s[i] = float(c.s[i]), age[i] = float(c.time[i] - c.born[i]);
    st[2 * i] = s[i], st[2 * i + 1] = end > start ? float((c.time[i] - c.born[i]) / (end - start)) : 0;
  }
  fields.add({"time", Association::point, Array::from_vector(std::move(c.time)), "", Role::none});
  if (releases) fields.add({"release time", Association::point, Array::from_vector(std::move(c.born)), "", Role::none});
  mesh.polygons.fixed = 3;
  mesh.polygons.connectivity = Array::from_vector(std::move(c.triangles));
  DatasetParts parts{std::move(mesh), std::move(fields), {}, {}, {}, end};
  return make_dataset(std::move(parts));
}

// Seeds evenly along a curve, and their parameters.
std::vector<double> even_parameters(const SeedCurve& curve, double spacing) {
  const auto n = size_t(std::max(std::ceil(curve.whole() / spacing - 1e-9), curve.closed ? 3.0 : 1.0));
  std::vector<double> out;
  for (size_t i = 0; i < n + size_t(!curve.closed); ++i) out.push_back(double(i) / double(n));
  return out;
}

// A run over a curve: spacing, seeds, and times between which nothing moves further than the spacing.
struct CurveRun {
  SeedCurve curve;
  double spacing;
  std::vector<double> parameters;
  UnsteadyRun run;

  CurveRun(const Series& series, const UnsteadySurfaceParams& p, const SeedCurve& c, const char* who, Context& context)
      : curve(c),
        spacing(p.spacing.value_or(first_diagonal(series) / 100)),
        parameters(even_parameters(curve, spacing)),
        run(series, {}, run_params(p, places()), who, false, context) {}
  std::vector<Vec3> places() const {
    std::vector<Vec3> at;
    for (const double s : parameters) at.push_back(curve(s));
    return at;
  }
  static double first_diagonal(const Series& series) {
    Box3 box;
    for_each_dataset(series.load(0), [&](const std::string&, const DatasetPtr& d) { box.add(d->bounds()); });
    return box.diagonal();
  }
};

// Calls f(t) at times up to `until` between which the fastest place of the open interval goes at most `spacing`.
template <class F>
void each_part(const UnsteadyFlow& flow, double from, double until, double spacing, F&& f) {
  const double far = flow.largest_speed() * (until - from);
  const auto n = size_t(std::clamp(std::ceil(far / spacing), 1.0, 10000.0));
  for (size_t k = 1; k <= n; ++k) f(k == n ? until : from + (until - from) * double(k) / double(n));
}

Collected collect(const Sheet& sheet) {
  Collected c;
  std::vector<int64_t> number(sheet.particles.size(), -1);
  for (const auto& tri : sheet.triangles)
    for (const uint32_t p : tri) {
      if (number[p] < 0) number[p] = c.add(sheet.particles[p], sheet.s[p], sheet.born[p]);
      c.triangles.push_back(number[p]);
    }
  return c;
}

}  // namespace

void describe(Schema& s, PathSurfaceParams& p) {
  describe_shared(s, p);
  describe(s, p.curve);
}
void describe(Schema& s, StreakSurfaceParams& p) {
  describe_shared(s, p);
  describe(s, p.curve);
}
void describe(Schema& s, TimeSurfaceParams& p) {
  describe_shared(s, p);
  s("center", p.center, "Centre of a rectangle that begins.").unit("length");
  s("normal", p.normal, "Its normal; default: z.");
  s("size", p.size, "Its two edges.").unit("length").at_least(0);
}

DatasetPtr path_surface(const Series& series, const std::vector<Data>& others, const PathSurfaceParams& p, Context& context) {
  CurveRun r(series, p, seed_curve(p.curve, seed_lines(others, "path_surface"), "path_surface"), "path_surface", context);
  UnsteadyRun& run = r.run;
  const bool closed = r.curve.closed;
  struct Member {
    Particle p;
    double s;
    int64_t number;
  };
  std::vector<Member> front;
  Collected out;
  const auto release = [&](Particle q, double s, UnsteadyCursor& cursor) {
    if (!q.started) detail::start_particle(cursor, q);
    front.push_back({q, s, q.ended ? -1 : out.add(q, s, run.start)});
  };
  {
    UnsteadyCursor cursor(run.flow);
    for (size_t i = 0; i < run.seeds.size(); ++i) {
      Particle q;
      q.x = run.seeds[i], q.t = run.start;
      release(q, r.parameters[i], cursor);
    }
  }
  size_t begun = 0;
  for (const Member& m : front) begun += !m.p.ended;
  run.require_some(begun);
  double now = run.start;
  run.each_interval([&](double until) {
    each_part(run.flow, now, until, r.spacing, [&](double t) {
      if (int64_t(out.x.size()) > p.max_points)
        fail_usage(fmt::format("the surface has more than {} points", p.max_points), "path_surface", "a larger spacing or max_points");
      std::vector<Particle> moving;
      for (const Member& m : front) moving.push_back(m.p);
      advance(run.flow, moving, t, 1, run.options, context);
      UnsteadyCursor cursor(run.flow);
      std::vector<Member> next;
      const size_t n = front.size();
      for (size_t i = 0; i < n; ++i) {
        Member m{moving[i], front[i].s, -1};
        if (!m.p.ended) m.number = out.add(m.p, m.s, run.start);
        const size_t own = next.size();
        next.push_back(m);
        if (i + 1 == n && !closed) break;
        const size_t j = (i + 1) % n;
        if (front[i].number < 0 || front[j].number < 0 || moving[i].ended || moving[j].ended) continue;
        // Particles between the two, evenly, on the chord.
        const Vec3 a = moving[i].x, b = moving[j].x;
        const double gap = length(b - a);
        if (gap > p.tear * r.spacing) continue;
        const auto more = size_t(std::max(0.0, std::ceil(gap / r.spacing) - 1));
        double sj = front[j].s;
        if (sj <= front[i].s) sj += 1;
        std::vector<int64_t> above{next[own].number};
        bool whole = true;
        for (size_t k = 1; k <= more; ++k) {
          Particle q;
          const double f = double(k) / double(more + 1);
          q.x = lerp(a, b, f), q.t = t, q.steps = moving[i].steps;
          if (!detail::start_particle(cursor, q)) {
            whole = false;
            break;
          }
          double s = front[i].s + f * (sj - front[i].s);
          if (s >= 1 && closed) s -= 1;
          next.push_back({q, s, out.add(q, s, run.start)});
          above.push_back(next.back().number);
        }
        if (!whole) continue;
        // The point of j is added next; on the last one of a closed front it is there already.
        above.push_back(j == 0 ? next[0].number : int64_t(out.x.size()));
        if (j != 0) out.x.push_back(b);  // for the diagonals' lengths, replaced below
        stitch({front[i].number, front[j].number}, above, out.x, out.triangles);
        if (j != 0) out.x.pop_back();
      }
      // Thin: of three within half a spacing the middle one goes from the next front on.
      front.clear();
      bool skipped = false;
      for (size_t i = 0; i < next.size(); ++i) {
        const bool inner =
            i > 0 && i + 1 < next.size() && !skipped && next[i].number >= 0 && next[i - 1].number >= 0 && next[i + 1].number >= 0;
        skipped = inner && length(next[i].p.x - next[i - 1].p.x) + length(next[i + 1].p.x - next[i].p.x) < 0.5 * r.spacing;
        if (!skipped) front.push_back(next[i]);
      }
    });
    now = until;
  });
  const Field velocity = run.velocity();
  return surface_dataset(std::move(out), velocity, run.start, run.time, false);
}

DatasetPtr streak_surface(const Series& series, const std::vector<Data>& others, const StreakSurfaceParams& p, Context& context) {
  CurveRun r(series, p, seed_curve(p.curve, seed_lines(others, "streak_surface"), "streak_surface"), "streak_surface", context);
  UnsteadyRun& run = r.run;
  Sheet sheet;
  std::vector<uint32_t> row;  // the particles released last
  const auto release = [&](double t) {
    UnsteadyCursor cursor(run.flow);
    std::vector<uint32_t> fresh;
    for (size_t i = 0; i < run.seeds.size(); ++i) {
      fresh.push_back(sheet.add(run.seeds[i], t, r.parameters[i]));
      detail::start_particle(cursor, sheet.particles.back());
    }
    const size_t n = row.size();
    for (size_t i = 0; i + 1 < n + size_t(r.curve.closed); ++i) {
      const uint32_t a = row[i], b = row[(i + 1) % n], c = fresh[i], d = fresh[(i + 1) % n];
      if (length(sheet.particles[a].x - sheet.particles[d].x) < length(sheet.particles[b].x - sheet.particles[c].x))
        sheet.triangles.insert(sheet.triangles.end(), {{c, d, a}, {d, b, a}});
      else sheet.triangles.insert(sheet.triangles.end(), {{c, d, b}, {c, b, a}});
    }
    row = std::move(fresh);
  };
  release(run.start);
  size_t begun = 0;
  for (const Particle& q : sheet.particles) begun += q.started;
  run.require_some(begun);
  double now = run.start;
  run.each_interval([&](double until) {
    each_part(run.flow, now, until, r.spacing, [&](double t) {
      if (int64_t(sheet.particles.size()) > p.max_points)
        fail_usage(fmt::format("the surface has more than {} points", p.max_points), "streak_surface", "a larger spacing or max_points");
      advance(run.flow, sheet.particles, t, 1, run.options, context);
      release(t);
      UnsteadyCursor cursor(run.flow);
      sheet.refine(cursor, t, r.spacing, p.tear * r.spacing, size_t(p.max_points));
    });
    now = until;
  });
  const Field velocity = run.velocity();
  return surface_dataset(collect(sheet), velocity, run.start, run.time, true);
}

DatasetPtr time_surface(const Series& series, const std::vector<Data>& others, const TimeSurfaceParams& p, Context& context) {
  const double spacing = p.spacing.value_or(CurveRun::first_diagonal(series) / 100);
  std::vector<Vec3> at;
  std::vector<std::array<uint32_t, 3>> triangles;
  if (!others.empty()) {
    const DatasetPtr surface = surface_of(single_dataset(others[0], "time_surface"), context);
    const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
    for (size_t i = 0; i < mesh.points.count(); ++i) at.push_back(mesh.points.at(i));
    const Triangles all = triangles_of(mesh);
    for (size_t t = 0; t < all.count(); ++t) triangles.push_back({all.indices[3 * t], all.indices[3 * t + 1], all.indices[3 * t + 2]});
    if (triangles.empty()) fail_usage("the second input has no surface", "time_surface");
  } else {
    if (!p.center || p.size.size() != 2)
      fail_usage("needs a surface to begin with", "time_surface", "a second input, or center=x,y,z normal=x,y,z size=a,b");
    const Vec3 n = normalize(p.normal.value_or(Vec3(0, 0, 1))),
               u = normalize(cross(std::abs(n.y) < 0.9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1), n));
    const Vec3 w = cross(n, u);
    const size_t nu = size_t(std::max(1.0, std::ceil(p.size[0] / spacing))), nw = size_t(std::max(1.0, std::ceil(p.size[1] / spacing)));
    for (size_t j = 0; j <= nw; ++j)
      for (size_t i = 0; i <= nu; ++i)
        at.push_back(*p.center + u * (p.size[0] * (double(i) / double(nu) - 0.5)) + w * (p.size[1] * (double(j) / double(nw) - 0.5)));
    for (size_t j = 0; j < nw; ++j)
      for (size_t i = 0; i < nu; ++i) {
        const auto a = uint32_t(i + (nu + 1) * j), b = a + 1, c = uint32_t(a + nu + 1), d = c + 1;
        triangles.insert(triangles.end(), {{a, b, d}, {a, d, c}});
      }
  }
  UnsteadyRun run(series, {}, run_params(p, at), "time_surface", false, context);
  Sheet sheet;
  {
    UnsteadyCursor cursor(run.flow);
    size_t begun = 0;
    for (size_t i = 0; i < at.size(); ++i) {
      sheet.add(at[i], run.start, double(i) / double(at.size()));
      begun += detail::start_particle(cursor, sheet.particles.back());
    }
    run.require_some(begun);
    sheet.triangles = std::move(triangles);
    sheet.refine(cursor, run.start, spacing, HUGE_VAL, size_t(p.max_points));
  }
  double now = run.start;
  run.each_interval([&](double until) {
    each_part(run.flow, now, until, spacing, [&](double t) {
      if (int64_t(sheet.particles.size()) > p.max_points)
        fail_usage(fmt::format("the surface has more than {} points", p.max_points), "time_surface", "a larger spacing or max_points");
      advance(run.flow, sheet.particles, t, 1, run.options, context);
      UnsteadyCursor cursor(run.flow);
      sheet.refine(cursor, t, spacing, p.tear * spacing, size_t(p.max_points));
    });
    now = until;
  });
  const Field velocity = run.velocity();
  return surface_dataset(collect(sheet), velocity, run.start, run.time, false);
}

}  // namespace sg
