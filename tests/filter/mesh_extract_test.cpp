// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/extract_ids.h"

#include "filter/field/gradient.h"
#include "filter/probe/resample.h"
#include "filter/scalar/contour.h"
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
  const DatasetPtr some = extract(d, {{5, 500}, "cell", {}, false}, ctx);
  CHECK(some->cell_count() == 2);
  CHECK(some->fields().require("block").array.get(1) == 500 / 64);
  CHECK(extract(d, {{5, 500}, "cell", {}, true}, ctx)->cell_count() == 510);
  CHECK(extract(d, {{2, 3}, "cell", {"block"}, false}, ctx)->cell_count() == 128);
  CHECK(extract(d, {{0}, "point", {}, false}, ctx)->cell_count() == 1);
  CHECK(extract(d, {{364}, "point", {}, false}, ctx)->cell_count() == 8);  // the middle
  CHECK(test::error_of([&] { extract(d, {{512}, "cell", {}, false}, ctx); }).find("0 to 511") != std::string::npos);
  CHECK(test::error_of([&] { extract(d, {{}, "cell", {}, false}, ctx); }).find("no numbers") != std::string::npos);
  CHECK(test::error_of([&] { extract(d, {{1}, "cell", {"r"}, false}, ctx); }).size() > 0);
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
  p.region.axis = "x";
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
