// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <numeric>
#include <tuple>

#include "filter/mesh/select/extract_ids.h"

#include "filter/field/derivatives/gradient.h"
#include "filter/mesh/select/extract.h"
#include "filter/probe/resample.h"
#include "filter/scalar/contour/contour.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr grid(Vec3 origin) {
  UniformGrid g;
  g.dims = {9, 9, 9};
  g.origin = origin;
  g.spacing = {0.25, 0.25, 0.25};
  std::vector<float> v;
  for (size_t i = 0; i < 729; ++i) {
    const Vec3 p{double(i % 9) - 4, double(i / 9 % 9) - 4, double(i / 81) - 4};
    v.push_back(float(length(p)));
  }
  FieldSet f;
  f.add({"r", Association::point, Array::from_vector(v), "", Role::scalars});
  std::vector<int32_t> block(512);
  for (size_t c = 0; c < 512; ++c) block[c] = int32_t(c / 64);
  f.add({"block", Association::cell, Array::from_vector(block), "", Role::labels});
  return make_dataset(g, std::move(f));
}

}  // namespace

TEST_CASE("extract: cells by their numbers, by a field of ids, by their points, and the others") {
  const DatasetPtr d = grid({0, 0, 0});
  Context ctx;
  const DatasetPtr some = extract(d, {{5, 500}, IdsOf::cell, {}, false}, ctx);
  CHECK(some->cell_count() == 2);
  CHECK(some->fields().require("block").array.get(1) == 500 / 64);
  CHECK(extract(d, {{5, 500}, IdsOf::cell, {}, true}, ctx)->cell_count() == 510);
  CHECK(extract(d, {{2, 3}, IdsOf::cell, {"block"}, false}, ctx)->cell_count() == 128);
  CHECK(extract(d, {{0}, IdsOf::point, {}, false}, ctx)->cell_count() == 1);
  CHECK(extract(d, {{364}, IdsOf::point, {}, false}, ctx)->cell_count() == 8);  // the middle
  CHECK(test::error_of([&] { extract(d, {{512}, IdsOf::cell, {}, false}, ctx); }).find("0 to 511") != std::string::npos);
  CHECK(test::error_of([&] { extract(d, {{}, IdsOf::cell, {}, false}, ctx); }).find("nothing is selected") != std::string::npos);
  CHECK(test::error_of([&] { extract(d, {{1}, IdsOf::cell, {"r"}, false}, ctx); }).size() > 0);
}

TEST_CASE("extract: by region, type, level and block") {
  const DatasetPtr d = grid({0, 0, 0});
  Context ctx;
  const Box3& b = d->bounds();
  ExtractParams p;
  p.region.box = {b.lo.x, b.center().x, b.lo.y, b.hi.y, b.lo.z, b.hi.z};
  CHECK(extract(d, p, ctx)->cell_count() == 256);
  p.all_points = false;
  CHECK(extract(d, p, ctx)->cell_count() == 320);
  p.all_points = true, p.invert = true;
  CHECK(extract(d, p, ctx)->cell_count() == 256);
  p = {};
  p.region.axis = CutAxis::x;
  CHECK(extract(d, p, ctx)->cell_count() == 256);
  p.ids = {0, 7};
  CHECK(extract(d, p, ctx)->cell_count() == 1);
  p = {};
  p.types = {"voxel"};
  CHECK(extract(d, p, ctx)->cell_count() == 512);
  p.types = {"tetra"};
  CHECK(extract(d, p, ctx)->cell_count() == 0);
  p.types = {"tetrahedroid"};
  CHECK(test::error_of([&] { extract(d, p, ctx); }).find("no cell type") != std::string::npos);
  p = {};
  p.levels = {0};
  CHECK(test::error_of([&] { extract(d, p, ctx); }).find("has no levels") != std::string::npos);
  AmrGrid g;
  g.levels.resize(2);
  g.levels[0].ratio = {1, 1, 1};
  g.levels[0].patches = {{{0, 0, 0}, {3, 3, 3}, 0, 0}};
  g.levels[1].spacing = {0.5, 0.5, 0.5};
  g.levels[1].patches = {{{2, 2, 2}, {5, 5, 5}, 64, 125}};
  p.levels = {1};
  CHECK(extract(make_dataset(g), p, ctx)->cell_count() == 64);
  p.levels = {2};
  CHECK(test::error_of([&] { extract(make_dataset(g), p, ctx); }).find("0 to 1") != std::string::npos);
  auto c = std::make_shared<Collection>();
  auto wing = std::make_shared<Collection>();
  wing->parts.push_back({"left", d});
  c->parts = {{"hull", d}, {"wing", CollectionPtr(wing)}};
  p = {};
  p.blocks = {"wing"};
  auto count = [&] {
    size_t n = 0;
    for_each_dataset(extract_blocks(CollectionPtr(c), p, ctx),
                     [&](const std::string&, const DatasetPtr& part) { n += part->cell_count(); });
    return n;
  };
  CHECK(count() == 512);
  p.blocks = {"0", "wing/left"};
  p.ids = {3};
  CHECK(count() == 2);
  p.blocks = {"wings"};
  CHECK(test::error_of([&] { count(); }).find("did you mean") != std::string::npos);
}

