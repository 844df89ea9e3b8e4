// SPDX-License-Identifier: Apache-2.0
#include <doctest/doctest.h>

#include <numeric>

#include "base/parallel.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/quality.h"
#include "support/params.h"
#include "support/test.h"
#include "surface_shapes.h"

using namespace sg;

namespace {

DatasetPtr one_cell(CellType type, const std::vector<Vec3>& at) {
  UnstructuredMesh m;
  std::vector<double> xyz;
  for (Vec3 p : at) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  std::vector<int32_t> ids(at.size());
  std::iota(ids.begin(), ids.end(), 0);
  m.points.xyz = Array::from_vector(xyz, 3);
  m.cells = {Array::from_vector(ids), {}, int(at.size())};
  m.single_type = type;
  return make_dataset(Mesh(m));
}

double value(const DatasetPtr& d, const std::string& measure, size_t cell = 0) {
  Context ctx;
  return quality(d, {{*value_of_word<CellMeasure>(measure)}}, ctx)->fields().require(measure, Association::cell).array.get(cell);
}

const double h3 = std::sqrt(3.0) / 2;

}  // namespace

TEST_CASE("quality: ideal cells have ideal values") {
  struct Ideal {
    CellType type;
    std::vector<Vec3> at;
    double angle, size;
    bool has_skew;
  };
  const std::vector<Ideal> all = {
      {CellType::triangle, {{0, 0, 0}, {1, 0, 0}, {0.5, h3, 0}}, 60, h3 / 2, false},
      {CellType::quad, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, 90, 1, true},
      {CellType::pixel, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 90, 1, true},
      {CellType::tetra,
       {{0, 0, 0}, {1, 0, 0}, {0.5, h3, 0}, {0.5, h3 / 3, std::sqrt(2.0 / 3)}},
       std::acos(1.0 / 3) * 180 / test::shapes::pi,
       std::sqrt(2.0) / 12,
       false},
      {CellType::hexahedron, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}, 90, 1, true},
      {CellType::voxel, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}, 90, 1, true},
      {CellType::wedge, {{0, 0, 0}, {1, 0, 0}, {0.5, h3, 0}, {0, 0, 1}, {1, 0, 1}, {0.5, h3, 1}}, 60, h3 / 2, false},
      {CellType::wedge, {{0, 0, 1}, {1, 0, 1}, {0.5, h3, 1}, {0, 0, 0}, {1, 0, 0}, {0.5, h3, 0}}, 60, h3 / 2, false},
      {CellType::pyramid,
       {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, std::sqrt(0.5)}},
       std::acos(std::sqrt(1.0 / 3)) * 180 / test::shapes::pi,
       std::sqrt(0.5) / 3,
       false},
  };
  for (const Ideal& i : all) {
    CAPTURE(int(i.type));
    for (double scale : {1.0, 1000.0}) {
      std::vector<Vec3> at = i.at;
      for (Vec3& p : at) p = p * scale;
      const DatasetPtr d = one_cell(i.type, at);
      CHECK(value(d, "scaled_jacobian") == doctest::Approx(1).epsilon(1e-12));
      CHECK(value(d, "aspect_ratio") == doctest::Approx(1).epsilon(1e-12));
      CHECK(value(d, "edge_ratio") == doctest::Approx(1).epsilon(1e-12));
      CHECK(value(d, "min_angle") == doctest::Approx(i.angle).epsilon(1e-12));
      CHECK(std::abs(value(d, "equiangle_skew")) < 1e-12);
      CHECK(value(d, "size") == doctest::Approx(i.size * std::pow(scale, cell_type_info(i.type).dimension)).epsilon(1e-12));
      if (i.has_skew) CHECK(std::abs(value(d, "skew")) < 1e-12);
      else CHECK(std::isnan(value(d, "skew")));
    }
  }
}

