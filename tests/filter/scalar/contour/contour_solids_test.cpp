// SPDX-License-Identifier: Apache-2.0
// The checks of isosurfaces on grids, on lists of cells (correctness.md, I1 to I6, I8, I9, I11, I13).
#include "filter/cell_meshes.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/scalar/contour/known_surfaces.h"

using namespace sg;
using namespace sg::test;

namespace {

const char* const cubes[] = {"hexahedron", "voxel", "polyhedron"};

// A grid's cells as hexahedra, voxels or polyhedra.
DatasetPtr as_cells(const DatasetPtr& grid, const std::string& kind) {
  DatasetParts parts = to_unstructured(grid)->parts();
  auto& m = std::get<UnstructuredMesh>(parts.mesh);
  if (kind == "voxel") return make_dataset(parts);
  const CellsView cells = cells_view(m.cells);
  std::vector<int64_t> ids, face_ids, face_offsets{0}, cell_faces{0};
  for (size_t c = 0; c < cells.count; ++c) {
    for (size_t k : {0, 1, 3, 2, 4, 5, 7, 6}) ids.push_back(cells.point(c, k));
    for (const auto& face : {std::array<size_t, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
      for (size_t k : face) face_ids.push_back(cells.point(c, k));
      face_offsets.push_back(int64_t(face_ids.size()));
    }
    cell_faces.push_back(int64_t(face_offsets.size()) - 1);
  }
  m.cells = {Array::from_vector(ids), {}, 8};
  m.types = {};
  m.single_type = kind == "polyhedron" ? CellType::polyhedron : CellType::hexahedron;
  if (kind == "polyhedron") {
    m.faces = {Array::from_vector(face_ids), Array::from_vector(face_offsets), 0};
    m.polyhedron_faces = Array::from_vector(cell_faces);
  }
  return make_dataset(parts);
}

}  // namespace

TEST_CASE("contour: hexahedra, voxels and polyhedra have the counts and Euler numbers of the grid") {
  for (const std::string kind : cubes) {
    CAPTURE(kind);
    const auto ball = contour_at(solid_mesh(kind, 16, 1.3, sphere), 0), ring = contour_at(solid_mesh(kind, 32, 1.6, torus), 0);
    CHECK(ball->point_count() == 726);
    CHECK(ball->cell_count() == 1448);
    CHECK(ring->point_count() == 2216);
    CHECK(ring->cell_count() == 4432);
    CHECK(Surface(ring).euler() == 0);
  }
}

TEST_CASE("contour: torus and tanglecube have their genus on every kind of solids") {
  for (const auto& kind : solid_kinds()) {
    CAPTURE(kind);
    const Surface ring(contour_at(solid_mesh(kind, 20, 1.6, torus), 0)), tubes(contour_at(solid_mesh(kind, 24, 3, tangle), 0));
    CHECK(ring.euler() == 0);
    CHECK(ring.faults() == 0);
    CHECK(ring.area() == doctest::Approx(4 * M_PI * M_PI * 0.4).epsilon(0.03));
    CHECK(-ring.volume() == doctest::Approx(2 * M_PI * M_PI * 0.16).epsilon(0.06));
    CHECK(tubes.euler() == -8);
    CHECK(tubes.components() == 1);
    CHECK(tubes.faults() == 0);
  }
}

TEST_CASE("contour: on cells the points of a sphere converge with order 2, facet normals with order 1") {
  for (const std::string kind : {"hexahedron", "tetra", "wedge", "mixed"}) {
    CAPTURE(kind);
    double h[3], volume[3], vertex[3] = {}, facet[3] = {};
    for (int i = 0; i < 3; ++i) {
      const int n = 8 << i;
      const Surface s(contour_at(solid_mesh(kind, n, 1.3, sphere), 0));
      h[i] = 1.0 / n;
      volume[i] = std::abs(-s.volume() - 4 * M_PI / 3);
      for (Vec3 p : s.points) vertex[i] = std::max(vertex[i], std::abs(length(p) - 1));
      double area = 0;  // thin triangles have any normal: weigh by area
      for (size_t t = 0; t < s.triangles.size(); ++t) {
        const auto& [a, b, c] = s.triangles[t];
        const Vec3 n2 = s.area_vector(t), out = normalize(s.points[size_t(a)] + s.points[size_t(b)] + s.points[size_t(c)]);
        facet[i] += length(cross(n2, out)), area += length(n2);
      }
      facet[i] /= area;
    }
    CHECK(observed_order(h, volume, 3) == doctest::Approx(2).epsilon(0.15));
    CHECK(observed_order(h, vertex, 3) == doctest::Approx(2).epsilon(0.2));
    CHECK(observed_order(h, facet, 3) == doctest::Approx(1).epsilon(0.2));
  }
}

TEST_CASE("contour: tunnels, deciders and ties come out on hexahedra, voxels and polyhedra as on grids") {
  for (const std::string kind : cubes) {
    CAPTURE(kind);
    auto surface = [&](std::vector<double> v, std::array<size_t, 3> n = {2, 2, 2}) {
      return Surface(contour_at(as_cells(grid_of<double>(n, std::move(v)), kind), 0));
    };
    const Surface tunnel = surface({9, -1, -1, -1, -1, -1, -1, 9}), discs = surface({1, -1, -1, -1, -1, -1, -1, 1});
    CHECK(tunnel.euler() == 0);
    CHECK(tunnel.components() == 1);
    CHECK(discs.euler() == 2);
    CHECK(discs.components() == 2);
    CHECK(surface({3, -1, -1, 3, -1, -1, -1, -1}).components() == 1);
    CHECK(surface({1, -3, -3, 1, -1, -1, -1, -1}).components() == 2);
    const Box3 box{{0, 0, 0}, {1, 1, 2}};
    CHECK(surface({13, -1, -1, -7, -1, 1, 7, -7, 15, -9, -3, -1}, {2, 2, 3}).faults(box) == 0);
  }
}

TEST_CASE("contour: a linear field gives the exact plane in curved cells with straight edges") {
  // x + 2y + 3z = 2.5 in the unit box: seen along z the unit square without the triangle where x + 2y > 2.5.
  const double area = (1 - 0.5 * 0.5 * 0.25) * std::sqrt(14.0) / 3;
  for (const auto& [type, order] : {std::pair{CellType::quadratic_tetra, 2},
                                    {CellType::quadratic_hexahedron, 2},
                                    {CellType::triquadratic_hexahedron, 2},
                                    {CellType::lagrange_tetra, 3},
                                    {CellType::lagrange_hexahedron, 4},
                                    {CellType::lagrange_wedge, 3},
                                    {CellType::bezier_hexahedron, 3}}) {
    CAPTURE(int(type));
    const DatasetPtr box = meshes::solid_box(type, 2, order);
    const Surface s(contour_at(box, 1.5));
    double off = 0;
    for (Vec3 p : s.points) off = std::max(off, std::abs(meshes::linear(p) - 1.5));
    CHECK(off < 2e-6);
    CHECK(s.area() == doctest::Approx(area).epsilon(1e-6));
    CHECK(s.faults(box->bounds()) == 0);
  }
}
