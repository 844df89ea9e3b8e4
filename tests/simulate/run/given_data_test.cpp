// SPDX-License-Identifier: Apache-2.0
// Runs in given data: their states tell which data it was.
#include "simulate/run/given_data.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "filter/every_mesh.h"
#include "simulate/fluid/smoke.h"
#include "simulate/particles/bodies/spring_mesh.h"
#include "simulate/particles/meshes.h"
#include "simulate/particles/particle_run.h"
#include "simulate/pde/mesh/heat_on_mesh.h"
#include "simulate/run/stored.h"
#include "support/test.h"

using namespace sg;
using test::goes_on;

namespace {

// The same numbers with gaps between them, in memory of their own.
Array with_gaps(const Array& a) {
  if (a.empty()) return a;
  const size_t m = size_t(a.components()), size = element_size(a.type());
  const Array packed = a.made_packed();
  std::byte* to = nullptr;
  const Buffer buffer = Buffer::allocate(a.count() * (m + 1) * size, &to);
  for (size_t i = 0; i < a.count(); ++i) std::copy_n(packed.raw() + i * m * size, m * size, to + i * (m + 1) * size);
  return Array(buffer, a.type(), a.count(), int(m), 0, ptrdiff_t((m + 1) * size), ptrdiff_t(size));
}

DatasetPtr laid_out_otherwise(const DatasetPtr& d) {
  DatasetParts parts = d->parts();
  if (auto* g = std::get_if<CurvilinearGrid>(&parts.mesh)) g->points.xyz = with_gaps(g->points.xyz);
  if (auto* u = std::get_if<UnstructuredMesh>(&parts.mesh))
    u->points.xyz = with_gaps(u->points.xyz), u->cells.connectivity = u->cells.connectivity.converted(ElementType::i32);
  if (auto* s = std::get_if<SurfaceMesh>(&parts.mesh)) s->points.xyz = with_gaps(s->points.xyz);
  FieldSet fields;
  for (const Field& f : d->fields()) fields.add(f.with(with_gaps(f.array)));
  parts.fields = fields;
  return make_dataset(std::move(parts));
}

DatasetPtr with_scalar(const DatasetPtr& d, const std::string& name, double last) {
  DatasetParts parts = d->parts();
  std::vector<double> values(d->point_count());
  for (size_t i = 0; i < values.size(); ++i) values[i] = double(i % 7);
  values.back() = last;
  parts.fields.add({name, Association::point, Array::from_vector(std::move(values)), "", Role::none});
  return make_dataset(std::move(parts));
}

// Goes on in `data`, also where it lies otherwise in memory; is refused in `others`.
template <class Params, class Run>
void tells_data_apart(const std::string& name, const Params& p, const Params& other, const std::vector<Data>& data,
                      const std::vector<Data>& otherwise, const std::vector<std::vector<Data>>& others, Run&& run) {
  INFO(name);
  Params stored = p;
  stored.store = goes_on(name, p, other, [&](const Params& q) { return run(data, q); });
  Params plain = p;
  plain.time = stored.time = 9 * p.frame;
  const std::string unbroken = test::fields_of(run(data, plain));
  const std::string state = stored.store;
  run(data, other);
  CHECK(test::fields_of(run(otherwise, stored)) == unbroken);
  CHECK(StateFile(state).frame() == 9);
  stored.time = 11 * p.frame;
  for (const std::vector<Data>& o : others) {
    CHECK_THROWS_WITH_AS(run(o, stored), doctest::Contains("in other data"), Error);
    Params kept = stored;
    kept.store.clear(), kept.time = 10 * p.frame;
    run(o, kept);  // and where its run is in memory
    CHECK_THROWS_WITH_AS(run(o, stored), doctest::Contains("in other data"), Error);
  }
  Params different = stored;
  different.frame *= 2;
  CHECK_THROWS_WITH_AS(run(data, different), doctest::Contains("another run"), Error);
  CHECK(StateFile(state).frame() == 9);
}

}  // namespace

TEST_CASE("runs in given data: heat on every kind of mesh goes on, and other meshes and fields are told apart") {
  Context context;
  const auto run = [&](const std::vector<Data>& d, const HeatOnMeshParams& q) {
    return heat_on_mesh(single_dataset(d[0], "test"), q, context);
  };
  HeatOnMeshParams p, other;
  p.frame = 0.02, p.initial = "x+warm", p.source = "warm*sin(9*time)", p.held = "border && x>0", p.value = "time";
  other.initial = "x", other.frame = 0.5;
  for (const test::MeshKind& kind : test::every_mesh()) {
    const DatasetPtr mesh = kind.make(4, 1);
    if (mesh->as<AmrGrid>()) continue;
    const DatasetPtr d = with_scalar(mesh, "warm", 1);
    const std::vector<std::vector<Data>> others{{with_scalar(mesh, "warm", 2)}, {with_scalar(kind.make(4, 1.25), "warm", 1)}};
    for (const MeshHeatScheme scheme : {MeshHeatScheme::backward_euler, MeshHeatScheme::crank_nicolson}) {
      p.scheme = scheme;
      tells_data_apart(std::string("heat_") + kind.name, p, other, {d}, {laid_out_otherwise(d)}, others, run);
    }
    // A field that nothing names may be any.
    HeatOnMeshParams q = p;
    q.store = test::fresh_folder("stored_unused") + "run", q.time = 2 * q.frame;
    run({d}, q), run({d}, other);
    CHECK_NOTHROW(run({with_scalar(d, "cold", 5)}, q));
  }
}

