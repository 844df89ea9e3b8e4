// SPDX-License-Identifier: Apache-2.0
// Cells without a reference map: polygons, polyhedra, prisms, strips, poly-lines; mean value coordinates.
#include <algorithm>

#include "cell_cases.h"
#include "data/cells/shape/cell_map.h"
#include "data/cells/shape/mean_value.h"
#include "support/test.h"

using namespace sg;

namespace {

// A prism over a polygon in the plane z = 0, as a polyhedron; `turned` faces run the wrong way round.
UnstructuredMesh prism(const std::vector<Vec3>& base, double height, std::vector<size_t> turned = {}) {
  const auto n = int64_t(base.size());
  std::vector<double> xyz;
  std::vector<int64_t> ids, faces, face_offsets{0};
  for (int k = 0; k < 2; ++k)
    for (Vec3 p : base) ids.push_back(int64_t(ids.size())), xyz.insert(xyz.end(), {p.x, p.y, p.z + k * height});
  std::vector<std::vector<int64_t>> list(2);
  for (int64_t i = 0; i < n; ++i) {
    list[0].push_back(n - 1 - i), list[1].push_back(n + i);
    list.push_back({i, (i + 1) % n, n + (i + 1) % n, n + i});
  }
  for (size_t f : turned) std::reverse(list[f].begin(), list[f].end());
  for (const auto& f : list) faces.insert(faces.end(), f.begin(), f.end()), face_offsets.push_back(int64_t(faces.size()));
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, 2 * n}), 0};
  m.single_type = CellType::polyhedron;
  m.faces = {Array::from_vector(faces), Array::from_vector(face_offsets), 0};
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, int64_t(list.size())});
  return m;
}

const std::vector<Vec3> l_shape{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 4, 0}, {0, 4, 0}};
bool in_l(double x, double y) { return x > 0 && y > 0 && ((x < 3 && y < 1) || (x < 1 && y < 4)); }

void check_linear(CellMap& m, const CellPlace& place, Vec3 x, double tolerance) {
  const auto at = m.reader().at();
  std::vector<double> w(at.size());
  m.weights(place, w);
  double sum = 0;
  Vec3 p;
  for (size_t k = 0; k < at.size(); ++k) sum += w[k], p += at[k] * w[k];
  CHECK(sum == doctest::Approx(1).epsilon(1e-12));
  CHECK(length(p - x) < tolerance);
}

}  // namespace

TEST_CASE("polyhedron: a non-convex one knows what is inside, its volume, and linear fields, however its faces are turned") {
  for (const std::vector<size_t>& turned : {std::vector<size_t>{}, {2}, {0, 1, 4}, {0, 1, 2, 3, 4, 5, 6, 7}}) {
    CellMap m(make_dataset(prism(l_shape, 2, turned)));
    m.open(0);
    CHECK(m.measure() == doctest::Approx(12).epsilon(1e-13));
    std::vector<double> w(12);
    m.integration_weights(w);
    double sum = 0;
    Vec3 moment;
    for (size_t k = 0; k < 12; ++k) sum += w[k], moment += m.reader().at()[k] * w[k];
    CHECK(sum == doctest::Approx(12).epsilon(1e-13));
    CHECK(length(moment - Vec3(2 * 6, 2 * 9, 12)) < 1e-11);  // of the L: 3 * 1.5 + 3 * 0.5, 3 * 0.5 + 3 * 2.5
    int inside = 0;
    CellPlace place;
    for (uint64_t i = 0; i < 2000; ++i) {
      const Vec3 x{4 * random_unit(1, i) - 0.5, 5 * random_unit(2, i) - 0.5, 3 * random_unit(3, i) - 0.5};
      const bool want = in_l(x.x, x.y) && x.z > 0 && x.z < 2;
      CHECK(m.locate(x, place) == want);
      CHECK((place.outside <= 0) == want);
      if (!want) continue;
      ++inside;
      check_linear(m, place, x, 1e-9);
    }
    CHECK(inside > 200);
  }
}

