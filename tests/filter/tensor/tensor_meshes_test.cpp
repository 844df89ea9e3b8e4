// SPDX-License-Identifier: Apache-2.0
// Tensors on every kind of mesh (correctness.md section 3).
#include "filter/every_mesh.h"
#include "filter/mesh/slice/slice.h"
#include "filter/mesh/transform/transform.h"
#include "filter/tensor/diffusion/diffusion_model.h"
#include "filter/tensor/diffusion/tensor_fit.h"
#include "filter/tensor/lines/hyperstreamlines.h"
#include "filter/tensor/lines/tensor_lines.h"
#include "filter/tensor/lines/tractography.h"
#include "filter/tensor/stress_measures.h"
#include "filter/tensor/tensor_measures.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

void write(const SymTensor& t, double* v) {
  const double all[9] = {t.xx, t.xy, t.xz, t.xy, t.yy, t.yz, t.xz, t.yz, t.zz};
  std::copy_n(all, 9, v);
}
template <class F>
DatasetPtr tensors_on(const DatasetPtr& mesh, F&& f) {
  return with_values(
      mesh, "tensor", 9, [&](Vec3 p, double* v) { write(f(p), v); }, Role::tensors);
}

/// The tensors on points, and means of them on cells.
template <class F>
void on_points_and_cells(const DatasetPtr& d, F&& f) {
  for (const bool cells : {false, true}) {
    CAPTURE(cells);
    f(cells ? on_cells(d) : d);
  }
}

HyperstreamlinesParams line_from(Vec3 seed, int eigenvector, TensorSection section = TensorSection::line) {
  HyperstreamlinesParams p;
  p.seeds = {seed.x, seed.y, seed.z}, p.eigenvector = eigenvector, p.section = section, p.min_radius = 0;
  return p;
}

// In the plane a tensor of three dimensions counts by its part in it, so one vector lies across.
SymTensor constant_flat() {
  Mat3 turn;
  turn.m[0][0] = turn.m[1][1] = 0.8, turn.m[1][0] = 0.6, turn.m[0][1] = -0.6;
  return rotated(diagonal(4, 2, 1), turn);
}

}  // namespace

TEST_CASE("tensor meshes: measures have their published values in every kind of mesh, on points and on cells") {
  for (const double side : {-1.0, 1.0})
    for (const MeshKind& kind : every_mesh()) {
      CAPTURE(kind.name);
      const SymTensor t = rotated(side < 0 ? diagonal(1.7, .3, .3) : diagonal(1, .6, .2), random_rotation(7));
      on_points_and_cells(tensors_on(kind.make(4, 1), [&](Vec3) { return t; }), [&](const DatasetPtr& in) {
        Context context;
        const DatasetPtr d = stress_measures(tensor_measures(in, {}, context), {}, context);
        const struct {
          const char* name;
          double first, second;
        } right[] = {{"FA", .799022, .585540},
                     {"MD", .766667, .6},
                     {"mode", 1, 0},
                     {"cl", .608696, .4 / 1.8},
                     {"cs", .391304, .6 / 1.8},
                     {"von Mises stress", 1.4, std::sqrt(.48)},
                     {"Tresca stress", 1.4, .8},
                     {"principal stress 1", 1.7, 1},
                     {"principal stress 2", .3, .6},
                     {"principal stress 3", .3, .2}};
        for (const auto& r : right) {
          const Field& f = d->fields().require(r.name);
          const Field& source = in->fields().require("tensor");
          REQUIRE(f.array.count() == source.array.count());
          REQUIRE(f.association == source.association);
          double worst = 0;
          for (size_t i = 0; i < f.array.count(); ++i) {
            const double off = std::abs(f.array.get(i) - (side < 0 ? r.first : r.second));
            worst = off <= worst ? worst : off;
          }
          CAPTURE(std::string(r.name));
          CHECK(worst < 1e-6);
        }
      });
    }
}

TEST_CASE("tensor meshes: signals without noise give the tensor back in every kind of mesh, on points and on cells") {
  GradientTable t;
  t.b.push_back(0), t.g.push_back({0, 0, 0});
  for (int i = 0; i < 6; ++i) {
    const double z = 1 - (i + 0.5) / 6, a = i * M_PI * (3 - std::sqrt(5.0)), r = std::sqrt(1 - z * z);
    t.b.push_back(1000), t.g.push_back({r * std::cos(a), r * std::sin(a), z});
  }
  const SymTensor d = rotated(diagonal(1.7e-3, 0.4e-3, 0.2e-3), random_rotation(3));
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const DatasetPtr images = with_values(kind.make(4, 1), "images", int(t.size()), [&](Vec3, double* v) {
      for (size_t i = 0; i < t.size(); ++i) v[i] = 700 * std::exp(-t.b[i] * d.along(t.g[i]));
    });
    on_points_and_cells(images, [&](const DatasetPtr& in) {
      std::vector<double> g;
      for (const Vec3 q : t.g) g.insert(g.end(), {q.x, q.y, q.z});
      DatasetParts parts = in->parts();
      parts.fields.add({"bval", Association::whole, Array::from_vector(std::vector<double>(t.b)), "s/mm^2", Role::none});
      parts.fields.add({"bvec", Association::whole, Array::from_vector(std::move(g), 3), "", Role::none});
      Context context;
      TensorFitParams p;
      p.frame = GradientFrame::world, p.field.name = "images";
      const DatasetPtr fit = tensor_fit(make_dataset(std::move(parts)), p, context);
      double right[9], worst = 0;
      write(d, right);
      const Array& a = fit->fields().require("tensor").array;
      REQUIRE(a.count() == in->fields().require("images").array.count());
      for (size_t i = 0; i < a.count(); ++i)
        for (int c = 0; c < 9; ++c) {
          const double off = std::abs(a.get(i, c) - right[c]);
          worst = off <= worst ? worst : off;
        }
      CHECK(worst < 1e-12);
    });
  }
}

