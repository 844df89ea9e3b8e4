// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "data/cells/cell_topology.h"
#include "data/cells/shape/cell_map.h"
#include "io/mesh/total_measure.h"
#include "io/mfem/element.h"
#include "io/text/mesh_text.h"
#include "mesh_robust.h"

using namespace sg;
using namespace sg::mfem;

namespace {

constexpr const char* triangle_and_square =
    "MFEM mesh v1.0\n\n# a comment\ndimension\n2\n\nelements\n2\n3 3 1 0 2 3\n4 2 3 2 4\n\nboundary\n1\n1 1 0 1\n\nvertices\n5\n";

// x^a y^b z^c up to total degree p, all in one.
double polynomial(Vec3 x, int p) {
  double sum = 0, f = 1;
  for (int k = 0; k <= p; ++k, f *= 0.7 * x.x - 0.4 * x.y + 0.9 * x.z + 0.1) sum += f;
  return sum;
}

// Smallest Jacobian determinant of solid cells over a lattice of places.
double smallest_jacobian(const DatasetPtr& d) {
  CellMap map(d);
  double least = 1e300;
  for (size_t c = 0; c < d->cell_count(); ++c) {
    map.open(c);
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j)
        for (int k = 0; k < 5; ++k) {
          const Vec3 at(0.05 + 0.15 * i, 0.02 + 0.05 * j, 0.05 + 0.06 * k);
          Mat3 m = map.jacobian(at);
          if (map.dimension() == 2) {
            const Vec3 n = cross(m.column(0), m.column(1));
            least = std::min(least, n.z);
          } else {
            least = std::min(least, determinant(m));
          }
        }
  }
  return least;
}

DatasetPtr data(const std::string& name) {
  Context context;
  return std::get<DatasetPtr>(read_data(test::data_file("meshes/high-order/" + name), {}, context));
}

}  // namespace

TEST_CASE("mfem: points of the nodal bases are those of the tables") {
  const auto lobatto = basis_points(Basis::gauss_lobatto, 3);
  CHECK(lobatto[1] == doctest::Approx((1 - 1 / std::sqrt(5.0)) / 2).epsilon(1e-14));
  CHECK(lobatto[2] == doctest::Approx((1 + 1 / std::sqrt(5.0)) / 2).epsilon(1e-14));
  CHECK(basis_points(Basis::gauss_lobatto, 4)[1] == doctest::Approx((1 - std::sqrt(3.0 / 7)) / 2).epsilon(1e-14));
  CHECK(basis_points(Basis::gauss_lobatto, 10)[5] == 0.5);
  const auto legendre = basis_points(Basis::gauss_legendre, 2);
  CHECK(legendre[0] == doctest::Approx((1 - std::sqrt(0.6)) / 2).epsilon(1e-14));
  CHECK(legendre[1] == 0.5);
  CHECK(basis_points(Basis::open_uniform, 1) == std::vector<double>{1.0 / 3, 2.0 / 3});
}

TEST_CASE("mfem: names of collections") {
  const auto is = [](const char* name, Family family, Basis basis, int order) {
    const FeCollection c = parse_collection(name, "here");
    return c.family == family && c.basis == basis && c.order == order;
  };
  CHECK(is("H1_3D_P10", Family::h1, Basis::gauss_lobatto, 10));
  CHECK(is("H1Pos_2D_P2", Family::h1, Basis::bernstein, 2));
  CHECK(is("H1@U_2D_P4", Family::h1, Basis::closed_uniform, 4));
  CHECK(is("L2_2D_P0", Family::l2, Basis::gauss_legendre, 0));
  CHECK(is("L2_T2_3D_P1", Family::l2, Basis::bernstein, 1));
  CHECK(is("Cubic", Family::h1, Basis::closed_uniform, 3));
  CHECK(is("Const3D", Family::l2, Basis::closed_uniform, 0));
  for (const char* wrong : {"H1_3D_P11", "H1_2D_P0", "L2_T9_2D_P1", "H1_2D", "H1_2D_Px", "Octic", "L2_T", "H1@x_2D_P2"}) {
    CAPTURE(wrong);
    CHECK(test::error_of([&] { parse_collection(wrong, "here"); }).starts_with("here: "));
  }
}

