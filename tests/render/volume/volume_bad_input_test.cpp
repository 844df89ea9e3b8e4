// SPDX-License-Identifier: Apache-2.0
// What a program may hand over by mistake, and views and fields at the edge of what there is: right pictures or clear errors.
#include "render/volume/sources/cells/volume_cells_support.h"
#include "scene/show/volume_parts.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

using doctest::Approx;

VolumeItem even(DatasetPtr data) { return item(std::move(data), one_color({1, 1, 1}), constant_opacity(0.7)); }
std::vector<DatasetPtr> some_meshes() {
  std::vector<DatasetPtr> all{grid(sg::test::cube(5, 0, 1), [](Vec3) { return 2.0; })};
  for (CellType kind : {CellType::tetra, CellType::hexahedron, CellType::polyhedron})
    all.push_back(with_field(sg::test::cube(kind, 2), [](Vec3) { return 2.0; }));
  return all;
}

}  // namespace

TEST_CASE("volume: an opacity without points, that does not ascend or leaves 0..1 is refused") {
  VolumeItem v = even(some_meshes()[0]);
  const auto error = [&](std::vector<Vec2> points) {
    v.opacity.points = std::move(points);
    return error_of([&] { look(scene_of({v})); });
  };
  CHECK(error({}).find("no points") != std::string::npos);
  CHECK(error({{0, 0}, {1, 0.5}, {0.5, 0.2}}).find("not in ascending order: 0.5 comes after 1") != std::string::npos);
  CHECK(error({{0, 0}, {NAN, 0.5}}).find("ascend") != std::string::npos);
  CHECK(error({{0, -0.1}}).find("not between 0 and 1") != std::string::npos);
  CHECK(error({{0, 1.1}}).find("not between 0 and 1") != std::string::npos);
  CHECK(error({{0, NAN}}).find("not between 0 and 1") != std::string::npos);
}

TEST_CASE("volume: constant fields, rays along faces and an eye inside are right in every kind of mesh") {
  for (const DatasetPtr& data : some_meshes()) {
    CAPTURE(data->kind());
    const Scene scene = scene_of({even(data)});
    // Along the face between cells at x = 1/2, and along the edge x = y = 1/2.
    for (const Vec2 p : {Vec2{0.5, 0.3}, Vec2{0.5, 0.5}, Vec2{0.21, 0.37}})
      CHECK(double(look(scene, p.x, p.y).rgba[3]) == Approx(1 - std::exp(-0.7)).epsilon(1e-3));
    const Frame inside = draw(scene, perspective_view(1, 1, 1, {0.4, 0.45, 0.75}, {0.4, 0.45, 0}));
    CHECK(double(inside.rgba[3]) == Approx(1 - std::exp(-0.7 * 0.75)).epsilon(1e-3));
  }
}

TEST_CASE("volume: parts of a collection take one look, and lengths of all of them") {
  UniformGrid a = sg::test::cube(5, 0, 1), b = a;
  b.origin.x = 1;
  VolumeItem first = even(grid(a, [](Vec3 p) { return p.x; })), second = even(grid(b, [](Vec3 p) { return p.x; }));
  first.mode = second.mode = RayFunction::distance;
  first.unit_distance = second.unit_distance = 0;
  first.color.lo = 0, first.color.hi = std::sqrt(3.0), first.levels = {0.5}, second.levels = {1.5};
  std::vector<Item> items{first, second};
  join_volumes(items, first, 3);
  const auto& other = std::get<VolumeItem>(items[1]);
  CHECK(other.group == 3);
  CHECK(other.levels == std::vector<double>{0.5});
  CHECK(other.unit_distance == Approx(0.01 * std::sqrt(6.0)));
  CHECK(other.color.hi == Approx(std::sqrt(6.0)));
  CHECK(other.data == second.data);
  CHECK(std::get<VolumeItem>(items[0]).unit_distance == other.unit_distance);
}
