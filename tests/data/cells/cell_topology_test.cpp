// SPDX-License-Identifier: Apache-2.0
#include "data/cells/cell_topology.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <set>

#include "base/random.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;

namespace {

struct Reference {
  CellType type;
  std::vector<Vec3> at;
  double volume = 0;
};

std::vector<Vec3> prism(int n) {
  std::vector<Vec3> r;
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < n; ++i) r.push_back({std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), double(k)});
  return r;
}

std::vector<Reference> references() {
  const std::vector<Vec3> hex{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const std::vector<Vec3> voxel{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  return {{CellType::tetra, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0 / 6},
          {CellType::hexahedron, hex, 1},
          {CellType::voxel, voxel, 1},
          {CellType::wedge, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0.5},
          {CellType::pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}, 1.0 / 3},
          {CellType::pentagonal_prism, prism(5), 2.5 * std::sin(2 * M_PI / 5)},
          {CellType::hexagonal_prism, prism(6), 3 * std::sin(2 * M_PI / 6)}};
}

// Positions of the nodes of a lattice cell of order n on its reference shape.
std::vector<Vec3> lattice_positions(CellType type, int n) {
  std::map<uint32_t, Vec3> at;
  const CellType shape = linear_type(type);
  for (int k = 0; k <= n; ++k)
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        if (shape == CellType::tetra && i + j + k > n) continue;
        if (shape == CellType::wedge && i + j > n) continue;
        if (shape == CellType::triangle && (i + j > n || k > 0)) continue;
        if (shape == CellType::quad && k > 0) continue;
        at[lattice_node(type, n, i, j, k)] = Vec3(i, j, k) / double(n);
      }
  std::vector<Vec3> r;
  for (const auto& [node, p] : at) {
    REQUIRE(node == r.size());  // every number once, without gaps
    r.push_back(p);
  }
  return r;
}

double enclosed(const CellFaces& faces, const std::vector<Vec3>& at) {
  double volume = 0;
  for (size_t f = 0; f < faces.size(); ++f) {
    std::vector<Vec3> p;
    for (uint32_t v : faces.face(f)) p.push_back(at[v]);
    std::vector<uint32_t> t;
    tessellate_face(faces.type[f], p, t);
    for (size_t i = 0; i < t.size(); i += 3) volume += dot(p[t[i]], cross(p[t[i + 1]], p[t[i + 2]])) / 6;
  }
  return volume;
}

// Every directed edge of the triangles of all faces has its opposite.
bool closed(const CellFaces& faces, const std::vector<Vec3>& at) {
  std::multiset<std::pair<uint32_t, uint32_t>> edges;
  for (size_t f = 0; f < faces.size(); ++f) {
    const auto nodes = faces.face(f);
    std::vector<Vec3> p;
    for (uint32_t v : nodes) p.push_back(at[v]);
    std::vector<uint32_t> t;
    tessellate_face(faces.type[f], p, t);
    for (size_t i = 0; i < t.size(); i += 3)
      for (size_t k = 0; k < 3; ++k) edges.insert({nodes[t[i + k]], nodes[t[i + (k + 1) % 3]]});
  }
  for (const auto& e : edges)
    if (edges.count(e) != 1 || edges.count({e.second, e.first}) != 1) return false;
  return true;
}

double area_of(CellType type, const std::vector<Vec3>& at, size_t* count = nullptr) {
  std::vector<uint32_t> t;
  tessellate_face(type, at, t);
  if (count) *count = t.size() / 3;
  double sum = 0;
  for (size_t i = 0; i < t.size(); i += 3) {
    const Vec3 n = cross(at[t[i + 1]] - at[t[i]], at[t[i + 2]] - at[t[i]]);
    CHECK(n.z > 0);  // oriented like the cell
    sum += n.z / 2;
  }
  return sum;
}

}  // namespace

TEST_CASE("cell topology: the faces of every linear solid are closed, outward and Eulerian") {
  for (const Reference& r : references()) {
    CAPTURE(cell_type_info(r.type).name);
    const LinearTopology& t = *linear_topology(r.type);
    CHECK(t.corners == int(r.at.size()));
    std::map<std::pair<int, int>, int> directed;
    double volume = 0;
    for (size_t f = 0; f < t.face_count(); ++f) {
      const auto c = t.face(f);
      for (size_t i = 0; i < c.size(); ++i) ++directed[{c[i], c[(i + 1) % c.size()]}];
      for (size_t i = 1; i + 1 < c.size(); ++i) volume += dot(r.at[c[0]], cross(r.at[c[i]], r.at[c[i + 1]])) / 6;
    }
    for (const auto& [e, n] : directed) {
      CHECK(n == 1);
      CHECK(directed.count({e.second, e.first}) == 1);
    }
    CHECK(volume == doctest::Approx(r.volume).epsilon(1e-14));
    CHECK(size_t(t.corners) + t.face_count() == t.edges.size() + 2);
    CHECK(directed.size() == 2 * t.edges.size());
    for (const auto& e : t.edges) CHECK(directed.count({e[0], e[1]}) == 1);
  }
}

