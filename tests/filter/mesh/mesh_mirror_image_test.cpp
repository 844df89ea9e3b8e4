// SPDX-License-Identifier: Apache-2.0
// A half and its mirror image as one mesh.
#include "data/cells/point_positions.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/transform/mirror.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

// f = linear(p) must be linear(image of p) beyond the mirror.
void check_values(const Dataset& d, int axis, double position, bool above) {
  const Array xyz = point_positions(d.mesh());
  const Field& f = d.fields().require("f");
  size_t wrong = 0;
  for (size_t i = 0; i < xyz.count(); ++i) {
    Vec3 p{xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)};
    if (above ? p[axis] > position : p[axis] < position) p[axis] = 2 * position - p[axis];
    wrong += std::abs(f.array.get(i) - linear(p)) > 1e-9;
  }
  CHECK(wrong == 0);
}

// Polygons all of whose points have x = 0.
size_t faces_in_mirror(const Dataset& surface) {
  const auto& m = *surface.as<SurfaceMesh>();
  const CellsView cells = cells_view(m.polygons);
  size_t n = 0;
  for (size_t c = 0; c < cells.count; ++c) {
    bool all = true;
    for (size_t i = 0; i < cells.size(c); ++i) all = all && std::abs(m.points.at(size_t(cells.point(c, i))).x) < 1e-9;
    n += all;
  }
  return n;
}

}  // namespace

TEST_CASE("mirror: a straight grid whose mirror stands at its end stays a grid without a seam") {
  for (int axis = 0; axis < 3; ++axis)
    for (const bool high : {false, true}) {
      CAPTURE(axis);
      CAPTURE(high);
      const DatasetPtr in = uniform_box(3, 4, 5);
      MirrorParams p;
      p.axis = CutAxis(axis + 1), p.position = high ? 1 : 0;
      Context context;
      const DatasetPtr out = mirror(in, p, context);
      REQUIRE(out->as<UniformGrid>());
      std::array<size_t, 3> dims{4, 5, 6};
      dims[size_t(axis)] = 2 * dims[size_t(axis)] - 1;
      CHECK(out->as<UniformGrid>()->dims == dims);
      CHECK(out->bounds().lo[axis] == doctest::Approx(high ? 0 : -1));
      CHECK(out->bounds().hi[axis] == doctest::Approx(high ? 2 : 1));
      check_values(*out, axis, *p.position, high);
      // Cells: the two next to the mirror are the same one.
      const Field& c = out->fields().require("c");
      const size_t n = dims[size_t(axis)] - 1, stride = axis == 0 ? 1 : axis == 1 ? 3 : 12;
      for (size_t i = 0; i < n; ++i) CHECK(c.array.get(i * stride) == c.array.get((n - 1 - i) * stride));
    }
}

TEST_CASE("mirror: a rectilinear grid stays one, whichever of its axes descend") {
  const std::vector<double> along[] = {{0, 0.2, 1}, {0, 0.5, 0.75, 1}, {0, 0.1, 0.3, 0.6, 1}};
  for (int down = 0; down < 8; ++down)
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true}) {
        CAPTURE(down);
        CAPTURE(axis);
        CAPTURE(high);
        std::vector<double> x[3];
        for (int a = 0; a < 3; ++a) {
          x[a] = along[a];
          if (down >> a & 1) std::reverse(x[a].begin(), x[a].end());
        }
        std::vector<Vec3> at;
        for (const double z : x[2])
          for (const double y : x[1])
            for (const double u : x[0]) at.emplace_back(u, y, z);
        RectilinearGrid g;
        g.x = Array::from_vector(x[0]), g.y = Array::from_vector(x[1]), g.z = Array::from_vector(x[2]);
        MirrorParams p;
        p.axis = CutAxis(axis + 1), p.position = high ? 1 : 0;
        Context context;
        const DatasetPtr out = mirror(with_fields(g, at), p, context);
        const auto* r = out->as<RectilinearGrid>();
        REQUIRE(r);
        const size_t n = 2 * x[axis].size() - 1;
        CHECK((axis == 0 ? r->x : axis == 1 ? r->y : r->z).count() == n);
        check_values(*out, axis, *p.position, high);
        for (int a = 0; a < 3; ++a) {
          const Array& c = a == 0 ? r->x : a == 1 ? r->y : r->z;
          CHECK((c.get(1) < c.get(0)) == bool(down >> a & 1));
        }
        // Cells along the mirror's axis: the same backwards as forwards.
        const Field& c = out->fields().require("c");
        const size_t cells = n - 1, stride = axis == 0 ? 1 : axis == 1 ? 2 : 6;
        for (size_t i = 0; i < cells; ++i) CHECK(c.array.get(i * stride) == c.array.get((cells - 1 - i) * stride));
      }
}

TEST_CASE("mirror: cells share the points in the mirror, so that no face remains there") {
  for (const CellType type :
       {CellType::tetra, CellType::hexahedron, CellType::wedge, CellType::polyhedron, CellType::quadratic_hexahedron}) {
    CAPTURE(int(type));
    const DatasetPtr in = solid_box(type, 2);
    Context context;
    const DatasetPtr out = mirror(in, {}, context);
    CHECK(out->cell_count() == 2 * in->cell_count());
    CHECK(out->bounds().lo.x == -1);
    const DatasetPtr outer = faces(out, {}, context);
    const Array xyz = point_positions(outer->mesh());
    CHECK(faces_in_mirror(*outer) == 0);
    const DatasetPtr half = faces(in, {}, context);
    CHECK(outer->cell_count() == 2 * (half->cell_count() - faces_in_mirror(*half)));
    double x_sum = 0;
    for (size_t i = 0; i < xyz.count(); ++i) x_sum += xyz.get(i, 0);
    CHECK(std::abs(x_sum) < 1e-9);
  }
}

TEST_CASE("mirror: vectors are mirrored, a mirror elsewhere leaves a gap, and what is wrong is told") {
  const DatasetPtr box = solid_box(CellType::hexahedron, 1);
  const size_t n = box->point_count();
  DatasetParts parts = box->parts();
  std::vector<double> v;
  for (size_t i = 0; i < n; ++i) v.insert(v.end(), {1, 2, 3});
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  const DatasetPtr in = make_dataset(std::move(parts));
  Context context;
  MirrorParams p;
  p.position = 2;
  const DatasetPtr out = mirror(in, p, context);
  CHECK(out->point_count() == 2 * n);
  CHECK(out->bounds().hi.x == 4);
  const Field& w = out->fields().require("v");
  for (size_t i = 0; i < 2 * n; ++i) {
    CHECK(w.array.get(i, 0) == (i < n ? 1 : -1));
    CHECK(w.array.get(i, 1) == 2);
  }
  p.axis = CutAxis::none;
  CHECK(error_of([&] { mirror(in, p, context); }).find("axis=x, y or z") != std::string::npos);
  p.axis = CutAxis::x, p.position = NAN;
  CHECK(error_of([&] { mirror(in, p, context); }).find("not finite") != std::string::npos);
}
