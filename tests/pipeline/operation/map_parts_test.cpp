// SPDX-License-Identifier: Apache-2.0
// An operation on a collection: which parts it takes, and what it tells of them.
#include "data/dataset.h"
#include "pipeline/operation/operation.h"
#include "support/test.h"

using namespace sg;

namespace {

// Triangles in a fan, or vertices alone.
DatasetPtr surface_of(size_t triangles, const std::string& field = "T") {
  std::vector<float> xyz{0, 0, 0}, values{0};
  std::vector<int32_t> offsets{0}, ids;
  for (size_t i = 0; i <= triangles; ++i) {
    xyz.insert(xyz.end(), {float(std::cos(0.1 * double(i))), float(std::sin(0.1 * double(i))), 0});
    values.push_back(float(i));
    if (i == triangles) continue;
    ids.insert(ids.end(), {0, int32_t(i) + 1, int32_t(i) + 2});
    offsets.push_back(int32_t(ids.size()));
  }
  const CellArray cells{Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets))};
  DatasetParts parts;
  if (triangles == 0) {
    PointCloud cloud;
    cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
    parts.mesh = std::move(cloud);
  } else {
    SurfaceMesh m;
    m.points.xyz = Array::from_vector(std::move(xyz), 3);
    m.polygons = cells;
    parts.mesh = std::move(m);
  }
  parts.fields.add({field, Association::point, Array::from_vector(std::move(values))});
  return make_dataset(std::move(parts));
}

Data collection(std::vector<Collection::Part> parts) {
  auto c = std::make_shared<Collection>();
  c->parts = std::move(parts);
  return CollectionPtr(c);
}

struct Told {
  Context context;
  std::string text;
  Told() {
    context.on_log = [this](LogLevel, std::string_view t) { text += std::string(t) + "\n"; };
  }
};

Data run(const char* name, const Data& in, const std::vector<std::string>& words, Context& context) {
  return run_operation(find_operation(name), {in}, words, context);
}

}  // namespace

TEST_CASE("collections: a contour leaves parts of points alone out with a note, and refuses when there is nothing else") {
  Told told;
  const Data in = collection({{"dots", surface_of(0)}, {"fan", surface_of(4)}});
  const Data out = run("contour", in, {"values=1.5"}, told.context);
  const auto& parts = std::get<CollectionPtr>(out)->parts;
  REQUIRE(parts.size() == 1);
  CHECK(parts[0].name == "fan");
  CHECK(std::get<DatasetPtr>(parts[0].data)->cell_count() == 3);  // one in each triangle that reaches beyond
  CHECK(told.text == "contour: parts of points and lines alone are left out: 'dots'\n");

  const Data dots = collection({{"dots", surface_of(0)}, {"more", surface_of(0)}});
  CHECK(test::error_of([&] { run("contour", dots, {"values=1.5"}, told.context); }).find("in part 'dots'") != std::string::npos);
}

TEST_CASE("collections: a part with faces that lacks the field is still an error") {
  Told told;
  const Data in = collection({{"one", surface_of(3, "T")}, {"two", surface_of(3, "p")}});
  CHECK(test::error_of([&] { run("contour", in, {"field=T", "values=1.5"}, told.context); }).find("in part 'two'") != std::string::npos);
}

TEST_CASE("collections: parts of which nothing is left are told of once, and only when nothing is left of any") {
  const Data in = collection({{"small", surface_of(2)}, {"large", surface_of(9)}});
  Told some;
  run("clip", in, {"field=T", "value=6"}, some.context);
  CHECK(some.text == "");
  Told none;
  run("clip", in, {"field=T", "value=60"}, none.context);
  CHECK(none.text == "clip: nothing is left\n");
}

TEST_CASE("collections: a value that is chosen is chosen once for all parts, round, and told once") {
  // T runs over 0..2 and 0..10: the middle of all is 5, of the small part 1.
  const Data in = collection({{"small", surface_of(2)}, {"large", surface_of(10)}});
  Told told;
  const Data out = run("isolines", in, {"count=1"}, told.context);
  for (const Collection::Part& part : std::get<CollectionPtr>(out)->parts) {
    const DatasetPtr d = std::get<DatasetPtr>(part.data);
    if (const Field* v = d->fields().find("contour value"); v && v->array.count() > 0) CHECK(v->array.get(0) == 5);
  }
  CHECK(std::get<DatasetPtr>(std::get<CollectionPtr>(out)->parts[1].data)->cell_count() > 0);

  Told clip;
  run("clip", in, {"field=T"}, clip.context);
  CHECK(clip.text == "clip: T = 5, near the middle of 0 to 10\n");

  // The plane goes through the middle of the box of all, which is the large part's.
  const Data moved = collection(
      {{"one", surface_of(9)}, {"two", std::get<DatasetPtr>(run("transform", Data(surface_of(9)), {"translate=4,0,0"}, told.context))}});
  const Data cut = run("slice", moved, {"normal=1,0,0"}, told.context);
  double at = -1;
  size_t pieces = 0;
  for_each_dataset(cut, [&](const std::string&, const DatasetPtr& d) {
    if (d->point_count() == 0) return;
    ++pieces;
    CHECK(d->bounds().lo.x == doctest::Approx(d->bounds().hi.x));
    if (at >= 0) CHECK(d->bounds().lo.x == doctest::Approx(at));
    at = d->bounds().lo.x;
  });
  CHECK(pieces <= 1);  // the middle lies between the two
}

TEST_CASE("collections: a contour tells of values that no part has, once, with the range of all") {
  const Data in = collection({{"small", surface_of(2)}, {"large", surface_of(9)}});  // T over 0..2 and 0..9
  Told some;
  run("contour", in, {"values=1,5"}, some.context);
  CHECK(some.text == "");
  Told none;
  run("contour", in, {"values=5,20"}, none.context);
  CHECK(none.text == "contour: nothing at T = 20; the field ranges from 0 to 9\n");
  // Between the parts there may be a gap.
  const Data high = run("calc", Data(surface_of(2)), {"expr=T+6", "name=T"}, none.context);
  const Data apart = collection({{"low", surface_of(2)}, {"high", std::get<DatasetPtr>(high)}});
  Told gap;
  run("contour", apart, {"field=T", "values=4"}, gap.context);
  CHECK(gap.text == "contour: nothing at T = 4; the field ranges from 0 to 8\n");
}