TEST_CASE("cell topology: edges of 2D cells go around them") {
  for (CellType type : {CellType::triangle, CellType::quad, CellType::pixel}) {
    const LinearTopology& t = *linear_topology(type);
    for (size_t e = 0; e < t.edges.size(); ++e) CHECK(t.edges[e][1] == t.edges[(e + 1) % t.edges.size()][0]);
    CHECK(t.face_count() == 0);
  }
  CHECK(linear_topology(CellType::polyhedron) == nullptr);
}

TEST_CASE("cell topology: faces of quadratic solids pass through their own nodes and close the cell") {
  // Mid-edge nodes lie halfway, mid-face nodes in the middle: any wrong number moves the surface.
  struct Case {
    CellType type;
    size_t nodes;
  };
  using enum CellType;
  for (const Case& c : {Case{quadratic_tetra, 10},
                        {quadratic_hexahedron, 20},
                        {quadratic_wedge, 15},
                        {quadratic_pyramid, 13},
                        {triquadratic_hexahedron, 27},
                        {biquadratic_quadratic_hexahedron, 24},
                        {quadratic_linear_wedge, 12},
                        {biquadratic_quadratic_wedge, 18},
                        {triquadratic_pyramid, 19},
                        {lagrange_tetra, 15},
                        {lagrange_wedge, 21}}) {
    CAPTURE(cell_type_info(c.type).name);
    Reference base{CellType::empty, {}, 0};
    for (const Reference& r : references())
      if (r.type == linear_type(c.type)) base = r;
    const CellFaces& faces = cell_faces(c.type, c.nodes);
    CHECK(faces.size() == linear_topology(base.type)->face_count());
    std::vector<Vec3> at = base.at;
    at.resize(c.nodes, Vec3(7, 7, 7));
    for (size_t f = 0; f < faces.size(); ++f) {
      const auto nodes = faces.face(f);
      const size_t k = faces.corners[f];
      Vec3 middle;
      for (size_t i = 0; i < k; ++i) middle += at[nodes[i]] / double(k);
      if (nodes.size() == k + 2) {
        at[nodes[4]] = lerp(at[nodes[0]], at[nodes[1]], 0.5);
        at[nodes[5]] = lerp(at[nodes[2]], at[nodes[3]], 0.5);
        continue;
      }
      for (size_t i = 0; i < k; ++i) at[nodes[k + i]] = lerp(at[nodes[i]], at[nodes[(i + 1) % k]], 0.5);
      if (nodes.size() > 2 * k) at[nodes[2 * k]] = middle;
    }
    CHECK(closed(faces, at));
    CHECK(enclosed(faces, at) == doctest::Approx(base.volume).epsilon(1e-13));
  }
}

TEST_CASE("cell topology: Lagrange and Bezier solids of order 1 to 5 are closed with the right volume") {
  for (CellType type : {CellType::lagrange_tetra, CellType::lagrange_hexahedron, CellType::lagrange_wedge, CellType::bezier_tetra,
                        CellType::bezier_hexahedron, CellType::bezier_wedge})
    for (int n = 1; n <= 5; ++n) {
      CAPTURE(cell_type_info(type).name);
      CAPTURE(n);
      const std::vector<Vec3> at = lattice_positions(type, n);
      CHECK(high_order_of(type, at.size()) == n);
      const CellFaces& faces = cell_faces(type, at.size());
      CHECK(closed(faces, at));
      const CellType shape = linear_type(type);
      CHECK(enclosed(faces, at) == doctest::Approx(shape == CellType::hexahedron ? 1
                                                   : shape == CellType::wedge    ? 0.5
                                                                                 : 1.0 / 6)
                                       .epsilon(1e-13));
    }
  CHECK(high_order_of(CellType::lagrange_hexahedron, 28) == 0);
  CHECK(cell_faces(CellType::lagrange_hexahedron, 28).face(0).size() == 4);
  CHECK(cell_faces(CellType::triangle, 3).size() == 0);
}

