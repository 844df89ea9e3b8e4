// SPDX-License-Identifier: Apache-2.0
// Tensors of a known stress and of real files.
#include "filter/mesh/slice/slice.h"
#include "filter/tensor/degenerate/degenerate_points.h"
#include "filter/tensor/glyphs/tensor_glyphs.h"
#include "filter/tensor/lines/hyperstreamlines.h"
#include "filter/tensor/stress_measures.h"
#include "filter/tensor/tensor_measures.h"
#include "filter/tensor/tensor_support.h"
#include "io/io.h"
#include "simulate/point_load.h"

using namespace sg;
using namespace sg::test;

TEST_CASE("point load: on the axis the stress is Boussinesq's; von Mises agrees with the source's own field") {
  Context context;
  PointLoadParams load;
  load.grid.type = FieldType::f64, load.grid.size = 11, load.load = 2, load.poisson = 0.3;
  const DatasetPtr in = point_load(load, context);
  const DatasetPtr d = stress_measures(in, {}, context);
  const Array &mine = d->fields().require("von Mises stress").array, &own = in->fields().require("von Mises stress").array;
  for (size_t i = 0; i < mine.count(); ++i) CHECK(mine.get(i) == doctest::Approx(own.get(i)).epsilon(1e-12));
  for (double z : {0.25, 1.0, 2.5}) {
    double s[9];
    point_load_stress(2, 0.3, {0, 0, z}, s);
    const Eigen3 e = eigen_of({s[0], s[4], s[8], s[1], s[5], s[2]});
    CHECK(e.value[2] == doctest::Approx(-3 * 2 / (2 * M_PI * z * z)).epsilon(1e-14));
    CHECK(e.value[0] == doctest::Approx(0.4 * 2 / (4 * M_PI * z * z)).epsilon(1e-14));
    CHECK(e.value[1] == doctest::Approx(e.value[0]).epsilon(1e-14));
  }
}

TEST_CASE("point load: div s = 0 with order 2, and every horizontal cut carries the whole load") {
  // Central differences of the closed form.
  double h[4], off[4];
  for (int n = 0; n < 4; ++n) {
    h[n] = 0.1 / double(1 << n), off[n] = 0;
    for (uint64_t i = 0; i < 30; ++i) {
      const Vec3 x(2 * random_unit(1, 3 * i) - 1, 2 * random_unit(1, 3 * i + 1) - 1, 0.7 + random_unit(1, 3 * i + 2));
      for (int row = 0; row < 3; ++row) {
        double sum = 0;
        for (int a = 0; a < 3; ++a) {
          double up[9], down[9];
          Vec3 step;
          step[a] = h[n];
          point_load_stress(1, 0.25, x + step, up);
          point_load_stress(1, 0.25, x - step, down);
          sum += (up[3 * row + a] - down[3 * row + a]) / (2 * h[n]);
        }
        off[n] = std::max(off[n], std::abs(sum));
      }
    }
  }
  CHECK(observed_order(h, off, 4) == doctest::Approx(2).epsilon(0.1));

  Context context;
  PointLoadParams load;
  load.grid.type = FieldType::f64, load.grid.bounds = {-8, 8, -8, 8, 0.5, 1.5}, load.grid.dims = {161, 161, 3};
  SliceParams cut;
  cut.axis = CutAxis::z, cut.position = 1.0;
  const DatasetPtr plane = slice(point_load(load, context), cut, context);
  const DatasetPtr t = traction(plane, {}, context);
  const Array& n = t->fields().require("normal traction").array;
  const Array& shear = t->fields().require("shear stress").array;
  const auto& mesh = *t->as<SurfaceMesh>();
  double force = 0;
  for (size_t i = 0; i < mesh.points.count(); ++i) {
    const Vec3 x = mesh.points.at(i);
    double s[9];
    point_load_stress(1, 0.25, x, s);
    CHECK(n.get(i) == doctest::Approx(s[8]).epsilon(1e-6));
    CHECK(shear.get(i) == doctest::Approx(std::hypot(s[2], s[5])).epsilon(1e-6));
    force -= n.get(i) * 0.1 * 0.1;
  }
  // Outside the square lies less than outside the circle within it: 1 - z^3/(r^2+z^2)^1.5 of the load is inside a circle r.
  CHECK(force < 1);
  CHECK(force > 1 - 1 / std::pow(65.0, 1.5) - 1e-3);
}

