// SPDX-License-Identifier: Apache-2.0
// Parameters for people and as JSON schema.
#include <fmt/core.h>

#include <algorithm>

#include "base/schema/color_params.h"
#include "base/schema/field_kinds.h"
#include "base/schema/schema.h"
#include "base/text/text.h"

namespace sg {

std::string_view param_type(const ParamDecl& decl) {
  switch (decl.ref.type()) {
    case ParamType::boolean: return "bool";
    case ParamType::integer: return "integer";
    case ParamType::number: return "number";
    case ParamType::word: return "word";
    case ParamType::field: return "field";
    case ParamType::point: return "x,y,z";
    case ParamType::integers: return "integers";
    case ParamType::numbers: return "numbers";
    case ParamType::words: return "words";
  }
  return "";
}

std::string params_help(const Schema& schema) {
  size_t width = 0;
  for (const ParamDecl& d : schema.decls()) width = std::max(width, d.name.size());
  std::string r;
  for (const ParamDecl& d : schema.decls()) {
    std::string facts(param_type(d));
    if (d.ref.type() == ParamType::field) facts = field_kinds_text(d.field_);
    if (!d.choices_.empty()) facts = d.ref.optional() ? "auto" : "";
    for (const std::string& c : d.choices_) facts += (facts.empty() ? "" : "|") + c;
    if (std::string t = items_text(d); !t.empty()) facts += ", " + t + " of them";
    if (std::string t = range_text(d); !t.empty()) facts += ", " + t;
    if (!d.unit_.empty() && !is_color(d)) facts += d.unit_[0] == '@' ? ", in units of '" + d.unit_.substr(1) + "'" : ", in " + d.unit_;
    if (d.required_) facts += ", required";
    else if (std::string t = param_text(d); !t.empty()) facts += ", default " + t;
    r += fmt::format("  {:<{}}  {} [{}]\n", d.name, width, d.doc, facts);
  }
  return r;
}

namespace {

// {"on":["point"],"of":["scalar"]}: which fields a parameter takes.
std::string field_json(const FieldKinds& k) {
  const auto list = [](std::initializer_list<std::pair<bool, const char*>> words) {
    std::string r;
    for (const auto& [is, word] : words)
      if (is) r += (r.empty() ? "" : ",") + json_string(word);
    return "[" + r + "]";
  };
  return "{\"on\":" + list({{k.points, "point"}, {k.cells, "cell"}}) +
         ",\"of\":" + list({{k.scalars, "scalar"}, {k.vectors, "vector"}, {k.tensors, "tensor"}, {k.others, "other"}}) + "}";
}

// {"type":"number","minimum":0}, without its braces: one value, or one element of a list.
std::string element_json(const ParamDecl& d) {
  std::string r;
  const bool null = d.ref.optional();
  const auto type = [&](const char* name) { return "\"type\":" + (null ? fmt::format("[\"{}\",\"null\"]", name) : json_string(name)); };
  switch (d.ref.type()) {
    case ParamType::boolean: return type("boolean");
    case ParamType::integer: r = type("integer"); break;
    case ParamType::integers: r = "\"type\":\"integer\""; break;
    case ParamType::number: r = type("number"); break;
    case ParamType::point:
    case ParamType::numbers: r = "\"type\":\"number\""; break;
    case ParamType::words: r = "\"type\":\"string\""; break;
    case ParamType::word:
    case ParamType::field: r = type("string"); break;
  }
  if (d.lo != -HUGE_VAL) r += fmt::format(",\"{}\":{}", d.lo_open ? "exclusiveMinimum" : "minimum", exact_number(d.lo));
  if (d.hi != HUGE_VAL) r += fmt::format(",\"{}\":{}", d.hi_open ? "exclusiveMaximum" : "maximum", exact_number(d.hi));
  if (!d.choices_.empty()) {
    std::string choices;
    for (const std::string& c : d.choices_) choices += (choices.empty() ? "" : ",") + json_string(c);
    if (d.ref.type() == ParamType::word && null) choices += ",null";
    r += ",\"enum\":[" + choices + "]";
  }
  return r;
}

// Whether the default is a value that the schema itself allows: "" and {} mean "chosen from the data".
bool has_default(const ParamDecl& decl) {
  if (decl.required_) return false;
  const Value v = decl.ref.get();
  if (auto* s = std::get_if<std::string>(&v)) return !s->empty();
  if (auto* d = std::get_if<double>(&v)) return std::isfinite(*d);
  if (auto* list = std::get_if<std::vector<double>>(&v);
      list && !std::all_of(list->begin(), list->end(), [](double x) { return std::isfinite(x); }))
    return false;
  return std::visit(
      [&](const auto& list) {
        if constexpr (!std::is_same_v<std::remove_cvref_t<decltype(list)>, std::string> && requires { list.size(); })
          return list.size() >= decl.least_items && list.size() <= decl.most_items;
        else return true;
      },
      v);
}

}  // namespace

std::string params_json(const Schema& schema) {
  std::string r =
      "{\"$schema\":\"https://json-schema.org/draft/2020-12/schema\",\"type\":\"object\",\"additionalProperties\":false,\"properties\":{";
  std::string required;
  bool first = true;
  for (const ParamDecl& d : schema.decls()) {
    const ParamType type = d.ref.type();
    const bool list = type == ParamType::point || type == ParamType::numbers || type == ParamType::integers || type == ParamType::words;
    r += (first ? "" : ",") + json_string(d.name) + ":{";
    if (list) {
      r += fmt::format("\"type\":{},\"items\":{{{}}}", d.ref.optional() ? "[\"array\",\"null\"]" : "\"array\"", element_json(d));
      const size_t least = type == ParamType::point ? 3 : d.least_items, most = type == ParamType::point ? 3 : d.most_items;
      if (least > 0) r += fmt::format(",\"minItems\":{}", least);
      if (most != SIZE_MAX) r += fmt::format(",\"maxItems\":{}", most);
    } else {
      r += element_json(d);
    }
    if (type == ParamType::field) r += ",\"field\":" + field_json(d.field_);
    if (!d.unit_.empty()) r += ",\"unit\":" + json_string(d.unit_);
    if (has_default(d)) r += ",\"default\":" + value_json(d.ref.get());
    r += ",\"description\":" + json_string(d.doc) + "}";
    if (d.required_) required += (required.empty() ? "" : ",") + json_string(d.name);
    first = false;
  }
  return r + "}" + (required.empty() ? "" : ",\"required\":[" + required + "]") + "}";
}

}  // namespace sg
