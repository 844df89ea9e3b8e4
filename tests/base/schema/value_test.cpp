// SPDX-License-Identifier: Apache-2.0
// Parameters as typed values: enums, what is left open, and values from other doors than text.
#include "base/schema/schema.h"
#include "support/test.h"

using namespace sg;
using test::error_of;

namespace {

enum class Side { inside, outside };
constexpr auto enum_words(Side) {
  return std::array{Word{"inside", Side::inside}, Word{"outside", Side::outside}, Word{"out", Side::outside}};
}

struct Cut {
  Side keep = Side::outside;
  std::optional<Side> other;
  std::vector<Side> sides{Side::inside};
  std::optional<int> count;
  std::optional<std::vector<double>> limits;
  std::optional<std::string> map;
  FieldName field;
  Vec3 at{1, 2, 3};
  std::vector<int64_t> ids;
  double size = 1;
  bool on = false;
};
void describe(Schema& s, Cut& p) {
  s("keep", p.keep, "Keep.");
  s("other", p.other, "Other.");
  s("sides", p.sides, "Sides.");
  s("count", p.count, "Count.").at_least(0);
  s("limits", p.limits, "Limits.");
  s("map", p.map, "Map.");
  s("field", p.field, "Field.").takes(fields::point_vectors);
  s("at", p.at, "At.");
  s("ids", p.ids, "Ids.");
  s("size", p.size, "Size.").positive();
  s("on", p.on, "On.");
}

}  // namespace

TEST_CASE("schema: an enum is stated by its words, in any case, and told by them") {
  Cut p;
  Schema s = schema_of(p);
  CHECK(param_text(*s.find("keep")) == "outside");
  set_params(s, {"keep=Inside", "sides=out,inside"}, "cut");
  CHECK(p.keep == Side::inside);
  CHECK(p.sides == std::vector{Side::outside, Side::inside});
  CHECK(param_text(*s.find("sides")) == "outside,inside");
  CHECK(error_of([&] { set_params(s, {"keep=insdie"}, "cut"); }).find("did you mean 'inside'?") != std::string::npos);
  CHECK(word_of(Side::outside) == "outside");
  CHECK(value_of_word<Side>("out") == Side::outside);
  CHECK_FALSE(value_of_word<Side>("no"));
}

TEST_CASE("schema: what may be left open says auto, and null to programs") {
  Cut p;
  Schema s = schema_of(p);
  for (const char* name : {"other", "count", "limits", "map"}) CHECK(param_text(*s.find(name)) == "auto");
  set_params(s, {"other=inside", "count=3", "limits=1,2", "map=viridis"}, "cut");
  CHECK((p.other == Side::inside && p.count == 3 && p.limits == std::vector<double>{1, 2} && p.map == "viridis"));
  for (const char* name : {"other", "count", "limits", "map"}) set_value(s, name, Value{}, "cut");
  CHECK((!p.other && !p.count && !p.limits && !p.map));
  CHECK(error_of([&] { set_value(s, "size", Value{}, "cut"); }) == "cut size: needs a value");
  CHECK(params_json(s).find(R"("other":{"type":["string","null"],"enum":["inside","outside","out",null],"default":null)") !=
        std::string::npos);
}

TEST_CASE("schema: values pass the same checks as text") {
  Cut p;
  Schema s = schema_of(p);
  set_value(s, "size", int64_t(3), "cut");  // a whole number is a number
  set_value(s, "count", 4.0, "cut");
  set_value(s, "ids", int64_t(7), "cut");  // one is a list of one
  set_value(s, "at", std::vector<int64_t>{4, 5, 6}, "cut");
  set_value(s, "limits", 0.5, "cut");
  set_value(s, "keep", "INSIDE", "cut");
  CHECK((p.size == 3 && p.count == 4 && p.ids == std::vector<int64_t>{7} && p.at == Vec3(4, 5, 6)));
  CHECK((p.limits == std::vector<double>{0.5} && p.keep == Side::inside));
  const auto error = [&](const char* name, Value v) { return error_of([&] { set_value(s, name, v, "cut"); }); };
  CHECK(error("size", 0.0) == "cut size: '0' is not in range: it must be above 0");
  CHECK(error("size", NAN).find("not in range") != std::string::npos);
  CHECK(error("size", "big") == "cut size: 'big' is not a number");
  CHECK(error("count", 1.5) == "cut count: '1.5' is not a whole number");
  CHECK(error("count", 1e300).find("is not a whole number") != std::string::npos);
  CHECK(error("count", int64_t(1) << 40).find("at most 2^31") != std::string::npos);
  CHECK(error("at", std::vector<double>{1, 2}) == "cut at: '1,2' is not three numbers like 0,0,1");
  CHECK(error("ids", std::vector<double>{1, 2.5}) == "cut ids: '2.5' in '1,2.5' is not a whole number");
  CHECK(error("on", int64_t(2)).find("true or false") != std::string::npos);
  CHECK(error("keep", int64_t(2)).find("a word") != std::string::npos);
  CHECK(error("sieze", 1.0).find("did you mean 'size'?") != std::string::npos);
  CHECK(p.size == 3);  // what is refused changes nothing
  const std::string typed = error_of([&] { set_param(s, "count", "-1_", "cut"); });
  CHECK(typed == "cut count: '-1_' is not a whole number");
  CHECK(error_of([&] { set_param(s, "size", "-1e9", "cut"); }).find("'-1e9' is not in range") != std::string::npos);  // as it was written
}

