// SPDX-License-Identifier: Apache-2.0
// Shapes drawn out, and height as a field.
#include "filter/field/elevation.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/transform/extrude.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

// Of a closed surface: the volume by the divergence theorem, positive when it faces outwards.
double enclosed(const Dataset& d) {
  const auto& m = *d.as<SurfaceMesh>();
  const CellsView cells = cells_view(m.polygons);
  double sum = 0;
  for (size_t c = 0; c < cells.count; ++c)
    for (size_t i = 1; i + 1 < cells.size(c); ++i)
      sum += dot(m.points.at(size_t(cells.point(c, 0))),
                 cross(m.points.at(size_t(cells.point(c, i))), m.points.at(size_t(cells.point(c, i + 1))))) /
             6;
  return sum;
}

// An L of three unit squares, with a number on each, turned over where asked.
DatasetPtr corner(bool turned) {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 1, 1, 0, 1, 2, 0, 1, 0, 1, 1, 1, 1, 1, 2, 1, 1, 0, 2, 1, 1, 2, 1}, 3);
  std::vector<int32_t> ids = {0, 1, 4, 3, 1, 2, 5, 4, 3, 4, 7, 6};
  if (turned)
    for (size_t c = 0; c < 3; ++c) std::swap(ids[4 * c + 1], ids[4 * c + 3]);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  FieldSet fields;
  fields.add({"n", Association::cell, Array::from_vector<int32_t>({10, 11, 12}), "", Role::none});
  fields.add({"p", Association::point, Array::from_vector<float>({0, 1, 2, 3, 4, 5, 6, 7}), "", Role::none});
  return make_dataset(m, std::move(fields));
}

}  // namespace

TEST_CASE("extrude: a flat shape becomes a closed solid that faces outwards, whichever way it lies") {
  for (const bool turned : {false, true})
    for (const double length : {2.0, -0.5}) {
      CAPTURE(turned);
      CAPTURE(length);
      ExtrudeParams p;
      p.length = length;
      Context context;
      const DatasetPtr out = extrude(corner(turned), p, context);
      CHECK(enclosed(*out) == doctest::Approx(3 * std::abs(length)));
      CHECK(out->cell_count() == 3 + 3 + 8);
      CHECK(out->point_count() == 16);
      CHECK(out->bounds().size().z == doctest::Approx(std::abs(length)));
      const Field &n = out->fields().require("n"), &f = out->fields().require("p"), &from = out->fields().require("original_cell");
      for (size_t c = 0; c < out->cell_count(); ++c) CHECK(n.array.get(c) == 10 + from.array.get(c));
      for (size_t i = 0; i < 16; ++i) CHECK(f.array.get(i) == double(i % 8));
    }
  // Walls alone, along another direction.
  ExtrudeParams p;
  p.caps = false, p.direction = Vec3{3, 0, 4}, p.length = 5;
  Context context;
  const DatasetPtr walls = extrude(corner(false), p, context);
  CHECK(walls->cell_count() == 8);
  CHECK(walls->bounds().hi.x == doctest::Approx(5));
  CHECK(walls->bounds().hi.z == doctest::Approx(5));
}

TEST_CASE("extrude: lines become walls, vertices lines; mistakes are told") {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0, 1, 1, 0}, 3);
  m.vertices = {Array::from_vector<int32_t>({2}), {}, 1};
  m.lines = {Array::from_vector<int32_t>({0, 1, 2}), {}, 3};
  Context context;
  ExtrudeParams p;
  p.length = 1;
  const DatasetPtr out = extrude(make_dataset(m), p, context);
  CHECK(out->as<SurfaceMesh>()->lines.size() == 1);
  CHECK(out->as<SurfaceMesh>()->polygons.size() == 2);
  const Field& from = out->fields().require("original_cell");
  CHECK(from.array.get(0) == 0);
  CHECK(from.array.get(1) == 1);
  CHECK(from.array.get(2) == 1);
  p.length = 0;
  CHECK(error_of([&] { extrude(corner(false), p, context); }).find("length is zero") != std::string::npos);
  p.length = 1, p.direction = Vec3();
  CHECK(error_of([&] { extrude(corner(false), p, context); }).find("direction is zero") != std::string::npos);
}

TEST_CASE("elevation: the height of each point above the origin along the direction") {
  const DatasetPtr box = solid_box(CellType::hexahedron, 2);
  Context context;
  ElevationParams p;
  p.direction = {0, 3, 4}, p.origin = {5, 1, 0}, p.name = "h";
  const DatasetPtr out = elevation(box, p, context);
  const auto& at = out->as<UnstructuredMesh>()->points;
  const Field& h = out->fields().require("h", Association::point);
  for (size_t i = 0; i < out->point_count(); ++i)
    CHECK(h.array.get(i) == doctest::Approx((at.at(i).y - 1) * 0.6 + at.at(i).z * 0.8).epsilon(1e-6));
  CHECK(
      elevation(uniform_box(2, 2, 2), {}, context)->range(elevation(uniform_box(2, 2, 2), {}, context)->fields().require("elevation")).hi ==
      1);
  p.direction = Vec3();
  CHECK(error_of([&] { elevation(box, p, context); }).find("direction is zero") != std::string::npos);
}
