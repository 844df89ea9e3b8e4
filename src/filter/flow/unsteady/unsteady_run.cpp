// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/unsteady/unsteady_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/fields/known_looks.h"
#include "filter/flow/geographic.h"
#include "filter/flow/line_mesh.h"

namespace sg {

void describe(Schema& s, UnsteadyParams& p, const std::string& start, const std::string& time) {
  s("field", p.field, "Velocity: point or cell field of 2 or 3 components; default: the active vectors.").takes(fields::vectors);
  s("times", p.times,
    "Time steps, FIRST:LAST:COUNT or a list; default: those of the file. Required for sources that can be computed for any time.")
      .unit("time");
  s("start", p.start, start).unit("time");
  s("time", p.time, time).unit("time");
  s("interpolation", p.interpolation,
    "Interpolation between time steps: linear through two, or cubic through four (smooth, for steps far apart).");
  describe(s, p.integration);
  s("max_steps", p.max_steps, "Maximum number of steps of a particle.").range(1, 1e9);
  describe(s, p.seeds);
  s("geographic", p.geographic,
    "x and y are in degrees and the velocity is in m/s: convert it, in the file's unit of time (lengths stay in degrees).");
  s("attributes", p.attributes, "Fields carried besides velocity and time: the mesh's other fields.");
}

namespace {

constexpr double most_cells_passed = 1e9;

double checked_time(const UnsteadyFlow& flow, std::optional<double> t, double otherwise, const char* name, const std::string& who) {
  if (!t) return otherwise;
  if (!std::isfinite(*t) || !flow.covers(*t))
    fail_usage(fmt::format("{}={} lies outside the series", name, exact_number(*t)), who,
               fmt::format("the series runs from {} to {}", exact_number(flow.times().front()), exact_number(flow.times().back())));
  return *t;
}

}  // namespace

UnsteadyRun::UnsteadyRun(const Series& series, const std::vector<Data>& others, const UnsteadyParams& p, std::string who, bool backward,
                         Context& context)
    : flow(series, p.field.name, p.interpolation, context, p.geographic),
      who_(std::move(who)),
      geographic_(p.geographic),
      context_(context) {
  if (others.size() > 1) fail_usage(fmt::format("takes a series and one mesh of seeds, but got {} more", others.size()), who_);
  start = checked_time(flow, p.start, flow.times().front(), "start", who_);
  time = checked_time(flow, p.time, flow.times().back(), "time", who_);
  sign = time >= start ? 1 : -1;
  if (sign < 0 && !backward)
    fail_usage(fmt::format("the time shown, {}, lies before the start, {}", exact_number(time), exact_number(start)), who_,
               "use pathlines to go backwards");
  StopParams stop;
  stop.max_steps = p.max_steps;
  IntegrationParams integration = p.integration;
  if (!integration.max_step)
    integration.max_step = std::max(4 * integration.step, integration.min_step.value_or(0));  // intervals bound steps too
  options = trace_options(integration, stop, 0);
  carries = std::find(p.attributes.begin(), p.attributes.end(), CarriedAttribute::fields) != p.attributes.end();
  flow.open(flow.interval_of(start, sign), context);
  check_way(flow.steps()[flow.base()], time - start, most_cells_passed, options, who_);
  if (!geographic_) warn_of_degrees(*flow.steps()[flow.base()].dataset(), velocity(), who_, context);
  UnsteadyCursor cursor(flow);
  const double largest = flow.largest_speed();
  const SeedPlace flows = [&](Vec3 x) {
    Vec3 v;
    return cursor(x, start, v) && (length(v) > 1e-3 * largest || !(largest > 0));
  };
  std::vector<Data> inputs{Data()};
  inputs.insert(inputs.end(), others.begin(), others.end());
  const size_t nearest = start - flow.begin() <= flow.end() - start ? flow.base() : flow.base() + 1;
  seeds = make_seeds(p.seeds, {flow.steps()[nearest].dataset()}, seed_mesh_of(inputs, who_), flows, context);
}

DatasetPtr UnsteadyRun::finished(DatasetPtr traced) const {
  return geographic_ ? in_metres(traced, velocity().name, flow.seconds()) : traced;
}

void UnsteadyRun::require_some(size_t started) const {
  if (started > 0) return;
  const Box3& b = flow.steps()[flow.base()].dataset()->bounds();
  fail_usage(fmt::format("none of {} seeds lies in the flow", seeds.size()), who_,
             fmt::format("the mesh extends over x {:.6g} to {:.6g}, y {:.6g} to {:.6g}, z {:.6g} to {:.6g}; there is no flow in hidden "
                         "cells and where values are NaN",
                         b.lo.x, b.hi.x, b.lo.y, b.hi.y, b.lo.z, b.hi.z));
}

namespace {

Points positions(const std::vector<Vec3>& x) {
  Box3 box;
  for (const Vec3& p : x) box.add(p);
  Points points;
  float* xyz = nullptr;
  points.xyz = Array::make<float>(x.size(), 3, &xyz);
  points.origin = near_origin(box);
  parallel_for(x.size(), 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      for (int a = 0; a < 3; ++a) xyz[3 * i + size_t(a)] = float(x[i][a] - points.origin[a]);
  });
  return points;
}

FieldSet point_fields(const LinePoints& lines, Field first, const Field& velocity, FieldSet more) {
  const size_t n = lines.x.size();
  float *speed = nullptr, *v = nullptr;
  FieldSet fields;
  if (!first.name.empty()) first.name = own_value(first.name, velocity.name), fields.add(std::move(first));
  const Role role = fields.empty() ? Role::scalars : Role::none;
  fields.add(
      {own_value("speed", velocity.name), Association::point, Array::make<float>(n, 1, &speed), velocity.unit, role, known_look("speed")});
  fields.add({velocity.name, Association::point, Array::make<float>(n, 3, &v), velocity.unit, Role::vectors});
  parallel_for(n, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (int a = 0; a < 3; ++a) v[3 * i + size_t(a)] = float(lines.v[i][a]);
      speed[i] = float(length(lines.v[i]));
    }
  });
  for (const Field& f : more)
    if (!fields.find(f.name, f.association)) fields.add(f);
  return fields;
}

}  // namespace