TEST_CASE("polyhedron: on corners, edges and faces the weights are linear and the place is inside") {
  CellMap m(make_dataset(prism(l_shape, 2)));
  m.open(0);
  CellPlace place;
  std::vector<double> w(12);
  for (size_t k = 0; k < 12; ++k) {
    REQUIRE(m.locate(m.reader().at()[k], place));
    m.weights(place, w);
    CHECK(w[k] == doctest::Approx(1).epsilon(1e-12));
  }
  for (Vec3 x : {Vec3(1.5, 0, 1), Vec3(1, 1, 1), Vec3(0.5, 4, 0.3), Vec3(0.2, 0.2, 0), Vec3(2, 1, 2)}) {
    REQUIRE(m.locate(x, place));
    check_linear(m, place, x, 1e-12);
  }
  CHECK_FALSE(m.locate({2, 2, 1}, place));  // in the notch
  CHECK(length(place.nearest - Vec3(1, 2, 1)) + length(place.nearest - Vec3(2, 1, 1)) == doctest::Approx(std::sqrt(2.0)));
  CHECK(place.distance2 == doctest::Approx(1));
  const std::vector<double> f = [&] {
    std::vector<double> v;
    for (Vec3 p : m.reader().at()) v.push_back(p.x - 2 * p.y + 3 * p.z);
    return v;
  }();
  CHECK(length(m.gradient(place, f) - Vec3(1, -2, 3)) < 1e-12);
}

TEST_CASE("polyhedron: two that share a bent face cover the space between them once") {
  // The shared quad is not flat: both must cut it along the same diagonal.
  std::vector<double> xyz{0,  0, 0, 0,  1, 0.4, 0, 1, 1.2, 0, 0, 1, -1, 0, 0, -1, 1, 0,
                          -1, 1, 1, -1, 0, 1,   1, 0, 0,   1, 1, 0, 1,  1, 1, 1,  0, 1};
  xyz[0] = 0.3, xyz[6] = -0.2;
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  const std::vector<int64_t> left{0, 1, 2, 3, 4, 5, 6, 7}, right{1, 0, 3, 2, 9, 8, 11, 10};
  std::vector<int64_t> ids = left, faces, offsets{0};
  ids.insert(ids.end(), {8, 9, 10, 11, 0, 1, 2, 3});
  auto box = [&](const std::vector<int64_t>& c) {
    for (std::array<size_t, 4> f :
         {std::array<size_t, 4>{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}}) {
      for (size_t k : f) faces.push_back(c[k]);
      offsets.push_back(int64_t(faces.size()));
    }
  };
  box(left), box(right);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, 8, 16}), 0};
  m.single_type = CellType::polyhedron;
  m.faces = {Array::from_vector(faces), Array::from_vector(offsets), 0};
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, 6, 12});
  CellMap map(make_dataset(m));
  CellPlace place;
  for (uint64_t i = 0; i < 2000; ++i) {
    const Vec3 x{0.6 * random_unit(1, i) - 0.3, 0.3 + 0.4 * random_unit(2, i), 0.45 + 0.3 * random_unit(3, i)};
    int holders = 0;
    for (size_t c = 0; c < 2; ++c) {
      map.open(c);
      holders += map.locate(x, place, 0);
    }
    CHECK(holders == 1);
  }
}

