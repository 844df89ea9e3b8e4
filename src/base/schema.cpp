// SPDX-License-Identifier: Apache-2.0
#include "base/schema.h"

#include "base/error.h"
#include "base/text.h"

namespace sg {

namespace {

template <class... F>
struct overloaded : F... {
  using F::operator()...;
};
template <class... F>
overloaded(F...) -> overloaded<F...>;

std::string range_text(const ParamDecl& d) {
  if (d.lo == -HUGE_VAL && d.hi == HUGE_VAL) return "";
  if (d.hi == HUGE_VAL) return (d.lo_open ? "above " : "at least ") + exact_number(d.lo);
  if (d.lo == -HUGE_VAL) return (d.hi_open ? "below " : "at most ") + exact_number(d.hi);
  if (d.lo_open || d.hi_open)
    return (d.lo_open ? "above " : "at least ") + exact_number(d.lo) + (d.hi_open ? " and below " : " and at most ") + exact_number(d.hi);
  return "from " + exact_number(d.lo) + " to " + exact_number(d.hi);
}

struct Setter {
  const ParamDecl& decl;
  std::string where;
  std::string_view text, given;  // without the blanks around it, and with them

  [[noreturn]] void fail(const std::string& wanted) const { fail(wanted, text); }
  // `part` is the item of a list that is wrong.
  [[noreturn]] void fail(const std::string& wanted, std::string_view part) const {
    fail_usage(part == text ? fmt::format("'{}' is not {}", text, wanted) : fmt::format("'{}' in '{}' is not {}", part, text, wanted),
               where);
  }
  double number(std::string_view t) const {
    const auto v = parse_double(t);
    if (!v) fail(fmt::format("a number{}", decl.unit_.empty() || decl.unit_[0] == '@' ? "" : " in " + decl.unit_), trim(t));
    if (!(*v >= decl.lo && *v <= decl.hi) || (decl.lo_open && *v == decl.lo) || (decl.hi_open && *v == decl.hi))
      fail("in range: it must be " + (range_text(decl).empty() ? std::string("a number, not NaN") : range_text(decl)), trim(t));
    return *v;
  }
  int64_t integer(std::string_view t) const {
    const auto v = parse_int(t);
    if (!v) fail("a whole number", trim(t));
    const double d = double(*v);
    if (d < decl.lo || d > decl.hi || (decl.lo_open && d == decl.lo) || (decl.hi_open && d == decl.hi))
      fail("in range: it must be " + range_text(decl), trim(t));
    return *v;
  }
  std::string word(std::string_view t) const {
    if (decl.choices_.empty()) return std::string(t);
    for (const std::string& c : decl.choices_)
      if (equal_ignoring_case(c, t)) return c;
    fail_usage(fmt::format("'{}' is not one of the choices", t), where, unknown_name_hint(t, decl.choices_));
  }
  Vec3 triple() const {
    const auto parts = split(text, ',');
    if (parts.size() != 3) fail("three numbers like 0,0,1");
    return {number(parts[0]), number(parts[1]), number(parts[2])};
  }

