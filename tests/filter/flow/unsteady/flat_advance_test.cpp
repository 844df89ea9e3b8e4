// SPDX-License-Identifier: Apache-2.0
// Particles in the plane, side by side in the lanes of vectors, against the general way.
#include <fmt/core.h>
#include <hwy/targets.h>

#include <cstring>

#include "base/parallel.h"
#include "base/text/text.h"
#include "filter/flow/unsteady/advance_one.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/unsteady_inputs.h"
#include "support/test.h"

using namespace sg;
using test::even_times;

namespace {

// In a plane across `flat`, with velocities of two or three components.
struct Plane {
  int flat = 2, components = 3;
  bool cubic = false, hole = false;
  int a() const { return flat == 0 ? 1 : 0; }
  int b() const { return flat == 2 ? 1 : 2; }
};

Vec3 swirl(const Plane& p, Vec3 x, double t) {
  const double u = x[p.a()], w = x[p.b()];
  Vec3 v(0, 0, 0);
  v[p.a()] = 1.5 * std::sin(2 * w + t) + 0.3, v[p.b()] = 1.5 * std::cos(1.5 * u - t);
  if (p.hole && length(x - Vec3(0.5, 0.5, 0.5)) < 0.4) v[p.a()] = NAN;
  return v;
}

constexpr size_t intervals = 4;

Series series_of(const Plane& p) {
  UniformGrid g;
  g.dims = {41, 37, 33}, g.origin = {-2, -2, -2}, g.spacing = {0.1, 0.11, 0.12};
  g.dims[size_t(p.flat)] = 1, g.origin[p.flat] = 0.5;
  auto steps = std::make_shared<std::vector<DatasetPtr>>();
  Series s;
  s.times = {0, 0.3, 0.5, 0.9, 1.2};
  for (const double t : s.times) {
    const DatasetPtr d = test::with_velocity(
        g, [&](Vec3 x) { return swirl(p, x, t); }, true);
    DatasetParts parts = d->parts();
    Field f = parts.fields.require("velocity");
    if (p.components == 2) {
      std::vector<float> two;
      for (size_t i = 0; i < f.array.count(); ++i)
        for (int c = 0; c < 2; ++c) two.push_back(float(f.array.get(i, c)));
      f.array = Array::from_vector(std::move(two), 2);
    }
    parts.fields.add(f);
    steps->push_back(make_dataset(std::move(parts)));
  }
  s.load = [steps](size_t k) -> Data { return (*steps)[k]; };
  return s;
}

TraceOptions options_of(const char* unit = "cells", double step = 0.5) {
  IntegrationParams integration;
  integration.step_unit = *value_of_word<StepUnit>(unit), integration.step = step;
  StopParams stop;
  stop.max_steps = 100000;
  return trace_options(integration, stop, 1);
}

std::vector<Particle> seeds_of(const Plane& p, double t) {
  std::vector<Particle> all;
  for (int j = -2; j < 63; ++j)
    for (int i = 0; i < 71; ++i) {
      Particle q;
      q.x[p.a()] = -1.97 + 0.0557 * i, q.x[p.b()] = -1.96 + 0.0613 * j, q.x[p.flat] = 0.5 + (i % 5 == 0 ? 0.01 : 0.0);
      if (i == 7) q.x[p.flat] = 0.9;  // beside it
      q.t = t;
      all.push_back(q);
    }
  return all;
}

using Advance = std::function<void(const UnsteadyFlow&, std::vector<Particle>&, double, int, Context&)>;

std::vector<Particle> carried(const Plane& p, int sign, const Advance& advance) {
  Context context;
  UnsteadyFlow flow(series_of(p), "velocity", p.cubic ? TimeInterpolation::cubic : TimeInterpolation::linear, context);
  std::vector<Particle> all = seeds_of(p, sign > 0 ? 0 : 1.2);
  for (size_t i = 0; i < all.size(); i += 6) all[i].t = sign > 0 ? 0.4 : 0.7;  // these wait
  for (size_t n = 0; n < intervals; ++n) {
    flow.open(sign > 0 ? n : intervals - 1 - n, context);
    advance(flow, all, sign > 0 ? flow.end() : flow.begin(), sign, context);
  }
  return all;
}

void one_by_one(const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int sign, const TraceOptions& o) {
  for (Particle& p : all) {
    UnsteadyCursor cursor(flow);
    if (p.ended || (until - p.t) * sign < 0) continue;
    if (p.started) {
      Vec3 v;
      cursor(p.x, p.t, v);
    } else if (!detail::start_particle(cursor, p)) {
      continue;
    }
    detail::advance_one(cursor, p, until, o, [](const Particle&) {});
  }
}

bool same(const Particle& a, const Particle& b) {
  return std::memcmp(&a.x, &b.x, sizeof a.x) == 0 && std::memcmp(&a.v, &b.v, sizeof a.v) == 0 && a.t == b.t && a.next == b.next &&
         a.steps == b.steps && a.started == b.started && a.ended == b.ended && a.why == b.why;
}
bool same(const std::vector<Particle>& a, const std::vector<Particle>& b) {
  bool all = a.size() == b.size();
  for (size_t i = 0; i < a.size() && all; ++i) all = same(a[i], b[i]);
  return all;
}

}  // namespace

