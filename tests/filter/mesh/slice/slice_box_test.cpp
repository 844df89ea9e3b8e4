// SPDX-License-Identifier: Apache-2.0
// Boxes as surfaces that cut, and AMR grids clipped by them.
#include <map>

#include "base/parallel.h"
#include "data/cells/shape/cell_map.h"
#include "filter/every_mesh.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/slice/slice.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Measures {
  double area = 0, volume = 0;  // volume: what the polygons enclose when they close and face outward
  size_t open_edges = 0;
};
Measures measures(const DatasetPtr& d) {
  const SurfaceMesh& m = *d->as<SurfaceMesh>();
  const CellsView v = cells_view(m.polygons);
  Measures r;
  std::map<std::pair<int64_t, int64_t>, int> edges;
  for (size_t c = 0; c < v.count; ++c) {
    const auto at = [&](size_t k) { return m.points.at(size_t(v.point(c, k))); };
    Vec3 normal;
    for (size_t k = 1; k + 1 < v.size(c); ++k) normal += 0.5 * cross(at(k) - at(0), at(k + 1) - at(0));
    r.area += length(normal), r.volume += dot(normal, at(0)) / 3;
    for (size_t k = 0; k < v.size(c); ++k) ++edges[{v.point(c, k), v.point(c, (k + 1) % v.size(c))}];
  }
  for (const auto& [e, n] : edges) r.open_edges += edges.count({e.second, e.first}) == 0;
  return r;
}

DatasetPtr with_linear(const DatasetPtr& d) {
  return with_values(d, "f", 1, [](Vec3 p, double* f) { *f = 1 + 2 * p.x - p.y + 3 * p.z; });
}

DatasetPtr cut(const DatasetPtr& d, const std::vector<double>& box) {
  Context context;
  SliceParams p;
  p.box = box;
  return slice(d, p, context);
}

double volume(const DatasetPtr& d) {
  CellMap map(d);
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) map.open(c), sum += map.measure();
  return sum;
}

}  // namespace

TEST_CASE("slice: a box inside any mesh cuts its own surface, with sharp edges, facing outward") {
  const std::vector<double> box{-0.53, 0.31, -0.2, 0.71, -0.62, 0.13};
  const double a = 0.84, b = 0.91, c = 0.75;
  for (const MeshKind& kind : solid_meshes()) {
    CAPTURE(kind.name);
    const DatasetPtr d = with_linear(kind.make(4, 1)), s = cut(d, box);
    const Measures m = measures(s);
    CHECK(m.area == doctest::Approx(2 * (a * b + b * c + c * a)).epsilon(1e-6));
    CHECK(m.volume == doctest::Approx(a * b * c).epsilon(1e-6));
    const Array &f = s->fields().require("f").array, &from = s->fields().require("original_cell").array;
    const bool straight = kind.name == "uniform" || kind.name == "rotated" || kind.name == "rectilinear" || kind.name == "amr" ||
                          kind.name == "tetra" || kind.name == "hexahedron" || kind.name == "voxel" || kind.name == "wedge";
    for (size_t i = 0; straight && i < s->point_count(); ++i) {
      const Vec3 p = s->as<SurfaceMesh>()->points.at(i);
      REQUIRE(f.get(i) == doctest::Approx(1 + 2 * p.x - p.y + 3 * p.z).epsilon(1e-5));
    }
    for (size_t i = 0; i < s->cell_count(); ++i) REQUIRE((from.get(i) >= 0 && from.get(i) < double(d->cell_count())));
    if (straight && kind.name != "amr") CHECK(m.open_edges == 0);  // levels of AMR meet in hanging points
  }
}