TEST_CASE("mfem: matrices reproduce polynomials of every basis, geometry and order") {
  // The degrees of freedom of a nodal basis are values at its nodes: those of the bases with equal distances are known.
  for (Geometry g : {Geometry::segment, Geometry::triangle, Geometry::square, Geometry::tetrahedron, Geometry::cube, Geometry::prism})
    for (int p : {1, 2, 3, 5}) {
      CAPTURE(int(g));
      CAPTURE(p);
      const FeCollection c = parse_collection(fmt::format("H1@U_3D_P{}", p), "");
      const int q = p + 2;
      const NodeMatrix m = node_matrix(g, c, q, "");
      const auto nodes = local_nodes(g, p);
      const auto out = lattice_places(info(g).shape, q);
      REQUIRE(m.dofs == nodes.size());
      auto at = [](std::array<int, 3> place, int n) { return Vec3(place[0], place[1], place[2]) / double(n); };
      double worst = 0;
      for (size_t k = 0; k < m.nodes; ++k) {
        double sum = 0;
        for (size_t d = 0; d < m.dofs; ++d) sum += m.m[k * m.dofs + d] * polynomial(at(nodes[d].place, p), p);
        worst = std::max(worst, std::fabs(sum - polynomial(at(out[k], q), p)));
      }
      CHECK(worst < 1e-12);
    }
  // Any basis: rows sum to 1, and order 10 stays accurate.
  for (const char* name : {"L2_T0_3D_P4", "L2_T1_3D_P3", "L2_T2_3D_P3", "L2_T5_3D_P2", "H1_3D_P6", "H1_3D_P10", "H1Pos_3D_P4"})
    for (Geometry g : {Geometry::triangle, Geometry::tetrahedron, Geometry::prism}) {
      const FeCollection c = parse_collection(name, "");
      if (c.order == 10 && g == Geometry::prism) continue;
      const NodeMatrix m = node_matrix(g, c, c.order, "");
      double worst = 0;
      for (size_t k = 0; k < m.nodes; ++k) {
        double sum = 0;
        for (size_t d = 0; d < m.dofs; ++d) sum += m.m[k * m.dofs + d];
        worst = std::max(worst, std::fabs(sum - 1));
      }
      CHECK(worst < 1e-10);
    }
}

TEST_CASE("mfem: a linear mesh keeps its vertices, attributes and order") {
  const DatasetPtr d = test::read_text("linear.mesh", std::string(triangle_and_square) + "2\n1 0\n0 0\n1 1\n0 1\n1 2\n");
  CHECK(d->point_count() == 5);
  CHECK(cell_type_counts(d->mesh()) == std::vector<std::pair<std::string_view, size_t>>{{"Triangle", 1}, {"Quad", 1}});
  CHECK(d->fields().require("attribute").array.get(0) == 3);
  CHECK(d->as<UnstructuredMesh>()->points.at(4) == Vec3(1, 2, 0));
  CHECK(cells_view(d->as<UnstructuredMesh>()->cells).point(0, 1) == 0);
}

TEST_CASE("mfem: degrees of freedom of order 3 lie on vertices, edges from the smaller vertex, and inside") {
  // One square with the vertices 1 0 2 3, nodes where Gauss and Lobatto put them: the cell is the square [0,2] x [0,1].
  const double a = (1 - 1 / std::sqrt(5.0)) / 2, b = 1 - a;
  std::string s =
      "MFEM mesh v1.0\ndimension\n2\nelements\n1\n1 3 1 0 2 3\nboundary\n0\nvertices\n4\nnodes\nFiniteElementSpace\n"
      "FiniteElementCollection: H1_2D_P3\nVDim: 2\nOrdering: 1\n\n";
  auto node = [&](double x, double y) { s += fmt::format("{} {}\n", 2 * x, y); };
  node(1, 0), node(0, 0), node(1, 1), node(0, 1);  // vertex 0 is the second corner
  node(b, 0), node(a, 0);                          // edge 1-0, from vertex 0
  node(1, a), node(1, b);                          // edge 0-2
  node(b, 1), node(a, 1);                          // edge 2-3, from vertex 2
  node(0, a), node(0, b);                          // edge 3-1, from vertex 1
  node(a, a), node(b, a), node(a, b), node(b, b);
  const DatasetPtr d = test::read_text("cubic.mesh", s);
  CHECK(d->point_count() == 16);
  const auto& m = *d->as<UnstructuredMesh>();
  const CellsView cells = cells_view(m.cells);
  REQUIRE(m.type(0) == CellType::lagrange_quad);
  for (int j = 0; j <= 3; ++j)
    for (int i = 0; i <= 3; ++i)
      CHECK(length(m.points.at(size_t(cells.point(0, lattice_node(CellType::quad, 3, i, j)))) - Vec3(2 * i / 3.0, j / 3.0, 0)) < 1e-14);
}

