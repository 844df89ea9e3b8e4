// SPDX-License-Identifier: Apache-2.0
#include "filter/segment/label_surface.h"

#include <map>

#include "base/parallel.h"
#include "support/test.h"

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

DatasetPtr run(const DatasetPtr& d, LabelSurfaceParams p = {}) {
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
  std::vector<uint8_t> v(27, 0);
  v[13] = 5;
  const auto one = run(labels({3, 3, 3}, v));
  CHECK(one->cell_count() == 6);
  CHECK(one->point_count() == 8);
  CHECK(volume(*one) == doctest::Approx(1));
  CHECK(one->bounds().lo == Vec3(0.5, 0.5, 0.5));
  CHECK(one->fields().require("label", Association::cell).array.get(3) == 5);

  v[14] = 7;  // a neighbour with another label: no wall between them
  const auto two = run(labels({3, 3, 3}, v));
  CHECK(two->cell_count() == 10);
  CHECK(two->point_count() == 12);
  CHECK(volume(*two) == doctest::Approx(2));
  LabelSurfaceParams only;
  only.labels = {7};
  CHECK(run(labels({3, 3, 3}, v), only)->cell_count() == 6);
}

TEST_CASE("label surface: volume is the number of voxels on random images, mirrored grids and any number of threads") {
  std::vector<uint8_t> v(512);
  size_t wanted = 0;
  for (size_t i = 0; i < v.size(); ++i) v[i] = uint8_t((i * 2654435761u >> 13) % 3), wanted += v[i] > 0;
  Mat3 mirror;
  mirror.m[0][0] = -1;
  CHECK(volume(*run(labels({8, 8, 8}, v))) == doctest::Approx(double(wanted)));
  CHECK(volume(*run(labels({8, 8, 8}, v, mirror))) == doctest::Approx(double(wanted)));
  const auto eight = run(labels({8, 8, 8}, v));
  set_thread_count(1);
  const auto single = run(labels({8, 8, 8}, v));
  set_thread_count(0);
  const Array &a = eight->as<SurfaceMesh>()->polygons.connectivity, &b = single->as<SurfaceMesh>()->polygons.connectivity;
  REQUIRE(a.count() == b.count());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
}

TEST_CASE("label surface: no label is an empty surface, other meshes are refused") {
  CHECK(run(labels({2, 2, 2}, std::vector<uint8_t>(8, 0)))->cell_count() == 0);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0}, 3);
  CHECK(test::error_of([&] { run(make_dataset(cloud)); }).find("uniform grids") != std::string::npos);
}
