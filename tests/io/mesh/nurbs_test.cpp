// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "io/mesh/total_measure.h"
#include "mesh_robust.h"

using namespace sg;

namespace {

// One square patch of orders 2 x 1 with the spans [0,1] [1,3] along u; control points at the Greville abscissae make it the identity
// on [0,3] x [0,1]. `turn` lists the edges of the first direction the other way round with the knots mirrored.
std::string identity(bool turn, std::string_view weights = "1 1 1 1 1 1 1 1") {
  std::string s = "MFEM NURBS mesh v1.0\n\ndimension\n2\nelements\n1\n5 3 0 1 2 3\nboundary\n0\nedges\n4\n";
  s += turn ? "0 1 0\n1 1 2\n0 2 3\n1 0 3\n" : "0 0 1\n1 1 2\n0 3 2\n1 0 3\n";
  s += "vertices\n4\nknotvectors\n2\n";
  s += turn ? "2 4 0 0 0 2 3 3 3\n" : "2 4 0 0 0 1 3 3 3\n";
  s += "1 2 0 0 1 1\nweights\n" + std::string(weights) + "\n";
  s += "FiniteElementSpace\nFiniteElementCollection: NURBS\nVDim: 2\nOrdering: 1\n\n";
  // Vertices, edge 0-1 from vertex 0, edge 2-3 from vertex 2: Greville points 0, 1/2, 2, 3.
  return s + "0 0\n3 0\n3 1\n0 1\n0.5 0\n2 0\n2 1\n0.5 1\n";
}

}  // namespace

TEST_CASE("nurbs: knot spans become Bezier cells that lie where the spline does") {
  for (bool turn : {false, true}) {
    CAPTURE(turn);
    const DatasetPtr d = test::read_text("identity.mesh", identity(turn));
    REQUIRE(d->cell_count() == 2);
    CHECK(d->as<UnstructuredMesh>()->type(0) == CellType::bezier_quad);
    CHECK(d->as<UnstructuredMesh>()->weights.empty());
    CHECK(d->point_count() == 15);  // 5 x 3: the order along v is raised to 2
    CHECK(d->fields().require("attribute").array.get(1) == 5);
    CellMap map(d);
    map.open(0);
    CHECK(length(map.position({0.3, 0.25, 0}) - Vec3(0.3, 0.25, 0)) < 1e-14);
    map.open(1);
    CHECK(length(map.position({0.3, 0.75, 0}) - Vec3(1.6, 0.75, 0)) < 1e-14);
  }
}

TEST_CASE("nurbs: a quarter of a ring is exact, as a mesh of numbered points and of patches") {
  const double w = std::sqrt(0.5);
  std::string head =
      "MFEM NURBS mesh v1.0\ndimension\n2\nelements\n1\n1 3 0 1 2 3\nboundary\n0\nedges\n4\n0 0 1\n1 1 2\n0 3 2\n1 0 3\nvertices\n4\n";
  const std::string numbered =
      head + fmt::format(
                 "knotvectors\n2\n1 2 0 0 1 1\n2 3 0 0 0 1 1 1\nweights\n1 1 1 1 {0} {0}\n"
                 "FiniteElementSpace\nFiniteElementCollection: NURBS2\nVDim: 2\nOrdering: 1\n\n1 0\n2 0\n0 2\n0 1\n2 2\n1 1\n",
                 w);
  const std::string patches = head + fmt::format(
                                         "patches\n\nknotvectors\n2\n1 2 0 0 1 1\n2 3 0 0 0 1 1 1\ndimension\n2\ncontrolpoints\n"
                                         "1 0 1\n2 0 1\n{1} {1} {0}\n{2} {2} {0}\n0 1 1\n0 2 1\n",
                                         w, w, 2 * w);
  for (const std::string& text : {numbered, patches}) {
    const DatasetPtr d = test::read_text("ring.mesh", text);
    REQUIRE(d->cell_count() == 1);
    CHECK(d->as<UnstructuredMesh>()->weights.count() == 9);
    CellMap map(d);
    map.open(0);
    for (double t : {0.1, 0.35, 0.8})
      for (double r : {0.0, 0.5, 1.0}) CHECK(length(map.position({r, t, 0})) == doctest::Approx(1 + r).epsilon(1e-14));
    CHECK(test::total_measure(d) == doctest::Approx(M_PI * 3 / 4).epsilon(1e-4));
  }
  // A field in the same space: x itself.
  const DatasetPtr d = test::read_text(
      "ring.saved",
      "solution\n" + numbered + "\nFiniteElementSpace\nFiniteElementCollection: NURBS2\nVDim: 1\nOrdering: 0\n\n1\n2\n0\n0\n2\n1\n");
  CellMap map(d);
  map.open(0);
  CellPlace place;
  place.rst = {0.25, 0.4, 0};
  std::vector<double> n(9);
  map.weights(place, n);
  double x = 0;
  for (size_t k = 0; k < 9; ++k) x += n[k] * d->fields().require("solution").array.get(size_t(map.reader().ids()[k]));
  CHECK(x == doctest::Approx(map.position(place.rst).x).epsilon(1e-14));
}