  void operator()(bool* p) const {
    const auto v = parse_bool(text);
    if (!v) fail("true or false");
    *p = *v;
  }
  void operator()(int* p) const {
    const int64_t v = integer(text);
    if (v < INT32_MIN || v > INT32_MAX) fail("a number of at most 2^31");
    *p = int(v);
  }
  void operator()(int64_t* p) const { *p = integer(text); }
  void operator()(double* p) const { *p = number(text); }
  void operator()(std::string* p) const { *p = decl.unit_.ends_with("file") ? std::string(given) : word(text); }
  void operator()(FieldName* p) const { p->name = std::string(given); }  // blanks at its ends may belong to it
  void operator()(Vec3* p) const { *p = triple(); }
  void operator()(std::optional<double>* p) const { *p = text == "auto" ? std::optional<double>() : number(text); }
  void operator()(std::optional<Vec3>* p) const { *p = text == "auto" ? std::optional<Vec3>() : triple(); }
  void operator()(std::vector<double>* p) const {
    std::vector<double> r;
    for (std::string_view t : split(text, ',')) r.push_back(number(t));
    *p = std::move(r);
  }
  void operator()(std::vector<int64_t>* p) const {
    std::vector<int64_t> r;
    for (std::string_view t : split(text, ',')) r.push_back(integer(t));
    *p = std::move(r);
  }
  void operator()(std::vector<std::string>* p) const {
    std::vector<std::string> r;
    for (std::string_view t : split(text, ',')) r.push_back(word(t));
    *p = std::move(r);
  }
};

template <class T, class F>
std::string joined(const std::vector<T>& v, F&& text) {
  std::string r;
  for (size_t i = 0; i < v.size(); ++i) r += (i ? "," : "") + text(v[i]);
  return r;
}

// JSON knows no infinity and no NaN.
bool all_finite(std::string_view numbers) {
  for (std::string_view t : split(numbers, ','))
    if (const auto v = parse_double(t); !v || !std::isfinite(*v)) return false;
  return true;
}

std::string triple_text(Vec3 v) { return exact_number(v.x) + "," + exact_number(v.y) + "," + exact_number(v.z); }

}  // namespace

const ParamDecl* Schema::find(std::string_view name) const {
  for (const ParamDecl& d : decls_)
    if (d.name == name) return &d;
  return nullptr;
}

void set_param(Schema& schema, std::string_view name, std::string_view text, std::string_view owner) {
  const ParamDecl* decl = schema.find(name);
  if (!decl) {
    std::vector<std::string> names;
    for (const ParamDecl& d : schema.decls()) names.push_back(d.name);
    fail_usage(fmt::format("unknown parameter '{}'", name), std::string(owner), unknown_name_hint(name, names));
  }
  std::visit(Setter{*decl, fmt::format("{} {}", owner, name), trim(text), text}, decl->ref);
}

void set_params(Schema& schema, const std::vector<std::string>& words, std::string_view owner) {
  std::string problems;
  for (const std::string& w : words) {
    try {
      const size_t eq = w.find('=');
      if (eq != std::string::npos) {
        set_param(schema, trim(std::string_view(w).substr(0, eq)), std::string_view(w).substr(eq + 1), owner);
      } else {
        const ParamDecl* decl = schema.find(w);
        if (decl && !std::holds_alternative<bool*>(decl->ref))
          fail_usage(fmt::format("'{}' needs a value", w), std::string(owner), fmt::format("write {}={}", w, param_text(*decl)));
        set_param(schema, w, "true", owner);
      }
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(e.what());
    }
  }
  if (!problems.empty()) fail_usage(problems);
}

std::string param_text(const ParamDecl& decl) {
  return std::visit(overloaded{
                        [](const bool* v) { return std::string(*v ? "true" : "false"); },
                        [](const int* v) { return std::to_string(*v); },
                        [](const int64_t* v) { return std::to_string(*v); },
                        [](const double* v) { return exact_number(*v); },
                        [](const std::string* v) { return *v; },
                        [](const FieldName* v) { return v->name; },
                        [](const Vec3* v) { return triple_text(*v); },
                        [](const std::optional<double>* v) { return *v ? exact_number(**v) : std::string("auto"); },
                        [](const std::optional<Vec3>* v) { return *v ? triple_text(**v) : std::string("auto"); },
                        [](const std::vector<double>* v) { return joined(*v, exact_number); },
                        [](const std::vector<int64_t>* v) { return joined(*v, [](int64_t i) { return std::to_string(i); }); },
                        [](const std::vector<std::string>* v) { return joined(*v, [](const std::string& s) { return s; }); },
                    },
                    decl.ref);
}

std::string param_type(const ParamDecl& decl) {
  return std::visit(overloaded{
                        [](const bool*) { return "bool"; },
                        [](const int*) { return "integer"; },
                        [](const int64_t*) { return "integer"; },
                        [](const double*) { return "number"; },
                        [](const std::string*) { return "word"; },
                        [](const FieldName*) { return "field"; },
                        [](const Vec3*) { return "x,y,z"; },
                        [](const std::optional<double>*) { return "number"; },
                        [](const std::optional<Vec3>*) { return "x,y,z"; },
                        [](const std::vector<double>*) { return "numbers"; },
                        [](const std::vector<int64_t>*) { return "integers"; },
                        [](const std::vector<std::string>*) { return "words"; },
                    },
                    decl.ref);
}

std::string params_text(const Schema& schema) {
  std::string r;
  for (const ParamDecl& d : schema.decls()) r += d.name + "=" + param_text(d) + "\n";
  return r;
}

std::string params_help(const Schema& schema) {
  size_t width = 0;
  for (const ParamDecl& d : schema.decls()) width = std::max(width, d.name.size());
  std::string r;
  for (const ParamDecl& d : schema.decls()) {
    std::string facts = param_type(d);
    if (!d.choices_.empty()) facts.clear();
    for (const std::string& c : d.choices_) facts += (facts.empty() ? "" : "|") + c;
    if (std::string t = range_text(d); !t.empty()) facts += ", " + t;
    if (!d.unit_.empty()) facts += d.unit_[0] == '@' ? ", in units of '" + d.unit_.substr(1) + "'" : ", in " + d.unit_;
    if (std::string t = param_text(d); !t.empty()) facts += ", default " + t;
    r += fmt::format("  {:<{}}  {} [{}]\n", d.name, width, d.doc, facts);
  }
  return r;
}

std::string params_json(const Schema& schema) {
  std::string r = "{\"type\":\"object\",\"additionalProperties\":false,\"properties\":{";
  bool first = true;
  for (const ParamDecl& d : schema.decls()) {
    const std::string type = param_type(d);
    std::string item, json_type = "string";
    if (type == "bool") json_type = "boolean";
    if (type == "integer") json_type = "integer";
    if (type == "number") json_type = "number";
    const bool list = type == "numbers" || type == "integers" || type == "words" || type == "x,y,z";
    item = type == "words" ? "string" : type == "integers" ? "integer" : list ? "number" : "";
    std::string limits;
    if (d.lo != -HUGE_VAL) limits += fmt::format(",\"{}\":{}", d.lo_open ? "exclusiveMinimum" : "minimum", exact_number(d.lo));
    if (d.hi != HUGE_VAL) limits += fmt::format(",\"{}\":{}", d.hi_open ? "exclusiveMaximum" : "maximum", exact_number(d.hi));
    if (!d.choices_.empty()) limits += ",\"enum\":[" + joined(d.choices_, [](const std::string& s) { return json_string(s); }) + "]";
    r += (first ? "" : ",") + json_string(d.name) + ":{";
    r += list ? fmt::format("\"type\":\"array\",\"items\":{{\"type\":\"{}\"{}}}", item, limits)
              : fmt::format("\"type\":\"{}\"{}", json_type, limits);
    if (type == "x,y,z") r += ",\"minItems\":3,\"maxItems\":3";
    if (type == "field") r += ",\"format\":\"field\"";
    if (!d.unit_.empty()) r += ",\"unit\":" + json_string(d.unit_);
    const std::string value = param_text(d);
    const bool finite_number = parse_double(value).has_value() && std::isfinite(*parse_double(value));
    if (json_type == "boolean" || ((json_type == "number" || json_type == "integer") && finite_number)) r += ",\"default\":" + value;
    else if (list && type != "words" && value != "auto" && all_finite(value)) r += ",\"default\":[" + value + "]";
    else if (!list && !value.empty() && json_type == "string") r += ",\"default\":" + json_string(value);
    r += ",\"description\":" + json_string(d.doc) + "}";
    first = false;
  }
  return r + "}}";
}

}  // namespace sg
