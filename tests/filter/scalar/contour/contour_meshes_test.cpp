// SPDX-License-Identifier: Apache-2.0
// Contours on every mesh kind, in 3D and 2D (correctness.md, I12, I13, I17).
#include "base/parallel.h"
#include "base/random.h"
#include "filter/cell_meshes.h"
#include "filter/scalar/contour/known_surfaces.h"

using namespace sg;
using namespace sg::test;

namespace {

// Area of the plane n.x = d inside [-1,1]^3, by clipping a big square.
double plane_in_cube(Vec3 n, double d) {
  const Vec3 u = normalize(cross(n, Vec3(0, 0, 1))), w = cross(n, u);
  std::vector<Vec3> poly;
  for (auto [a, b] : {std::pair{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}) poly.push_back(n * d + u * double(a) + w * double(b));
  for (int x = 0; x < 3; ++x)
    for (double side : {-1.0, 1.0}) {
      std::vector<Vec3> next;
      for (size_t k = 0; k < poly.size(); ++k) {
        const Vec3 p = poly[k], q = poly[(k + 1) % poly.size()];
        const double fp = 1 - side * p[x], fq = 1 - side * q[x];
        if (fp >= 0) next.push_back(p);
        if ((fp >= 0) != (fq >= 0)) next.push_back(lerp(p, q, fp / (fp - fq)));
      }
      poly = next;
    }
  Vec3 area;
  for (size_t k = 1; k + 1 < poly.size(); ++k) area += cross(poly[k] - poly[0], poly[k + 1] - poly[0]) * 0.5;
  return length(area);
}

void check_plane(const DatasetPtr& d, const DatasetPtr& s) {
  const Surface surface(s);
  CHECK(surface.area() == doctest::Approx(plane_in_cube(plane_normal, 0.1234)).epsilon(1e-6));
  double off = 0, turned = 0;
  for (Vec3 p : surface.points) off = std::max(off, std::abs(oblique_plane(p)));
  const Field& n = s->fields().require("Normals", Association::point);
  for (size_t i = 0; i < n.array.count(); ++i)
    turned = std::max(turned, length(Vec3(n.array.get(i, 0), n.array.get(i, 1), n.array.get(i, 2)) + plane_normal));
  CHECK(off < 1e-6);
  CHECK(turned < 1e-6);
  CHECK(surface.faults(d->bounds()) == 0);
  CHECK(surface.every_point_used());
  for (size_t t = 0; t < surface.triangles.size(); ++t) CHECK(dot(surface.area_vector(t), plane_normal) <= 1e-9);
}

template <class Map>
DatasetPtr mapped(std::array<size_t, 3> n, Map&& map, double (*f)(Vec3), double r = 1) {
  const Mesh box = uniform(n, {-r, -r, -r}, {r, r, r});
  const Lattice lattice(box);
  std::vector<double> xyz;
  for (size_t k = 0; k < n[2]; ++k)
    for (size_t j = 0; j < n[1]; ++j)
      for (size_t i = 0; i < n[0]; ++i) {
        const Vec3 p = map(lattice.view().position(i, j, k));
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  CurvilinearGrid g;
  g.dims = n;
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  FieldSet fields;
  fields.add(point_field<double>(g, n, f));
  return make_dataset(g, fields);
}

DatasetPtr rectilinear(std::array<size_t, 3> n, double (*f)(Vec3), bool down) {
  auto axis = [&](size_t count, bool flip) {
    std::vector<double> x;
    for (size_t i = 0; i < count; ++i) {
      const double t = -1 + 2 * double(i) / double(count - 1);
      x.push_back((flip ? -1 : 1) * (t + 0.2 * (1 - t * t)));
    }
    return Array::from_vector(std::move(x));
  };
  RectilinearGrid g{axis(n[0], down), axis(n[1], false), axis(n[2], false)};
  FieldSet fields;
  fields.add(point_field<double>(g, n, f));
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("contour: a linear field gives a plane, exact and without cracks, on every mesh of solids") {
  const auto box = cube(8, 1, oblique_plane);
  check_plane(box, contour_at(box, 0));
  for (bool down : {false, true}) {
    const auto d = rectilinear({7, 9, 8}, oblique_plane, down);
    check_plane(d, contour_at(d, 0));
  }
  const auto curved = mapped(
      {9, 7, 8},
      [](Vec3 p) {  // bent inside, the border stays in place
        const double b = (1 - p.x * p.x) * (1 - p.y * p.y) * (1 - p.z * p.z);
        return p + b * Vec3(.1, -.15, .2);
      },
      oblique_plane);
  check_plane(curved, contour_at(curved, 0));
  const auto mirrored = mapped(
      {6, 7, 8}, [](Vec3 p) { return Vec3(-p.x, p.y, p.z); }, oblique_plane);
  check_plane(mirrored, contour_at(mirrored, 0));
  for (const auto& kind : solid_kinds()) {
    CAPTURE(kind);
    const auto d = solid_mesh(kind, 5, 1, oblique_plane);
    check_plane(d, contour_at(d, 0));
  }
}

TEST_CASE("contour: a turned and sheared uniform grid gives the same plane") {
  UniformGrid g = uniform({9, 9, 9}, {-1, -1, -1}, {1, 1, 1});
  g.direction = Mat3{{{0, -1, 0}, {0, 0, -1}, {1, 0, 0}}};  // left-handed or not: the surface must not care
  g.origin = {1, 1, -1};
  FieldSet fields;
  fields.add(point_field<float>(g, {9, 9, 9}, oblique_plane));
  const auto d = make_dataset(g, fields);
  check_plane(d, contour_at(d, 0));
}

TEST_CASE("contour: a sphere on a curvilinear grid has area and normals of order 2") {
  double h[4], area[4], normal[4];
  const size_t n[] = {13, 25, 49, 97};
  for (int i = 0; i < 4; ++i) {
    const auto d = mapped(
        {n[i], n[i], n[i]}, [](Vec3 p) { return p + 0.12 * Vec3(std::sin(2 * p.y), std::sin(2 * p.z), std::sin(2 * p.x)); }, sphere, 1.4);
    const auto c = contour_at(d, 0);
    const Surface s(c);
    h[i] = 1.0 / double(n[i] - 1);
    area[i] = std::abs(s.area() - 4 * M_PI);
    CHECK(s.euler() == 2);
    CHECK(s.faults() == 0);
    CHECK(s.volume() < 0);
    normal[i] = 0;
    const Field& f = c->fields().require("Normals", Association::point);
    for (size_t v = 0; v < s.points.size(); ++v)
      normal[i] = std::max(normal[i], length(Vec3(f.array.get(v, 0), f.array.get(v, 1), f.array.get(v, 2)) + normalize(s.points[v])));
  }
  CHECK(observed_order(h, area, 4) == doctest::Approx(2).epsilon(0.1));
  CHECK(observed_order(h, normal, 4) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("contour: bent cells of every kind give a closed sphere") {
  for (const auto& kind : solid_kinds()) {
    CAPTURE(kind);
    const Surface s(contour_at(solid_mesh(kind, 10, 1.5, sphere, 0.08), 0));
    CHECK(s.euler() == 2);
    CHECK(s.faults() == 0);
    CHECK(s.area() == doctest::Approx(4 * M_PI).epsilon(0.03));
    CHECK(s.volume() == doctest::Approx(-4 * M_PI / 3).epsilon(0.06));
  }
}

TEST_CASE("contour: hexahedra and the lattice agree, also on random values, and mixed cells leave no holes") {
  auto noise = [](Vec3 p) {  // closed: negative at the border
    const bool border = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.99;
    return border ? -1.0
                  : random_unit(5, uint64_t(std::lround((p.x + 1) * 1000) + 4000 * std::lround((p.y + 1) * 1000) +
                                            16000000 * std::lround((p.z + 1) * 1000))) -
                        0.5;
  };
  const Surface lattice(contour_at(cube(9, 1, noise), 0));
  for (const auto& kind : solid_kinds()) {
    CAPTURE(kind);
    const auto d = solid_mesh(kind, 8, 1, noise);
    const Surface s(contour_at(d, 0));
    CHECK(!s.triangles.empty());
    CHECK(s.faults() == 0);
    if (kind != "hexahedron" && kind != "voxel" && kind != "polyhedron") continue;
    CHECK(s.points.size() == lattice.points.size());
    CHECK(s.triangles.size() == lattice.triangles.size());
    CHECK(s.euler() == lattice.euler());
    CHECK(s.volume() == doctest::Approx(lattice.volume()).epsilon(1e-6));
  }
}

TEST_CASE("contour: unstructured meshes give the same bytes for 1 and 8 threads") {
  const auto d = solid_mesh("tetra", 14, 1.5, sphere);
  set_thread_count(1);
  const auto one = contour_at(d, 0);
  set_thread_count(8);
  const auto eight = contour_at(d, 0);
  set_thread_count(0);
  CHECK(one->cell_count() > 0);
  CHECK(same_surface(one, eight));
  CHECK(same_bytes(one->fields().require("Normals").array, eight->fields().require("Normals").array));
}

TEST_CASE("contour: circle lines converge with order 2 and have the inside on the left, in every plane") {
  auto circle = [](double a, double b) { return 1 - std::hypot(a, b); };
  double h[4], around[4], area[4];
  const size_t n[] = {17, 33, 65, 129};
  for (int plane = 0; plane < 3; ++plane) {
    for (int i = 0; i < 4; ++i) {
      std::array<size_t, 3> dims{n[i], n[i], n[i]};
      dims[size_t(plane)] = 1;
      Vec3 lo(-1.3, -1.3, -1.3);
      lo[plane] = 0.5;
      const Mesh g = uniform(dims, lo, {1.3, 1.3, 1.3});
      const int u = plane == 0 ? 1 : 0, v = plane == 2 ? 1 : 2;
      FieldSet fields;
      fields.add(point_field<float>(g, dims, [&](Vec3 p) { return circle(p[u], p[v]); }));
      const auto c = contour_at(make_dataset(g, fields), 0);
      const Surface s(c);
      CHECK(s.triangles.empty());
      CHECK(c->cell_count() == s.lines.size());
      CHECK(s.lines.size() == s.points.size());
      double length_sum = 0, area_sum = 0;
      std::vector<int> in(s.points.size()), out(s.points.size());
      for (const auto& [a, b] : s.lines) {
        const Vec3 p = s.points[size_t(a)], q = s.points[size_t(b)];
        length_sum += length(q - p);
        area_sum += 0.5 * (p[u] * q[v] - q[u] * p[v]);
        ++out[size_t(a)], ++in[size_t(b)];
        CHECK(p[plane] == doctest::Approx(0.5));
      }
      for (size_t p = 0; p < in.size(); ++p) CHECK((in[p] == 1 && out[p] == 1));
      h[i] = 1.0 / double(n[i] - 1);
      around[i] = std::abs(length_sum - 2 * M_PI);
      area[i] = std::abs(area_sum - M_PI);  // positive: counterclockwise about the larger values
    }
    CHECK(observed_order(h, around, 4) == doctest::Approx(2).epsilon(0.1));
    CHECK(observed_order(h, area, 4) == doctest::Approx(2).epsilon(0.1));
  }
}

TEST_CASE("contour: an ambiguous square joins or separates by the asymptotic decider") {
  auto separated = [](double a, double b, double c, double d) {
    // Inside corners on the left of the lines: count the lines whose ends lie at corner 0 (edges below and left).
    const Surface s(contour_at(grid_of<double>({2, 2, 1}, {a, b, c, d}), 0));
    REQUIRE(s.lines.size() == 2);
    bool corner0 = false;
    for (const auto& l : s.lines) {
      const Vec3 m = (s.points[size_t(l[0])] + s.points[size_t(l[1])]) * 0.5;
      corner0 = corner0 || m.x + m.y < 0.9;
    }
    return corner0 == (a >= 0);
  };
  CHECK(!separated(3, -1, -1, 3));
  CHECK(separated(1, -3, -3, 1));
  CHECK(!separated(-1, 3, 3, -1));
  CHECK(separated(-3, 1, 1, -3));
}

TEST_CASE("contour: lines on triangles, quads, pixels and polygons agree with the grid") {
  auto f = [](Vec3 p) { return p.x * p.x + p.y * p.y - 0.5; };
  const int n = 20, s = n + 1;
  std::vector<double> xyz, v;
  for (int j = 0; j < s; ++j)
    for (int i = 0; i < s; ++i) {
      const Vec3 p(-1 + 2.0 * i / n, -1 + 2.0 * j / n, 0);
      xyz.insert(xyz.end(), {p.x, p.y, p.z});
      v.push_back(f(p));
    }
  for (CellType type : {CellType::triangle, CellType::quad, CellType::pixel, CellType::polygon}) {
    CellsOf m;
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const int a = i + s * j;
        if (type == CellType::triangle) {
          m.cell(type, {a, a + 1, a + 1 + s});
          m.cell(type, {a, a + 1 + s, a + s});
        } else if (type == CellType::pixel) {
          m.cell(type, {a, a + 1, a + s, a + 1 + s});
        } else {
          m.cell(type, {a, a + 1, a + 1 + s, a + s});
        }
      }
    UnstructuredMesh u;
    u.points.xyz = Array::from_vector(xyz, 3);
    u.cells.connectivity = Array::from_vector(m.ids);
    u.cells.offsets = Array::from_vector(m.offsets);
    u.types = Array::from_vector(m.types);
    SurfaceMesh surface;
    surface.points = u.points;
    surface.polygons = u.cells;
    FieldSet fields;
    fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
    for (const DatasetPtr& d : {make_dataset(u, fields), make_dataset(surface, fields)}) {
      if (type == CellType::pixel && d->as<SurfaceMesh>()) continue;
      const Surface lines(contour_at(d, 0));
      double length_sum = 0, area = 0;
      for (const auto& [a, b] : lines.lines) {
        length_sum += length(lines.points[size_t(b)] - lines.points[size_t(a)]);
        area -= 0.5 * cross(lines.points[size_t(a)], lines.points[size_t(b)]).z;  // outside is larger: clockwise
      }
      CHECK(lines.lines.size() == lines.points.size());
      CHECK(length_sum == doctest::Approx(2 * M_PI * std::sqrt(0.5)).epsilon(0.01));
      CHECK(area == doctest::Approx(M_PI * 0.5).epsilon(0.01));
    }
  }
}
