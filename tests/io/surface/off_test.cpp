// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include "io/mesh/mesh_robust.h"

using namespace sg;

namespace {

void put(std::string& s, float v) {
  char b[4];
  std::memcpy(b, &v, 4);
  std::reverse(b, b + 4);
  s.append(b, 4);
}
void put(std::string& s, int32_t v) {
  char b[4];
  std::memcpy(b, &v, 4);
  std::reverse(b, b + 4);
  s.append(b, 4);
}

const std::string colored =
    "# first\nCNOFF # second\n4 3 0\n0 0 0  0 0 1  1 0 0 1\n1 0 0 0 0 1 0 1 0 1 # end\n1 1 0 0 0 1 0 0 1 1\n0 1 0 0 0 1 0 0 0 0.5\n"
    "3 0 1 2 255 0 0\n2 0 2\n3 0 2 3\n";

}  // namespace

TEST_CASE("off: colours, normals and faces of any size") {
  const DatasetPtr d = test::read_text("a.off", colored);
  const auto& m = *d->as<SurfaceMesh>();
  CHECK(d->point_count() == 4);
  CHECK(m.lines.size() == 1);
  CHECK(m.polygons.size() == 2);
  CHECK(m.polygons.fixed == 3);
  CHECK(d->fields().require("Normals").array.get(3, 2) == 1);
  const Array rgba = d->fields().require("RGBA", Association::point).array;
  CHECK(rgba.get(1, 1) == 255);
  CHECK(rgba.get(3, 3) == 128);
  const Array face = d->fields().require("RGBA", Association::cell).array;  // the line comes first
  CHECK(face.get(0, 0) == 200);
  CHECK(face.get(1, 0) == 255);
  CHECK(face.get(1, 1) == 0);
}

TEST_CASE("off: header and numbers wherever blanks allow them") {
  const DatasetPtr d = test::read_text("b.off", "\t\n  OFF3 1 0\n0 0\n0\n 1 0 0\r\n  0 1\t0\n\n 3 0\n 1 2");
  CHECK(d->point_count() == 3);
  CHECK(d->as<SurfaceMesh>()->polygons.size() == 1);
}

TEST_CASE("off: binary files are big-endian") {
  std::string s = "STOFF BINARY\n";
  for (int32_t n : {3, 1, 3}) put(s, n);
  for (int k = 0; k < 3; ++k)
    for (float v : {float(k), float(k * k), 0.5f, 0.25f, 0.75f}) put(s, v);
  for (int32_t n : {3, 2, 1, 0, 3}) put(s, n);
  for (float v : {0.f, 1.f, 0.f}) put(s, v);
  const DatasetPtr d = test::read_text("c.off", s);
  CHECK(d->as<SurfaceMesh>()->points.at(2) == Vec3(2, 4, 0.5));
  CHECK(d->fields().require("TCoords").array.get(1, 1) == 0.75);
  CHECK(d->fields().require("RGBA").array.get(0, 1) == 255);
  test::check_survives("robust.off", s);
}

TEST_CASE("off: what is wrong is named with its line") {
  auto message = [](const std::string& s) { return test::error_of([&] { test::read_bytes("w.off", s); }); };
  CHECK(message("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n").find("line 6: vertex 3") != std::string::npos);
  CHECK(message("OFF\n3000000000 1 0\n").find("line 2") != std::string::npos);
  CHECK(message("OFF\n-1 1 0\n").find("line 2") != std::string::npos);
  CHECK(message("OFF\n2 0 0\n0 0 zero\n").find("'zero'") != std::string::npos);
  CHECK(message("OFF\n2 0 0\n0 0 nan\n1 1 1\n").find("finite") != std::string::npos);
}

TEST_CASE("off: cut and damaged files are refused") {
  test::check_survives("robust.off", colored);
  test::check_survives_sizes("robust.off", colored);
}
