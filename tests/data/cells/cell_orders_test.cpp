// SPDX-License-Identifier: Apache-2.0
// Orders along the axes and rational weights of a mesh: what is refused, and what they mean for faces.
#include "cell_cases.h"
#include "data/cells/cell_reader.h"
#include "support/test.h"

using namespace sg;

namespace {

UnstructuredMesh one(CellType type, size_t nodes, std::vector<uint8_t> orders, int components = 3) {
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>(3 * nodes), 3);
  std::vector<int64_t> ids(nodes);
  for (size_t i = 0; i < nodes; ++i) ids[i] = int64_t(i);
  m.cells = {Array::from_vector(ids), Array::from_vector(std::vector<int64_t>{0, int64_t(nodes)}), 0};
  m.single_type = type;
  m.degrees = Array::from_vector(std::move(orders), components);
  return m;
}

}  // namespace

TEST_CASE("orders: those that do not fit the cells are refused with the cell's number") {
  using enum CellType;
  CHECK_NOTHROW(validate(one(lagrange_hexahedron, 24, {1, 2, 3})));
  CHECK_NOTHROW(validate(one(bezier_quad, 6, {1, 2, 0})));
  CHECK_NOTHROW(validate(one(bezier_wedge, 12, {2, 2, 1})));
  CHECK_NOTHROW(validate(one(lagrange_wedge, 21, {2, 2, 2})));
  CHECK_NOTHROW(validate(one(lagrange_hexahedron, 27, {0, 0, 0})));
  CHECK_NOTHROW(validate(one(tetra, 4, {9, 9, 9})));  // has no orders
  CHECK(test::error_of([] { validate(one(lagrange_hexahedron, 24, {1, 2, 2})); }).find("cell 0 is a LagrangeHexahedron of 24") == 0);
  CHECK(test::error_of([] { validate(one(lagrange_quad, 24, {11, 1, 0})); }).find("orders are 1 to 10") != std::string::npos);
  CHECK(test::error_of([] { validate(one(lagrange_wedge, 12, {2, 1, 1})); }).find("wedge are equal") != std::string::npos);
  CHECK(test::error_of([] { validate(one(lagrange_quad, 6, {1, 2, 0, 1, 2, 0})); }).find("3 u8 per cell") != std::string::npos);
  CHECK(test::error_of([] { validate(one(lagrange_quad, 6, {1, 2}, 2)); }).find("3 u8 per cell") != std::string::npos);
}

TEST_CASE("rational weights: one finite f64 a point") {
  UnstructuredMesh m = one(CellType::bezier_curve, 3, {2, 0, 0});
  m.weights = Array::from_vector(std::vector<double>{1, 1, 0.7});
  CHECK_NOTHROW(validate(m));
  CellReader r(make_dataset(m));
  r.open(0);
  CHECK(r.weights().size() == 3);
  CHECK(r.weights()[2] == 0.7);
  CHECK(r.orders() == std::array<int, 3>{2, 0, 0});
  m.weights = Array::from_vector(std::vector<double>{1, 1});
  CHECK(test::error_of([&] { validate(m); }).find("one f64 per point") != std::string::npos);
  m.weights = Array::from_vector(std::vector<float>{1, 1, 1});
  CHECK(test::error_of([&] { validate(m); }).find("one f64 per point") != std::string::npos);
  m.weights = Array::from_vector(std::vector<double>{1, 1, std::nan("")});
  CHECK(test::error_of([&] { validate(m); }).find("point 2") != std::string::npos);
}

TEST_CASE("orders: the faces of cells with an order per axis carry theirs, and close the cell") {
  using enum CellType;
  for (CellType type : {lagrange_hexahedron, bezier_hexahedron, lagrange_wedge, bezier_wedge})
    for (std::array<int, 3> o : {std::array{2, 2, 1}, {1, 1, 4}, {3, 3, 2}, {1, 2, 3}, {4, 2, 1}}) {
      if (linear_type(type) == wedge && o[0] != o[1]) continue;
      CAPTURE(cell_type_info(type).name);
      CAPTURE(o[0] * 100 + o[1] * 10 + o[2]);
      const size_t nodes = lattice_nodes(type, o);
      const CellShape& s = *CellShape::find(type, nodes, o);
      std::vector<Vec3> at;
      for (size_t k = 0; k < nodes; ++k) at.push_back(s.node(k) + (is_bezier(type) ? Vec3() : test::random_vector(3, k) * 0.02));
      UnstructuredMesh m = one(type, nodes, {uint8_t(o[0]), uint8_t(o[1]), uint8_t(o[2])});
      CellFaceReader reader(m);
      const size_t faces = reader.open(0);
      CHECK(faces == cell_faces(linear_type(type), 0).size());
      double volume = 0;
      for (size_t f = 0; f < faces; ++f) {
        const auto ids = reader.nodes(f);
        const CellShape* flat = CellShape::find(reader.face_type(f), ids.size(), reader.face_orders(f));
        REQUIRE(flat);
        // Its nodes lie where the face's own lattice says: between its corners.
        std::vector<Vec3> p, ring_at;
        for (size_t k = 0; k < ids.size(); ++k) {
          std::vector<double> n(4);
          const size_t corners = cell_faces(type, nodes, o).corners[f];
          CellShape::find(corners == 3 ? triangle : quad, corners)->values(flat->node(k), n.data());
          Vec3 want;
          for (size_t c = 0; c < corners; ++c) want += s.node(size_t(ids[c])) * n[c];
          CHECK(length(s.node(size_t(ids[k])) - want) < 1e-14);
          p.push_back(at[size_t(ids[k])]);
        }
        std::vector<uint32_t> t, ring;
        tessellate_face(reader.face_type(f), p, t, reader.face_orders(f));
        for (size_t i = 0; i < t.size(); i += 3) volume += dot(p[t[i]], cross(p[t[i + 1]], p[t[i + 2]])) / 6;
        const auto fo = reader.face_orders(f);
        const bool three = linear_type(reader.face_type(f)) == triangle;
        CHECK(t.size() / 3 == size_t(three ? fo[0] * fo[0] : 2 * fo[0] * fo[1]));
        face_outline(reader.face_type(f), ids.size(), ring, fo);
        CHECK(ring.size() == size_t(three ? 3 * fo[0] : 2 * (fo[0] + fo[1])));
        for (uint32_t k : ring) CHECK(flat->outside(flat->node(k)) > -1e-14);
      }
      CHECK(volume == doctest::Approx(s.reference_measure()).epsilon(0.1));
      if (is_bezier(type)) CHECK(volume == doctest::Approx(s.reference_measure()).epsilon(1e-13));
    }
}