TEST_CASE("flat grids: particles side by side go where the scalar reference goes") {
  const TraceOptions o = options_of();
  for (const Plane& plane : {Plane{2, 3, false}, Plane{2, 2, false}, Plane{0, 3, false}, Plane{1, 3, false}, Plane{2, 2, true},
                             Plane{2, 3, true}, Plane{0, 3, true}, Plane{2, 3, false, true}, Plane{0, 3, true, true}})
    for (const int sign : {1, -1}) {
      const std::string what =
          fmt::format("across {}, {} components, cubic {}, hole {}, sign {}", plane.flat, plane.components, plane.cubic, plane.hole, sign);
      CAPTURE(what);
      const auto got =
          carried(plane, sign, [&](const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int s, Context& context) {
            advance(flow, all, until, s, o, context);
          });
      const auto want = carried(plane, sign, [&](const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int s, Context&) {
        one_by_one(flow, all, until, s, o);
      });
      REQUIRE(got.size() == want.size());
      size_t arrived = 0, left = 0, never = 0, other = 0, steps = 0;
      double worst = 0, speed = 0;
      for (size_t i = 0; i < got.size(); ++i) {
        const Particle &a = got[i], &b = want[i];
        if (i % 71 == 7) {  // of these the general way takes the nearest place of the plane
          CHECK(a.ended);
          ++never;
          continue;
        }
        CHECK(a.started == b.started);
        other += a.ended != b.ended, steps += a.steps != b.steps;
        if (a.ended != b.ended) continue;
        if (!a.started) {
          ++never;
        } else if (a.ended) {
          ++left;
          CHECK(a.why == b.why);
          CHECK(std::abs(a.t - b.t) < 0.02);
        } else {
          ++arrived;
          CHECK(a.t == b.t);
          worst = std::max(worst, length(a.x - b.x)), speed = std::max(speed, length(a.v - b.v));
        }
      }
      CHECK(arrived > 500);
      CHECK(left > 200);
      CHECK(never > 60);
      // Velocities are interpolated in f32: 1e-7 of the largest at each stage. Across y (not side by side) steps are sized
      // by another root.
      CHECK(other <= got.size() / 500);
      CHECK(steps <= got.size() / 20);
      CHECK(worst < (plane.flat == 1 ? 1e-3 : 2e-6));
      CHECK(speed < (plane.flat == 1 ? 1e-3 : 4e-6));
    }
}

TEST_CASE("flat grids: steps by length and by time, and a life of few steps, as the scalar reference") {
  for (const char* unit : {"length", "time"}) {
    TraceOptions o = options_of(unit, 0.02);
    o.max_steps = 9;
    const Plane plane;
    const auto got = carried(plane, 1, [&](const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int s, Context& context) {
      advance(flow, all, until, s, o, context);
    });
    const auto want = carried(plane, 1, [&](const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int s, Context&) {
      one_by_one(flow, all, until, s, o);
    });
    size_t tired = 0, differ = 0;
    for (size_t i = 0; i < got.size(); ++i) {
      if (i % 71 == 7) continue;
      tired += got[i].ended && got[i].why == StopReason::steps;
      differ += got[i].ended != want[i].ended || got[i].why != want[i].why || got[i].steps != want[i].steps ||
                length(got[i].x - want[i].x) > 1e-4;
    }
    CHECK(tired > 1000);
    CHECK(differ <= got.size() / 100);
  }
}

TEST_CASE("flat grids: the same bytes for any number of threads and any width of vectors") {
  const TraceOptions o = options_of();
  for (const bool cubic : {false, true}) {
    const Plane plane{2, 3, cubic, true};
    Way way;
    const Advance advance_all = [&](const UnsteadyFlow& flow, std::vector<Particle>& all, double until, int s, Context& context) {
      advance(flow, all, until, s, o, context, &way);
    };
    set_thread_count(1);
    const auto want = carried(plane, 1, advance_all);
    const Way first = std::move(way);
    const auto check = [&] {
      way = {};
      const auto got = carried(plane, 1, advance_all);
      CHECK(same(want, got));
      CHECK(way.particle == first.particle);
      REQUIRE(way.size() == first.size());
      CHECK(std::memcmp(way.x.data(), first.x.data(), way.size() * sizeof(Vec3)) == 0);
      CHECK(std::memcmp(way.v.data(), first.v.data(), way.size() * sizeof(Vec3)) == 0);
    };
    CHECK(first.size() > want.size());
    set_thread_count(8);
    check();
    set_thread_count(0);
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const std::string name = hwy::TargetName(target);
      if (name == "SCALAR" || name == "EMU128" || name == "Scalar" || name == "Emu128") continue;
      hwy::SetSupportedTargetsForTest(target);
      hwy::GetChosenTarget().Update(target);
      CAPTURE(name);
      check();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
  }
}

TEST_CASE("flat grids: a particle's way does not depend on who goes beside it") {
  const TraceOptions o = options_of();
  const Plane plane;
  Context context;
  UnsteadyFlow flow(series_of(plane), "velocity", TimeInterpolation::linear, context);
  flow.open(0, context);
  std::vector<Particle> all = seeds_of(plane, 0), alone;
  for (size_t i = 3; i < all.size(); i += 91) alone.push_back(all[i]);
  advance(flow, all, flow.end(), 1, o, context);
  for (Particle& p : alone) advance(flow, std::span(&p, 1), flow.end(), 1, o, context);
  for (size_t i = 3, k = 0; i < all.size(); i += 91) CHECK(same(all[i], alone[k++]));
}
