// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/head_pose.h"

#include "support/test.h"

using namespace sg;

namespace {

// A skull around a brain over a neck with its spine, in Hounsfield units + 1024; a cavity at the face. `up` and `front` turn it about.
DatasetPtr head(int up, int front, bool skull = true, bool patient = false) {
  constexpr int n = 40;
  std::vector<uint16_t> values;
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const double x = i - 19.5, y = (j - 19.5) * -front, z = (k - 19.5) * up;  // the face at low y, the crown at high z
        const double r = std::hypot(x, y), neck = std::hypot(x, y - 4);
        int hu = -1000;
        if (z > -4) hu = r < 13 ? 35 : r < 15 && skull ? 1200 : r < 17 ? 20 : -1000;
        else hu = neck < 3 ? 900 : neck < 10 ? 40 : -1000;
        if (z > -2 && z < 4 && std::hypot(x, y + 9) < 2.5) hu = -900;
        values.push_back(uint16_t(hu + 1024));
      }
  UniformGrid g;
  g.dims = {n, n, n};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"ct", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  parts.notes.emplace_back("Modality", "CT");
  if (patient) parts.notes.emplace_back("space", "left-posterior-superior");
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("head pose: the skull tells where the crown is, cavities where the face is") {
  for (const int up : {-1, 1})
    for (const int front : {-1, 1}) {
      INFO(up << ' ' << front);
      const auto pose = unstated_pose(*head(up, front));
      REQUIRE(pose);
      CHECK(pose->crown == up);
      CHECK(pose->face == front);
      CameraDefaults camera;
      REQUIRE(stand_up(*pose, camera));
      CHECK(camera.up == Vec3{0, 0, double(up)});
      CHECK(camera.direction.y * front > 0);
      CHECK(dot(camera.direction, camera.up) > 0);
      // As in the patient frame: left is across front and up.
      CHECK(camera.axes.left == cross(camera.axes.up, camera.axes.front));
    }
}

TEST_CASE("head pose: not known without a skull, not asked where the file states it") {
  const auto pose = unstated_pose(*head(1, 1, false));
  REQUIRE(pose);
  CHECK(pose->crown == 0);
  CameraDefaults camera;
  CHECK_FALSE(stand_up(*pose, camera));
  CHECK(camera.up == CameraDefaults().up);
  CHECK_FALSE(unstated_pose(*head(1, 1, true, true)));
}