TEST_CASE("polyhedron: a bent pentagon is cut into the same triangles from both sides") {
  // Ear clipping depends on where it starts and which way it goes, so both cells must start it alike.
  const double notched[5][2] = {{1, 0}, {0.3, 0.9}, {0.1, 0.1}, {-0.8, -0.6}, {0.3, -0.9}};
  // Two prisms over a pentagon whose shared face is bent: together they are one prism, each place in one of them.
  std::vector<double> xyz;
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 5; ++i) {
      const double z = k == 1 ? 0.3 * random_unit(4, uint64_t(i)) - 0.15 : k - 1.0;
      xyz.insert(xyz.end(), {notched[i][0], notched[i][1], z});
    }
  std::vector<int64_t> ids, faces, offsets{0};
  auto add = [&](std::vector<int64_t> f) {
    faces.insert(faces.end(), f.begin(), f.end());
    offsets.push_back(int64_t(faces.size()));
  };
  for (int64_t c = 0; c < 2; ++c) {
    for (int64_t i = 0; i < 10; ++i) ids.push_back(5 * c + i);
    const int64_t b = 5 * c;
    if (c == 0) add({b + 4, b + 3, b + 2, b + 1, b}), add({b + 7, b + 8, b + 9, b + 5, b + 6});
    else add({b + 3, b + 2, b + 1, b, b + 4}), add({b + 5, b + 6, b + 7, b + 8, b + 9});
    for (int64_t i = 0; i < 5; ++i) add({b + i, b + (i + 1) % 5, b + 5 + (i + 1) % 5, b + 5 + i});
  }
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, 10, 20}), 0};
  m.single_type = CellType::polyhedron;
  m.faces = {Array::from_vector(faces), Array::from_vector(offsets), 0};
  m.polyhedron_faces = Array::from_vector(std::vector<int64_t>{0, 7, 14});
  CellMap map(make_dataset(m));
  double volume = 0;
  for (size_t c = 0; c < 2; ++c) map.open(c), volume += map.measure();
  double area = 0;
  for (int i = 0; i < 5; ++i) area += (notched[i][0] * notched[(i + 1) % 5][1] - notched[i][1] * notched[(i + 1) % 5][0]) / 2;
  CHECK(volume == doctest::Approx(2 * area).epsilon(1e-13));
  CellPlace place;
  int wrong = 0;
  std::vector<Vec3> outline;
  for (auto p : notched) outline.push_back({p[0], p[1], 0});
  std::vector<uint32_t> cut;
  triangulate_polygon(outline, cut);
  auto covered = [&](Vec3 x) {
    Vec3 near, l;
    nearest_triangle(outline, cut, {x.x, x.y, 0}, near, l);
    return length(near - Vec3(x.x, x.y, 0)) < 1e-14;
  };
  for (uint64_t i = 0; i < 3000; ++i) {
    const Vec3 x = test::random_vector(6, i) * Vec3(1.8, 1.8, 0.5);
    int holders = 0;
    for (size_t c = 0; c < 2; ++c) {
      map.open(c);
      holders += map.locate(x, place, 0);
    }
    wrong += holders > 1 || (holders == 0 && covered(x));
  }
  CHECK(wrong == 0);
}

TEST_CASE("prisms: pentagonal and hexagonal ones are located and integrated by their faces") {
  for (int n : {5, 6}) {
    std::vector<Vec3> at;
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < n; ++i) at.push_back({std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 3.0 * k});
    CellMap m(test::one_cell(n == 5 ? CellType::pentagonal_prism : CellType::hexagonal_prism, at));
    m.open(0);
    CHECK(m.measure() == doctest::Approx(1.5 * n * std::sin(2 * M_PI / n)).epsilon(1e-13));
    CellPlace place;
    for (uint64_t i = 0; i < 100; ++i) {
      const Vec3 x = test::random_vector(1, i) + Vec3(0, 0, 1.5);
      REQUIRE(m.locate(x, place));
      check_linear(m, place, x, 1e-10);
    }
    CHECK_FALSE(m.locate({0.99, 0.3, 1}, place));
    CHECK_FALSE(m.locate({0, 0, 3.01}, place));
  }
}

TEST_CASE("polygon: mean value weights of a non-convex one are linear inside, on sides and at corners") {
  // Lifted into a tilted plane.
  auto lift = [](Vec3 p) { return Vec3(p.x, p.y, 0.5 * p.x - 0.2 * p.y + 1); };
  std::vector<Vec3> at;
  for (Vec3 p : l_shape) at.push_back(lift(p));
  CellMap m(test::one_cell(CellType::polygon, at));
  m.open(0);
  const double tilt = std::sqrt(1 + 0.25 + 0.04);
  CHECK(m.measure() == doctest::Approx(6 * tilt).epsilon(1e-13));
  CellPlace place;
  int inside = 0;
  for (uint64_t i = 0; i < 1000; ++i) {
    const double u = 4 * random_unit(1, i) - 0.5, v = 5 * random_unit(2, i) - 0.5;
    const Vec3 x = lift({u, v, 0});
    CHECK(m.locate(x, place) == in_l(u, v));
    if (!in_l(u, v)) continue;
    ++inside;
    check_linear(m, place, x, 1e-10);
  }
  CHECK(inside > 200);
  std::vector<double> w(6);
  for (size_t k = 0; k < 6; ++k) {
    REQUIRE(m.locate(at[k], place));
    m.weights(place, w);
    CHECK(w[k] == doctest::Approx(1).epsilon(1e-12));
  }
  REQUIRE(m.locate(lerp(at[2], at[3], 0.25), place));
  m.weights(place, w);
  CHECK(w[2] == doctest::Approx(0.75).epsilon(1e-12));
  m.integration_weights(w);
  double sum = 0;
  for (double v : w) sum += v;
  CHECK(sum == doctest::Approx(6 * tilt).epsilon(1e-13));
  std::vector<double> f;
  for (Vec3 p : at) f.push_back(2 * p.x + p.y);
  const Vec3 normal = normalize(Vec3(-0.5, 0.2, 1)), slope{2, 1, 0};
  CHECK(length(m.gradient(place, f) - (slope - normal * dot(normal, slope))) < 1e-12);
}