TEST_CASE("far from zero: contours, gradients and resampling at an offset of 1e7 are those at zero, moved") {
  const Vec3 far{1e7, -2e7, 3e7};
  const DatasetPtr near_grid = grid({0, 0, 0}), far_grid = grid(far);
  Context ctx;
  ContourParams c;
  c.values = {2.5};
  const DatasetPtr a = contour(near_grid, c, ctx), b = contour(far_grid, c, ctx);
  REQUIRE(a->point_count() == b->point_count());
  const Points &p = a->as<SurfaceMesh>()->points, &q = b->as<SurfaceMesh>()->points;
  double worst = 0;
  for (size_t i = 0; i < p.count(); ++i) worst = std::max(worst, length(q.at(i) - far - p.at(i)));
  CHECK(worst < 2e-7);  // places of f32 offsets from a double origin, not of f32 coordinates of 1e7 (which are 1 apart)
  const Array g = gradient(near_grid, {{"r"}, "g"}, ctx)->fields().require("g").array,
              h = gradient(far_grid, {{"r"}, "g"}, ctx)->fields().require("g").array;
  CHECK(std::memcmp(g.raw(), h.raw(), g.bytes()) == 0);
  ResampleParams r;
  r.dims = {6, 7, 5};
  const DatasetPtr s = resample(near_grid, r, ctx), t = resample(far_grid, r, ctx);
  const Array &u = s->fields().require("r").array, &v = t->fields().require("r").array;
  for (size_t i = 0; i < u.count(); ++i) CHECK(v.get(i) == doctest::Approx(u.get(i)).epsilon(1e-6));
}

