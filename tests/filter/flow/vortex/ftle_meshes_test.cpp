// SPDX-License-Identifier: Apache-2.0
// FTLE on every kind of mesh (correctness.md F5, F6).
#include "filter/every_mesh.h"
#include "filter/flow/unsteady/unsteady_lines.h"
#include "filter/flow/vortex/ftle.h"
#include "filter/mesh/transform/transform.h"

using namespace sg;
using namespace sg::test;

namespace {

void check_even(const Data& data, bool flat, double rate) {
  for (const double duration : {1.2, -0.9}) {
    Context context;
    FtleParams p;
    p.duration = duration, p.dims = {3, 3, flat ? 1 : 2}, p.integration.tolerance = 1e-8;
    p.bounds = {-0.25, 0.35, -0.3, 0.2, flat ? 0 : -0.2, flat ? 0 : 0.2};
    const DatasetPtr d = ftle(steady_series(data), p, context);
    const Field &f = d->fields().require("ftle"), &along = d->fields().require("stretch direction");
    REQUIRE(f.array.count() == (flat ? 9 : 18));
    double worst = 0;
    for (size_t i = 0; i < f.array.count(); ++i) {
      const double off = std::abs(f.array.get(i) - rate) + std::abs(std::abs(along.array.get(i, duration > 0 ? 0 : 1)) - 1);
      worst = off <= worst ? worst : off;  // NaN too
    }
    CHECK(worst < 1e-5 * rate);
  }
}

}  // namespace

TEST_CASE("ftle meshes: of diag(l, -l) it is l everywhere, in every kind of mesh, for any duration (F5)") {
  const double rate = 0.5;
  const auto u = [&](Vec3 x) { return Vec3(rate * x.x, -rate * x.y, 0); };
  const auto with = [&](const DatasetPtr& d) { return flow::with_velocity(d, u); };
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    check_even(with(kind.make(5, 1)), kind.flat, rate);
  }
  for (const bool flat : {false, true}) {
    CAPTURE(flat);
    check_even(collection_of(halves(flat, 4, 1), with), flat, rate);
  }
}

TEST_CASE("ftle meshes: the double gyre has its known values in every kind of flat mesh, as well as it holds the flow (F6)") {
  const struct {
    Vec3 at;
    double ftle;
  } known[] = {{{0.25, 0.25, 0}, 0.295298}, {{1, 0.5, 0}, 0.0691409}};
  TransformParams place;
  place.scale = {1, 0.5, 1}, place.translate = {1, 0.5, 0};
  Context context;
  for (const MeshKind& kind : flat_meshes()) {
    CAPTURE(kind.name);
    const DatasetPtr mesh = transform(kind.make(48, 1), place, context);
    std::vector<DatasetPtr> all;
    Series series;
    series.times = even_times(0, 15, 31);
    for (const double t : series.times) all.push_back(flow::with_velocity(mesh, [t](Vec3 x) { return unsteady::gyre(x, t); }));
    series.load = [&](size_t k) -> Data { return all[k]; };
    for (const auto& k : known) {
      FtleParams p;
      p.duration = 15, p.interpolation = TimeInterpolation::cubic, p.offset = 5e-4, p.dims = {2, 2, 1};
      p.integration.integrator = Scheme::rk4, p.integration.step = 0.25, p.integration.step_unit = StepUnit::time;
      p.bounds = {k.at.x, k.at.x + 0.01, k.at.y, k.at.y + 0.01, 0, 0};
      const DatasetPtr d = ftle(series, p, context);
      // The values at Bezier points are not those of the flow but of a smoothed one.
      const double exact = kind.name.find("bezier") == 0 ? 0.08 : 0.05;
      CHECK(d->fields().require("ftle").array.get(0) == doctest::Approx(k.ftle).epsilon(exact));
    }
  }
}
