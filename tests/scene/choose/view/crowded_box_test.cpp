// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/crowded_box.h"

#include <cmath>
#include <numbers>

#include "support/test.h"

using namespace sg;

namespace {

// Rings of points around a cylinder of radius 1, growing geometrically to `far`, with a value that falls from 1 as r^-power.
DatasetPtr around_cylinder(double far, double power) {
  constexpr size_t around = 64, out = 64;
  std::vector<float> xyz, v;
  for (size_t j = 0; j < out; ++j)
    for (size_t i = 0; i < around; ++i) {
      const double r = std::pow(far, double(j) / (out - 1)), a = 2 * std::numbers::pi * double(i) / (around - 1);
      xyz.insert(xyz.end(), {float(r * std::cos(a)), float(r * std::sin(a)), 0});
      v.push_back(float(std::pow(r, -power)));
    }
  CurvilinearGrid g;
  g.dims = {around, out, 1};
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet f;
  f.add({"p", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(g, f);
}

std::optional<Box3> box_of(const DatasetPtr& d) {
  const FieldOf f{d.get(), &d->fields()[0]};
  return crowded_box({&f, 1});
}

}  // namespace

TEST_CASE("crowded box: the part around a body in its far field, where the field varies there alone") {
  const auto box = box_of(around_cylinder(100, 2));
  REQUIRE(box);
  for (int a = 0; a < 2; ++a) {
    CHECK(box->lo[a] < -1.5);
    CHECK(box->lo[a] > -30);
    CHECK(box->hi[a] == doctest::Approx(-box->lo[a]).epsilon(0.1));
  }
  CHECK_FALSE(box_of(around_cylinder(100, 0.1)));  // it varies all the way
  CHECK_FALSE(box_of(around_cylinder(3, 2)));      // and here the body is in sight
}