TEST_CASE("mfem: a discontinuous field opens the mesh only where it jumps") {
  const std::string mesh = std::string(triangle_and_square) + "2\n1 0\n0 0\n1 1\n0 1\n1 2\n";
  // On the square 1 everywhere; on the triangle 1 at vertices 3 and 2, 5 at vertex 4.
  const std::string field = "\nFiniteElementSpace\nFiniteElementCollection: L2_T1_2D_P1\nVDim: 1\nOrdering: 0\n\n1\n1\n1\n1\n1\n1\n5\n";
  DatasetPtr d = test::read_text("jump.saved", "solution\n" + mesh + field);
  CHECK(d->point_count() == 5);
  CHECK(d->fields().require("solution").array.get(4) == 5);
  d = test::read_text(
      "jump.saved",
      "solution\n" + mesh + "\nFiniteElementSpace\nFiniteElementCollection: L2_T1_2D_P1\nVDim: 1\nOrdering: 0\n\n1\n1\n1\n1\n2\n2\n5\n");
  CHECK(d->point_count() == 7);
  // A field of higher order raises the geometry; one of order 0 lies on the cells.
  std::string quadratic = "\nFiniteElementSpace\nFiniteElementCollection: L2_T4_2D_P2\nVDim: 1\nOrdering: 0\n\n";
  for (int k = 0; k < 15; ++k) quadratic += "1\n";
  d = test::read_text("jump.saved", "solution\n" + mesh + quadratic);
  CHECK(d->as<UnstructuredMesh>()->type(0) == CellType::lagrange_quad);
  CHECK(test::total_measure(d) == doctest::Approx(1.5));
  d = test::read_text("jump.saved",
                      "solution\n" + mesh + "\nFiniteElementSpace\nFiniteElementCollection: L2_2D_P0\nVDim: 1\nOrdering: 0\n\n3\n4\n");
  CHECK(d->fields().require("solution", Association::cell).array.get(1) == 4);
  ReadOptions none;
  none.fields = {"attribute"};
  CHECK(test::read_text("jump.saved", "solution\n" + mesh + quadratic, none)->as<UnstructuredMesh>()->type(0) == CellType::quad);
}

TEST_CASE("mfem: grid functions beside a mesh, and a mesh beside a grid function") {
  write_file(test::temp_folder() + "pair.mesh", std::string(triangle_and_square) + "2\n1 0\n0 0\n1 1\n0 1\n1 2\n");
  const std::string space = "FiniteElementSpace\nFiniteElementCollection: H1_2D_P1\nVDim: 2\nOrdering: 0\n\n";
  write_file(test::temp_folder() + "pair.speed.gf", space + "1 2 3 4 5\n6 7 8 9 10\n");
  Context context;
  for (const char* name : {"pair.mesh", "pair.speed.gf"}) {
    const DatasetPtr d = std::get<DatasetPtr>(read_data(test::temp_folder() + name, {}, context));
    const Field& f = d->fields().require("speed");
    CHECK(f.components() == 3);
    CHECK(f.array.get(2, 0) == 3);
    CHECK(f.array.get(2, 1) == 8);
    CHECK(f.array.get(2, 2) == 0);
  }
}

