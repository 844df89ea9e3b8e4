// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/sym_tensor.h"

#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

// What must hold for any decomposition, relative to the tensor's size.
void check_decomposition(const SymTensor& d, double tolerance = 4e-15) {
  const Eigen3 e = eigen_of(d);
  const double size = d.max_abs();
  CHECK(e.value[0] >= e.value[1]);
  CHECK(e.value[1] >= e.value[2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) CHECK(std::abs(dot(e.vector[i], e.vector[j]) - (i == j)) < tolerance);
  CHECK(dot(cross(e.vector[0], e.vector[1]), e.vector[2]) == doctest::Approx(1));
  for (int k = 0; k < 3; ++k) {
    const Vec3 off = d * e.vector[k] - e.vector[k] * e.value[k];
    CHECK(std::max({std::abs(off.x), std::abs(off.y), std::abs(off.z)}) <= tolerance * size);
  }
}

}  // namespace

TEST_CASE("eigen: known values come back from any rotation, equal and nearly equal ones too") {
  const double sets[][3] = {{3, 2, 1},  {1.7, .3, .3},  {1, 1, -2}, {1, 1 + 1e-9, 1 - 1e-9}, {1, 1 + 1e-15, 1},  {5, 0, 0},
                            {0, 0, -5}, {1e8, 1, 1e-8}, {1, 1, 1},  {1e-3, -1e-3, 0},        {1, 1e-20, -1e-20}, {2, 2, 1 + 1e-12}};
  for (const auto& s : sets)
    for (uint64_t seed = 0; seed < 50; ++seed) {
      const SymTensor d = rotated(diagonal(s[0], s[1], s[2]), random_rotation(seed));
      check_decomposition(d);
      double sorted[3] = {s[0], s[1], s[2]};
      std::sort(sorted, sorted + 3, std::greater<>());
      const Eigen3 e = eigen_of(d);
      for (int k = 0; k < 3; ++k) CHECK(std::abs(e.value[k] - sorted[k]) <= 1e-14 * std::max(std::abs(sorted[0]), std::abs(sorted[2])));
    }
}

TEST_CASE("eigen: random tensors of every size between 1e-300 and 1e300") {
  for (int exponent = -300; exponent <= 300; exponent += 20)
    for (uint64_t i = 0; i < 20; ++i) {
      double v[6];
      for (int k = 0; k < 6; ++k) v[k] = (2 * random_unit(7, i * 6 + uint64_t(k)) - 1) * std::pow(10.0, exponent);
      check_decomposition({v[0], v[1], v[2], v[3], v[4], v[5]});
    }
}

TEST_CASE("eigen: diagonal tensors are exact, zero has the axes, NaN and infinity give NaN") {
  const Eigen3 e = eigen_of(diagonal(0.1, -7, 0.3));
  CHECK(e.value[0] == 0.3);
  CHECK(e.value[1] == 0.1);
  CHECK(e.value[2] == -7);
  CHECK(e.vector[0] == Vec3(0, 0, 1));
  CHECK(e.vector[1] == Vec3(1, 0, 0));
  CHECK(e.vector[2] == Vec3(0, 1, 0));
  const Eigen3 zero = eigen_of({});
  CHECK(zero.value[0] == 0);
  CHECK(zero.vector[2] == Vec3(0, 0, 1));
  for (double bad : {double(NAN), double(INFINITY)}) {
    const Eigen3 n = eigen_of({1, 2, 3, bad, 0, 0});
    for (int k = 0; k < 3; ++k) CHECK(std::isnan(n.value[k]));
    CHECK(std::isnan(n.vector[0].x));
    CHECK(std::isnan(eigen_in_plane({1, 2, 0, bad, 0, 0}).value[0]));
  }
}

TEST_CASE("eigen in the plane: agrees with three dimensions and keeps z apart") {
  for (uint64_t i = 0; i < 200; ++i) {
    SymTensor d{2 * random_unit(3, 3 * i) - 1, 2 * random_unit(3, 3 * i + 1) - 1, 0, 2 * random_unit(3, 3 * i + 2) - 1, 0, 0};
    if (i % 10 == 0) d.xy = 0;
    const Eigen3 e = eigen_in_plane(d);
    CHECK(e.value[0] >= e.value[1]);
    CHECK(e.value[2] == 0);
    for (int k = 0; k < 2; ++k) CHECK(length(d * e.vector[k] - e.vector[k] * e.value[k]) < 1e-14);
    CHECK(length(cross(e.vector[0], e.vector[1]) - e.vector[2]) < 1e-15);
  }
}

TEST_CASE("tensor functions: exp undoes log, a rotation keeps the norm, composing gives the tensor back") {
  for (uint64_t seed = 0; seed < 30; ++seed) {
    const SymTensor d = rotated(diagonal(3, 1, 0.01), random_rotation(seed));
    CHECK((exp_of(log_of(d, 1e-30)) - d).max_abs() < 1e-13);
    CHECK((compose(eigen_of(d)) - d).max_abs() < 1e-14);
    CHECK(d.norm() == doctest::Approx(std::sqrt(10.0001)).epsilon(1e-14));
    CHECK(d.determinant() == doctest::Approx(0.03).epsilon(1e-12));
    CHECK(std::abs(d.deviator().trace()) < 1e-14);
  }
  CHECK((diagonal(1e-300, 0, 0)).norm() == doctest::Approx(1e-300).epsilon(1e-12));
  CHECK((diagonal(1e300, 1e300, 0)).norm() == doctest::Approx(std::sqrt(2.0) * 1e300).epsilon(1e-12));
}
