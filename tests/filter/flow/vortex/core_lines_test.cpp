// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/core_lines.h"

#include <cstring>

#include "base/parallel.h"
#include "filter/flow/flow_support.h"
#include "filter/flow/vortex/parallel_vectors.h"
#include "filter/mesh/to_unstructured.h"
#include "support/test.h"

using namespace sg;

namespace {

// In [-1,1]^3, n points a side.
template <class F>
DatasetPtr flow_on_grid(size_t n, F&& velocity) {
  return test::cube_flow(n, -1, 1, velocity);
}

double line_length(const Dataset& d) {
  double sum = 0;
  const SurfaceMesh& m = *d.as<SurfaceMesh>();
  const CellsView lines = cells_view(m.lines);
  for (size_t c = 0; c < lines.count; ++c)
    for (size_t k = lines.begin(c) + 1; k < lines.end(c); ++k)
      sum += length(m.points.at(size_t(lines.connectivity[k])) - m.points.at(size_t(lines.connectivity[k - 1])));
  return sum;
}

// Turns about a tilted axis through a point and flows along it.
const Vec3 through(0.13, -0.07, 0.02), axis = normalize(Vec3(0.3, 0.2, 1));
Vec3 swirl(Vec3 x) { return cross(axis, x - through) * 2.0 + axis; }

}  // namespace

TEST_CASE("vortex cores: the axis of a linear swirl comes out exactly, as one line from wall to wall, on grids, hexahedra and tetrahedra") {
  Context context;
  const DatasetPtr grid = flow_on_grid(9, swirl);
  for (const DatasetPtr& mesh : {grid, to_unstructured(grid, {}, context)})
    for (const char* method : {"sujudi_haimes", "levy"}) {
      VortexCoresParams p;
      p.method = *value_of_word<CoreMethod>(method);
      const DatasetPtr core = single_dataset(vortex_cores(mesh, p, context), "test");
      const SurfaceMesh& m = *core->as<SurfaceMesh>();
      CAPTURE(method);
      REQUIRE(m.lines.size() == 1);
      for (size_t i = 0; i < m.points.count(); ++i) CHECK(length(cross(m.points.at(i) - through, axis)) < 1e-9);
      // The axis meets the walls z = -1 and z = 1.
      CHECK(line_length(*core) == doctest::Approx(2 / axis.z).epsilon(1e-9));
      CHECK(core->range(core->fields().require("swirling strength")).lo == doctest::Approx(2));
      CHECK(core->range(core->fields().require("core angle")).hi == doctest::Approx(0).epsilon(1e-4));
    }
}

TEST_CASE("vortex cores: of a smooth bent vortex they lie near its centre line") {
  // Turning about the circle of radius R = 0.6 in the plane z = 0 with 12 radians per time, flowing along it with speed 1: where the
  // acceleration lies along the flow, u^2/(R 12^2) = 0.012 beside it.
  Context context;
  const auto ring = [](Vec3 x) {
    const double r = std::sqrt(x.x * x.x + x.y * x.y);
    if (r < 0.2) return Vec3(NAN, NAN, NAN);
    const Vec3 out(x.x / r, x.y / r, 0), along(-x.y / r, x.x / r, 0);
    const double a = r - 0.6, fall = std::exp(-2 * (a * a + x.z * x.z));
    return along * fall + (out * -x.z + Vec3(0, 0, a)) * (12 * fall);
  };
  const DatasetPtr core = single_dataset(vortex_cores(flow_on_grid(33, ring), {}, context), "test");
  const SurfaceMesh& m = *core->as<SurfaceMesh>();
  REQUIRE(m.lines.size() >= 1);
  for (size_t i = 0; i < m.points.count(); ++i) {
    const Vec3 x = m.points.at(i);
    CHECK(std::abs(std::sqrt(x.x * x.x + x.y * x.y) - 0.6) < 0.03);
    CHECK(std::abs(x.z) < 0.03);
  }
  CHECK(line_length(*core) == doctest::Approx(2 * 3.14159 * 0.6).epsilon(0.05));
}

TEST_CASE("vortex cores: flow without turning has none, and flat meshes are refused") {
  Context context;
  const DatasetPtr none = single_dataset(vortex_cores(flow_on_grid(5, [](Vec3 x) { return Vec3(x.x, -x.y, 1); }), {}, context), "test");
  CHECK(none->cell_count() == 0);
  UniformGrid flat;
  flat.dims = {4, 4, 1};
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::vector<float>(48, 1.0f), 3), "", Role::vectors});
  const DatasetPtr plane = make_dataset(Mesh(flat), std::move(fields));
  CHECK(test::error_of([&] { vortex_cores(plane, {}, context); }).find("critical_points") != std::string::npos);
}

TEST_CASE("vortex cores: of a collection the solid parts count, and its node sets and skins do not") {
  Context context;
  SurfaceMesh skin;
  skin.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  skin.polygons.fixed = 3, skin.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2});
  FieldSet fields;
  fields.add({"velocity", Association::point, Array::from_vector(std::vector<double>(9, 1.0), 3), "", Role::vectors});
  auto both = std::make_shared<Collection>();
  both->parts.push_back({"skin", make_dataset(Mesh(skin), fields)});
  both->parts.push_back({"nodes", make_dataset(Mesh(PointCloud{skin.points}), fields)});
  both->parts.push_back({"solid", flow_on_grid(9, swirl)});
  const DatasetPtr core = single_dataset(vortex_cores(CollectionPtr(both), {}, context), "test");
  CHECK(core->as<SurfaceMesh>()->lines.size() == 1);
  CHECK(line_length(*core) == doctest::Approx(2 / axis.z).epsilon(1e-9));
}

TEST_CASE("parallel vectors: the same lines for any number of threads, and NaN leaves a gap") {
  Context context;
  const DatasetPtr in = flow_on_grid(17, [](Vec3 x) { return x.z > 0.5 ? Vec3(NAN, NAN, NAN) : swirl(x); });
  set_thread_count(1);
  const DatasetPtr one = single_dataset(vortex_cores(in, {}, context), "test");
  set_thread_count(8);
  const DatasetPtr many = single_dataset(vortex_cores(in, {}, context), "test");
  set_thread_count(0);
  REQUIRE(one->point_count() == many->point_count());
  const Array &a = one->as<SurfaceMesh>()->points.xyz, &b = many->as<SurfaceMesh>()->points.xyz;
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  CHECK(one->bounds().hi.z < 0.51);
  CHECK(one->bounds().lo.z == doctest::Approx(-1));
}
