// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_surface.h"

#include <algorithm>
#include <map>

#include "base/random.h"
#include "segment_support.h"

using namespace sg;

namespace {

DatasetPtr labels(std::array<size_t, 3> d, const std::vector<uint8_t>& v, Mat3 direction = {}) {
  UniformGrid g;
  g.dims = d;
  g.direction = direction;
  FieldSet f;
  f.add({"label", Association::point, Array::from_vector(v), "", Role::scalars});
  return make_dataset(g, f);
}

DatasetPtr surface_of_labels(const DatasetPtr& d, LabelSurfaceParams p = {}) {
  Context context;
  return label_surface(d, p, context);
}

// Volume enclosed by the quads, positive when they face outward (divergence theorem).
double volume(const Dataset& d) {
  const auto& m = *d.as<SurfaceMesh>();
  const CellsView c = cells_view(m.polygons);
  double sum = 0;
  for (size_t q = 0; q < c.count; ++q) {
    const Vec3 a = m.points.at(size_t(c.point(q, 0))), b = m.points.at(size_t(c.point(q, 1))), e = m.points.at(size_t(c.point(q, 2))),
               f = m.points.at(size_t(c.point(q, 3)));
    sum += dot(a, cross(b, e)) + dot(a, cross(e, f));
  }
  return sum / 6;
}

}  // namespace

TEST_CASE("label surface: the box of each voxel, closed and facing outward, with its label") {
  LabelSurfaceParams boxes;
  boxes.smooth = boxes.walls = false;
  std::vector<uint8_t> v(27, 0);
  v[13] = 5;
  const auto one = surface_of_labels(labels({3, 3, 3}, v), boxes);
  CHECK(one->cell_count() == 6);
  CHECK(one->point_count() == 8);
  CHECK(volume(*one) == doctest::Approx(1));
  CHECK(one->bounds().lo == Vec3(0.5, 0.5, 0.5));
  CHECK(one->fields().require("label", Association::cell).array.get(3) == 5);

  v[14] = 7;  // a neighbour with another label: no wall between them
  const auto two = surface_of_labels(labels({3, 3, 3}, v), boxes);
  CHECK(two->cell_count() == 10);
  CHECK(two->point_count() == 12);
  CHECK(volume(*two) == doctest::Approx(2));
  LabelSurfaceParams only = boxes;
  only.labels = {7};
  CHECK(surface_of_labels(labels({3, 3, 3}, v), only)->cell_count() == 6);
}

TEST_CASE("label surface: volume is the number of voxels on random images, mirrored grids and any number of threads") {
  std::vector<uint8_t> v(512);
  size_t wanted = 0;
  for (size_t i = 0; i < v.size(); ++i) v[i] = uint8_t((i * 2654435761u >> 13) % 3), wanted += v[i] > 0;
  Mat3 mirror;
  mirror.m[0][0] = -1;
  LabelSurfaceParams boxes;
  boxes.smooth = boxes.walls = false;
  CHECK(volume(*surface_of_labels(labels({8, 8, 8}, v), boxes)) == doctest::Approx(double(wanted)));
  CHECK(volume(*surface_of_labels(labels({8, 8, 8}, v, mirror), boxes)) == doctest::Approx(double(wanted)));
  const auto eight = surface_of_labels(labels({8, 8, 8}, v), boxes);
  set_thread_count(1);
  const auto single = surface_of_labels(labels({8, 8, 8}, v), boxes);
  set_thread_count(0);
  const Array &a = eight->as<SurfaceMesh>()->polygons.connectivity, &b = single->as<SurfaceMesh>()->polygons.connectivity;
  REQUIRE(a.count() == b.count());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

TEST_CASE("label surface: no label is an empty surface, other meshes are refused") {
  CHECK(surface_of_labels(labels({2, 2, 2}, std::vector<uint8_t>(8, 0)))->cell_count() == 0);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0}, 3);
  CHECK(test::error_of([&] { surface_of_labels(make_dataset(cloud)); }).find("uniform and rectilinear") != std::string::npos);
}

