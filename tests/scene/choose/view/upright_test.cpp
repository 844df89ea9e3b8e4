// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/upright.h"

#include <cmath>

#include "scene/look/look.h"
#include "support/test.h"

using namespace sg;

namespace {

// A box in the frame of `turn`, which says to which axis each of its own x, y, z goes.
void add_box(std::vector<float>& xyz, std::vector<int32_t>& ids, Vec3 lo, Vec3 hi, const std::array<int, 3>& turn) {
  const auto base = int32_t(xyz.size() / 3);
  for (int c = 0; c < 8; ++c) {
    const Vec3 p{c & 1 ? hi.x : lo.x, c & 2 ? hi.y : lo.y, c & 4 ? hi.z : lo.z};
    float q[3];
    for (int a = 0; a < 3; ++a) q[turn[size_t(a)]] = float(p[a]);
    xyz.insert(xyz.end(), q, q + 3);
  }
  for (const int32_t i : {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5}) ids.push_back(base + i);
}

// A trunk on four thin feet, with a head in front; its own z is up.
DatasetPtr animal(const std::array<int, 3>& turn) {
  SurfaceMesh m;
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  add_box(xyz, ids, {0, 0.1, 2}, {4, 1.4, 3.5}, turn);
  for (const double x : {0.2, 3.4})
    for (const double y : {0.2, 1.0}) add_box(xyz, ids, {x, y, 0}, {x + 0.3, y + 0.3, 2}, turn);
  add_box(xyz, ids, {4, -0.4, 3}, {5.2, 1.9, 4.2}, turn);
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.polygons = {Array::from_vector(std::move(ids)), {}, 4};
  DatasetParts parts;
  parts.mesh = m;
  return make_dataset(std::move(parts));
}

double stands(const DatasetPtr& d, int axis) {
  const SurfaceMesh* one[] = {d->as<SurfaceMesh>()};
  return stability(one, axis);
}

}  // namespace

TEST_CASE("upright: a shape stands on the hull of its feet, and topples where its middle lies beside them") {
  const DatasetPtr d = animal({0, 1, 2});
  // Seen from above the trunk widens from 1.3 to the 2.3 of the head.
  const double shadow = 4 * (1.3 + 2.3) / 2 + 1.2 * 2.3;
  CHECK(stands(d, 2) == doctest::Approx(3.5 * 1.1 / shadow));
  CHECK(stands(d, 1) == 0);  // on its side it lies on the cheek
  CHECK(stability({}, 2) == 0);
}

TEST_CASE("upright: a cone of many points stands on its base as wide as its shadow, and on its tip on the ring above it") {
  const int around = 96, rings = 60;
  std::vector<float> xyz;
  std::vector<int32_t> ids;
  for (int k = 0; k <= rings; ++k)  // the tip at 0, the base at 0.9
    for (int i = 0; i < around; ++i) {
      const double h = 0.015 * k, a = 2 * M_PI * i / around;
      for (const double c : {0.5 * h * std::cos(a), 0.5 * h * std::sin(a), h}) xyz.push_back(float(c));
    }
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < around; ++i) {
      const int j = (i + 1) % around;
      for (const int id : {k * around + i, k * around + j, (k + 1) * around + j, (k + 1) * around + i}) ids.push_back(id);
    }
  const auto cone = [&](double sign) {
    std::vector<float> turned = xyz;
    for (size_t i = 2; i < turned.size(); i += 3) turned[i] *= float(sign);
    SurfaceMesh m;
    m.points.xyz = Array::from_vector(std::move(turned), 3);
    m.polygons = {Array::from_vector(ids), {}, 4};
    DatasetParts parts;
    parts.mesh = m;
    return stands(make_dataset(std::move(parts)), 2);
  };
  CHECK(cone(-1) == doctest::Approx(1).epsilon(1e-6));
  CHECK(cone(1) == doctest::Approx(1.0 / rings / rings).epsilon(1e-4));  // 0.015 of 0.9; the next ring is above a fiftieth of the height
}

TEST_CASE("upright: up is where a shape stands, whatever is customary in files of its kind") {
  const std::array<int, 3> z_up{0, 1, 2}, y_up{0, 2, 1};
  const auto up_of = [](const std::array<int, 3>& turn, const std::string& extension, std::string* said = nullptr) {
    const DatasetPtr d = animal(turn);
    CameraDefaults camera = choose_view(d->bounds(), extension, false);
    const std::string why = stand_upright({&d, 1}, extension, camera);
    if (said) *said = why;
    return camera.up;
  };
  for (const char* extension : {"stl", "obj", "ply", "vtp"}) {
    CHECK(up_of(z_up, extension) == Vec3{0, 0, 1});
    CHECK(up_of(y_up, extension) == Vec3{0, 1, 0});
  }
  std::string said;
  up_of(y_up, "stl", &said);
  CHECK(said.find("up is y") != std::string::npos);
  up_of(z_up, "stl", &said);
  CHECK(said.empty());
  CHECK(up_of(z_up, "glb") == Vec3{0, 1, 0});  // glTF defines it
}

TEST_CASE("upright: where the other axis is better, but not clearly, it is said what is taken for up") {
  SurfaceMesh m;  // a bar of six sides along x, on one that is narrow
  m.points.xyz = Array::from_vector<float>(
      {-2, -0.15f, -1, 2, -0.15f, -1, 2, 0.15f, -1, -2, 0.15f, -1, -2, -1, 0, 2, -1, 0, 2, 1, 0, -2, 1, 0, -2, 0, 1.5f, 2, 0, 1.5f}, 3);
  m.polygons = {Array::from_vector<int32_t>({0, 3, 2, 1, 0, 1, 5, 4, 2, 3, 7, 6, 4, 5, 9, 8, 6, 7, 8, 9}), {}, 4};
  DatasetParts parts;
  parts.mesh = m;
  const DatasetPtr d = make_dataset(std::move(parts));
  CHECK(stands(d, 2) == doctest::Approx(0.3 / 2));
  CHECK(stands(d, 1) == 0);
  CameraDefaults camera = choose_view(d->bounds(), "obj", false);
  CHECK(stand_upright({&d, 1}, "obj", camera).find("up is y, as in most files of this kind") != std::string::npos);
  CHECK(camera.up == Vec3{0, 1, 0});
  CHECK(stand_upright({&d, 1}, "stl", camera).empty());
  CHECK(stand_upright({&d, 1}, "", camera).empty());  // not of a file
}

TEST_CASE("upright: a ball stands nowhere, and nothing is said of it") {
  SurfaceMesh m;  // an octahedron on its tip
  m.points.xyz = Array::from_vector<float>({1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1}, 3);
  m.polygons = {Array::from_vector<int32_t>({0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5}), {}, 3};
  DatasetParts parts;
  parts.mesh = m;
  const DatasetPtr d = make_dataset(std::move(parts));
  CHECK(stands(d, 2) == 0);
  CameraDefaults camera = choose_view(d->bounds(), "stl", false);
  CHECK(stand_upright({&d, 1}, "stl", camera).empty());
}