TEST_CASE("slice: planes through grids whose axes run backwards face along their normals") {
  for (const Vec3 normal : {Vec3(1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(1, 2, -0.5)}) {
    Context context;
    SliceParams p;
    p.normal = normal, p.origin = Vec3(0.1, 0.07, -0.13);
    const SurfaceMesh m = *slice(flow::mesh_of("rectilinear", 4, 1), p, context)->as<SurfaceMesh>();
    const CellsView v = cells_view(m.polygons);
    REQUIRE(v.count > 0);
    for (size_t c = 0; c < v.count; ++c) {
      const auto at = [&](size_t k) { return m.points.at(size_t(v.point(c, k))); };
      Vec3 n;
      for (size_t k = 1; k + 1 < v.size(c); ++k) n += cross(at(k) - at(0), at(k + 1) - at(0));
      REQUIRE(dot(n, normal) > 0);
    }
  }
}

TEST_CASE("slice: a box whose faces are faces of cells, one within a cell, one that is half outside, one that misses") {
  for (const char* name : {"uniform", "hexahedron", "tetra", "amr"}) {
    CAPTURE(name);
    const DatasetPtr d = flow::mesh_of(name, 4, 1);
    const Measures on_faces = measures(cut(d, {-0.5, 0.5, -0.5, 0.5, -0.5, 0.5}));
    CHECK(on_faces.area == doctest::Approx(6));
    CHECK(on_faces.volume == doctest::Approx(1));
    const Measures small = measures(cut(d, {0.05, 0.2, 0.1, 0.15, 0.07, 0.17}));
    CHECK(small.volume == doctest::Approx(0.15 * 0.05 * 0.1));
    CHECK(measures(cut(d, {0.3, 3, 0.3, 3, 0.3, 3})).area == doctest::Approx(3 * 0.49));
    CHECK(measures(cut(d, {-1, 1, -1, 1, -1, 1})).area == doctest::Approx(24));  // the mesh's own border
    CHECK(cut(d, {2, 3, 2, 3, 2, 3})->cell_count() == 0);
    CHECK(cut(d, {-2, 2, -2, 2, -2, 2})->cell_count() == 0);
  }
  CHECK(error_of([] { cut(flow::mesh_of("uniform", 2, 1), {0, 1, 0, 1, 1, 0}); }).find("empty along z") != std::string::npos);
}

TEST_CASE("slice: a box cuts surfaces and curves into lines and points, and gives the same for any number of threads") {
  const DatasetPtr lines = cut(flat_surface("triangles", 5, 1), {-0.33, 0.4, -0.27, 0.5, -1, 1});
  double sum = 0;
  const SurfaceMesh& m = *lines->as<SurfaceMesh>();
  const CellsView v = cells_view(m.lines);
  for (size_t c = 0; c < v.count; ++c)
    for (size_t k = 0; k + 1 < v.size(c); ++k) sum += length(m.points.at(size_t(v.point(c, k))) - m.points.at(size_t(v.point(c, k + 1))));
  CHECK(sum == doctest::Approx(2 * (0.73 + 0.77)));
  const DatasetPtr d = with_linear(flow::mesh_of("tetra", 12, 1));
  std::vector<DatasetPtr> made;
  for (const int threads : {1, 8}) {
    set_thread_count(threads);
    made.push_back(cut(d, {-0.53, 0.31, -0.2, 0.71, -0.62, 0.13}));
  }
  set_thread_count(0);
  REQUIRE(made[0]->point_count() == made[1]->point_count());
  CHECK(made[0]->cell_count() > 500);
  for (size_t i = 0; i < made[0]->point_count(); ++i)
    REQUIRE(made[0]->as<SurfaceMesh>()->points.at(i) == made[1]->as<SurfaceMesh>()->points.at(i));
}

TEST_CASE("clip: AMR inside and outside a box have its volume and the rest, wherever the levels meet") {
  for (const std::vector<double>& box : {std::vector{-0.53, 0.31, -0.2, 0.71, -0.62, 0.13}, std::vector{-0.5, 0.5, -0.5, 0.5, -0.5, 0.5},
                                         std::vector{-0.9, -0.1, -0.8, 0.05, 0.2, 0.95}, std::vector{0.03, 0.21, 0.02, 0.2, 0.01, 0.19}}) {
    const double whole = (box[1] - box[0]) * (box[3] - box[2]) * (box[5] - box[4]);
    Context context;
    ClipParams p;
    p.box = box;
    for (const int n : {4, 6}) {
      const DatasetPtr d = with_linear(flow::amr_cube(n, 1)), in = std::get<DatasetPtr>(clip(d, p, context));
      CHECK(volume(in) == doctest::Approx(whole).epsilon(1e-9));
      const auto* m = in->as<UnstructuredMesh>();
      for (size_t i = 0; i < in->point_count(); ++i) {
        const Vec3 x = m->points.at(i);
        for (int a = 0; a < 3; ++a) REQUIRE((x[a] >= box[size_t(2 * a)] - 1e-12 && x[a] <= box[size_t(2 * a) + 1] + 1e-12));
        REQUIRE(in->fields().require("f").array.get(i) == doctest::Approx(1 + 2 * x.x - x.y + 3 * x.z).epsilon(1e-9));
      }
      ClipParams q = p;
      q.keep = ClipSide::outside;
      CHECK(volume(std::get<DatasetPtr>(clip(d, q, context))) == doctest::Approx(8 - whole).epsilon(1e-9));
    }
  }
}