namespace {

struct Measures {
  double area = 0, volume = 0;
  bool closed = true;
};

// Of the faces around one label, those of it on the second side turned round; two triangles per quad.
Measures around_label(const Dataset& d, int64_t label) {
  const auto& m = *d.as<SurfaceMesh>();
  const CellsView c = cells_view(m.polygons);
  const Array& sides = d.fields().require("sides", Association::cell).array;
  Measures r;
  std::map<std::pair<int64_t, int64_t>, int> edges;  // directed edges must cancel
  for (size_t q = 0; q < c.count; ++q) {
    const bool first = int64_t(sides.get(q, 0)) == label, second = int64_t(sides.get(q, 1)) == label;
    if (first == second) continue;
    Vec3 p[4];
    for (size_t k = 0; k < 4; ++k) {
      p[k] = m.points.at(size_t(c.point(q, k)));
      const int64_t a = c.point(q, k), b = c.point(q, (k + 1) % 4);
      edges[{std::min(a, b), std::max(a, b)}] += (a < b ? 1 : -1) * (first ? 1 : -1);
    }
    const double sign = first ? 1 : -1;
    for (int t = 1; t < 3; ++t) {
      r.area += length(cross(p[t] - p[0], p[t + 1] - p[0])) / 2;
      r.volume += sign * dot(p[0], cross(p[t], p[t + 1])) / 6;
    }
  }
  for (const auto& [edge, n] : edges) r.closed = r.closed && n == 0;
  return r;
}

DatasetPtr balls(size_t n, double radius, Vec3 spacing, bool halves) {
  const Vec3 c = spacing * (0.5 * double(n) - 0.3);
  return test::image_of<uint8_t>(
      {n, n, n}, [=](Vec3 p) { return length(p - c) < radius ? 1.0 + (halves && p.x > c.x) : 0.0; }, spacing, Role::labels);
}

}  // namespace

TEST_CASE("label surface: a smooth ball has its area and volume, where stairs have half as much again") {
  const double area = 4 * M_PI * 20 * 20, volume = area * 20 / 3;
  const auto d = balls(48, 20, {1, 1, 1}, false);
  const Measures smooth = around_label(*surface_of_labels(d), 1);
  CHECK(smooth.area == doctest::Approx(area).epsilon(0.02));
  CHECK(smooth.volume == doctest::Approx(volume).epsilon(0.005));
  CHECK(smooth.closed);
  LabelSurfaceParams boxes;
  boxes.smooth = false;
  CHECK(around_label(*surface_of_labels(d, boxes), 1).area == doctest::Approx(1.5 * area).epsilon(0.02));
  const Measures flat = around_label(*surface_of_labels(balls(48, 20, {1, 1.5, 0.9}, false)), 1);
  CHECK(flat.area == doctest::Approx(area).epsilon(0.025));
  CHECK(flat.volume == doctest::Approx(volume).epsilon(0.01));
}

TEST_CASE("label surface: no smooth point is farther than half a sample from its corner") {
  const auto d = balls(24, 9, {1, 1, 1}, true);
  LabelSurfaceParams boxes;
  boxes.smooth = false;
  const auto a = surface_of_labels(d), b = surface_of_labels(d, boxes);
  REQUIRE(a->point_count() == b->point_count());
  const Points &p = a->as<SurfaceMesh>()->points, &q = b->as<SurfaceMesh>()->points;
  double most = 0;
  for (size_t i = 0; i < p.count(); ++i)
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(p.at(i)[c] - q.at(i)[c]));
  CHECK(most <= 0.50001);
  CHECK(most > 0.3);
}

TEST_CASE("label surface: two halves of a ball share a flat wall, each closed") {
  const auto s = surface_of_labels(balls(48, 20, {1, 1, 1}, true));
  const Measures one = around_label(*s, 1), two = around_label(*s, 2);
  CHECK(one.closed);
  CHECK(two.closed);
  const double half = 2 * M_PI * 400, disc = M_PI * 400;
  CHECK(one.area == doctest::Approx(half + disc).epsilon(0.03));
  CHECK(one.volume + two.volume == doctest::Approx(4 * M_PI / 3 * 8000).epsilon(0.005));
  // Faces between both look from 1 to 2, along x.
  const Array& sides = s->fields().require("sides", Association::cell).array;
  size_t walls = 0;
  for (size_t q = 0; q < sides.count(); ++q) walls += sides.get(q, 0) == 1 && sides.get(q, 1) == 2;
  CHECK(double(walls) == doctest::Approx(disc).epsilon(0.03));
  LabelSurfaceParams none;
  none.walls = false;
  CHECK(surface_of_labels(balls(48, 20, {1, 1, 1}, true), none)->cell_count() == s->cell_count() - walls);
}

