// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/unsteady_surfaces.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "filter/flow/fronts/default_curve.h"
#include "filter/flow/fronts/sheet.h"
#include "filter/flow/fronts/surface_run.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/mesh/surface.h"

namespace sg {

namespace {

void describe_shared(Schema& s, UnsteadySurfaceParams& p) {
  s("field", p.field, "Velocity: point or cell field of 2 or 3 components; default: the active vectors.").takes(fields::vectors);
  s("times", p.times, "Time steps, FIRST:LAST:COUNT or a list; default: those of the file.").unit("time");
  s("start", p.start, "Time at which the surface begins; default: the first time of the series.").unit("time");
  s("time", p.time, "Time at which it ends; default: the last time of the series.").unit("time");
  s("interpolation", p.interpolation, "Interpolation between time steps.");
  describe(s, p.integration);
  s("geographic", p.geographic, "x and y are in degrees and the velocity is in m/s: convert it.");
  s("spacing", p.spacing, "Maximum edge length of the surface; default: a 100th of the mesh's diagonal.").unit("length").positive();
  s("tear", p.tear, "Gaps wider than this many spacings that cannot be filled are left open.").range(1, 1e6);
  s("max_points", p.max_points, "Maximum number of points of the surface.").range(4, 1e9);
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

// The points and triangles of a mesh's surface.
void given_surface(const Data& data, std::vector<Vec3>& at, std::vector<std::array<uint32_t, 3>>& triangles, Context& context) {
  const DatasetPtr surface = surface_of(single_dataset(data, "time_surface"), context);
  const SurfaceMesh& mesh = *surface->as<SurfaceMesh>();
  for (size_t i = 0; i < mesh.points.count(); ++i) at.push_back(mesh.points.at(i));
  const Triangles all = triangles_of(mesh);
  for (size_t t = 0; t < all.count(); ++t) triangles.push_back({all.indices[3 * t], all.indices[3 * t + 1], all.indices[3 * t + 2]});
  if (triangles.empty()) fail_usage("the second input has no surface", "time_surface");
}

// The rectangle of the parameters.
void rectangle(TimeSurfaceParams p, const Series& series, double spacing, std::vector<Vec3>& at,
               std::vector<std::array<uint32_t, 3>>& triangles, Context& context) {
  if (!p.center && !p.normal && p.size.empty()) {
    const SeedRectangle r =
        rectangle_across_the_flow(flow_at(series, p.start, p.field.name, "time_surface", context), "time_surface", context);
    p.center = r.center, p.normal = r.normal, p.size = {r.size[0], r.size[1]};
  }
  if (!p.center || p.size.size() != 2)
    fail_usage("needs a surface to begin with", "time_surface", "give one as a second input, or center=x,y,z normal=x,y,z size=a,b");
  const auto [u, w] = rectangle_sides(normalize(p.normal.value_or(Vec3(0, 0, 1))));
  const double along = std::max(1.0, std::ceil(p.size[0] / spacing)), across = std::max(1.0, std::ceil(p.size[1] / spacing));
  if (!((along + 1) * (across + 1) <= 1e7))
    fail_usage(fmt::format("{:.3g} seeds are too many", (along + 1) * (across + 1)), "time_surface",
               "use a larger spacing or a smaller size");
  const auto nu = size_t(along), nw = size_t(across);
  for (size_t j = 0; j <= nw; ++j)
    for (size_t i = 0; i <= nu; ++i)
      at.push_back(*p.center + u * (p.size[0] * (double(i) / double(nu) - 0.5)) + w * (p.size[1] * (double(j) / double(nw) - 0.5)));
  for (size_t j = 0; j < nw; ++j)
    for (size_t i = 0; i < nu; ++i) {
      const auto a = uint32_t(i + (nu + 1) * j), b = a + 1, c = uint32_t(a + nu + 1), d = c + 1;
      triangles.insert(triangles.end(), {{a, b, d}, {a, d, c}});
    }
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
  s("center", p.center, "Centre of a rectangle to start from; default: in the middle of the mesh, across the flow.").unit("length");
  s("normal", p.normal, "Its normal; default: z.");
  s("size", p.size, "Lengths of its two edges.").unit("length").at_least(0);
}

DatasetPtr streak_surface(const Series& series, const std::vector<Data>& others, const StreakSurfaceParams& p, Context& context) {
  CurveRun r(series, others, p, p.curve, "streak_surface", context);
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
  each_part(
      run, r.spacing, p.max_points, "streak_surface", [&] { return sheet.particles.size(); },
      [&](double t) {
        advance(run.flow, sheet.particles, t, 1, run.options, context);
        release(t);
        UnsteadyCursor cursor(run.flow);
        sheet.refine(cursor, t, r.spacing, p.tear * r.spacing, size_t(p.max_points));
      });
  return run.finished(surface_dataset(collect(sheet), run.velocity(), run.start, run.time, true));
}

DatasetPtr time_surface(const Series& series, const std::vector<Data>& others, const TimeSurfaceParams& p, Context& context) {
  const double spacing = p.spacing.value_or(first_diagonal(series) / 100);
  std::vector<Vec3> at;
  std::vector<std::array<uint32_t, 3>> triangles;
  if (others.empty()) rectangle(p, series, spacing, at, triangles, context);
  else given_surface(others[0], at, triangles, context);
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
  each_part(
      run, spacing, p.max_points, "time_surface", [&] { return sheet.particles.size(); },
      [&](double t) {
        advance(run.flow, sheet.particles, t, 1, run.options, context);
        UnsteadyCursor cursor(run.flow);
        sheet.refine(cursor, t, spacing, p.tear * spacing, size_t(p.max_points));
      });
  return run.finished(surface_dataset(collect(sheet), run.velocity(), run.start, run.time, false));
}

}  // namespace sg
