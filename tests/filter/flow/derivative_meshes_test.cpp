// SPDX-License-Identifier: Apache-2.0
// Divergence, curl and vortex measures on every kind of mesh (correctness.md F4).
#include "filter/every_mesh.h"

#include <numbers>
#include "filter/field/derivatives/derivatives.h"
#include "filter/flow/vortex/measures.h"
#include "filter/stats/integrate.h"

using namespace sg;
using namespace sg::test;

namespace {

using std::numbers::pi;

Vec3 abc(Vec3 p) {
  const double a = std::sqrt(3.0), b = std::sqrt(2.0);
  return {a * std::sin(p.z) + std::cos(p.y), b * std::sin(p.x) + a * std::cos(p.z), std::sin(p.y) + b * std::cos(p.x)};
}

Vec3 vector(const Field& f, size_t i) { return {f.array.get(i, 0), f.array.get(i, 1), f.array.get(i, 2)}; }

/// Root mean square of what divergence and curl lack of those of the ABC flow, at the points inside.
std::pair<double, double> abc_errors(const MeshKind& kind, int n) {
  Context context;
  const DatasetPtr d = flow::with_velocity(kind.make(n, 1), abc);
  const DatasetPtr both = curl(divergence(d, {{"u"}, "d"}, context), {{"u"}, "c"}, context);
  const Field &div = both->fields().require("d", Association::point), &rot = both->fields().require("c", Association::point);
  const Array at = point_positions(d->mesh());
  double dd = 0, cc = 0, count = 0;
  for (size_t i = 0; i < at.count(); ++i) {
    const Vec3 p(at.get(i, 0), at.get(i, 1), at.get(i, 2));
    if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.6) continue;
    const Vec3 off = vector(rot, i) - abc(p);
    dd += div.array.get(i) * div.array.get(i), cc += dot(off, off), count += 1;
  }
  return {std::sqrt(dd / count), std::sqrt(cc / count)};
}

}  // namespace

TEST_CASE("derivative meshes: those of a linear flow are exact in every kind of mesh, on points and on cells") {
  // du_i/dx_k, for flat meshes without z.
  const double g[3][3] = {{0.5, -1.2, 0.7}, {2, 0.3, -0.4}, {-0.6, 1.1, 0.9}};
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const int axes = kind.flat ? 2 : 3;
    const auto u = [&](Vec3 p) {
      Vec3 v;
      for (int i = 0; i < axes; ++i)
        for (int k = 0; k < axes; ++k) v[i] += g[i][k] * p[k];
      return v;
    };
    const DatasetPtr points = flow::with_velocity(kind.make(4, 1), u);
    const double trace = g[0][0] + g[1][1] + (kind.flat ? 0 : g[2][2]);
    const Vec3 spin = kind.flat ? Vec3(0, 0, g[1][0] - g[0][1]) : Vec3(g[2][1] - g[1][2], g[0][2] - g[2][0], g[1][0] - g[0][1]);
    for (const DatasetPtr& d : {points, on_cells(points)}) {
      const bool cells = d != points;
      if (cells && kind.name == "strips") continue;  // each is a whole row: their middles lie on one line
      CAPTURE(cells);
      Context context;
      const Association on = cells ? Association::cell : Association::point;
      const DatasetPtr m = vortex_measures(d, {{"u"}, {VortexMeasure::vorticity, VortexMeasure::divergence}}, context);
      const DatasetPtr own = curl(divergence(d, {{"u"}, "d"}, context), {{"u"}, "c"}, context);
      const FieldSet &a = m->fields(), &b = own->fields();
      const Field &div = a.require("divergence", on), &rot = a.require("vorticity", on), &d_own = b.require("d", on),
                  &c = b.require("c", on);
      double worst = 0;
      for (size_t i = 0; i < div.array.count(); ++i) {
        const double off = std::abs(div.array.get(i) - trace) + length(vector(rot, i) - spin) + std::abs(d_own.array.get(i) - trace) +
                           length(vector(c, i) - spin);
        worst = off <= worst ? worst : off;  // NaN too
      }
      CHECK(worst < 1e-8);
    }
  }
}

TEST_CASE("derivative meshes: the ABC flow has no divergence and is its own curl, with order 2, in every kind of solid mesh (F4)") {
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    const int n = kind.name.find("lagrange") == 0 ? 6 : 5;  // of order 3: thirds of it
    const auto [div0, rot0] = abc_errors(kind, n);
    const auto [div1, rot1] = abc_errors(kind, 2 * n);
    CHECK(std::log2(rot0 / rot1) > 1.6);
    if (div1 > 1e-12) CHECK(std::log2(div0 / div1) > 1.6);  // else each component's differences vanish by themselves
    CHECK(rot1 < 0.05);
    CHECK(div1 < 0.01);
  }
}

TEST_CASE("derivative meshes: the mean square of the ABC flow is a^2 + b^2 + c^2 in every kind of solid mesh (F4)") {
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    if (kind.name == "rotated" || kind.name == "curvilinear" || kind.name.find("bent") == 0 || kind.name.find("curved") == 0) continue;
    Context context;
    const DatasetPtr d = with_values(kind.make(6, pi), "s", 1, [](Vec3 p, double* v) { *v = dot(abc(p), abc(p)); });
    const TablePtr t = integrate(d, {{"s"}}, context);
    CHECK(shapes::number(*t, "mean", 1) == doctest::Approx(6).epsilon(1e-12));
  }
}
