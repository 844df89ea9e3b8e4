// SPDX-License-Identifier: Apache-2.0
// The same field gives the same surface on every mesh that holds it, whole or in pieces.
#include "base/parallel.h"
#include "base/random.h"
#include "filter/cell_meshes.h"
#include "filter/mesh/append.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/select/piece.h"

using namespace sg;
using namespace sg::test;

namespace {

double wavy(Vec3 p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + std::sin(2.5 * p.y) * std::cos(3 * p.z) + dot(p, p) - 0.8; }
// Negative at the border, and anything inside: every ambiguity of a cell.
double noise(Vec3 p) {
  if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > 0.99) return -1;
  auto n = [](double x) { return uint64_t(std::lround((x + 2) * 1000)); };
  return random_unit(9, n(p.x) + 4000 * n(p.y) + 16000000 * n(p.z)) - 0.45;
}

DatasetPtr rectilinear(const DatasetPtr& uniform) {
  const auto& u = *uniform->as<UniformGrid>();
  auto axis = [&](int a) {
    std::vector<double> x;
    for (size_t i = 0; i < u.dims[size_t(a)]; ++i) x.push_back(u.origin[a] + u.spacing[a] * double(i));
    return Array::from_vector(std::move(x));
  };
  return make_dataset(RectilinearGrid{axis(0), axis(1), axis(2)}, uniform->fields());
}

DatasetPtr curvilinear(const DatasetPtr& uniform) {
  const Lattice lattice(uniform->mesh());
  CurvilinearGrid g;
  g.dims = uniform->as<UniformGrid>()->dims;
  std::vector<double> xyz;
  for (size_t k = 0; k < g.dims[2]; ++k)
    for (size_t j = 0; j < g.dims[1]; ++j)
      for (size_t i = 0; i < g.dims[0]; ++i) {
        const Vec3 p = lattice.view().position(i, j, k);
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  return make_dataset(g, uniform->fields());
}

}  // namespace

TEST_CASE("contour: uniform, rectilinear and curvilinear grids, hexahedra, voxels and polyhedra give the same surface") {
  for (double (*f)(Vec3) : {wavy, noise}) {
    const auto grid = cube(13, 1, f);
    const Surface first(contour_at(grid, 0));
    CHECK(first.triangles.size() > 500);
    for (const auto& d : {rectilinear(grid), curvilinear(grid), solid_mesh("hexahedron", 12, 1, f), solid_mesh("voxel", 12, 1, f),
                          solid_mesh("polyhedron", 12, 1, f)}) {
      const Surface s(contour_at(d, 0));
      CAPTURE(d->kind());
      CHECK(s.points.size() == first.points.size());
      CHECK(s.triangles.size() == first.triangles.size());
      CHECK(s.area() == doctest::Approx(first.area()).epsilon(1e-6));
      CHECK(s.volume() == doctest::Approx(first.volume()).epsilon(1e-6));
      CHECK(s.components() == first.components());
      CHECK(s.euler() == first.euler());
      CHECK(s.faults(d->bounds()) == 0);
    }
  }
}

TEST_CASE("contour: tetrahedra, wedges, pyramids and mixed cells come to the same area with order 2") {
  auto sphere = [](Vec3 p) { return length(p) - 0.7; };
  for (const std::string kind : {"tetra", "wedge", "pyramid", "mixed"}) {
    CAPTURE(kind);
    double h[3], area[3], normal[3];
    for (int i = 0; i < 3; ++i) {
      const int n = 10 << i;
      const auto c = contour_at(solid_mesh(kind, n, 1, sphere), 0);
      const Surface s(c);
      CHECK(s.euler() == 2);
      CHECK(s.faults() == 0);
      h[i] = 1.0 / n;
      area[i] = std::abs(s.area() - 4 * M_PI * 0.49);
      normal[i] = 0;
      const Field& f = c->fields().require("Normals", Association::point);
      for (size_t v = 0; v < s.points.size(); ++v)
        normal[i] = std::max(normal[i], length(Vec3(f.array.get(v, 0), f.array.get(v, 1), f.array.get(v, 2)) + normalize(s.points[v])));
    }
    CHECK(observed_order(h, area, 3) == doctest::Approx(2).epsilon(0.15));
    CHECK(observed_order(h, normal, 3) == doctest::Approx(2).epsilon(0.15));
  }
}

