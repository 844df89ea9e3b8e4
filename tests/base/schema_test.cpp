// SPDX-License-Identifier: Apache-2.0
#include "base/schema.h"

#include "base/text.h"
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