TEST_CASE("nurbs: a disc in one patch has its corners at (+-2, +-2) and the area 8 pi") {
  std::string s =
      "MFEM NURBS mesh v1.0\ndimension\n2\nelements\n1\n1 3 0 1 2 3\nboundary\n0\nedges\n4\n0 0 1\n1 1 2\n0 3 2\n1 0 3\nvertices\n4\n"
      "knotvectors\n2\n2 3 0 0 0 1 1 1\n2 3 0 0 0 1 1 1\nweights\n1 1 1 1\n";
  for (int k = 0; k < 4; ++k) s += "0.70710678118654752\n";
  s +=
      "1\nFiniteElementSpace\nFiniteElementCollection: NURBS2\nVDim: 2\nOrdering: 1\n\n-2 -2\n2 -2\n2 2\n-2 2\n0 -4\n4 0\n0 4\n-4 0\n0 0\n";
  const DatasetPtr d = test::read_text("disc.mesh", s);
  CHECK(test::total_measure(d) == doctest::Approx(8 * M_PI).epsilon(1e-4));
  CellMap map(d);
  map.open(0);
  for (double t : {0.0, 0.2, 0.7})
    for (Vec3 at : {Vec3(t, 0, 0), Vec3(1, t, 0), Vec3(t, 1, 0), Vec3(0, t, 0)})
      CHECK(length(map.position(at)) == doctest::Approx(std::sqrt(8.0)).epsilon(1e-14));
}

TEST_CASE("nurbs: what is wrong is named") {
  auto message = [&](std::string s, std::string_view from, std::string_view to) {
    s.replace(s.find(from), from.size(), to);
    return test::error_of([&] { test::read_bytes("wrong.mesh", s); });
  };
  CHECK(message(identity(false), "2 4 0 0 0 1 3 3 3", "2 4 0 0 0 4 3 3 3").find("decreases") != std::string::npos);
  CHECK(message(identity(false), "2 4 0 0 0 1 3 3 3", "2 4 0 0 1 1 3 3 3").find("not repeated") != std::string::npos);
  CHECK(message(identity(false), "0 3 2\n", "1 3 2\n").find("different numbers") != std::string::npos);
  CHECK(message(identity(false), "0 3 2\n", "7 3 2\n").find("knot vector 7") != std::string::npos);
  CHECK(message(identity(false), "0 3 2\n", "0 3 1\n").find("not in the list of edges") != std::string::npos);
  CHECK(message(identity(false, "1 1 1 0 1 1 1 1"), "boundary", "boundary").find("weight 0") != std::string::npos);
  CHECK(message(identity(false), "vertices", "periodic").find("periodic") != std::string::npos);
  CHECK(
      message("solution\n" + identity(false) + "FiniteElementSpace\nFiniteElementCollection: H1_2D_P1\nVDim: 1\nOrdering: 0\n\n1 1 1 1 1 1",
              "solution", "solution")
          .size() > 10);
}

TEST_CASE("nurbs: cut and damaged files are refused") {
  test::check_survives("robust.mesh", identity(true));
  test::check_survives_sizes("robust.mesh", identity(true));
}

TEST_CASE("nurbs: circles of the real meshes are round" * doctest::skip(test::no_data())) {
  Context context;
  DatasetPtr d = std::get<DatasetPtr>(read_data(test::data_file("meshes/high-order/square-disc-nurbs.mesh"), {}, context));
  CHECK(d->cell_count() == 4);
  CellMap map(d);
  double least = 1e9, most = 0;
  for (size_t c = 0; c < 4; ++c) {
    map.open(c);
    for (int i = 0; i <= 10; ++i) {
      const double r = length(map.position({i / 10.0, 1, 0}) - Vec3(0.5, 0.5, 0));
      least = std::min(least, r), most = std::max(most, r);
    }
  }
  CHECK(most - least < 1e-8);  // nine digits
  CHECK(test::total_measure(d) == doctest::Approx(1 - M_PI * most * most).epsilon(1e-4));

  d = std::get<DatasetPtr>(read_data(test::data_file("meshes/high-order/pipe-nurbs.mesh"), {}, context));
  CHECK(d->cell_count() == 8);
  CHECK(d->point_count() == 120);
  CellMap pipe(d);
  for (size_t c = 0; c < 8; ++c) {
    pipe.open(c);
    for (double s : {0.1, 0.5, 0.9}) {
      CHECK(determinant(pipe.jacobian({s, 0.4, 0.3})) > 0);
      if (pipe.position({0, s, 0}).z > 1e-9) continue;  // the ends at z = 0 are rings of radius 2 and 3
      for (double r : {0.0, 1.0}) {
        const double radius = length(pipe.position({r, s, 0}));
        CHECK(std::min(std::fabs(radius - 2), std::fabs(radius - 3)) < 1e-8);
      }
    }
  }
}
