// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

// Binary STL of the triangles given as nine floats each.
std::string binary_stl(const std::vector<float>& xyz, std::string header = "solid that is binary all the same") {
  header.resize(80, ' ');
  const auto n = uint32_t(xyz.size() / 9);
  header.append(reinterpret_cast<const char*>(&n), 4);
  for (uint32_t t = 0; t < n; ++t) {
    header.append(12, '\0');
    header.append(reinterpret_cast<const char*>(&xyz[t * 9]), 36);
    header.append("at");
  }
  return header;
}

// A torus of n x m quads, two triangles each: every point is used six times.
std::vector<float> torus(int n, int m) {
  auto point = [&](int i, int j, std::vector<float>& out) {
    const double u = 2 * M_PI * (i % n) / n, v = 2 * M_PI * (j % m) / m;
    out.push_back(float((2 + std::cos(v)) * std::cos(u)));
    out.push_back(float((2 + std::cos(v)) * std::sin(u)));
    out.push_back(float(std::sin(v)));
  };
  std::vector<float> r;
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      point(i, j, r), point(i + 1, j, r), point(i, j + 1, r);
      point(i + 1, j, r), point(i + 1, j + 1, r), point(i, j + 1, r);
    }
  return r;
}

bool corners_are(const DatasetPtr& d, const std::vector<float>& xyz) {
  const SurfaceMesh& s = surface_of(d);
  const CellsView v = cells_view(s.polygons);
  if (v.count * 9 != xyz.size()) return false;
  for (size_t c = 0; c < v.count * 3; ++c)
    for (int a = 0; a < 3; ++a)
      if (s.points.xyz.get(size_t(v.connectivity[c]), a) != double(xyz[c * 3 + size_t(a)])) return false;
  return true;
}

}  // namespace

TEST_CASE("stl: points of a binary file are merged exactly, in the order of their first use") {
  const std::vector<float> xyz{0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 1, 0, 0, 1, 1, 0, -0.0f, 1, 0};
  const auto d = read_text("q.stl", binary_stl(xyz));
  CHECK(d->point_count() == 4);
  CHECK(d->cell_count() == 2);
  CHECK(surface_of(d).polygons.fixed == 3);
  const CellsView v = cells_view(surface_of(d).polygons);
  const int want[6] = {0, 1, 2, 1, 3, 2};
  for (size_t i = 0; i < 6; ++i) CHECK(v.connectivity[i] == want[i]);
  CHECK(corners_are(d, xyz));
}

TEST_CASE("stl: a large surface keeps every corner, is closed, and is the same for 1 and 4 threads") {
  const int n = 300, m = 200;
  const auto xyz = torus(n, m);
  const std::string path = temp_file("torus.stl", binary_stl(xyz));
  const auto one = with_threads(1, [&] { return read_file(path); });
  const auto four = with_threads(4, [&] { return read_file(path); });
  CHECK(one->point_count() == size_t(n * m));  // Euler: V - E + F = 0 with E = 3V, F = 2V
  CHECK(one->cell_count() == size_t(2 * n * m));
  CHECK(corners_are(one, xyz));
  CHECK(same_array(surface_of(one).points.xyz, surface_of(four).points.xyz));
  CHECK(same_array(surface_of(one).polygons.connectivity, surface_of(four).polygons.connectivity));
  int64_t seen = -1;
  bool ordered = true;
  const CellsView v = cells_view(surface_of(one).polygons);
  for (size_t i = 0; i < v.count * 3; ++i) {
    ordered = ordered && v.connectivity[i] <= seen + 1;
    seen = std::max(seen, v.connectivity[i]);
  }
  CHECK(ordered);
}

TEST_CASE("stl: triangles in any order merge the same points") {
  auto xyz = torus(120, 90);
  const size_t n = xyz.size() / 9;
  uint64_t state = 1;
  for (size_t i = n; i-- > 1;) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    const size_t j = (state >> 33) % (i + 1);
    if (i != j) std::swap_ranges(xyz.begin() + ptrdiff_t(9 * i), xyz.begin() + ptrdiff_t(9 * i + 9), xyz.begin() + ptrdiff_t(9 * j));
  }
  const auto d = read_text("mixed.stl", binary_stl(xyz));
  CHECK(d->point_count() == 120 * 90);
  CHECK(corners_are(d, xyz));
}