TEST_CASE("tensor meshes: a constant tensor has straight hyperstreamlines to the border, with elliptic sections, in every kind of mesh") {
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    const SymTensor t = kind.flat ? constant_flat() : constant;
    const Eigen3 e = eigen_of(t);
    const DatasetPtr mesh = tensors_on(kind.make(4, 1), [&](Vec3) { return t; });
    const Vec3 seed(0.05, 0.02, kind.flat ? 0 : -0.03);
    Context context;
    for (int k = 0; k < (kind.flat ? 2 : 3); ++k) {
      CAPTURE(k);
      const DatasetPtr l = hyperstreamlines(mesh, line_from(seed, k + 1), context);
      const size_t n = l->point_count();
      REQUIRE(n > 4);
      double worst = 0;
      bool one_way = true;
      for (size_t i = 0; i < n; ++i) {
        const Vec3 off = point(l, i) - seed;
        worst = std::max({worst, length(off - e.vector[k] * dot(off, e.vector[k])), std::abs(value(l, "eigenvalue", i) - e.value[k])});
        if (i > 0) one_way = one_way && dot(point(l, i) - point(l, i - 1), point(l, n - 1) - point(l, 0)) > 0;
      }
      CHECK(worst < 1e-6);
      CHECK(one_way);
      CHECK(value(l, "stop", 0) == int(TensorStop::outside));
      // Bent boxes end within a tenth of it, the turned grid farther out.
      for (const size_t end : {size_t(0), n - 1}) {
        const Vec3 q = point(l, end);
        CHECK(std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)}) > 0.88);
      }
    }
    HyperstreamlinesParams p = line_from(seed, 1, TensorSection::ellipse);
    p.factor = 0.01, p.sides = 24;
    const DatasetPtr tube = hyperstreamlines(mesh, p, context);
    REQUIRE(tube->point_count() >= 48);
    double worst = 0, widest[2] = {0, 0};
    for (size_t i = 0; i < tube->point_count(); ++i) {
      const Vec3 off = point(tube, i) - seed;
      const double a = dot(off, e.vector[1]) / 0.02, b = dot(off, e.vector[2]) / 0.01;
      worst = std::max(worst, std::abs(a * a + b * b - 1));
      widest[0] = std::max(widest[0], std::abs(a)), widest[1] = std::max(widest[1], std::abs(b));
    }
    CHECK(worst < 1e-4);
    CHECK(widest[0] == doctest::Approx(1).epsilon(1e-4));
    CHECK(widest[1] == doctest::Approx(1).epsilon(1e-4));
    TractographyParams fibre;
    fibre.seeds = {seed.x, seed.y, seed.z};
    const DatasetPtr f = tractography(mesh, fibre, context);
    const Vec3 run = point(f, f->point_count() - 1) - point(f, 0);
    CHECK(std::abs(dot(normalize(run), e.vector[0])) == doctest::Approx(1).epsilon(1e-10));
    CHECK(length(run) > 1.8);
  }
}

TEST_CASE("tensor meshes: hyperstreamlines turn with their eigenvector and never back, in every kind of mesh") {
  // Eigenvector 1 circles about the z axis, where stored eigenvectors change their sign twice a turn.
  const auto ring = [](Vec3 p) {
    const double r2 = p.x * p.x + p.y * p.y;
    return outer({-p.y, p.x, 0}, 2) + outer({0, 0, 1}, 0.1 * r2);
  };
  for (const MeshKind& kind : every_mesh()) {
    CAPTURE(kind.name);
    Context context;
    const DatasetPtr mesh = tensors_on(kind.make(12, 1), ring);
    HyperstreamlinesParams p = line_from({0.62, 0.03, kind.flat ? 0 : 0.1}, 1);
    p.max_length = 5, p.direction = LineDirection::forward;
    const DatasetPtr l = hyperstreamlines(mesh, p, context);
    const size_t n = l->point_count();
    REQUIRE(n > 12);
    const double r0 = std::hypot(0.62, 0.03);
    double radius = 0, angle = 0, least = 1;
    for (size_t i = 0; i < n; ++i) {
      const Vec3 q = point(l, i);
      radius = std::max(radius, std::abs(std::hypot(q.x, q.y) - r0));
      if (i == 0) continue;
      const Vec3 before = point(l, i - 1);
      angle += std::atan2(before.x * q.y - before.y * q.x, before.x * q.x + before.y * q.y);
      if (i > 1) least = std::min(least, dot(normalize(q - before), normalize(before - point(l, i - 2))));
    }
    CHECK(radius < 0.01);
    CHECK(std::abs(angle) > 6.2);  // once around
    CHECK(least > 0.9);
  }
}
