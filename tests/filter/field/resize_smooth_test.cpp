// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/field/sampling/gaussian_smooth.h"
#include "filter/field/sampling/reconstruction.h"
#include "filter/field/sampling/resize.h"
#include "support/params.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr grid_of(std::array<size_t, 3> dims, const std::function<double(Vec3)>& f, ElementType type = ElementType::f64,
                   Association association = Association::point, Role role = Role::scalars) {
  UniformGrid g;
  g.dims = dims, g.spacing = {0.5, 1, 2};
  std::vector<double> v;
  const bool cells = association == Association::cell;
  for (size_t k = 0; k < dims[2] - cells; ++k)
    for (size_t j = 0; j < dims[1] - cells; ++j)
      for (size_t i = 0; i < dims[0] - cells; ++i)
        v.push_back(f(g.spacing * (Vec3{double(i), double(j), double(k)} + Vec3{0.5, 0.5, 0.5} * double(cells))));
  FieldSet fields;
  fields.add({"f", association, Array::from_vector(v).converted(type), "", role});
  return make_dataset(g, fields);
}
const Array& f_of(const DatasetPtr& d) { return d->fields().require("f").array; }
double plane(Vec3 p) { return 1 + p.x - 2 * p.y + 0.5 * p.z; }

}  // namespace

TEST_CASE("resize: what rises evenly stays so, up and down, for points and cells, to the border") {
  Context context;
  for (Association association : {Association::point, Association::cell})
    for (std::array<int64_t, 3> to : {std::array<int64_t, 3>{17, 9, 7}, {5, 4, 3}, {9, 13, 4}})
      for (const Kernel kernel : {Kernel::linear, Kernel::catmull_rom, Kernel::mitchell, Kernel::bspline, Kernel::bspline_smooth}) {
        INFO(word_of(kernel), " ", to[0]);
        const DatasetPtr out = resize(grid_of({9, 7, 5}, plane, ElementType::f64, association), {{to[0], to[1], to[2]}, kernel}, context);
        const auto& g = *out->as<UniformGrid>();
        CHECK(g.dims == std::array<size_t, 3>{size_t(to[0]), size_t(to[1]), size_t(to[2])});
        const bool cells = association == Association::cell;
        const Vec3 half = g.spacing * (cells ? 0.5 : 0.0);
        CHECK(length(g.spacing * Vec3{double(to[0] - 1), double(to[1] - 1), double(to[2] - 1)} - Vec3{4, 6, 8}) < 1e-12);
        double off = 0;
        size_t n = 0;
        for (size_t k = 0; k < g.dims[2] - cells; ++k)
          for (size_t j = 0; j < g.dims[1] - cells; ++j)
            for (size_t i = 0; i < g.dims[0] - cells; ++i)
              off = std::max(off, std::abs(f_of(out).get(n++) - plane(g.spacing * Vec3{double(i), double(j), double(k)} + half)));
        CHECK(n == f_of(out).count());
        // A widened kernel meets its samples unevenly: the sum of shares is divided out, their first moment is not.
        CHECK(off < 0.2);
        if (to[0] >= 9 && to[1] >= 7 && to[2] >= 5) CHECK(off < 1e-5);
      }
}

TEST_CASE("resize: the same dims give the same values back when the kernel interpolates; types and labels are kept") {
  Context context;
  uint64_t seed = 0;
  const DatasetPtr bytes = grid_of(
      {6, 5, 4}, [&](Vec3) { return std::floor(256 * random_unit(9, seed++)); }, ElementType::u8);
  for (const Kernel kernel : {Kernel::nearest, Kernel::linear, Kernel::catmull_rom, Kernel::bspline, Kernel::sinc}) {
    const Array out = f_of(resize(bytes, {{6, 5, 4}, kernel}, context));
    REQUIRE(out.type() == ElementType::u8);
    for (size_t i = 0; i < out.count(); ++i) CHECK(out.get(i) == f_of(bytes).get(i));
  }
  const DatasetPtr labels = grid_of(
      {6, 5, 4}, [](Vec3 p) { return p.x < 1 ? 3 : 9; }, ElementType::i32, Association::point, Role::labels);
  const Array l = f_of(resize(labels, {{23}, Kernel::bspline}, context));
  CHECK(l.type() == ElementType::i32);
  for (size_t i = 0; i < l.count(); ++i) CHECK((l.get(i) == 3 || l.get(i) == 9));
}

TEST_CASE("resize: fewer samples take the mean of many instead of missing some") {
  Context context;
  // Every second sample is 1: half of them on average, whatever the phase.
  int n = 0;
  const DatasetPtr stripes = grid_of({65, 1, 1}, [&](Vec3) { return double(n++ % 2); });
  const Array out = f_of(resize(stripes, {{9, 1, 1}, Kernel::mitchell}, context));
  for (size_t i = 1; i + 1 < out.count(); ++i) CHECK(out.get(i) == doctest::Approx(0.5).epsilon(0.02));
}

