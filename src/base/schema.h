// SPDX-License-Identifier: Apache-2.0
// One declaration per parameter: describe(Schema&, Params&) binds each member to its name, default, unit, range and
// sentence; the command line, pipeline file, help, JSON schema, checks and cache key all read that list.
//
//   struct ContourParams { FieldName field; std::vector<double> values; bool normals = true; };
//   void describe(Schema& s, ContourParams& p) {
//     s("field",   p.field,   "Point field to contour; default: the active scalar.");
//     s("values",  p.values,  "Isovalues, one surface each; default: the middle of the range.").unit("@field");
//     s("normals", p.normals, "Unit normals from the field's gradient.");
//   }
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/vec.h"

namespace sg {

/// Name of a field in the input; empty = the operation chooses (its help says how).
struct FieldName {
  std::string name;
  bool empty() const { return name.empty(); }
  friend bool operator==(const FieldName&, const FieldName&) = default;
};

/// What a parameter may be bound to. The value at the time of describe() is the default.
using ParamRef = std::variant<bool*, int*, int64_t*, double*, std::string*, FieldName*, Vec3*, std::optional<double>*, std::optional<Vec3>*,
                              std::vector<double>*, std::vector<int64_t>*, std::vector<std::string>*>;

struct ParamDecl {
  std::string name;
  ParamRef ref;
  std::string doc;
  std::string unit_;                      ///< "m", "deg", or "@field": the unit of that field parameter
  double lo = -HUGE_VAL, hi = HUGE_VAL;   ///< inclusive range of numbers (each element of a list)
  bool lo_open = false, hi_open = false;  ///< the bound itself is not allowed
  std::vector<std::string> choices_;      ///< allowed words of a string (each element of a list)

  ParamDecl& unit(std::string u) {
    unit_ = std::move(u);
    return *this;
  }
  ParamDecl& range(double low, double high) {
    lo = low, hi = high;
    return *this;
  }
  ParamDecl& at_least(double low) {
    lo = low;
    return *this;
  }
  ParamDecl& positive() {
    lo = 0, lo_open = true;
    return *this;
  }
  ParamDecl& choices(std::vector<std::string> words) {
    choices_ = std::move(words);
    return *this;
  }
};

/// Collects declarations; references returned by operator() stay valid until the next call.
class Schema {
 public:
  template <class T>
  ParamDecl& operator()(std::string name, T& value, std::string doc) {
    decls_.push_back({std::move(name), ParamRef(&value), std::move(doc), {}, -HUGE_VAL, HUGE_VAL, false, false, {}});
    return decls_.back();
  }
  std::vector<ParamDecl>& decls() { return decls_; }
  const std::vector<ParamDecl>& decls() const { return decls_; }
  const ParamDecl* find(std::string_view name) const;

 private:
  std::vector<ParamDecl> decls_;
};

template <class P>
Schema schema_of(P& params) {
  Schema s;
  describe(s, params);
  return s;
}

/// Sets one parameter from text; throws Error(usage) naming `owner` (the operation), the parameter, and what would be right.
void set_param(Schema& schema, std::string_view name, std::string_view text, std::string_view owner);

/// Sets from "key=value" words; collects all mistakes and reports them together in one Error(usage).
/// A bare word sets the boolean of that name to true.
void set_params(Schema& schema, const std::vector<std::string>& words, std::string_view owner);

/// Value as text that set_param reads back to the same value.
std::string param_text(const ParamDecl& decl);
/// "number", "numbers", "bool", "word", "field", "x,y,z", ...
std::string param_type(const ParamDecl& decl);
/// All values as "name=value" lines in declaration order: the part of the cache key that is the parameters.
std::string params_text(const Schema& schema);
/// A table for people: name, type, default, unit, sentence.
std::string params_help(const Schema& schema);
/// JSON schema of the parameters: {"type":"object","properties":{...}}.
std::string params_json(const Schema& schema);

}  // namespace sg