TEST_CASE("mfem: meshes made from a few numbers fill their box") {
  for (auto [type, cells] : std::vector<std::pair<const char*, size_t>>{{"hex", 24}, {"tet", 144}, {"wedge", 48}, {"pyramid", 144}}) {
    CAPTURE(type);
    const DatasetPtr d = test::read_text(
        "inline.mesh", fmt::format("MFEM INLINE mesh v1.0\ntype = {}\nnx = 2\nny = 3\nnz = 4\nsx = 1.0\nsy = 2.0\nsz = 3.0\n", type));
    CHECK(d->cell_count() == cells);
    CHECK(test::total_measure(d) == doctest::Approx(6));
    CHECK(smallest_jacobian(d) > 0);
  }
  CHECK(test::read_text("inline.mesh", "MFEM INLINE mesh v1.0\ntype = tri\nnx = 2\nny = 3\n")->cell_count() == 12);
  CHECK(test::read_text("inline.mesh", "MFEM INLINE mesh v1.0\ntype = segment\nnx = 5\n")->cell_count() == 5);
  CHECK(test::error_of([&] {
          test::read_bytes("inline.mesh", "MFEM INLINE mesh v1.0\ntype = hex\nnx = 90000\nny = 90000\nnz = 90000\n");
        }).find("at most") != std::string::npos);
}

TEST_CASE("mfem: what cannot be read says so") {
  const std::string mesh = std::string(triangle_and_square) + "2\n1 0\n0 0\n1 1\n0 1\n1 2\n";
  auto message = [&](const std::string& bytes) { return test::error_of([&] { test::read_bytes("wrong.mesh", bytes); }); };
  std::string s = mesh;
  s.replace(s.find("3 2 4\n"), 5, "3 2 9");
  CHECK(message(s).find("vertex 9") != std::string::npos);
  s = mesh;
  s.replace(s.find("4 2 3 2 4"), 3, "4 5");
  CHECK(message(s).find("dimension 3") != std::string::npos);
  CHECK(message("MFEM mesh v2.0\n").find("its content is not") != std::string::npos);
  CHECK(message("MFEM mesh v1.0\ndimension\n2\nelements\n99999999999\n").find("line 5") != std::string::npos);
  CHECK(test::error_of([&] {
          test::read_bytes(
              "nd.saved", "solution\n" + mesh + "FiniteElementSpace\nFiniteElementCollection: RT_Trace_2D_P1\nVDim: 1\nOrdering: 0\n\n1\n");
        }).find("RT_Trace_2D_P1") != std::string::npos);
  CHECK(test::error_of([&] { test::read_bytes("alone.gf", "FiniteElementSpace\nFiniteElementCollection: H1_2D_P1\n"); }).size() > 10);
  CHECK(test::error_of([&] { test::read_bytes("q.saved", "quadrature\n" + mesh + "QuadratureSpace\n"); }).find("quadrature") !=
        std::string::npos);
}

TEST_CASE("mfem: sizes that no file backs are refused") {
  test::check_survives_sizes(
      "sizes.mesh",
      "MFEM NC mesh v1.0\ndimension\n2\nelements\n2\n0 1 3 0 0 1 2 3\n-1 1 3 3 1 2 3 4\nboundary\n0\nvertex_parents\n1\n"
      "4 0 1\ncoordinates\n4\n2\n0 0\n1 0\n1 1\n0 1\n");
  test::check_survives_sizes("sizes.mesh", std::string(triangle_and_square) + "2\n1 0\n0 0\n1 1\n0 1\n1 2\n");
  test::check_survives_sizes("sizes.mesh", "MFEM INLINE mesh v1.0\ntype = tet\nnx = 2\nny = 3\nnz = 4\nsx = 1\nsy = 2\nsz = 3\n");
  test::check_survives_sizes(
      "sizes.saved",
      "solution\n" + std::string(triangle_and_square) +
          "\nnodes\nFiniteElementSpace\nFiniteElementCollection: L2_T1_2D_P1\nVDim: 2\nOrdering: 1\n\n0 0 1 0 0 1 1 "
          "1\n0 1 1 1 2 1\nFiniteElementSpace\nFiniteElementCollection: H1_2D_P2\nVDim: 1\nOrdering: 0\n\n1 2 3 4 5 6 7 8 9 10 11 12\n");
}

