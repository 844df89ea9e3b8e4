// SPDX-License-Identifier: Apache-2.0
// What fields operations take: stated for every parameter, true, and checked in one place.
#include <set>

#include "base/schema/field_kinds.h"
#include "pipeline/operation/check_fields.h"
#include "pipeline/operation/operation.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr int sizes[] = {1, 2, 3, 4, 5, 6, 7, 9};

// Point fields p1, p2, ... and cell fields c1, c2, ... of so many components.
FieldSet fields_for(size_t points, size_t cells) {
  FieldSet fields;
  for (const int n : sizes)
    for (const auto& [name, on, count] : {std::tuple("p", Association::point, points), std::tuple("c", Association::cell, cells)}) {
      std::vector<double> v(count * size_t(n));
      for (size_t i = 0; i < v.size(); ++i) v[i] = 1 + double(i * 7919 % 101) / 17;
      fields.add({name + std::to_string(n), on, Array::from_vector(std::move(v), n), "", Role::none});
    }
  return fields;
}

DatasetPtr with_fields(Mesh mesh) {
  const DatasetPtr bare = make_dataset(mesh, FieldSet{});
  return make_dataset(std::move(mesh), fields_for(bare->point_count(), bare->cell_count()));
}

std::vector<DatasetPtr> sample_meshes() {
  UniformGrid solid, flat;
  solid.dims = {4, 4, 4}, flat.dims = {6, 6, 1};
  SurfaceMesh triangles, lines;
  std::vector<double> xyz;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) xyz.insert(xyz.end(), {double(i), double(j), 0.1 * i * j});
  std::vector<int32_t> ids;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const int a = i + 4 * j;
      ids.insert(ids.end(), {a, a + 1, a + 5, a, a + 5, a + 4});
    }
  triangles.points.xyz = lines.points.xyz = Array::from_vector(xyz, 3);
  triangles.polygons.fixed = 3, triangles.polygons.connectivity = Array::from_vector(ids);
  lines.lines.fixed = 4, lines.lines.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7});
  return {with_fields(solid), with_fields(flat), with_fields(triangles), with_fields(lines)};
}

// Words without which an operation asks for something else, and such that it is soon done.
std::vector<std::string> words_for(const Operation& o, const ParamDecl& of) {
  std::vector<std::string> r;
  const ParamSet params = o.make_params();
  const auto add = [&](const char* name, const char* value) {
    const ParamDecl* d = params.schema.find(name);
    if (d && d->name != of.name && (d->ref.type() == ParamType::integer || d->ref.type() == ParamType::field))
      r.push_back(d->name + "=" + value);
  };
  add("size", "8"), add("resolution", "8"), add("truth", "p1"), add("b", "p3");
  if (o.name == "dice") add("field", "p1");
  if (o.name == "extract") r.push_back("ids=1,2");
  if (o.name == "glyph_points") r.push_back("mode=apart");
  if (o.name == "glyphs" && of.name == "latitude") r.insert(r.end(), {"shape=barbs", "vectors=p3"});
  return r;
}

}  // namespace

TEST_CASE("operations: every parameter that names a field says which fields it takes") {
  // Fields of any number of components on points or cells: what every other parameter must not be left at.
  const std::set<std::string> any{"scale field",   "component field",  "gradient field",  "threshold field",   "histogram field",
                                  "contour field", "tensor_fit field", "tensor_fit mask", "tensor_glyphs mask"};
  std::set<std::string> seen;
  for (const Operation& o : operations()) {
    const ParamSet params = o.make_params();
    for (const ParamDecl& d : params.schema.decls()) {
      if (d.ref.type() != ParamType::field) continue;
      const std::string name = std::string(o.name) + " " + d.name;
      if (d.field_ == FieldKinds{}) seen.insert(name);
      CHECK_MESSAGE((d.field_.points || d.field_.cells), name);
      CHECK_MESSAGE(ops_help(o.name).find("[" + field_kinds_text(d.field_)) != std::string::npos, name);
    }
  }
  CHECK(seen == any);
}

TEST_CASE("operations: what a declaration refuses, the operation does not take either") {
  const std::vector<DatasetPtr> all = sample_meshes();
  for (const Operation& o : operations()) {
    if (o.kind == OperationKind::source) continue;
    const ParamSet plain = o.make_params();
    for (const ParamDecl& d : plain.schema.decls()) {
      if (d.ref.type() != ParamType::field || d.field_ == FieldKinds{}) continue;
      for (const DatasetPtr& mesh : all)
        for (const Field& f : mesh->fields()) {
          std::vector<std::string> words = words_for(o, d);
          words.push_back(d.name + "=" + f.name);
          const ParamSet params = make_params(o, words);
          const std::vector<Data> inputs(size_t(std::max(1, o.min_inputs)), Data(mesh));
          std::string refused;
          try {
            check_fields(o.name, params.schema, inputs);
          } catch (const Error& e) {
            refused = e.what();
          }
          if (refused.empty()) continue;
          bool ran = true;
          try {
            Context context;
            o.run(inputs, params, context);
          } catch (const Error&) {
            ran = false;
          }
          CHECK_MESSAGE(!ran, refused);
        }
    }
  }
}

TEST_CASE("operations: a field of the wrong kind is refused with what is wrong, where, and which fields would do") {
  const std::vector<DatasetPtr> all = sample_meshes();
  const auto run = [&](const char* name, const std::vector<std::string>& words) {
    Context context;
    return run_operation(find_operation(name), {all[0]}, words, context);
  };
  CHECK(test::error_of([&] { run("streamlines", {"field=p1"}); }) ==
        "streamlines field: field 'p1' is a point field of 1 component; it takes a vector field (2 or 3 components) of points or cells: "
        "p2, c2, "
        "p3, c3");
  CHECK(test::error_of([&] { run("ridges", {"field=c1"}); }).find("a scalar field (1 component) of points: p1; cell_to_point moves it") !=
        std::string::npos);
  CHECK(test::error_of([&] { run("ridges", {"field=p3"}); }).find("magnitude or component makes a scalar of it") != std::string::npos);
  CHECK(test::error_of([&] { run("tensor_eigen", {"field=p5"}); }).find("a tensor field (9, 7, 6, 4 or 3 components)") !=
        std::string::npos);
  CHECK(test::error_of([&] { run("magnitude", {"field=p1"}); }).find("a field of several components of points or cells") !=
        std::string::npos);
  CHECK(test::error_of([&] { run("streamlines", {"field=p33"}); }).find("did you mean") != std::string::npos);  // the operation's own
}

TEST_CASE("operations: a field that one part of a collection has in the right kind is not refused") {
  const ParamSet params = make_params(find_operation("streamlines"), {"field=u"});
  const auto part = [](int components) {
    UniformGrid g;
    g.dims = {2, 2, 2};
    FieldSet fields;
    fields.add({"u", Association::point, Array::from_vector(std::vector<float>(8 * size_t(components), 1), components), "", Role::none});
    return make_dataset(Mesh(g), std::move(fields));
  };
  auto both = std::make_shared<Collection>();
  both->parts = {{"a", part(1)}, {"b", part(3)}};
  const Data one = part(1), mixed = CollectionPtr(both);
  CHECK_NOTHROW(check_fields("streamlines", params.schema, std::span(&mixed, 1)));
  CHECK_THROWS_AS(check_fields("streamlines", params.schema, std::span(&one, 1)), Error);
}