TEST_CASE("contour: the pieces of a mesh with ghost layers give the whole's surface without seams") {
  for (const bool grid : {true, false}) {
    CAPTURE(grid);
    const auto whole = grid ? cube(17, 1, wavy) : solid_mesh("tetra", 10, 1, wavy);
    const Surface all(contour_at(whole, 0));
    Context context;
    auto parts = std::make_shared<Collection>();
    size_t triangles = 0;
    for (int i = 0; i < 4; ++i) {
      PieceParams p;
      p.piece = i, p.pieces = 4, p.ghost_levels = 1;
      const auto part = contour_at(piece(whole, p, context), 0);
      triangles += Surface(part).triangles.size();
      parts->parts.push_back({std::to_string(i), part});
    }
    CHECK(triangles == all.triangles.size());
    // Put together, points that lie in one place also have one normal.
    std::map<std::array<long, 3>, Vec3> normals;
    double apart = 0;
    size_t met = 0;
    for (const auto& part : parts->parts) {
      const auto& d = std::get<DatasetPtr>(part.data);
      const Surface s(d);
      const Field& f = d->fields().require("Normals", Association::point);
      for (size_t v = 0; v < s.points.size(); ++v) {
        const Vec3 n(f.array.get(v, 0), f.array.get(v, 1), f.array.get(v, 2));
        const std::array<long, 3> key{std::lround(s.points[v].x * 1e5), std::lround(s.points[v].y * 1e5), std::lround(s.points[v].z * 1e5)};
        const auto [at, fresh] = normals.emplace(key, n);
        if (!fresh) apart = std::max(apart, length(at->second - n)), ++met;
      }
    }
    CHECK(met > 50);
    CHECK(apart < 1e-5);
    CHECK(std::abs(double(normals.size()) - double(all.points.size())) < 0.01 * double(all.points.size()));
  }
}

TEST_CASE("contour: cells give the same bytes for any number of threads, also in a random order, several values at once") {
  for (const std::string kind : {"tetra", "mixed"}) {
    const auto ordered = solid_mesh(kind, kind == "tetra" ? 24 : 30, 1, wavy);
    // The cells in a random order, as mesh generators leave them.
    DatasetParts parts = ordered->parts();
    if (kind == "tetra") {
      auto& m = std::get<UnstructuredMesh>(parts.mesh);
      const CellsView cells = cells_view(m.cells);
      std::vector<size_t> order(cells.count);
      std::iota(order.begin(), order.end(), size_t(0));
      std::sort(order.begin(), order.end(), [](size_t a, size_t b) { return random_unit(3, a) < random_unit(3, b); });
      std::vector<int32_t> ids;
      for (size_t c : order)
        for (size_t k = 0; k < 4; ++k) ids.push_back(int32_t(cells.point(c, k)));
      m.cells = {Array::from_vector(std::move(ids)), {}, 4};
      m.types = {}, m.single_type = CellType::tetra;
    }
    const auto d = make_dataset(std::move(parts));
    Context context;
    ContourParams p;
    p.values = {0, 0.4};
    set_thread_count(1);
    const auto one = contour(d, p, context), straight = contour(ordered, p, context);
    set_thread_count(8);
    const auto eight = contour(d, p, context);
    set_thread_count(0);
    CHECK(same_surface(one, eight));
    CHECK(same_bytes(one->fields().require("Normals", Association::point).array,
                     eight->fields().require("Normals", Association::point).array));
    CHECK(Surface(one).triangles.size() == Surface(straight).triangles.size());
    CHECK(Surface(one).area() == doctest::Approx(Surface(straight).area()));
    CHECK(Surface(one).components() == Surface(straight).components());
    // Three values and more skip blocks of cells by their ranges; the surfaces stay what they are one by one.
    p.values = {-5, 0, 0.4, 0.7};
    const auto several = contour(d, p, context);
    size_t triangles = 0;
    for (double v : p.values) triangles += contour_at(d, v)->cell_count();
    CHECK(several->cell_count() == triangles);
  }
}

TEST_CASE("contour: broken cells leave no crash: flat, self-crossing, open and two-point polyhedra") {
  CellsOf m;
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 2; ++j)
      for (int i = 0; i < 2; ++i) m.point(Vec3(i, j, k));
  m.cell(CellType::hexahedron, {0, 0, 0, 0, 4, 5, 7, 6});                              // collapsed
  m.cell(CellType::tetra, {0, 1, 2, 3});                                               // flat
  m.polyhedron({0, 1, 2, 3, 4, 5, 6, 7}, {{0, 3, 1, 2}, {4, 7, 5, 6}, {0, 1, 5, 4}});  // open, crossing itself
  m.polyhedron({0, 1, 3, 2, 4, 5, 7, 6}, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 5, 6}});
  m.polyhedron({0, 7}, {{0, 1}, {1, 0}});
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(m.xyz, 3);
  mesh.cells.connectivity = Array::from_vector(m.ids);
  mesh.cells.offsets = Array::from_vector(m.offsets);
  mesh.types = Array::from_vector(m.types);
  std::vector<int64_t> ids, offsets{0};
  for (const auto& face : m.faces) {
    ids.insert(ids.end(), face.begin(), face.end());
    offsets.push_back(int64_t(ids.size()));
  }
  mesh.faces.connectivity = Array::from_vector(ids);
  mesh.faces.offsets = Array::from_vector(offsets);
  mesh.polyhedron_faces = Array::from_vector(m.of_cell);
  for (int pattern = 1; pattern < 256; ++pattern) {
    std::vector<double> v;
    for (int c = 0; c < 8; ++c) v.push_back(pattern >> c & 1 ? 1.5 : -1);
    FieldSet fields;
    fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
    const auto c = contour_at(make_dataset(mesh, fields), 0);
    for (Vec3 p : Surface(c).points) CHECK(std::isfinite(p.x + p.y + p.z));
  }
}
