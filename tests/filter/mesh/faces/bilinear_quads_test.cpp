// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/faces/bilinear_quads.h"

#include <map>

#include "filter/mesh/surface.h"
#include "support/test.h"

using namespace sg;

namespace {

// Two unit squares and a triangle side by side along x, with values v at their seven points and a number on each cell.
DatasetPtr strip(std::vector<float> v) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0, 3, 0, 0}, 3);
  m.polygons = {Array::from_vector<int32_t>({0, 1, 4, 3, 1, 2, 5, 4, 2, 6, 5}), Array::from_vector<int32_t>({0, 4, 8, 11}), 0};
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  fields.add({"cell", Association::cell, Array::from_vector<int32_t>({5, 6, 7}), "", Role::none});
  return make_dataset(Mesh(std::move(m)), std::move(fields));
}

// xy on the first square, so that it twists; zero on x = 1 and beyond but for the corner (2, 1).
const std::vector<float> twisted{0, 0, 0, 0, 1, 0, 0};

}  // namespace

TEST_CASE("bilinear quads: inside a square values are those of the bilinear map, as positions are") {
  const DatasetPtr parts = bilinear_parts(strip(twisted), "v");
  const SurfaceMesh& m = *parts->as<SurfaceMesh>();
  CHECK(m.polygons.size() == 3 * 64);
  const Field &v = parts->fields().require("v"), &cell = parts->fields().require("cell");
  size_t inside = 0;
  for (size_t p = 0; p < m.points.count(); ++p) {
    const Vec3 x = m.points.at(p);
    if (x.x > 1) continue;
    CHECK(v.array.get(p) == doctest::Approx(x.x * x.y).epsilon(1e-6));
    ++inside;
  }
  CHECK(inside == 81);
  for (size_t c = 0; c < 3 * 64; ++c) CHECK(cell.array.get(c) == 5 + double(c / 64));
}

TEST_CASE("bilinear quads: neighbours share the points of their edge, so that no crack opens") {
  const DatasetPtr parts = bilinear_parts(strip(twisted), "v");
  const SurfaceMesh& m = *parts->as<SurfaceMesh>();
  // Each inner edge belongs to two parts; the outline of 2 x 1 and the triangle has 6 edges and its slanted one, of 8 parts each.
  std::map<std::pair<int64_t, int64_t>, int> uses;
  const CellsView v = cells_view(m.polygons);
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 0; k < v.size(c); ++k) ++uses[std::minmax(v.point(c, k), v.point(c, (k + 1) % v.size(c)))];
  size_t outer = 0;
  for (const auto& [edge, n] : uses) {
    CHECK(n <= 2);
    outer += n == 1;
  }
  CHECK(outer == 7 * 8);
  double area = 0;
  for (size_t c = 0; c < v.count; ++c) {
    Vec3 twice;
    for (size_t k = 1; k + 1 < v.size(c); ++k) {
      const auto at = [&](size_t i) { return m.points.at(size_t(v.point(c, i))); };
      twice += cross(at(k) - at(0), at(k + 1) - at(0));
    }
    CHECK(twice.z > 0);
    area += 0.5 * twice.z;
  }
  CHECK(area == doctest::Approx(2.5));
}

TEST_CASE("bilinear quads: a field that is linear over every square, and one of cells, leave the surface as it is") {
  const DatasetPtr plane = strip({0, 1, 2, 3, 4, 5, 3});
  CHECK(bilinear_parts(plane, "v") == plane);
  CHECK(bilinear_parts(plane, "cell") == plane);
}
