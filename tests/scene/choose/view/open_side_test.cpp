// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/open_side.h"

#include "support/test.h"

using namespace sg;

namespace {

// The faces of the unit cube without one of them (-1: all), looking outward or inward.
SurfaceMesh cube(int without, bool inward, double far = 0) {
  constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};  // -x +x -y +y -z +z
  SurfaceMesh m;
  std::vector<float> xyz;
  for (int c = 0; c < 8; ++c)
    for (int a = 0; a < 3; ++a) xyz.push_back(float((c >> a & 1) + far));
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  std::vector<int32_t> ids;
  for (int f = 0; f < 6; ++f)
    for (int k = 0; k < 4 && f != without; ++k) ids.push_back(faces[f][inward ? 3 - k : k]);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  return m;
}

}  // namespace

TEST_CASE("open side: out of the missing face, whichever way the others look, wherever the box stands") {
  constexpr Vec3 out[6] = {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}};
  for (int without = 0; without < 6; ++without)
    for (const bool inward : {false, true})
      for (const double far : {0.0, 100.0}) {
        CAPTURE(without);
        CAPTURE(inward);
        const auto open = open_side(cube(without, inward, far));
        REQUIRE(open);
        CHECK(length(*open - out[without]) < 1e-6);
      }
}

TEST_CASE("open side: closed and empty surfaces have none") {
  CHECK_FALSE(open_side(cube(-1, false)));
  CHECK_FALSE(open_side(cube(-1, true)));
  CHECK_FALSE(open_side(SurfaceMesh()));
}