TEST_CASE("schema: sets of parameters know what was stated, and copies have values of their own") {
  ParamSet a = make_param_set<Cut>();
  CHECK_FALSE(a.schema.stated("size"));
  set_value(a.schema, "size", 1.0, "cut");  // the default, but stated
  CHECK(a.schema.stated("size"));
  set_params(a.schema, {"field=v", "other=outside"}, "cut");
  ParamSet b = copy_of(a);
  CHECK((b.schema.stated("size") && !b.schema.stated("keep")));
  CHECK(params_text(a.schema) == params_text(b.schema));
  set_value(b.schema, "size", 9.0, "cut");
  CHECK((a.as<Cut>().size == 1 && b.as<Cut>().size == 9));
}

TEST_CASE("schema: JSON says which fields a parameter takes") {
  Cut p;
  CHECK(params_json(schema_of(p)).find(R"("field":{"on":["point"],"of":["vector"]})") != std::string::npos);
}

namespace {

// A parameter that is a view of members: the ends of a span as a list of two, open where it is the whole.
struct Span {
  size_t lo = 0, hi = SIZE_MAX;
};
struct SpanView {
  static constexpr ParamType type = ParamType::integers;
  static constexpr bool optional = true;
  static Value get(const Span& s) { return s.hi == SIZE_MAX ? Value() : Value(std::vector<int64_t>{int64_t(s.lo), int64_t(s.hi)}); }
  static void set(Span& s, const Value& v) {
    s = {};
    if (auto* ends = std::get_if<std::vector<int64_t>>(&v)) s = {size_t((*ends)[0]), size_t((*ends)[1])};
  }
};
struct Take {
  std::string from;
  Span span;
  size_t skip = 0;
};
void describe(Schema& s, Take& p) {
  s("from", p.from, "From.").required();
  s.view<SpanView>("span", p.span, "Span.").at_least(0).items(2);
  s("skip", p.skip, "Skip.");
}

}  // namespace

TEST_CASE("schema: a view is a parameter of a type that its member has not") {
  ParamSet params = make_param_set<Take>();
  Take& p = params.as<Take>();
  CHECK(changed_words(params).empty());
  set_param(params.schema, "span", "3,5", "take");
  CHECK((p.span.lo == 3 && p.span.hi == 5));
  CHECK(changed_words(params) == std::vector<std::string>{"span=3,5"});
  set_param(params.schema, "span", "auto", "take");
  CHECK(p.span.hi == SIZE_MAX);
  CHECK(error_of([&] { set_param(params.schema, "span", "3,5,6", "take"); }) == "take span: '3,5,6' is not a list of 2");
  CHECK(error_of([&] { set_param(params.schema, "span", "3,-5", "take"); }).find("at least 0") != std::string::npos);
  CHECK(error_of([&] { set_value(params.schema, "skip", int64_t(-1), "take"); }).find("at least 0") != std::string::npos);
  CHECK(error_of([&] { set_value(params.schema, "skip", "many", ""); }) == "skip: 'many' is not a whole number");
}

TEST_CASE("schema: JSON says how long lists are and what is required") {
  Take p;
  const std::string json = params_json(schema_of(p));
  CHECK(json.find(R"("span":{"type":["array","null"],"items":{"type":"integer","minimum":0},"minItems":2,"maxItems":2,"default":null)") !=
        std::string::npos);
  CHECK(json.ends_with(R"("required":["from"]})"));
  CHECK(json.starts_with(R"({"$schema":"https://json-schema.org/draft/2020-12/schema","type":"object")"));
  CHECK(params_help(schema_of(p)).find("2 of them") != std::string::npos);
}