TEST_CASE("label surface: a hundred thousand labels, each closed around its one sample") {
  std::vector<int32_t> v(47 * 47 * 47);
  for (size_t i = 0; i < v.size(); ++i) v[i] = int32_t(i) - 3000;  // negative ones too; 0 is nothing
  UniformGrid g;
  g.dims = {47, 47, 47};
  FieldSet f;
  f.add({"label", Association::point, Array::from_vector(v), "", Role::scalars});
  const auto s = surface_of_labels(make_dataset(g, f));
  CHECK(s->cell_count() == 3 * 47 * 47 * 48);
  LabelSurfaceParams boxes;
  boxes.smooth = false;
  const auto b = surface_of_labels(make_dataset(g, f), boxes);
  for (const int64_t label : {int64_t(-3000), int64_t(-1), int64_t(50000), int64_t(v.back())}) {
    CHECK(around_label(*s, label).closed);
    CHECK(around_label(*b, label).volume == doctest::Approx(1).epsilon(1e-4));
  }
}

TEST_CASE("label surface: random labels are closed in every type; NaN and hidden samples are nothing") {
  const auto noise = [](Vec3 p) { return std::floor(4 * random_unit(3, uint64_t(p.x + 16 * (p.y + 16 * p.z)))); };
  for (const auto& d : {test::image_of<int16_t>({16, 16, 16}, noise), test::image_of<uint16_t>({16, 16, 16}, noise),
                        test::image_of<float>({16, 16, 16}, noise), test::image_of<uint64_t>({16, 16, 16}, noise)}) {
    const auto s = surface_of_labels(d);
    for (int64_t label = 1; label < 4; ++label) CHECK(around_label(*s, label).closed);
  }
  const auto one = [](Vec3 p) { return p == Vec3(1, 1, 1) ? double(NAN) : 1.0; };
  const auto d = test::with_hidden_points(test::image_of<float>({3, 3, 3}, one), [](size_t i) { return i == 26; });
  LabelSurfaceParams boxes;
  boxes.smooth = false;
  CHECK(around_label(*surface_of_labels(d, boxes), 1).volume == doctest::Approx(25));
}

TEST_CASE("label surface: labels beyond 32 bits, values that are no labels, cells of rectilinear grids") {
  std::vector<int64_t> v(27, 0);
  v[13] = int64_t(1) << 40, v[14] = -(int64_t(1) << 41);
  UniformGrid g;
  g.dims = {3, 3, 3};
  FieldSet f;
  f.add({"label", Association::point, Array::from_vector(v), "", Role::scalars});
  const auto s = surface_of_labels(make_dataset(g, f));
  CHECK(s->cell_count() == 11);
  CHECK(around_label(*s, int64_t(1) << 40).closed);
  const auto half = test::image_of<float>({3, 3, 3}, [](Vec3 p) { return p.x + 0.5; });
  CHECK(test::error_of([&] { surface_of_labels(half); }).find("not a label field") != std::string::npos);

  RectilinearGrid r;
  r.x = Array::from_vector<double>({0, 1, 2, 3, 4}), r.y = Array::from_vector<double>({5, 3, 1, -1}),
  r.z = Array::from_vector<float>({0, 1, 2, 3});
  std::vector<uint8_t> cells(4 * 3 * 3, 0);
  cells[5 + 12] = cells[6 + 12] = 9;
  FieldSet c;
  c.add({"label", Association::cell, Array::from_vector(cells), "", Role::labels});
  LabelSurfaceParams boxes;
  boxes.smooth = false;
  const auto b = surface_of_labels(make_dataset(r, c), boxes);
  CHECK(b->bounds().lo == Vec3(1, 1, 1));
  CHECK(b->bounds().hi == Vec3(3, 3, 2));
  CHECK(around_label(*b, 9).volume == doctest::Approx(4));
}

TEST_CASE("label surface: the same points for any number of threads") {
  const auto d = balls(60, 25, {1, 1, 1}, true);
  const auto points = [&](int threads) {
    set_thread_count(threads);
    const auto s = surface_of_labels(d);
    set_thread_count(0);
    return s->as<SurfaceMesh>()->points.xyz;
  };
  const Array a = points(1), b = points(8);
  REQUIRE(a.bytes() == b.bytes());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}
