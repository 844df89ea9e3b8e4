// SPDX-License-Identifier: Apache-2.0
// Boussinesq's point load on every kind of solid mesh (correctness.md section 3).
#include "filter/every_mesh.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/mesh/slice/slice.h"
#include "filter/mesh/transform/transform.h"
#include "filter/stats/integrate.h"
#include "filter/tensor/lines/hyperstreamlines.h"
#include "filter/tensor/stress_measures.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

constexpr double P = 2, nu = 0.3;

/// A force P at the origin presses along +z into z >= 0 (Timoshenko, Goodier, art. 138), here by the radial and the ring part of the
/// stress in cylinder coordinates, the way that the book has it.
SymTensor stress(Vec3 p) {
  const double z = p.z, r2 = p.x * p.x + p.y * p.y, r = std::sqrt(r2), R2 = r2 + z * z, R = std::sqrt(R2), R3 = R2 * R, R5 = R3 * R2;
  const double q = P / (2 * M_PI), k = 1 - 2 * nu;
  // (1/r^2 - z/(R r^2)) = 1/(R (R + z)), which has a value on the axis.
  const double bowl = 1 / (R * (R + z));
  const double rr = q * (k * bowl - 3 * z * r2 / R5), ring = q * k * (z / R3 - bowl), zz = -3 * q * z * z * z / R5,
               rz = -3 * q * r * z * z / R5;
  const double c = r > 0 ? p.x / r : 1, s = r > 0 ? p.y / r : 0;
  return {rr * c * c + ring * s * s, rr * s * s + ring * c * c, zz, (rr - ring) * c * s, rz * s, rz * c};
}

DatasetPtr loaded(const MeshKind& kind, int n, double r, Vec3 middle) {
  Context context;
  TransformParams place;
  place.translate = middle;
  return with_values(
      transform(kind.make(n, r), place, context), "stress", 9,
      [](Vec3 p, double* v) {
        const SymTensor t = stress(p);
        const double all[9] = {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz};
        std::copy_n(all, 9, v);
      },
      Role::tensors);
}

}  // namespace

TEST_CASE("point load meshes: on the axis s_zz = -3P/(2 pi z^2), s_xx = (1-2 nu) P/(4 pi z^2), along the line of compression") {
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    Context context;
    HyperstreamlinesParams p;
    p.eigenvector = 3, p.section = TensorSection::line, p.seeds = {0, 0, 2.5};
    const DatasetPtr l = hyperstreamlines(loaded(kind, 8, 1, {0, 0, 2.5}), p, context);
    const auto& points = l->as<SurfaceMesh>()->points;
    REQUIRE(points.count() > 6);
    double aside = 0, zz = 0, xx = 0, lowest = 9, highest = 0;
    for (size_t i = 0; i < points.count(); ++i) {
      const Vec3 x = points.at(i);
      lowest = std::min(lowest, x.z), highest = std::max(highest, x.z);
      if (x.z < 1.55) continue;  // the turned grid reaches nearer to the load, which its cells are too large for
      const double z2 = x.z * x.z;
      aside = std::max(aside, std::hypot(x.x, x.y));
      zz = std::max(zz, std::abs(l->fields().require("eigenvalue").array.get(i) / (-3 * P / (2 * M_PI * z2)) - 1));
      for (const char* name : {"eigenvalue 1", "eigenvalue 2"})
        xx = std::max(xx, std::abs(l->fields().require(name).array.get(i) / ((1 - 2 * nu) * P / (4 * M_PI * z2)) - 1));
    }
    CHECK(aside < 0.03);
    CHECK(zz < 0.04);
    CHECK(xx < 0.16);  // a sixteenth of s_zz, so that the same errors count more
    CHECK(lowest < 1.65);
    CHECK(highest > 3.35);
  }
}

TEST_CASE("point load meshes: the forces balance, div s = 0, with order 2") {
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    double off[2];
    for (int k = 0; k < 2; ++k) {
      const int n = (kind.name.find("lagrange") == 0 ? 6 : 5) << k;
      Context context;
      const DatasetPtr d = gradient(loaded(kind, n, 0.5, {0.8, 0.5, 2}), {{"stress"}, "g"}, context);
      const Array &g = d->fields().require("g", Association::point).array, at = point_positions(d->mesh());
      REQUIRE(g.components() == 27);
      double sum = 0, count = 0;
      for (size_t i = 0; i < g.count(); ++i) {
        const Vec3 p(at.get(i, 0) - 0.8, at.get(i, 1) - 0.5, at.get(i, 2) - 2);
        if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.3) continue;
        for (int row = 0; row < 3; ++row) {
          double div = 0;
          for (int a = 0; a < 3; ++a) div += g.get(i, 3 * (3 * row + a) + a);
          sum += div * div;
        }
        count += 1;
      }
      off[k] = std::sqrt(sum / count);
    }
    CHECK(std::log2(off[0] / off[1]) > 1.5);
    CHECK(off[1] < 0.003);
  }
}

TEST_CASE("point load meshes: the surface is free of traction, and cuts of every kind of solid mesh carry the load") {
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    Context context;
    TractionParams up;
    up.normal = Vec3(0, 0, -1);
    // Its bottom is the surface of the half space, beside the load.
    const DatasetPtr ground = traction(loaded(kind, 4, 0.5, {1.2, 0, 0.5}), up, context);
    const Array at = point_positions(ground->mesh()), &t = ground->fields().require("traction").array;
    size_t free = 0;
    double most = 0;
    for (size_t i = 0; i < at.count(); ++i)
      if (std::abs(at.get(i, 2)) < 1e-12) {
        ++free;
        for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(t.get(i, c)));
      }
    const bool straight = kind.name != "rotated" && kind.name != "curvilinear" && kind.name.find("bent") && kind.name.find("curved");
    CHECK((free > 4) == straight);
    CHECK(most < 1e-12);

    if (kind.name.find(' ') != std::string::npos && kind.name.find("bent") != 0) continue;  // curved cells are cut by pieces of them
    // The cut z = 2 pushes as the closed form does, and its force is the integral of it.
    SliceParams cut;
    cut.axis = CutAxis::z, cut.position = 2.0;
    const DatasetPtr plane = traction(slice(loaded(kind, 8, 1, {0, 0, 2.03}), cut, context), {}, context);
    const Array &n = plane->fields().require("normal traction").array, &shear = plane->fields().require("shear stress").array;
    const auto& mesh = *plane->as<SurfaceMesh>();
    REQUIRE(mesh.polygons.size() > 30);
    double worst = 0;
    for (size_t i = 0; i < mesh.points.count(); ++i) {
      const SymTensor s = stress(mesh.points.at(i));
      worst = std::max({worst, std::abs(n.get(i) - s.zz), std::abs(shear.get(i) - std::hypot(s.xz, s.yz))});
    }
    CHECK(worst < 0.04 * std::abs(stress({0, 0, 2}).zz));
    if (!straight) continue;
    double force = 0;
    const int m = 64;
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i) force += stress({(2 * i + 1.0) / m - 1, (2 * j + 1.0) / m - 1, 2}).zz * 4 / (m * m);
    CHECK(shapes::number(*integrate(plane, {{"normal traction"}}, context), "integral", 1) == doctest::Approx(force).epsilon(0.01));
  }
}