DatasetPtr lines_of(const LinePoints& lines, Field first, const Field& velocity, double time, FieldSet more, std::vector<Field> per_line,
                    const char* id) {
  SurfaceMesh mesh;
  mesh.points = positions(lines.x);
  // Vertices come before lines: that is how cells of a surface are numbered.
  std::vector<size_t> order;
  order.reserve(lines.lines());
  std::vector<int64_t> vertices, ids, offsets{0};
  ids.reserve(lines.x.size());
  for (size_t l = 0; l < lines.lines(); ++l)
    if (lines.begin[l + 1] - lines.begin[l] == 1) vertices.push_back(int64_t(lines.begin[l])), order.push_back(l);
  for (size_t l = 0; l < lines.lines(); ++l) {
    if (lines.begin[l + 1] - lines.begin[l] < 2) continue;
    for (size_t i = lines.begin[l]; i < lines.begin[l + 1]; ++i) ids.push_back(int64_t(i));
    offsets.push_back(int64_t(ids.size()));
    order.push_back(l);
  }
  if (!vertices.empty()) mesh.vertices.connectivity = Array::from_vector(std::move(vertices)), mesh.vertices.fixed = 1;
  mesh.lines.connectivity = Array::from_vector(std::move(ids));
  mesh.lines.offsets = Array::from_vector(std::move(offsets));
  FieldSet fields = point_fields(lines, std::move(first), velocity, std::move(more));
  per_line.push_back({id, Association::cell, Array::from_vector(lines.seed), "", Role::none});
  for (Field& f : per_line) {
    if (f.array.count() != lines.lines()) fail_internal("one value per line", f.name);
    const size_t size = element_size(f.array.type());
    const Array from = f.array.made_packed();
    std::byte* to = nullptr;
    f.array = Array::make_raw(from.type(), order.size(), 1, &to);
    for (size_t i = 0; i < order.size(); ++i) std::memcpy(to + i * size, from.raw() + order[i] * size, size);
    f.association = Association::cell;
    fields.add(std::move(f));
  }
  DatasetParts parts{std::move(mesh), std::move(fields), {}, {}, {}, time};
  return make_dataset(std::move(parts));
}

DatasetPtr points_of(const LinePoints& lines, Field first, const Field& velocity, double time, FieldSet more) {
  PointCloud cloud;
  cloud.points = positions(lines.x);
  std::vector<int64_t> seed(lines.x.size());
  for (size_t l = 0; l < lines.lines(); ++l)
    for (size_t i = lines.begin[l]; i < lines.begin[l + 1]; ++i) seed[i] = lines.seed[l];
  FieldSet fields = point_fields(lines, std::move(first), velocity, std::move(more));
  fields.add({"seed", Association::point, Array::from_vector(std::move(seed)), "", Role::none});
  DatasetParts parts{std::move(cloud), std::move(fields), {}, {}, {}, time};
  return make_dataset(std::move(parts));
}

}  // namespace sg