TEST_CASE("runs in given data: air round a surface and smoke from it") {
  Context context;
  SmokeRoundParams p, other;
  p.size = 12, p.frame = 0.05, p.lift = 3, p.bounds = {-1.5, 1.5, -1.5, 1.5, -1.5, 3}, other.size = 4, other.bounds = p.bounds;
  const DatasetPtr ball = test::ball(2);
  const auto run = [&](const std::vector<Data>& d, const SmokeRoundParams& q) {
    return smoke_round(single_dataset(d[0], "test"), q, context);
  };
  p.source = {0, 0, -1.2, 0.2};
  tells_data_apart("smoke_round", p, other, {ball}, {laid_out_otherwise(ball)}, {{test::ball(1)}}, run);
  p.role = other.role = SurfaceRole::source;
  p.source.clear();
  tells_data_apart("smoke_round_source", p, other, {ball}, {laid_out_otherwise(ball)}, {{test::ball(1)}}, run);
}

TEST_CASE("runs in given data: smoke from the values of fields") {
  Context context;
  SmokeFromParams p, other;
  p.size = 12, p.frame = 0.05, p.lift = 3, p.field = {"soot"}, p.temperature_field = {"heat"}, other = p, other.size = 4;
  const DatasetPtr mesh = test::every_mesh()[0].make(4, 1);
  const DatasetPtr d = with_scalar(with_scalar(mesh, "soot", 1), "heat", 1);
  const auto run = [&](const std::vector<Data>& in, const SmokeFromParams& q) {
    return smoke_from(single_dataset(in[0], "test"), q, context);
  };
  tells_data_apart("smoke_from_field", p, other, {d}, {laid_out_otherwise(d)}, {{with_scalar(d, "heat", 2)}, {with_scalar(d, "soot", 2)}},
                   run);
}

TEST_CASE("runs in given data: particles in a wind that bounce off surfaces") {
  Context context;
  ParticlesInParams p, other;
  p.rate = 300, p.frame = 0.1, p.life = 0.6, p.drag = 3, p.emitter = {0, 0, 0.7, 0.1}, other.emitter = p.emitter, other.count = 3;
  const auto turning = [](double speed) { return test::wind(9, [=](Vec3 x) { return Vec3(-speed * x.y, speed * x.x, 0); }); };
  const DatasetPtr wind = turning(1), box = test::box({-0.3, -0.3, -0.5}, {0.3, 0.3, 0.1});
  const auto run = [&](const std::vector<Data>& d, const ParticlesInParams& q) { return particle_system_in(d, q, context); };
  tells_data_apart("particle_system_in", p, other, {wind, box}, {laid_out_otherwise(wind), laid_out_otherwise(box)},
                   {{turning(1.5), box}, {wind, test::box({-0.3, -0.3, -0.5}, {0.3, 0.3, 0.2})}, {wind}}, run);
  p.use = other.use = FieldUse::none;
  tells_data_apart("particles_on", p, other, {box}, {laid_out_otherwise(box)}, {{test::box({-0.3, -0.3, -0.5}, {0.3, 0.3, 0.2})}}, run);
}

TEST_CASE("runs in given data: cloth that falls on a ball") {
  Context context;
  SpringMeshParams p, other;
  p.frame = 0.02, p.step = 0.002, p.mass = 0.01, p.stiffness = 50, p.damping = 0.1, p.hold = {0}, other.mass = 5;
  const auto cloth = [](int n, double z) {
    DatasetParts parts = test::flat_surface("triangles", n, 0.8)->parts();
    std::get<SurfaceMesh>(parts.mesh).points.origin.z = z;
    return make_dataset(std::move(parts));
  };
  const DatasetPtr d = cloth(6, 1.05), ball = test::ball(2);
  const auto run = [&](const std::vector<Data>& in, const SpringMeshParams& q) { return spring_mesh(in, q, context); };
  for (const Integrator i : {Integrator::verlet, Integrator::backward_euler}) {
    p.integrator = i;
    tells_data_apart("spring_mesh", p, other, {d, ball}, {laid_out_otherwise(d), laid_out_otherwise(ball)},
                     {{cloth(6, 1.04), ball}, {d, test::ball(1)}, {ball, d}}, run);
  }
}
