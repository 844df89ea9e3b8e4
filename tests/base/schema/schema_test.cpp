// SPDX-License-Identifier: Apache-2.0
#include "base/schema/schema.h"

#include "base/schema/color_params.h"
#include "base/text/text.h"
#include "support/test.h"

using namespace sg;

namespace {
struct P {
  FieldName field;
  std::vector<double> values{1, 2.5};
  bool normals = true;
  double size = 1;
  std::string mode = "fixed";
  std::optional<Vec3> center;
};
void describe(Schema& s, P& p) {
  s("field", p.field, "Field.");
  s("values", p.values, "Values.").unit("@field");
  s("normals", p.normals, "Normals.");
  s("size", p.size, "Size.").positive().unit("m");
  s("mode", p.mode, "Mode.").choices({"fixed", "free"});
  s("center", p.center, "Center.");
}
}  // namespace

TEST_CASE("schema: words set parameters, every mistake is reported at once") {
  P p;
  Schema s = schema_of(p);
  set_params(s, {"field=T", "values=300,400", "normals=no", "center=1,2,3"}, "contour");
  CHECK(p.field.name == "T");
  CHECK(p.values == std::vector<double>{300, 400});
  CHECK_FALSE(p.normals);
  CHECK(*p.center == Vec3(1, 2, 3));
  const std::string e = test::error_of([&] { set_params(s, {"valeus=1", "size=0", "mode=fxied"}, "contour"); });
  CHECK(e.find("did you mean 'values'?") != std::string::npos);
  CHECK(e.find("above 0") != std::string::npos);
  CHECK(e.find("did you mean 'fixed'?") != std::string::npos);
}

TEST_CASE("schema: a name stands for one parameter") {
  double glyphs = 1, colours = 2;
  Schema s;
  s("scale", glyphs, "Of the glyphs.");
  CHECK(test::error_of([&] { s("scale", colours, "Of the colours."); }) == "parameter 'scale' is declared twice");
  CHECK(s.decls().size() == 1);
}

TEST_CASE("schema: text of parameters reads back to the same values") {
  P p, q;
  p.size = 0.1, p.values = {1e-20, 3};
  Schema a = schema_of(p), b = schema_of(q);
  for (const ParamDecl& d : a.decls()) set_param(b, d.name, param_text(d), "x");
  CHECK(params_text(a) == params_text(b));
  CHECK(q.values == p.values);
  CHECK(params_json(a).find("\"exclusiveMinimum\":0") != std::string::npos);
}

TEST_CASE("text: numbers parse whole or not at all") {
  CHECK(*parse_double("1e400") == HUGE_VAL);
  CHECK(*parse_double("+.5") == 0.5);
  CHECK_FALSE(parse_double("1x"));
  CHECK_FALSE(parse_double(""));
  CHECK(*parse_bytes("2G") == (2ull << 30));
  CHECK(quoted_words("a 'b c' d=\"e f\"") == std::vector<std::string>{"a", "b c", "d=e f"});
}

namespace {
struct Limits {
  int count = 3;
  int64_t big = 1;
  std::vector<double> list{1, HUGE_VAL};
  std::vector<std::string> axes;
  std::optional<double> angle;
};
void describe(Schema& s, Limits& p) {
  s("count", p.count, "Count.").positive();
  s("big", p.big, "Big.").range(0, 10);
  s("list", p.list, "List.");
  s("axes", p.axes, "Axes.").choices({"x", "y", "z"});
  s("angle", p.angle, "Angle.").unit("deg");
}
}  // namespace

TEST_CASE("schema: open bounds hold for whole numbers too, and what does not fit is refused") {
  Limits p;
  Schema s = schema_of(p);
  auto error = [&](const char* word) { return test::error_of([&] { set_params(s, {word}, "op"); }); };
  CHECK(error("count=0") == "op count: '0' is not in range: it must be above 0");
  CHECK(error("count=3000000000").find("at most 2^31") != std::string::npos);
  CHECK(error("count=1.5").find("is not a whole number") != std::string::npos);
  CHECK(error("big=11").find("from 0 to 10") != std::string::npos);
  CHECK(error("axes=x,w").find("'w' is not one of the choices") != std::string::npos);
  CHECK(error("list=1,,2").find("'' in '1,,2' is not a number") != std::string::npos);
  CHECK(error("angle").find("write angle=auto") != std::string::npos);
  CHECK(error("angle=x").find("a number in deg") != std::string::npos);
  set_params(s, {"axes=Y,z", "angle=7", "count=1"}, "op");
  CHECK(p.axes == std::vector<std::string>{"y", "z"});
  CHECK(*p.angle == 7);
  set_param(s, "angle", "auto", "op");
  CHECK_FALSE(p.angle);
}

TEST_CASE("schema: JSON never holds infinities") {
  Limits p;
  const std::string json = params_json(schema_of(p));
  CHECK(json.find("inf") == std::string::npos);
  CHECK(json.find("\"exclusiveMinimum\":0") != std::string::npos);
}

namespace {
struct Colors {
  std::string halo = "white";
  Vec3 glow;
};
void describe(Schema& s, Colors& p) {
  s("halo", p.halo, "Halo.").unit(color_unit);
  s("glow", p.glow, "Glow.").unit(linear_color_unit);
}
}  // namespace

TEST_CASE("schema: colours are told to windows, and are no units of measure to people") {
  Colors p;
  Schema s = schema_of(p);
  CHECK(params_json(s).find("\"unit\":\"color\"") != std::string::npos);
  CHECK(params_json(s).find("\"unit\":\"linear color\"") != std::string::npos);
  CHECK(params_help(s).find("color") == std::string::npos);
  CHECK(test::error_of([&] { set_param(s, "glow", "1,red,0", "op"); }).find("'red' in '1,red,0' is not a number") != std::string::npos);
}