TEST_CASE("quality: known values of cells that are not ideal") {
  const DatasetPtr right = one_cell(CellType::triangle, {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}});
  CHECK(value(right, "aspect_ratio") == doctest::Approx(5 * 12 / (4 * std::sqrt(3.0) * 6)));
  CHECK(value(right, "scaled_jacobian") == doctest::Approx(12 / 20.0 * 2 / std::sqrt(3.0)));
  CHECK(value(right, "edge_ratio") == doctest::Approx(5.0 / 3));
  CHECK(value(right, "max_angle") == doctest::Approx(90));
  CHECK(value(right, "min_angle") == doctest::Approx(std::atan2(3, 4) * 180 / test::shapes::pi));
  const DatasetPtr slanted = one_cell(CellType::quad, {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 1, 0}});
  CHECK(value(slanted, "skew") == doctest::Approx(std::sqrt(0.5)));
  CHECK(value(slanted, "scaled_jacobian") == doctest::Approx(std::sqrt(0.5)));
  CHECK(value(slanted, "equiangle_skew") == doctest::Approx(0.5));
  CHECK(value(slanted, "aspect_ratio") == doctest::Approx(std::sqrt(2.0) * (2 + 2 * std::sqrt(2.0)) / 4));
  const DatasetPtr brick =
      one_cell(CellType::voxel, {{0, 0, 0}, {2, 0, 0}, {0, 1, 0}, {2, 1, 0}, {0, 0, 4}, {2, 0, 4}, {0, 1, 4}, {2, 1, 4}});
  CHECK(value(brick, "aspect_ratio") == doctest::Approx(4));
  CHECK(value(brick, "size") == doctest::Approx(8));
  const DatasetPtr flipped = one_cell(CellType::tetra, {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}});
  CHECK(value(flipped, "scaled_jacobian") < 0);
  CHECK(value(flipped, "size") == doctest::Approx(-1.0 / 6));
  CHECK(value(flipped, "max_angle") == doctest::Approx(90));
  const DatasetPtr dart = one_cell(CellType::quad, {{0, 0, 0}, {2, 0, 0}, {0.5, 0.5, 0}, {0, 2, 0}});
  CHECK(value(dart, "scaled_jacobian") < 0);
  CHECK(value(dart, "max_angle") > 180);
  CHECK(value(dart, "size") == doctest::Approx(1));
  const DatasetPtr tall = one_cell(CellType::wedge, {{0, 0, 0}, {1, 0, 0}, {0.5, h3, 0}, {0, 0, 3}, {1, 0, 3}, {0.5, h3, 3}});
  CHECK(value(tall, "aspect_ratio") == doctest::Approx(std::sqrt(11 * (1 + 9 + 9)) / 9));
}

TEST_CASE("quality: degenerate cells are bad, not a crash; types without a measure have none") {
  const DatasetPtr point = one_cell(CellType::tetra, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
  CHECK(value(point, "scaled_jacobian") == 0);
  CHECK(std::isinf(value(point, "aspect_ratio")));
  CHECK(std::isinf(value(point, "edge_ratio")));
  const DatasetPtr flat = one_cell(CellType::triangle, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
  CHECK(value(flat, "scaled_jacobian") == 0);
  CHECK(std::isinf(value(flat, "aspect_ratio")));
  const DatasetPtr line = one_cell(CellType::line, {{0, 0, 0}, {3, 4, 0}});
  CHECK(std::isnan(value(line, "scaled_jacobian")));
  CHECK(value(line, "size") == doctest::Approx(5));
  Context ctx;
  CHECK(test::error_of([&] { test::params_of<QualityParams>({"measures=scaled_jacobean"}); }).find("scaled_jacobian") != std::string::npos);
  CHECK(test::error_of([&] { quality(flat, {{}}, ctx); }).find("no measure is requested") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0}, 3);
  CHECK(test::error_of([&] { quality(make_dataset(Mesh(cloud)), {}, ctx); }).find("no cells") != std::string::npos);
}

TEST_CASE("quality: every mesh kind: sizes add up, and threads do not matter") {
  using namespace test::meshes;
  Context ctx;
  for (const DatasetPtr& d :
       {uniform_box(3, 4, 5), solid_box(CellType::tetra, 2), solid_box(CellType::polyhedron, 2), solid_box(CellType::wedge, 2),
        solid_box(CellType::pyramid, 2), solid_box(CellType::quadratic_hexahedron, 1), solid_box(CellType::lagrange_tetra, 1, 3)}) {
    set_thread_count(1);
    const DatasetPtr q =
        quality(d, {{CellMeasure::size, CellMeasure::edge_ratio, CellMeasure::scaled_jacobian, CellMeasure::min_angle}}, ctx);
    set_thread_count(8);
    const DatasetPtr again =
        quality(d, {{CellMeasure::size, CellMeasure::edge_ratio, CellMeasure::scaled_jacobian, CellMeasure::min_angle}}, ctx);
    set_thread_count(0);
    double sum = 0;
    const Field& size = q->fields().require("size", Association::cell);
    for (size_t i = 0; i < size.array.count(); ++i) sum += size.array.get(i);
    CHECK(sum == doctest::Approx(1).epsilon(1e-12));
    for (const char* m : {"size", "edge_ratio", "scaled_jacobian", "min_angle"})
      CHECK(same_bytes(q->fields().require(m, Association::cell).array, again->fields().require(m, Association::cell).array));
  }
  const DatasetPtr hex = test::shapes::box().dataset();
  CHECK(value(hex, "scaled_jacobian") == doctest::Approx(1));
  CHECK(value(solid_box(CellType::polyhedron, 1), "min_angle") == doctest::Approx(90));
}