namespace {

DatasetPtr turned(std::array<size_t, 3> dims, const Mat3& direction) {
  UniformGrid g;
  g.dims = dims, g.origin = {1, -2, 3}, g.spacing = {0.5, 0.25, 2}, g.direction = direction;
  return make_dataset(g);
}

Mat3 turn(double angle) {  // about z, then about x
  const double c = std::cos(angle), s = std::sin(angle);
  const double rows[3][3] = {{c, -s, 0}, {c * s, c * c, -s}, {s * s, s * c, c}};
  Mat3 m;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m.m[i][j] = rows[i][j];
  return m;
}

std::vector<int64_t> all_cells(const DatasetPtr& d) {
  std::vector<int64_t> ids(d->cell_count());
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

// Where the grid has the corners of one of its cells, as a ring in each layer.
std::vector<Vec3> corners_of(const UniformGrid& g, size_t cell) {
  size_t n[3], at[3], axes[3], k = 0;
  for (size_t a = 0; a < 3; ++a) {
    n[a] = std::max<size_t>(g.dims[a], 2) - 1;
    if (g.dims[a] > 1) axes[k++] = a;
  }
  at[0] = cell % n[0], at[1] = cell / n[0] % n[1], at[2] = cell / (n[0] * n[1]);
  constexpr size_t ring[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  std::vector<Vec3> corners;
  for (size_t c = 0; c < size_t(1) << k; ++c) {
    Vec3 index{double(at[0]), double(at[1]), double(at[2])};
    for (size_t a = 0; a < k; ++a) index[int(axes[a])] += double(ring[c][a]);
    corners.push_back(g.origin + g.direction * (g.spacing * index));
  }
  return corners;
}

}  // namespace

TEST_CASE("extract: cells of turned grids are hexahedra and quads, those of straight ones voxels and pixels") {
  const std::tuple<std::array<size_t, 3>, CellType, CellType> kinds[] = {
      {{4, 3, 3}, CellType::voxel, CellType::hexahedron}, {{4, 3, 1}, CellType::pixel, CellType::quad},
      {{4, 1, 3}, CellType::pixel, CellType::quad},       {{1, 4, 3}, CellType::pixel, CellType::quad},
      {{1, 5, 1}, CellType::line, CellType::line},        {{1, 1, 1}, CellType::vertex, CellType::vertex}};
  for (const auto& [dims, plain, other] : kinds) {
    CAPTURE(int(other));
    const DatasetPtr a = turned(dims, Mat3()), b = turned(dims, turn(0.4));
    CHECK(extract_cells(a, all_cells(a), "test")->as<UnstructuredMesh>()->single_type == plain);
    CHECK(extract_cells(b, all_cells(b), "test")->as<UnstructuredMesh>()->single_type == other);
  }
}

TEST_CASE("extract: the corners of a turned grid's cells lie exactly where the grid has them") {
  for (const std::array<size_t, 3> dims : {std::array<size_t, 3>{5, 4, 3}, {5, 4, 1}, {5, 1, 3}, {1, 4, 3}}) {
    const DatasetPtr d = turned(dims, turn(0.7));
    for (const std::vector<int64_t>& ids : {all_cells(d), std::vector<int64_t>{0, 3, int64_t(d->cell_count()) - 1}}) {
      const DatasetPtr cells = extract_cells(d, ids, "test");
      const auto& m = *cells->as<UnstructuredMesh>();
      const CellsView v = cells_view(m.cells);
      REQUIRE(v.count == ids.size());
      double worst = 0;
      for (size_t c = 0; c < v.count; ++c) {
        const std::vector<Vec3> there = corners_of(*d->as<UniformGrid>(), size_t(ids[c]));
        REQUIRE(v.size(c) == there.size());
        for (size_t k = 0; k < there.size(); ++k) worst = std::max(worst, length(m.points.at(size_t(v.point(c, k))) - there[k]));
      }
      CHECK(worst < 1e-14);
    }
  }
}

TEST_CASE("extract: the cells of a turned or mirrored grid have their volume, none is inside out") {
  Mat3 mirror;
  mirror.m[0][0] = 0, mirror.m[0][1] = 1, mirror.m[1][0] = 1, mirror.m[1][1] = 0;  // x and y exchanged
  for (const Mat3& direction : {turn(0.4), turn(-2), mirror}) {
    const DatasetPtr d = turned({4, 3, 3}, direction), cells = extract_cells(d, all_cells(d), "test");
    const auto& m = *cells->as<UnstructuredMesh>();
    REQUIRE(m.single_type == CellType::hexahedron);
    const CellsView v = cells_view(m.cells);
    for (size_t c = 0; c < v.count; ++c) {
      auto p = [&](size_t k) { return m.points.at(size_t(v.point(c, k))); };
      CHECK(dot(cross(p(1) - p(0), p(3) - p(0)), p(4) - p(0)) == doctest::Approx(0.25).epsilon(1e-12));  // 0.5 * 0.25 * 2
    }
  }
}

TEST_CASE("extract: the end of a path names a part where it is the end of one path alone") {
  const auto blocks = std::make_shared<Collection>(Collection{{{"Angelo NOVI", grid({0, 0, 0})}, {"wall", grid({9, 0, 0})}}});
  const auto sets = std::make_shared<Collection>(Collection{{{"wall", grid({0, 9, 0})}, {"inlet", grid({0, 0, 9})}}});
  const auto both = std::make_shared<Collection>(Collection{{{"Element Blocks", blocks}, {"Side Sets", sets}}});
  const Data all = std::make_shared<const Collection>(Collection{{{"run", both}}});
  Context context;
  const auto chosen = [&](std::vector<std::string> names) {
    ExtractParams p;
    p.blocks = std::move(names);
    std::vector<std::string> found;
    for_each_dataset(extract_blocks(all, p, context), [&](const std::string& name, const DatasetPtr&) { found.push_back(name); });
    return found;
  };
  CHECK(chosen({"Angelo NOVI"}) == std::vector<std::string>{"run/Element Blocks/Angelo NOVI"});
  CHECK(chosen({"Side Sets/wall", "inlet"}) == std::vector<std::string>{"run/Side Sets/wall", "run/Side Sets/inlet"});
  CHECK(chosen({"Element Blocks"}) == std::vector<std::string>{"run/Element Blocks/Angelo NOVI", "run/Element Blocks/wall"});
  const std::string both_walls = test::error_of([&] { chosen({"wall"}); });
  CHECK(both_walls.find("2 parts are called 'wall'") != std::string::npos);
  CHECK(both_walls.find("'run/Element Blocks/wall', 'run/Side Sets/wall'") != std::string::npos);
  CHECK(test::error_of([&] { chosen({"NOVI"}); }).find("there is no block 'NOVI'") != std::string::npos);
  ExtractParams p;
  p.part = "inlet";
  CHECK(std::get<DatasetPtr>(extract_blocks(all, p, context)) == std::get<DatasetPtr>(sets->parts[1].data));
  p.part = "wall";
  CHECK(test::error_of([&] { extract_blocks(all, p, context); }).find("2 parts are called 'wall'") != std::string::npos);
}

TEST_CASE("extract: one part of a collection by its path or its number is the part itself, a table too") {
  const auto inner = std::make_shared<Collection>(Collection{{{"left", grid({0, 0, 0})}, {"right", grid({9, 0, 0})}}});
  const auto table = std::make_shared<const Table>();
  const Data all = std::make_shared<const Collection>(Collection{{{"wing", inner}, {"#0", grid({0, 9, 0})}, {"numbers", table}}});
  Context context;
  const auto part = [&](const std::string& name) {
    ExtractParams p;
    p.part = name;
    return extract_blocks(all, p, context);
  };
  CHECK(std::get<DatasetPtr>(part("wing/right")) == std::get<DatasetPtr>(inner->parts[1].data));
  CHECK(std::get<DatasetPtr>(part("#0")) == std::get<DatasetPtr>(inner->parts[0].data));
  CHECK(std::get<DatasetPtr>(part("#2"))->bounds().lo.y == 9);
  CHECK(std::get<TablePtr>(part("numbers")) == table);
  CHECK(test::error_of([&] { part("wing/rigth"); }).find("did you mean 'wing/right'?") != std::string::npos);
  CHECK(test::error_of([&] { part("#4"); }).find("there is no part '#4'") != std::string::npos);
  ExtractParams p;
  p.part = "wing/left", p.ids = {0, 7};
  CHECK(std::get<DatasetPtr>(extract_blocks(all, p, context))->cell_count() == 2);
  p.blocks = {"wing"};
  CHECK(test::error_of([&] { extract_blocks(all, p, context); }).find("state one of them") != std::string::npos);
  CHECK(test::error_of([&] { extract_blocks(grid({0, 0, 0}), p, context); }).find("no collection") != std::string::npos);
}
