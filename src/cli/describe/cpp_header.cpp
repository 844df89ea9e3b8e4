// SPDX-License-Identifier: Apache-2.0
#include "cli/describe/cpp_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "pipeline/catalog/catalog.h"
#include "scene/show/show.h"

namespace sg {

namespace {

// "marschner_lobb" -> "MarschnerLobb": a member may not have the name of its struct, and many do.
std::string type_name(std::string_view name) {
  std::string r;
  bool upper = true;
  for (const char c : name) {
    if (c == '_') upper = true;
    else r += upper && c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c, upper = false;
  }
  return r;
}

std::string member_name(const std::string& name) {
  static const std::vector<std::string> keywords = {"and",    "or",   "not",     "xor",   "default", "operator", "class", "union",
                                                    "switch", "case", "private", "short", "long",    "double",   "float", "int",
                                                    "char",   "bool", "auto",    "new",   "delete",  "for",      "while", "do",
                                                    "if",     "else", "this",    "using", "export",  "register"};
  return std::find(keywords.begin(), keywords.end(), name) == keywords.end() ? name : name + "_";
}

std::string_view cpp_type(ParamType type) {
  switch (type) {
    case ParamType::boolean: return "bool";
    case ParamType::integer: return "int64_t";
    case ParamType::number: return "double";
    case ParamType::word:
    case ParamType::field: return "std::string";
    case ParamType::point: return "Vec3";
    case ParamType::integers: return "std::vector<int64_t>";
    case ParamType::numbers: return "std::vector<double>";
    case ParamType::words: return "std::vector<std::string>";
  }
  return "";
}

std::string literal(double v) {
  if (std::isnan(v)) return "std::numeric_limits<double>::quiet_NaN()";
  if (std::isinf(v)) return v > 0 ? "std::numeric_limits<double>::infinity()" : "-std::numeric_limits<double>::infinity()";
  return exact_number(v);
}
std::string literal(int64_t v) { return v == INT64_MIN ? "INT64_MIN" : std::to_string(v); }
std::string literal(bool v) { return v ? "true" : "false"; }
std::string literal(std::monostate) { return ""; }
std::string literal(const std::string& v) { return v.empty() ? "" : json_string(v); }
template <class T>
std::string literal(const std::vector<T>& v) {
  std::string r;
  for (const T& x : v) r += (r.empty() ? "" : ", ") + literal(x);
  return r;
}

std::string member(const ParamDecl& d) {
  const std::string type(cpp_type(d.ref.type()));
  std::string facts;
  for (const std::string& c : d.choices_) facts += (facts.empty() ? "" : "|") + c;
  if (facts.empty()) facts = range_text(d);
  if (!d.unit_.empty()) facts += (facts.empty() ? "" : ", ") + d.unit_;
  std::string about = d.doc + (facts.empty() ? "" : " [" + facts + "]");
  std::replace(about.begin(), about.end(), '\n', ' ');
  const std::string value = std::visit([](const auto& v) { return literal(v); }, d.ref.get());
  return fmt::format("  {} {}{{{}}};  ///< {}\n", d.ref.optional() ? "std::optional<" + type + ">" : type, member_name(d.name), value,
                     about);
}

// `first`: the first line of the struct.
std::string struct_of(std::string_view name, std::string_view sentence, const std::string& first, const Schema& schema) {
  const std::string type = type_name(name);
  std::string r = fmt::format("/// {}\nstruct {} {{\n  {}\n", sentence, type, first);
  std::string stated;
  for (const ParamDecl& d : schema.decls()) {
    if (schema.find(d.name) != &d) continue;  // of two of one name the first counts
    r += member(d);
    const std::string m = member_name(d.name);
    stated += fmt::format("    if ({0} != plain.{0}) p.push_back({{\"{1}\", {2}}});\n", m, d.name,
                          d.ref.optional() ? fmt::format("{0} ? Value(*{0}) : Value()", m) : m);
  }
  r += "  /// What is not the default.\n";
  if (stated.empty()) return r + "  Params stated_params() const { return {}; }\n};\n\n";
  return r +
         fmt::format("  Params stated_params() const {{\n    const {} plain;\n    Params p;\n{}    return p;\n  }}\n}};\n\n", type, stated);
}

}  // namespace

std::string cpp_header() {
  std::string r =
      "// SPDX-License-Identifier: Apache-2.0\n"
      "// Made by `sightglass ops --cpp`: every operation, way to show and setting as a struct, for sightglass.h.\n"
      "//   data.run(sg::ops::Contour{.field = \"T\", .values = {300, 400}});\n"
      "//   scene.show(data, sg::shows::Surface{.opacity = 0.5}).camera(sg::settings::Camera{.view = \"front\"});\n"
      "// Values are checked when they are used. A member that is a list, a word or a field and empty: the operation chooses.\n"
      "#pragma once\n#include <limits>\n#include <optional>\n\n#include \"sightglass.h\"\n\nnamespace sightglass {\n\nnamespace ops {\n\n";
  const auto named = [](std::string_view tag, std::string_view name) {
    return fmt::format("static constexpr const char* {} = \"{}\";", tag, name);
  };
  for (const Operation& o : operations())
    r += struct_of(o.name, fmt::format("{}\n/// {}", o.sentence, kinds_help(o)), named("operation_name", o.name), o.make_params().schema);
  r += "}  // namespace ops\n\nnamespace shows {\n\n";
  for (const ShowKind& k : show_kinds()) r += struct_of(k.name, k.sentence, named("way_name", k.name), k.make_params().schema);
  r += "}  // namespace shows\n\nnamespace settings {\n\n";
  for (CatalogEntry& e : catalog()) {
    if (e.kind != EntryKind::camera && e.kind != EntryKind::picture && e.kind != EntryKind::film) continue;
    std::erase_if(e.schema.decls(), [](const ParamDecl& d) { return d.name == "output"; });  // an argument of its own
    r += struct_of(e.name, e.sentence, "operator Params() const { return stated_params(); }", e.schema);
  }
  return r + "}  // namespace settings\n\n}  // namespace sightglass\n";
}

}  // namespace sg