TEST_CASE("stl: ASCII in any layout") {
  const std::string text =
      "solid a name\r\n facet normal 0 0 1\r\n  outer loop\r\n   vertex 0 0 0\r\n\tVERTEX 1.5e0 0 0\r\n vertex 0 1 -.25\r\n endloop\r\n "
      "endfacet\r\nendsolid a name\r\n";
  const auto d = read_text("a.stl", text);
  CHECK(d->point_count() == 3);
  CHECK(d->cell_count() == 1);
  CHECK(surface_of(d).points.xyz.get(1, 0) == 1.5);
  CHECK(surface_of(d).points.xyz.get(2, 2) == -0.25);
  CHECK(d->notes().at(0).second == "a name");
  CHECK(read_text("e.stl", "solid\nendsolid\n")->cell_count() == 0);
}

TEST_CASE("stl: writing and reading back, binary and ASCII") {
  const auto xyz = torus(40, 30);
  const auto d = read_text("t.stl", binary_stl(xyz));
  Context context;
  for (const bool binary : {true, false}) {
    WriteOptions o;
    o.binary = binary;
    const std::string path = temp_folder() + "w.stl";
    write_data(path, d, o, context);
    CHECK(corners_are(read_file(path), xyz));
  }
}

TEST_CASE("stl: polygons and strips are cut into triangles that keep their side") {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}, 3);
  m.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 0, 1});
  m.polygons.offsets = Array::from_vector(std::vector<int32_t>{0, 4, 6});  // the second polygon has two points only
  m.strips.connectivity = Array::from_vector(std::vector<int32_t>{1, 4, 2, 5});
  m.strips.offsets = Array::from_vector(std::vector<int32_t>{0, 4});
  Context context;
  const std::string path = temp_folder() + "p.stl";
  write_data(path, make_dataset(m), {}, context);
  const auto d = read_file(path);
  CHECK(d->cell_count() == 4);
  const SurfaceMesh& s = surface_of(d);
  const CellsView v = cells_view(s.polygons);
  double area = 0;
  for (size_t c = 0; c < 4; ++c) {
    const Vec3 a = s.points.at(size_t(v.point(c, 0))), b = s.points.at(size_t(v.point(c, 1))), e = s.points.at(size_t(v.point(c, 2)));
    CHECK(cross(b - a, e - a).z > 0);
    area += 0.5 * cross(b - a, e - a).z;
  }
  CHECK(area == doctest::Approx(2));
}

TEST_CASE("stl: other meshes are told to extract their surface") {
  Context context;
  CHECK(contains(error_of([&] { write_data(temp_folder() + "x.stl", make_dataset(UniformGrid{}), {}, context); }), "-f 'faces'"));
}

TEST_CASE("stl: bad files are refused") {
  CHECK(contains(refusal("b.stl", "hello"), "too short for STL"));
  CHECK(contains(refusal("b.stl", binary_stl(torus(4, 4)).substr(0, 500)), "32 triangles need 1684 bytes, but there are 500"));
  std::vector<float> nan{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, std::nanf(""), 0};
  CHECK(contains(refusal("b.stl", binary_stl(nan)), "triangle 1 has a coordinate"));
  const std::string facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  CHECK(contains(refusal("b.stl", "solid\n" + facet), "truncated"));
  CHECK(contains(refusal("b.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n"), "line 4: 'vertex' does not have three numbers"));
  CHECK(contains(
      refusal("b.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nendloop\nendfacet\n" + facet + "endsolid\n"),
      "three vertices"));
  CHECK(contains(refusal("b.stl", "solid\nfacet normal 0 0 1\npoint 0 0 0\nendsolid\n"), "line 3: 'point' is not an STL keyword"));
}

TEST_CASE("stl: cut and damaged files give errors, never crashes") {
  CHECK(cut_and_damage("cut.stl", binary_stl(torus(5, 4))) == 63);
  std::string text = "solid t\n";
  for (int i = 0; i < 20; ++i)
    text += fmt::format("facet normal 0 0 1\nouter loop\nvertex {} 0 0\nvertex 1 {} 0\nvertex 0 1 0\nendloop\nendfacet\n", i, i);
  CHECK(cut_and_damage("cut.stl", text + "endsolid t\n") == 63);
}
