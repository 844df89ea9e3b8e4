// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/boundaries.h"

#include "base/parallel.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"
#include "volume_support.h"

using namespace sg;

namespace {

std::vector<DerivativeSample> samples_of(const DatasetPtr& d, bool with_second = false, size_t most = 1000000) {
  Context context;
  return sample_derivatives(d, d->fields()[0], -1, with_second, most, context);
}

}  // namespace

TEST_CASE("boundaries: two nested balls have their borders halfway between the materials") {
  const auto found = material_boundaries(samples_of(test::cube_of(65, "f", test::nested_balls)), 0, 300);
  REQUIRE(found.size() == 2);
  CHECK(found[0].value == doctest::Approx(50).epsilon(0.1));
  CHECK(found[1].value == doctest::Approx(200).epsilon(0.05));
  for (const MaterialBoundary& m : found) {
    CHECK(m.lo < m.value);
    CHECK(m.value < m.hi);
    CHECK(m.share > 0);
  }
  // The steepest slope of erfc(x / blur) is 2 / (sqrt(pi) blur).
  CHECK(found[1].mean_gradient < 100 * 2 / (std::sqrt(3.14159265) * 0.06));
  CHECK(found[1].mean_gradient > 0.5 * 100 * 2 / (std::sqrt(3.14159265) * 0.06));
  OpacityCurve opacity;
  TransferDetail detail;
  const std::string why = show_boundaries(found, 0, 300, opacity, detail);
  CHECK(why.find(" and ") != std::string::npos);
  CHECK(opacity.at(found[1].value) > opacity.at(found[0].value));
  CHECK(opacity.at(0) == 0);
  CHECK(opacity.at(100) < 0.05);  // the inside of the outer ball
  CHECK(opacity.at(300) == 0);
  CHECK(std::is_sorted(opacity.points.begin(), opacity.points.end(), [](Vec2 a, Vec2 b) { return a.x < b.x; }));
}

TEST_CASE("boundaries: nothing stands out in a ramp, a constant, or too few samples") {
  CHECK(material_boundaries(samples_of(test::cube_of(33, "f", [](Vec3) { return 4.0; })), 3, 5).empty());
  CHECK(material_boundaries({}, 0, 1).empty());
  CHECK(material_boundaries(samples_of(test::cube_of(33, "f", [](Vec3 p) { return p.x; })), -1, 1).size() <= 1);
  OpacityCurve opacity;
  TransferDetail detail;
  CHECK(show_boundaries({}, 0, 1, opacity, detail).empty());
  CHECK(detail.plain());
}

TEST_CASE("derivative samples: exact for quadratics on turned and stretched grids, and on cells of other meshes to first order") {
  // f = quadratic of the world: gradients and second derivatives do not know about the grid's axes.
  const auto f = [](Vec3 p) { return 2 * p.x * p.x - p.y * p.y + p.x * p.z + 3 * p.y; };
  UniformGrid g;
  g.dims = {9, 8, 7};
  g.origin = {0.3, -0.2, 0.1}, g.spacing = {0.1, 0.2, 0.05};
  g.direction.m[0][0] = 0.6, g.direction.m[0][1] = -0.8, g.direction.m[1][0] = 0.8, g.direction.m[1][1] = 0.6;
  std::vector<double> v;
  std::vector<Vec3> at;
  for (size_t k = 0; k < 7; ++k)
    for (size_t j = 0; j < 8; ++j)
      for (size_t i = 0; i < 9; ++i) {
        const Vec3 p = g.origin + g.direction * (g.spacing * Vec3{double(i), double(j), double(k)});
        v.push_back(f(p));
        if (i % 8 && j % 7 && k % 6) at.push_back(p);
      }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  const DatasetPtr d = make_dataset(Mesh(g), fields);
  const auto samples = samples_of(d, true);
  REQUIRE(samples.size() == at.size());
  for (size_t i = 0; i < at.size(); ++i) {
    const Vec3 p = at[i];
    const Vec3f grad(Vec3{4 * p.x + p.z, -2 * p.y + 3, p.x});
    const SecondDerivatives h{4, -2, 0, 0, 1, 0};
    CHECK(samples[i].gradient == doctest::Approx(length(grad)).epsilon(1e-4));
    CHECK(samples[i].second_derivative == doctest::Approx(second_derivative_along(grad, h)).epsilon(1e-3));
    CHECK(samples[i].curvature == doctest::Approx(mean_curvature(grad, h)).epsilon(1e-3));
  }
  Context context;
  const DatasetPtr cells = to_unstructured(d);
  const auto other = samples_of(cells, true);
  CHECK(other.size() > at.size() / 2);
  const Range a = second_axis_range(d, d->fields()[0], -1, SecondAxis::gradient, nullptr, context),
              b = second_axis_range(cells, cells->fields()[0], -1, SecondAxis::gradient, nullptr, context);
  CHECK(a.hi == doctest::Approx(b.hi).epsilon(0.25));
}

TEST_CASE("derivative samples: the same for any number of threads, and as many as asked for") {
  const DatasetPtr d = test::cube_of(49, "f", test::nested_balls);
  set_thread_count(1);
  const auto one = samples_of(d, true, 20000);
  set_thread_count(8);
  const auto eight = samples_of(d, true, 20000);
  set_thread_count(0);
  REQUIRE(one.size() == eight.size());
  CHECK(one.size() <= 20000);
  CHECK(one.size() > 15000);
  bool same = true;
  for (size_t i = 0; i < one.size(); ++i) same = same && one[i].value == eight[i].value && one[i].curvature == eight[i].curvature;
  CHECK(same);
  CHECK(samples_of(test::cube_of(2, "f", test::nested_balls)).empty());  // no inside
}