TEST_CASE("mfem: cut and damaged files are refused") {
  test::check_survives(
      "robust.saved",
      "solution\n" + std::string(triangle_and_square) +
          "\nnodes\nFiniteElementSpace\nFiniteElementCollection: L2_T1_2D_P1\nVDim: 2\nOrdering: 1\n\n0 0 1 0 0 1 1 1\n0 1 1 "
          "1 2 1\nFiniteElementSpace\nFiniteElementCollection: H1_2D_P2\nVDim: 1\nOrdering: 0\n\n1 2 3 4 5 6 7 8 9 10 11 12\n");
  test::check_survives(
      "nc.mesh",
      "MFEM NC mesh v1.0\ndimension\n2\nelements\n5\n-1 1 3 3 1 2 3 4\n0 1 3 0 0 4 8 7\n0 1 3 0 4 1 5 8\n0 1 3 0 8 5 2 6\n"
      "0 1 3 0 7 8 6 3\nboundary\n0\nvertex_parents\n5\n4 0 1\n5 1 2\n6 2 3\n7 0 3\n8 4 6\ncoordinates\n4\n2\n0 0\n1 0\n1 1\n0 1\n");
}

TEST_CASE("mfem: curved meshes equal the same meshes that VTK holds" * doctest::skip(test::no_data())) {
  for (const std::string name : {"star-q2", "escher-p2", "fichera-mixed-p2"}) {
    CAPTURE(name);
    const DatasetPtr a = data(std::string(name) + ".mesh"), b = data(std::string(name) + ".vtk");
    const auto &m = *a->as<UnstructuredMesh>(), &v = *b->as<UnstructuredMesh>();
    CHECK(a->point_count() == b->point_count());
    REQUIRE(a->cell_count() == b->cell_count());
    const CellsView mc = cells_view(m.cells), vc = cells_view(v.cells);
    double worst = 0;
    for (size_t c = 0; c < mc.count; ++c) {
      REQUIRE(mc.size(c) == vc.size(c));
      // The .vtk files hold tetrahedra that were turned and wedges upside down: there each node is found at some place of the other.
      const bool turned = m.type(c) == CellType::lagrange_tetra || m.type(c) == CellType::lagrange_wedge;
      for (size_t k = 0; k < mc.size(c); ++k) {
        const Vec3 at = m.points.at(size_t(mc.point(c, k)));
        double nearest = 1e9;
        for (size_t l = turned ? 0 : k; l < (turned ? mc.size(c) : k + 1); ++l)
          nearest = std::min(nearest, length(at - v.points.at(size_t(vc.point(c, l)))));
        worst = std::max(worst, nearest);
      }
    }
    CHECK(worst < 1e-5);  // files of six digits
  }
}

TEST_CASE("mfem: no element of the real meshes is folded" * doctest::skip(test::no_data())) {
  for (const std::string name :
       {"star-q2.mesh", "star-q3.mesh", "star-mixed-p2.mesh", "escher-p2.mesh", "escher-p3.mesh", "toroid-hex.mesh", "toroid-wedge.mesh",
        "fichera-mixed-p2.mesh", "ex27.saved", "laghos.saved", "triple-pt-1/triple-pt-1.mesh", "tinyzoo-3d.mesh"}) {
    CAPTURE(name);
    CHECK(smallest_jacobian(data(name)) > 0);
  }
  CHECK(test::total_measure(data("amr-quad.mesh")) == doctest::Approx(1));
  CHECK(test::total_measure(data("navier.saved")) == doctest::Approx(1));
  CHECK(test::total_measure(data("laghos.saved")) == doctest::Approx(1));
  CHECK(test::total_measure(data("triple-pt-1/triple-pt-1.mesh")) == doctest::Approx(21));
  CHECK(test::total_measure(data("tinyzoo-3d.mesh")) == doctest::Approx(1 + 0.5 + 1.0 / 3 + 1.0 / 6));
}
