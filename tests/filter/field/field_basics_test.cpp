// SPDX-License-Identifier: Apache-2.0
#include "filter/field/basics.h"

#include "support/test.h"

using namespace sg;
using sg::test::error_of;

namespace {

DatasetPtr two_points() {
  UniformGrid g;
  g.dims = {2, 1, 1};
  FieldSet f;
  f.add({"T", Association::point, Array::from_vector(std::vector<float>{273.15f, 300}), "K", Role::scalars});
  f.add({"v", Association::point, Array::from_vector(std::vector<double>{3, 4, 0, NAN, 1, 1}, 3), "m/s", Role::vectors});
  f.add({"id", Association::cell, Array::from_vector(std::vector<int32_t>{7}), "", Role::global_ids});
  f.add({"rev", Association::whole, Array::from_vector(std::vector<uint8_t>{1}), "", Role::none});
  return make_dataset(g, f);
}

}  // namespace

TEST_CASE("fields: select keeps, drops and shares the data") {
  Context ctx;
  const DatasetPtr in = two_points();
  const DatasetPtr kept = select(in, {.keep = {"v", "rev"}}, ctx);
  CHECK(kept->fields().names() == std::vector<std::string>{"v", "rev"});
  CHECK(kept->fields().require("v").array.raw() == in->fields().require("v").array.raw());
  CHECK(select(in, {.drop = {"T"}}, ctx)->fields().names() == std::vector<std::string>{"v", "id", "rev"});
  CHECK(error_of([&] { select(in, {.keep = {"vv"}}, ctx); }).find("did you mean 'v'") != std::string::npos);
  CHECK(error_of([&] { select(in, {.drop = {"pressure"}}, ctx); }).find("not found") != std::string::npos);
  CHECK(error_of([&] { select(in, {}, ctx); }).find("keep=NAMES") != std::string::npos);
}

TEST_CASE("fields: magnitude has the unit of its vector, NaN stays NaN") {
  Context ctx;
  const Field m = magnitude(two_points(), {}, ctx)->fields().require("v_magnitude", Association::point);
  CHECK(m.array.type() == ElementType::f64);
  CHECK(m.array.get(0) == 5);
  CHECK(std::isnan(m.array.get(1)));
  CHECK(m.unit == "m/s");
  CHECK(magnitude(two_points(), {.field = {"v"}, .name = "speed"}, ctx)->fields().find("speed") != nullptr);
  CHECK(error_of([] {
          Context c;
          magnitude(two_points(), {.field = {"T"}}, c);
        }).find("one component") != std::string::npos);
  CHECK(error_of([] {
          Context c;
          magnitude(select(two_points(), {.keep = {"T"}}, c), {}, c);
        }).find("no vector field") != std::string::npos);
}

TEST_CASE("fields: scale replaces or adds, and drops a unit that would be wrong") {
  Context ctx;
  const DatasetPtr c = scale_field(two_points(), {.offset = -273.15, .name = "C", .unit = "degC"}, ctx);
  CHECK(c->fields().require("C").unit == "degC");
  CHECK(c->fields().require("C").array.get(1) == doctest::Approx(26.85));
  CHECK(c->fields().require("T").unit == "K");
  std::string note;
  ctx.on_log = [&](LogLevel, std::string_view t) { note = t; };
  const Field t = scale_field(two_points(), {.field = {"T"}, .factor = 2}, ctx)->fields().require("T");
  CHECK(t.unit.empty());
  CHECK(t.role == Role::scalars);
  CHECK(t.array.get(1) == 600);
  CHECK(note.find("loses its unit K") != std::string::npos);
  const Field id = scale_field(two_points(), {.field = {"id"}}, ctx)->fields().require("id");
  CHECK(id.array.type() == ElementType::f32);
  CHECK(id.association == Association::cell);
  CHECK(error_of([] {
          Context x;
          scale_field(two_points(), {.field = {"Q"}}, x);
        }).find("not found") != std::string::npos);
  CHECK(error_of([] {
          Context x;
          scale_field(two_points(), {.factor = INFINITY}, x);
        }).find("finite") != std::string::npos);
}

TEST_CASE("fields: component shares the bytes and is named after its axis") {
  Context ctx;
  const DatasetPtr in = two_points();
  const Field y = component(in, {.component = 1}, ctx)->fields().require("v_y");
  CHECK(y.array.get(0) == 4);
  CHECK(y.unit == "m/s");
  CHECK(y.array.buffer().data == in->fields().require("v").array.buffer().data);
  CHECK(error_of([&] { component(in, {.component = 3}, ctx); }).find("0 to 2") != std::string::npos);
}