TEST_CASE("cell topology: node numbers of cubic Lagrange cells are those of VTK's files") {
  using enum CellType;
  CHECK(lattice_node(lagrange_wedge, 3, 2, 1, 0) == 8);
  CHECK(lattice_node(lagrange_wedge, 3, 0, 2, 3) == 16);
  CHECK(lattice_node(lagrange_wedge, 3, 0, 3, 1) == 22);
  CHECK(lattice_node(lagrange_wedge, 3, 0, 1, 1) == 35);
  CHECK(lattice_node(lagrange_wedge, 3, 1, 1, 2) == 39);
  CHECK(lattice_node(lagrange_hexahedron, 3, 3, 3, 1) == 28);
  CHECK(lattice_node(lagrange_hexahedron, 3, 0, 1, 2) == 34);
  CHECK(lattice_node(lagrange_hexahedron, 3, 2, 3, 1) == 45);
  CHECK(lattice_node(lagrange_hexahedron, 3, 1, 2, 0) == 50);
  CHECK(lattice_node(lagrange_tetra, 3, 2, 0, 1) == 12);
  CHECK(lattice_node(lagrange_tetra, 3, 1, 1, 1) == 17);
  CHECK(lattice_node(lagrange_tetra, 3, 1, 1, 0) == 19);
}

TEST_CASE("cell topology: curved 2D cells become n*n triangles per triangle and cover their area") {
  for (int n = 1; n <= 5; ++n) {
    size_t count = 0;
    CHECK(area_of(CellType::lagrange_triangle, lattice_positions(CellType::lagrange_triangle, n), &count) == doctest::Approx(0.5));
    CHECK(count == size_t(n * n));
    CHECK(area_of(CellType::bezier_quad, lattice_positions(CellType::bezier_quad, n), &count) == doctest::Approx(1));
    CHECK(count == size_t(2 * n * n));
  }
  std::vector<Vec3> q{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {.5, 0, 0}, {1, .5, 0}, {.5, 1, 0}, {0, .5, 0}, {.5, .5, 0}};
  CHECK(area_of(CellType::biquadratic_quad, q) == doctest::Approx(1));
  q.pop_back();
  CHECK(area_of(CellType::quadratic_quad, q) == doctest::Approx(1));
  CHECK(area_of(CellType::quadratic_polygon, q) == doctest::Approx(1));
  CHECK(area_of(CellType::quadratic_linear_quad, {q[0], q[1], q[2], q[3], q[4], q[6]}) == doctest::Approx(1));
  const std::vector<Vec3> t{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {.5, 0, 0}, {.5, .5, 0}, {0, .5, 0}, {1. / 3, 1. / 3, 0}};
  CHECK(area_of(CellType::biquadratic_triangle, t) == doctest::Approx(0.5));
  CHECK(area_of(CellType::quadratic_triangle, {t.begin(), t.begin() + 6}) == doctest::Approx(0.5));
  CHECK(area_of(CellType::pixel, {q[0], q[1], q[3], q[2]}) == doctest::Approx(1));
  CHECK(area_of(CellType::triangle_strip, {q[0], q[1], q[3], q[2]}) == doctest::Approx(1));
}

TEST_CASE("cell topology: non-convex polygons are cut into ears") {
  // A comb with five teeth: area by the shoelace formula.
  std::vector<Vec3> comb{{0, 0, 0}, {9, 0, 0}};
  for (int i = 8; i >= 0; --i) comb.push_back({double(i) + 0.5, i % 2 ? 0.5 : 3.0, 0});
  double shoelace = 0;
  for (size_t i = 0; i < comb.size(); ++i) {
    const Vec3 a = comb[i], b = comb[(i + 1) % comb.size()];
    shoelace += (a.x * b.y - b.x * a.y) / 2;
  }
  size_t count = 0;
  CHECK(area_of(CellType::polygon, comb, &count) == doctest::Approx(shoelace).epsilon(1e-13));
  CHECK(count == comb.size() - 2);
  const std::vector<Vec3> arrow{{0, 0, 0}, {2, -1, 0}, {1, 0, 0}, {2, 1, 0}};
  CHECK(area_of(CellType::quad, arrow) == doctest::Approx(1));
  // Tilted, mirrored and folded outlines keep n-2 triangles.
  std::vector<Vec3> tilted = comb;
  for (Vec3& p : tilted) p = {p.y, p.x + p.y, p.x};
  std::vector<uint32_t> t;
  triangulate_polygon(tilted, t);
  CHECK(t.size() == 3 * (comb.size() - 2));
  const Vec3 whole = polygon_vector_area(tilted);
  double sum = 0;
  for (size_t i = 0; i < t.size(); i += 3) sum += length(cross(tilted[t[i + 1]] - tilted[t[i]], tilted[t[i + 2]] - tilted[t[i]]));
  CHECK(sum == doctest::Approx(length(whole)).epsilon(1e-12));
  t.clear();
  const std::vector<Vec3> bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0.5, 0}};
  triangulate_polygon(bow, t);
  CHECK(t.size() == 9);
  t.clear();
  triangulate_polygon(std::vector<Vec3>(6, Vec3(1, 1, 1)), t);
  CHECK(t.size() == 12);
}

