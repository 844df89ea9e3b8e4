// SPDX-License-Identifier: Apache-2.0
// Flows on curves: only the part along the curve carries anything, and lines end where the curve does.
#include "filter/flow/streamlines.h"
#include "filter/flow/texture/surface/refined_surface.h"
#include "support/test.h"

using namespace sg;

namespace {

// A curve through n points as one poly-line or as n - 1 lines, with a vector at each point.
template <class At, class V>
DatasetPtr curve(size_t n, bool whole, At at, V velocity) {
  SurfaceMesh s;
  std::vector<double> xyz, v;
  std::vector<int64_t> ids, offsets{0};
  for (size_t i = 0; i < n; ++i) {
    const Vec3 p = at(double(i) / double(n - 1)), u = velocity(double(i) / double(n - 1));
    xyz.insert(xyz.end(), {p.x, p.y, p.z}), v.insert(v.end(), {u.x, u.y, u.z});
    if (whole) ids.push_back(int64_t(i));
    else if (i + 1 < n) ids.insert(ids.end(), {int64_t(i), int64_t(i + 1)}), offsets.push_back(int64_t(ids.size()));
  }
  if (whole) offsets.push_back(int64_t(ids.size()));
  s.points.xyz = Array::from_vector(std::move(xyz), 3);
  s.lines = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(v), 3), "", Role::vectors});
  return make_dataset(Mesh(std::move(s)), std::move(f));
}

}  // namespace

TEST_CASE("streamlines: on curves they stay on them, follow what is along them, and end at their ends") {
  Context context;
  for (const bool whole : {true, false}) {
    CAPTURE(whole);
    // Along x, while the flow also blows across.
    const DatasetPtr d = curve(
        51, whole, [](double t) { return Vec3(5 * t, 0, 0); }, [](double) { return Vec3(1, 0.5, -0.3); });
    const DatasetPtr lines = std::get<DatasetPtr>(streamlines({Data(d)}, {}, context));
    REQUIRE(lines->cell_count() > 0);
    const auto& s = *lines->as<SurfaceMesh>();
    const CellsView cells = cells_view(s.lines);
    for (size_t c = 0; c < cells.count; ++c) {
      CHECK(cells.size(c) < 200);
      for (size_t k = 0; k < cells.size(c); ++k) {
        const Vec3 p = s.points.at(size_t(cells.point(c, k)));
        CHECK(std::hypot(p.y, p.z) < 1e-6);
        CHECK(p.x > -1e-6);
        CHECK(p.x < 5 + 1e-6);
      }
      CHECK(s.points.at(size_t(cells.point(c, cells.size(c) - 1))).x > 4.8);
    }
  }
}

TEST_CASE("streamlines: a bent curve is followed from end to end in few steps") {
  Context context;
  const DatasetPtr d = curve(
      201, true, [](double t) { return Vec3(std::cos(3 * t), std::sin(3 * t), t); }, [](double) { return Vec3(0.2, 0.1, 1); });
  const DatasetPtr lines = std::get<DatasetPtr>(streamlines({Data(d)}, {}, context));
  REQUIRE(lines->cell_count() > 0);
  CHECK(lines->point_count() < 300 * lines->cell_count());
}

TEST_CASE("surface_lic: by default a skin of many faces is split into about 150 000 triangles, a given density is kept") {
  const DatasetPtr square = [] {
    SurfaceMesh s;
    s.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
    s.polygons = {Array::from_vector(std::vector<int64_t>{0, 1, 2, 3}), {}, 4};
    return make_dataset(Mesh(s));
  }();
  const double diagonal = std::sqrt(2.0);
  CHECK(textured_edge(*square, diagonal, 400.0) == diagonal / 400);
  CHECK(textured_edge(*square, diagonal, 0.0) == 0);
  // One triangle for each 0.3 edge^2: those of 400 samples would be 267 000.
  CHECK(textured_edge(*square, diagonal, {}) == doctest::Approx(std::sqrt(1 / (0.3 * 150000))));
  CHECK(textured_edge(*square, 10 * diagonal, {}) == doctest::Approx(10 * diagonal / 400));
}
