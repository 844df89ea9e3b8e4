// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/ridges.h"

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "filter/flow/flow_support.h"
#include "support/test.h"

using namespace sg;

namespace {

template <class F>
DatasetPtr height(std::array<size_t, 3> n, F&& f) {
  const double h = 2.0 / double(n[0] - 1);
  const UniformGrid g = test::even_grid(n, {-1, -1, n[2] > 1 ? -1.0 : 0.0}, h);
  Array v = test::at_points(
      g, [&](Vec3 x) { return Vec3(f(x), 0, 0); }, 1);
  FieldSet fields;
  fields.add({"height", Association::point, std::move(v), "", Role::scalars});
  return make_dataset(Mesh(g), std::move(fields));
}

double total(const DatasetPtr& d, const char* field) {
  double sum = 0;
  const Field& f = d->fields().require(field, Association::cell);
  for (size_t i = 0; i < f.array.count(); ++i) sum += f.array.get(i);
  return sum;
}

// A wall along a tilted line, higher in its middle.
const Vec3 across = normalize(Vec3(2, 1, 0)), along = normalize(Vec3(-1, 2, 0));
double wall(Vec3 x) { return (1 - 0.2 * dot(x, along) * dot(x, along)) * std::exp(-8 * (dot(x, across) - 0.05) * (dot(x, across) - 0.05)); }

}  // namespace

TEST_CASE("ridges: the crest of a straight wall is found to second order, and nothing else") {
  Context context;
  double last = 0;
  for (const size_t n : {41, 81}) {
    RidgesParams p;
    p.strength = 0.2, p.smooth = 0;
    const DatasetPtr d = ridges(height({n, n, 1}, wall), p, context);
    const SurfaceMesh& m = *d->as<SurfaceMesh>();
    CHECK(m.lines.size() == 1);  // over the peak, where the other principal direction's line crosses
    double worst = 0;
    for (size_t i = 0; i < m.points.count(); ++i) {
      const Vec3 x = m.points.at(i);
      const double off = std::abs(dot(x, across) - 0.05);
      CHECK(off < 0.02);
      // The order is that inside: second derivatives at the border are of first order, and at the peak the gradient vanishes.
      if (std::abs(x.y) < 0.85 && std::abs(dot(x, along)) > 0.15) worst = std::max(worst, off);
    }
    CHECK(total(d, "length") > 1.8);
    if (last > 0) CHECK(worst < last / 2.5);
    last = worst;
  }
}

TEST_CASE("ridges: fields of the input that other operations mark kinds of lines with do not end any") {
  Context context;
  RidgesParams p;
  p.strength = 0.2, p.smooth = 0;
  const DatasetPtr plain = height({41, 41, 1}, wall);
  DatasetParts parts = plain->parts();
  std::vector<float> numbers(plain->cell_count());
  for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = float(i);
  for (const char* name : {"contour value", "edge type"})
    parts.fields.add({name, Association::cell, Array::from_vector(numbers), "", Role::none});
  const DatasetPtr a = ridges(plain, p, context), b = ridges(make_dataset(std::move(parts)), p, context);
  CHECK(a->point_count() == b->point_count());
  CHECK(total(a, "length") == total(b, "length"));
}

TEST_CASE("ridges: a ring has a circle, its negative the same valley, and a limit cuts it") {
  Context context;
  const auto ring = [](Vec3 x) {
    const double r = std::sqrt(x.x * x.x + x.y * x.y) - 0.6;
    return (2 + x.x) * std::exp(-20 * r * r);
  };
  RidgesParams p;
  p.strength = 0.15, p.smooth = 0.5;
  const DatasetPtr crest = ridges(height({101, 101, 1}, ring), p, context);
  CHECK(total(crest, "length") == doctest::Approx(2 * 3.14159265 * 0.6).epsilon(0.02));
  p.kind = RidgeKind::valleys;
  const DatasetPtr trough = ridges(height({101, 101, 1}, [&](Vec3 x) { return -ring(x); }), p, context);
  CHECK(total(trough, "length") == doctest::Approx(total(crest, "length")).epsilon(1e-6));
  p.kind = RidgeKind::ridges, p.limit = 2.0;  // the half x > 0
  CHECK(total(ridges(height({101, 101, 1}, ring), p, context), "length") == doctest::Approx(3.14159265 * 0.6).epsilon(0.05));
}

TEST_CASE("ridges: in space a sheet has a surface, of the right place and area") {
  Context context;
  RidgesParams p;
  p.strength = 0.3;
  const DatasetPtr in = height({33, 33, 33}, [](Vec3 x) {
    return (1 - 0.2 * (x.x - 0.1) * (x.x - 0.1) - 0.1 * (x.y + 0.2) * (x.y + 0.2)) * std::exp(-6 * (x.z - 0.1) * (x.z - 0.1));
  });
  set_thread_count(1);
  const DatasetPtr one = ridges(in, p, context);
  set_thread_count(8);
  const DatasetPtr many = ridges(in, p, context);
  set_thread_count(0);
  const Array &a = one->as<SurfaceMesh>()->points.xyz, &b = many->as<SurfaceMesh>()->points.xyz;
  REQUIRE(a.bytes() == b.bytes());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  CHECK(one->bounds().lo.z == doctest::Approx(0.1).epsilon(0.1));
  CHECK(one->bounds().hi.z == doctest::Approx(0.1).epsilon(0.1));
  CHECK(one->bounds().size().x > 1.8);
  CHECK(one->bounds().size().y > 1.8);
}

TEST_CASE("ridges: vectors and cell fields are refused by name") {
  Context context;
  UniformGrid g;
  g.dims = {4, 4, 1};
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<float>(48, 1.0f), 3), "", Role::vectors});
  const DatasetPtr d = make_dataset(Mesh(g), std::move(fields));
  CHECK(test::error_of([&] { ridges(d, {.field = {"v"}}, context); }).find("'v'") != std::string::npos);
}