TEST_CASE("cell topology: outlines of tens of thousands of corners are cut in less than the square of their time, and add up") {
  const auto begin = std::chrono::steady_clock::now();
  constexpr size_t n = 30000;
  std::vector<Vec3> star, comb, tangle;
  for (size_t i = 0; i < n; ++i) {
    const double a = 2 * M_PI * double(i) / double(n), r = 0.5 + 0.5 * random_unit(1, i);
    star.push_back({r * std::cos(a), r * std::sin(a), 0});
    tangle.push_back({random_unit(2, i), random_unit(3, i), 0});
    const size_t half = n / 2;
    comb.push_back(i < half ? Vec3(double(i), -1, 0) : Vec3(double(n - 1 - i), i % 2 ? 1000 : 0, 0));
  }
  for (const auto* outline : {&star, &comb}) {
    std::vector<uint32_t> t;
    triangulate_polygon(*outline, t);
    CHECK(t.size() == 3 * (n - 2));
    double sum = 0;
    bool turned = false;
    for (size_t i = 0; i < t.size(); i += 3) {
      const double z = cross((*outline)[t[i + 1]] - (*outline)[t[i]], (*outline)[t[i + 2]] - (*outline)[t[i]]).z;
      turned = turned || z < 0;
      sum += z;
    }
    CHECK(!turned);
    CHECK(sum == doctest::Approx(polygon_vector_area(*outline).z).epsilon(1e-9));
  }
  std::vector<uint32_t> t;
  triangulate_polygon(tangle, t);
  CHECK(t.size() == 3 * (n - 2));
  CHECK(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < 20);
}

TEST_CASE("property: cutting ears with a grid of corners gives the triangles of looking at all of them") {
  for (const uint64_t seed : test::property_seeds(20)) {
    CAPTURE(seed);
    test::Random random(seed);
    const int n = random.whole(64, 400);
    const double stretch = random.magnitude(1e-4, 1e4);
    std::vector<Vec3> p;
    for (int i = 0; i < n; ++i) {
      const double a = 2 * M_PI * i / n, r = random.in(0.2, 1);
      p.push_back({stretch * r * std::cos(a), r * std::sin(a), 0});
    }
    std::vector<uint32_t> got, want, ring(static_cast<size_t>(n));
    triangulate_polygon(p, got);
    std::iota(ring.begin(), ring.end(), 0u);
    const auto turn = [&](uint32_t a, uint32_t b, uint32_t c) {
      return (p[b].x - p[a].x) * (p[c].y - p[a].y) - (p[b].y - p[a].y) * (p[c].x - p[a].x);
    };
    for (size_t i = 0; ring.size() > 3;) {
      i %= ring.size();
      const uint32_t a = ring[(i + ring.size() - 1) % ring.size()], b = ring[i], c = ring[(i + 1) % ring.size()];
      const bool ear = turn(a, b, c) > 0 && std::none_of(ring.begin(), ring.end(), [&](uint32_t q) {
                         return q != a && q != b && q != c && turn(a, b, q) >= 0 && turn(b, c, q) >= 0 && turn(c, a, q) >= 0;
                       });
      if (!ear) {
        ++i;
        continue;
      }
      want.insert(want.end(), {a, b, c});
      ring.erase(ring.begin() + ptrdiff_t(i));
    }
    want.insert(want.end(), ring.begin(), ring.end());
    CHECK(got == want);
  }
}

TEST_CASE("cell topology: outlines and curves run through all their nodes in order") {
  std::vector<uint32_t> r;
  face_outline(CellType::lagrange_quad, 16, r);
  CHECK(r == std::vector<uint32_t>{0, 4, 5, 1, 6, 7, 2, 9, 8, 3, 11, 10});
  face_outline(CellType::lagrange_triangle, 10, r);
  CHECK(r == std::vector<uint32_t>{0, 3, 4, 1, 5, 6, 2, 7, 8});
  face_outline(CellType::pixel, 4, r);
  CHECK(r == std::vector<uint32_t>{0, 1, 3, 2});
  curve_order(CellType::lagrange_curve, 5, r);
  CHECK(r == std::vector<uint32_t>{0, 2, 3, 4, 1});
  curve_order(CellType::quadratic_edge, 3, r);
  CHECK(r == std::vector<uint32_t>{0, 2, 1});
  curve_order(CellType::poly_line, 3, r);
  CHECK(r == std::vector<uint32_t>{0, 1, 2});
}

TEST_CASE("cell topology: a solid is no 2D cell") {
  std::vector<uint32_t> t;
  CHECK(test::error_of([&] { tessellate_face(CellType::tetra, std::vector<Vec3>(4), t); }).find("Tetra is not a 2D cell") !=
        std::string::npos);
  CHECK(test::error_of([] { lattice_node(CellType::lagrange_pyramid, 2, 0); }).find("no node lattice") != std::string::npos);
}
