// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/measures.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/flow/eigen_general.h"
#include "filter/flow/flow_support.h"
#include "support/params.h"
#include "support/test.h"

using namespace sg;

namespace {

Mat3 matrix(std::initializer_list<double> v) {
  Mat3 m;
  int k = 0;
  for (const double e : v) m.m[k / 3][k % 3] = e, ++k;
  return m;
}

// The flow of Arnold, Beltrami and Childress on n^3 points of its period.
DatasetPtr abc_grid(size_t n) {
  const double a = std::sqrt(3.0), b = std::sqrt(2.0), c = 1;
  return test::cube_flow(n, 0, 2 * M_PI, [=](Vec3 x) {
    return Vec3(a * std::sin(x.z) + c * std::cos(x.y), b * std::sin(x.x) + a * std::cos(x.z), c * std::sin(x.y) + b * std::cos(x.x));
  });
}

}  // namespace

TEST_CASE("general eigenvalues: real ones, pairs and multiple ones are those of the matrix") {
  const GeneralEigenvalues spin = general_eigenvalues(matrix({0.5, -2, 0, 2, 0.5, 0, 0, 0, -1}));
  CHECK(spin.complex_pair);
  CHECK(spin.real[0] == doctest::Approx(-1));
  CHECK(spin.re == doctest::Approx(0.5));
  CHECK(spin.im == doctest::Approx(2));
  const GeneralEigenvalues triple = general_eigenvalues(matrix({3, 0, 0, 0, 3, 0, 0, 0, 3}));
  CHECK(!triple.complex_pair);
  for (const double e : triple.real) CHECK(e == doctest::Approx(3));
  // Random ones: the characteristic polynomial vanishes there, sum and product are trace and determinant.
  for (uint64_t t = 0; t < 300; ++t) {
    Mat3 a;
    for (uint64_t k = 0; k < 9; ++k) a.m[k / 3][k % 3] = std::pow(10.0, double(t % 7) - 3) * (2 * random_unit(5, 9 * t + k) - 1);
    const GeneralEigenvalues e = general_eigenvalues(a);
    double size = 0;
    for (const auto& row : a.m)
      for (const double v : row) size = std::max(size, std::abs(v));
    const double sum = e.complex_pair ? e.real[0] + 2 * e.re : e.real[0] + e.real[1] + e.real[2];
    const double product = e.complex_pair ? e.real[0] * (e.re * e.re + e.im * e.im) : e.real[0] * e.real[1] * e.real[2];
    CHECK(std::abs(sum - (a.m[0][0] + a.m[1][1] + a.m[2][2])) < 1e-12 * size);
    CHECK(std::abs(product - determinant(a)) < 1e-11 * size * size * size);
    const Vec3 v = eigenvector_of(a, e.real[0]);
    CHECK(length(a * v - e.real[0] * v) < 1e-8 * size);
  }
}

TEST_CASE("vortex measures: rigid rotation, pure shear and pure strain have the values of their definitions") {
  const VortexMeasures turn = vortex_measures_of(matrix({0, -1.5, 0, 1.5, 0, 0, 0, 0, 0}), {0, 0, 2});
  CHECK(turn.vorticity == Vec3(0, 0, 3));
  CHECK(turn.q == doctest::Approx(2.25));
  CHECK(turn.lambda2 == doctest::Approx(-2.25));
  CHECK(turn.swirling_strength == doctest::Approx(1.5));
  CHECK(turn.helicity == doctest::Approx(6));
  CHECK(turn.normalized_helicity == doctest::Approx(1));
  CHECK(turn.strain == doctest::Approx(0));
  CHECK(turn.okubo_weiss == doctest::Approx(-9));
  CHECK(turn.delta > 0);
  const VortexMeasures shear = vortex_measures_of(matrix({0, 2, 0, 0, 0, 0, 0, 0, 0}), {1, 0, 0});
  CHECK(shear.vorticity == Vec3(0, 0, -2));
  CHECK(shear.q == doctest::Approx(0));
  CHECK(shear.strain == doctest::Approx(2));
  CHECK(shear.swirling_strength == doctest::Approx(0));
  CHECK(shear.kinematic_vorticity == doctest::Approx(1));
  const VortexMeasures pull = vortex_measures_of(matrix({1, 0, 0, 0, -1, 0, 0, 0, 0}), {1, 0, 0});
  CHECK(pull.q == doctest::Approx(-1));
  CHECK(pull.lambda2 == doctest::Approx(1));
  CHECK(pull.okubo_weiss == doctest::Approx(4));
  CHECK(pull.divergence == doctest::Approx(0));
}

TEST_CASE("vortex measures: the curl of the ABC flow is the flow itself, with order 2") {
  double last = 0;
  for (const size_t n : {17, 33, 65}) {
    Context context;
    const DatasetPtr d = vortex_measures(
        abc_grid(n), {{}, {VortexMeasure::vorticity, VortexMeasure::divergence, VortexMeasure::normalized_helicity}}, context);
    const Field &w = d->fields().require("vorticity"), &u = d->fields().require("velocity");
    double worst = 0;
    for (size_t i = 0; i < d->point_count(); ++i)
      for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(w.array.get(i, c) - u.array.get(i, c)));
    if (last > 0) CHECK(std::log2(last / worst) == doctest::Approx(2).epsilon(0.1));
    last = worst;
  }
}

TEST_CASE("vortex measures: the same bytes for any number of threads; unknown words are named") {
  Context context;
  const DatasetPtr in = abc_grid(24);
  set_thread_count(1);
  const DatasetPtr one = vortex_measures(in, {}, context);
  set_thread_count(8);
  const DatasetPtr many = vortex_measures(in, {}, context);
  set_thread_count(0);
  for (const char* name : {"vorticity", "Q", "lambda2", "swirling strength", "helicity"}) {
    const Array &a = one->fields().require(name).array, &b = many->fields().require(name).array;
    CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  }
  CHECK(test::error_of([&] { test::params_of<VortexMeasuresParams>({"measures=lambda_2"}); }).find("lambda2") != std::string::npos);
}