TEST_CASE("polygon: a regular one has equal weights at its centre, and weights are positive inside convex ones") {
  std::vector<Vec3> at;
  for (int i = 0; i < 7; ++i) at.push_back({std::cos(2 * M_PI * i / 7), std::sin(2 * M_PI * i / 7), 0});
  std::vector<double> w(7);
  polygon_weights(at, {0, 0, 0}, w);
  for (double v : w) CHECK(v == doctest::Approx(1.0 / 7).epsilon(1e-13));
  for (uint64_t i = 0; i < 100; ++i) {
    polygon_weights(at, test::random_vector(3, i) * Vec3(1, 1, 0), w);
    for (double v : w) CHECK(v > 0);
  }
}

TEST_CASE("winding number: 1 inside, 0 outside, 1/2 on a face, whatever the distance") {
  const CellFaces& faces = cell_faces(CellType::tetra, 4);
  const std::vector<Vec3> at{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  CHECK(winding_number(at, faces.nodes, {0.1, 0.1, 0.1}) == doctest::Approx(1).epsilon(1e-14));
  CHECK(winding_number(at, faces.nodes, {0.4, 0.4, 0.4}) == doctest::Approx(0).epsilon(1e-14));
  CHECK(winding_number(at, faces.nodes, {1e6, 3, 2}) == doctest::Approx(0).epsilon(1e-14));
  CHECK(std::abs(winding_number(at, faces.nodes, {0.2, 0.2, 0})) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(enclosed_volume(at, faces.nodes) == doctest::Approx(1.0 / 6).epsilon(1e-14));
}

TEST_CASE("strips, poly-lines and poly-vertices are their pieces") {
  CellPlace place;
  CellMap strip(test::one_cell(CellType::triangle_strip, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {2, 0, 0}}));
  strip.open(0);
  CHECK(strip.measure() == doctest::Approx(1.5));
  for (uint64_t i = 0; i < 50; ++i) {
    const Vec3 x{1.0 * random_unit(1, i), random_unit(2, i), 0};
    REQUIRE(strip.locate(x, place));
    check_linear(strip, place, x, 1e-12);
    const double f[5] = {0, 5, 2, 7, 4};  // 2 x + 5 y
    CHECK(length(strip.gradient(place, f) - Vec3(2, 5, 0)) < 1e-12);
  }
  CellMap line(test::one_cell(CellType::poly_line, {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}}));
  line.open(0);
  CHECK(line.measure() == 5);
  REQUIRE(line.locate({2, 1, 0}, place));
  std::vector<double> w(3);
  line.weights(place, w);
  CHECK(w[1] == doctest::Approx(2.0 / 3));
  CHECK(w[2] == doctest::Approx(1.0 / 3));
  line.integration_weights(w);
  CHECK(w == std::vector<double>{1, 2.5, 1.5});
  CHECK_FALSE(line.locate({2.5, 1, 0}, place));
  CHECK(place.distance2 == doctest::Approx(0.25));
  CellMap points(test::one_cell(CellType::poly_vertex, {{0, 0, 0}, {2, 0, 0}}));
  points.open(0);
  CHECK(points.locate({2, 0, 0}, place));
  w.resize(2);
  points.weights(place, w);
  CHECK(w == std::vector<double>{0, 1});
  CHECK(points.measure() == 2);
}

TEST_CASE("quadratic polygon: its middle nodes are corners of the outline") {
  std::vector<Vec3> at;
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 5; ++i) at.push_back({std::cos(2 * M_PI * (i + k * 0.5) / 5), std::sin(2 * M_PI * (i + k * 0.5) / 5), 0});
  CellMap m(test::one_cell(CellType::quadratic_polygon, at));
  m.open(0);
  CHECK(m.measure() == doctest::Approx(5 * std::sin(2 * M_PI / 10)).epsilon(1e-13));
  CellPlace place;
  REQUIRE(m.locate({0.3, 0.4, 0}, place));
  check_linear(m, place, {0.3, 0.4, 0}, 1e-12);
}