TEST_CASE("resize: a hole stays a hole of its size, and its neighbours go on evenly") {
  Context context;
  const DatasetPtr holed = grid_of(
      {9, 9, 9},
      [](Vec3 p) {
        return p == Vec3{2, 4, 8} ? NAN : plane(p);
      },
      ElementType::f32);
  const DatasetPtr out = resize(holed, {{17, 17, 17}, Kernel::catmull_rom}, context);
  size_t missing = 0, wrong = 0, n = 0;
  for (size_t k = 0; k < 17; ++k)
    for (size_t j = 0; j < 17; ++j)
      for (size_t i = 0; i < 17; ++i, ++n) {
        const double v = f_of(out).get(n);
        missing += v != v;
        wrong += v == v && std::abs(v - plane({0.25 * double(i), 0.5 * double(j), double(k)})) > 1e-4;
      }
  CHECK(missing == 8);
  CHECK(wrong == 0);
}

TEST_CASE("resize: bad requests say what would be right") {
  Context context;
  const DatasetPtr flat = grid_of({5, 5, 1}, plane);
  CHECK_THROWS_WITH_AS(resize(flat, {{5, 5}, Kernel::linear}, context), doctest::Contains("one or three"), Error);
  CHECK_THROWS_WITH_AS(resize(flat, {{5, 5, 4}, Kernel::linear}, context), doctest::Contains("axis z"), Error);
  CHECK_THROWS_WITH_AS(resize(flat, {{5, 1, 1}, Kernel::linear}, context), doctest::Contains("axis y"), Error);
  CHECK_THROWS_WITH_AS(test::params_of<ResizeParams>({"kernel=linaer"}), doctest::Contains("linear"), Error);
  CHECK_THROWS_AS(resize(flat, {{1 << 20, 1 << 20, 1}, Kernel::linear}, context), Error);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<float>(3), 3);
  CHECK_THROWS_WITH_AS(resize(make_dataset(cloud, FieldSet{}), {{5}, Kernel::linear}, context), doctest::Contains("resample"), Error);
}

TEST_CASE("gaussian_smooth: a wave loses exp(-(k sigma)^2/2) of its height, along each axis in world lengths") {
  Context context;
  const double k = 1.1, sigma = 0.9;
  const DatasetPtr in = grid_of({81, 41, 21}, [&](Vec3 p) { return std::cos(k * p.x) * std::cos(0.5 * k * p.y); });
  const DatasetPtr out = gaussian_smooth(in, {{}, {sigma}, ""}, context);
  const size_t middle = 40 + 81 * (20 + 41 * 10);
  const double expected = std::exp(-0.5 * sigma * sigma * (k * k + 0.25 * k * k));
  CHECK(f_of(out).get(middle) / f_of(in).get(middle) == doctest::Approx(expected).epsilon(2e-3));
  CHECK(f_of(out).type() == ElementType::f64);
  const DatasetPtr one = gaussian_smooth(in, {{}, {sigma, 0, 0}, "smooth"}, context);
  CHECK(one->fields().require("smooth").array.get(middle) / f_of(in).get(middle) ==
        doctest::Approx(std::exp(-0.5 * sigma * sigma * k * k)).epsilon(2e-3));
  CHECK(f_of(one).get(5) == f_of(in).get(5));
}

TEST_CASE("gaussian_smooth: constants stay constant at borders, beside holes and on uneven axes; holes stay holes") {
  Context context;
  RectilinearGrid g;
  g.x = Array::from_vector(std::vector<double>{3, 2, 1.8, 1, 0.9, 0}), g.y = Array::from_vector(std::vector<double>{0, 1, 5}),
  g.z = Array::from_vector(std::vector<double>{2});
  std::vector<float> v(18, 7.25f);
  v[7] = NAN;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  const DatasetPtr out = gaussian_smooth(make_dataset(g, fields), {{}, {0.7}, ""}, context);
  for (size_t i = 0; i < 18; ++i) CHECK((i == 7 ? f_of(out).get(i) != f_of(out).get(i) : std::abs(f_of(out).get(i) - 7.25) < 1e-5));
}

TEST_CASE("gaussian_smooth and resize: the same bytes with any number of threads") {
  Context context;
  const DatasetPtr in = grid_of(
      {70, 60, 50}, [](Vec3 p) { return std::sin(3 * p.x) + p.y * p.z; }, ElementType::f32);
  set_thread_count(1);
  const Array a = f_of(gaussian_smooth(in, {{}, {1.5}, ""}, context)), b = f_of(resize(in, {{90, 30, 77}, Kernel::bspline}, context));
  set_thread_count(8);
  const Array c = f_of(gaussian_smooth(in, {{}, {1.5}, ""}, context)), d = f_of(resize(in, {{90, 30, 77}, Kernel::bspline}, context));
  set_thread_count(0);
  CHECK(std::equal(a.raw(), a.raw() + a.bytes(), c.raw()));
  CHECK(std::equal(b.raw(), b.raw() + b.bytes(), d.raw()));
}

TEST_CASE("gaussian_smooth: bad requests say what would be right") {
  Context context;
  const DatasetPtr labels = grid_of(
      {4, 4, 4}, [](Vec3) { return 2; }, ElementType::i32, Association::point, Role::labels);
  CHECK_THROWS_WITH_AS(gaussian_smooth(labels, {{"f"}, {1}, ""}, context), doctest::Contains("labels"), Error);
  const DatasetPtr in = grid_of({4, 4, 4}, plane);
  CHECK_THROWS_WITH_AS(gaussian_smooth(in, {{}, {1, 2}, ""}, context), doctest::Contains("one or three"), Error);
  CHECK_THROWS_WITH_AS(gaussian_smooth(in, {{}, {-1}, ""}, context), doctest::Contains("not a valid length"), Error);
}