TEST_CASE("notch_stress_fixed: von Mises and the first component agree with the file's own" * doctest::skip(no_data())) {
  Context context;
  const Data data = read_data(data_file("tensors/notch_stress_fixed.vtk"), {}, context);
  const DatasetPtr in = std::get<DatasetPtr>(data);
  const DatasetPtr d = stress_measures(in, {}, context);
  const Array& own = in->fields().require("Nodal Stress").array;
  const Array& mean = d->fields().require("mean stress").array;
  const Array& mises = d->fields().require("von Mises stress").array;
  REQUIRE(mises.count() == 3537);
  for (size_t i = 0; i < own.count(); i += 7) {
    const double xx = own.get(i, 0), yy = own.get(i, 1), zz = own.get(i, 2), xy = own.get(i, 3), yz = own.get(i, 4), xz = own.get(i, 5);
    CHECK(mean.get(i) == doctest::Approx((xx + yy + zz) / 3));
    CHECK(mises.get(i) == doctest::Approx(std::sqrt(0.5 * ((xx - yy) * (xx - yy) + (yy - zz) * (yy - zz) + (zz - xx) * (zz - xx)) +
                                                    3 * (xy * xy + yz * yz + xz * xz))));
  }
}

TEST_CASE("point load: the line of compression on the axis is straight with Boussinesq's stress; for nu = 1/2 all are rays from the load") {
  Context context;
  PointLoadParams load;
  load.grid.type = FieldType::f64, load.grid.size = 41;
  HyperstreamlinesParams p;
  p.eigenvector = 3, p.section = TensorSection::line, p.seeds = {0, 0, 1};
  const DatasetPtr axis = hyperstreamlines(point_load(load, context), p, context);
  const auto& line = *axis->as<SurfaceMesh>();
  const Array& value = axis->fields().require("eigenvalue").array;
  for (size_t i = 0; i < line.points.count(); ++i) {
    const Vec3 x = line.points.at(i);
    CHECK(std::hypot(x.x, x.y) < 1e-9);
    if (x.z > 0.5) CHECK(value.get(i) == doctest::Approx(-3 / (2 * M_PI * x.z * x.z)).epsilon(0.02));
  }
  CHECK(axis->bounds().size().z == doctest::Approx(2).epsilon(1e-3));

  double h[3], off[3];
  for (int n = 0; n < 3; ++n) {
    load.poisson = 0.5, load.grid.size = 16 << n;
    p.seeds = {0.33, 0.21, 1.03};
    const DatasetPtr ray = hyperstreamlines(point_load(load, context), p, context);
    h[n] = 1.0 / (16 << n), off[n] = 0;
    const Vec3 right = normalize(Vec3(0.33, 0.21, 1.03));
    const auto& points = ray->as<SurfaceMesh>()->points;
    for (size_t i = 0; i < points.count(); ++i) {
      const Vec3 x = points.at(i);
      if (x.z > 0.5) off[n] = std::max(off[n], length(x - right * dot(x, right)));
    }
    CHECK(points.count() > 20);
  }
  CHECK(observed_order(h, off, 3) == doctest::Approx(2).epsilon(0.2));
}

TEST_CASE("notch_stress_fixed: lines of tension run from end to end, cuts have degenerate points, glyphs lie within" *
          doctest::skip(no_data())) {
  Listener l;
  const DatasetPtr in = std::get<DatasetPtr>(read_data(data_file("tensors/notch_stress_fixed.vtk"), {}, l.context));
  HyperstreamlinesParams p;
  p.section = TensorSection::line, p.seeds = {0.2, 0.05, 0.0051, 0.1, 0.03, 0.0051};
  const DatasetPtr lines = hyperstreamlines(in, p, l.context);
  REQUIRE(lines->cell_count() == 2);
  CHECK(lines->bounds().size().x > 0.39);
  CHECK(lines->range(lines->fields().require("eigenvalue")).hi <= in->range(in->fields().require("Nodal Stress-normed")).hi * 1.01);
  SliceParams cut;
  cut.axis = CutAxis::z, cut.position = 0.0051;
  const DatasetPtr points = degenerate_points(slice(in, cut, l.context), {}, l.context);
  CHECK(points->point_count() >= 4);
  const DatasetPtr glyphs = tensor_glyphs(in, {}, l.context);
  CHECK(glyphs->cell_count() > 1000);
  CHECK(glyphs->bounds().diagonal() < 1.1 * in->bounds().diagonal());
}
