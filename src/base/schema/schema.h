// SPDX-License-Identifier: Apache-2.0
// One declaration per parameter: describe(Schema&, Params&) binds each member to its name, default, unit, range and
// sentence; the command line, pipeline file, Python, help, JSON schema, checks and cache key all read that list.
//
//   enum class Side { inside, outside };
//   constexpr auto enum_words(Side) { return std::array{Word{"inside", Side::inside}, Word{"outside", Side::outside}}; }
//   struct CutParams { FieldName field; std::vector<double> values; Side keep = Side::inside; bool normals = true; };
//   void describe(Schema& s, CutParams& p) {
//     s("field",   p.field,   "Field that is compared; default: the active scalar.").takes(fields::point_scalars);
//     s("values",  p.values,  "Limits; default: the middle of the range.").unit("@field");
//     s("keep",    p.keep,    "Which side stays.");
//     s("normals", p.normals, "Unit normals from the field's gradient.");
//   }
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/schema/param_ref.h"

namespace sg {

/// The fields that a parameter of type FieldName takes.
struct FieldKinds {
  bool points = true, cells = true;                                    ///< where its values are
  bool scalars = true, vectors = true, tensors = true, others = true;  ///< of 1; 2 or 3; 3, 4, 6, 7 or 9; any other number
  friend bool operator==(const FieldKinds&, const FieldKinds&) = default;
};
namespace fields {
inline constexpr FieldKinds scalars{true, true, true, false, false, false};
inline constexpr FieldKinds vectors{true, true, false, true, false, false};
inline constexpr FieldKinds tensors{true, true, false, false, true, false};
inline constexpr FieldKinds on_points{true, false, true, true, true, true};
inline constexpr FieldKinds point_scalars{true, false, true, false, false, false};
inline constexpr FieldKinds point_vectors{true, false, false, true, false, false};
}  // namespace fields

struct ParamDecl {
  std::string name;
  ParamRef ref;
  std::string doc;
  std::string unit_;                      ///< "m", "deg", or "@field": the unit of that field parameter
  double lo = -HUGE_VAL, hi = HUGE_VAL;   ///< inclusive range of numbers (each element of a list)
  bool lo_open = false, hi_open = false;  ///< the bound itself is not allowed
  std::vector<std::string> choices_;      ///< allowed words (each element of a list); those of an enum by themselves
  FieldKinds field_;
  size_t least_items = 0, most_items = SIZE_MAX;  ///< length of a list
  bool required_ = false;                         ///< there is no default that would do
  bool stated = false;                            ///< was set, rather than left at its default

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
  /// Words that are known when the program runs alone (presets, maps); for others bind an enum.
  ParamDecl& choices(std::vector<std::string> words) {
    choices_ = std::move(words);
    return *this;
  }
  ParamDecl& takes(FieldKinds kinds) {
    field_ = kinds;
    return *this;
  }
  ParamDecl& items(size_t least, size_t most) {
    least_items = least, most_items = most;
    return *this;
  }
  ParamDecl& items(size_t count) { return items(count, count); }
  /// For help and JSON; that it was stated is for the operation to check.
  ParamDecl& required() {
    required_ = true;
    return *this;
  }
};

/// Collects declarations; references returned by operator() stay valid until the next call.
class Schema {
 public:
  template <class T>
  ParamDecl& operator()(std::string name, T& value, std::string doc) {
    return add(std::move(name), ParamRef(value), std::move(doc));
  }
  /// A view of a member of another type, see ParamRef::seen_as().
  template <class View, class T>
  ParamDecl& view(std::string name, T& value, std::string doc) {
    return add(std::move(name), ParamRef::seen_as<View>(value), std::move(doc));
  }
  std::vector<ParamDecl>& decls() { return decls_; }
  const std::vector<ParamDecl>& decls() const { return decls_; }
  const ParamDecl* find(std::string_view name) const;
  ParamDecl* find(std::string_view name);
  /// Whether a parameter of that name was set.
  bool stated(std::string_view name) const;

 private:
  ParamDecl& add(std::string name, ParamRef ref, std::string doc);
  std::vector<ParamDecl> decls_;
};

template <class P>
Schema schema_of(P& params) {
  Schema s;
  describe(s, params);
  return s;
}

/// A parameter struct of some type and the schema bound to it. Fresh ones hold the defaults.
/// Copies share their values; copy_of() makes others.
struct ParamSet {
  std::shared_ptr<void> values;
  Schema schema;                  ///< refers into `values`
  ParamSet (*fresh)() = nullptr;  ///< makes another one with the defaults

  template <class P>
  P& as() const {
    return *static_cast<P*>(values.get());
  }
};

template <class P>
ParamSet make_param_set() {
  auto values = std::make_shared<P>();
  return {values, schema_of(*values), make_param_set<P>};
}

template <class P>
ParamSet param_set_of(P values) {
  ParamSet set = make_param_set<P>();
  set.as<P>() = std::move(values);
  return set;
}

ParamSet copy_of(const ParamSet& params);

/// Sets one parameter. Whole numbers serve as numbers, a single value as a list of one; words may differ in case. Throws Error(usage)
/// naming `owner` (the operation; "" = the parameter's name says all), the parameter, and what would be right; the value as it was
/// `written`, where that is given.
void set_value(Schema& schema, std::string_view name, const Value& value, std::string_view owner, std::string_view written = {});

/// The same from text, as command lines and pipeline files write it.
void set_param(Schema& schema, std::string_view name, std::string_view text, std::string_view owner);

/// Sets from "key=value" words; collects all mistakes and reports them together in one Error(usage).
/// A bare word sets the boolean of that name to true.
void set_params(Schema& schema, const std::vector<std::string>& words, std::string_view owner);

/// Value as text that set_param reads back to the same value.
std::string param_text(const ParamDecl& decl);
/// "number", "numbers", "bool", "word", "field", "x,y,z", ...
std::string_view param_type(const ParamDecl& decl);
/// "above 0", "from 1 to 4"; "" without limits.
std::string range_text(const ParamDecl& decl);
/// "3", "1 to 3", "at least 2": how long a list may be; "" without limits.
std::string items_text(const ParamDecl& decl);
/// "name=value" of those whose values are not the defaults: which set_params() turns back into the same values.
std::vector<std::string> changed_words(const ParamSet& params);
/// All values as "name=value" lines in declaration order: the part of the cache key that is the parameters.
std::string params_text(const Schema& schema);
/// A table for people: name, type, default, unit, description.
std::string params_help(const Schema& schema);
/// JSON schema of the parameters (draft 2020-12): {"$schema":...,"type":"object","additionalProperties":false,"properties":{...}}. Beside
/// the standard's words, "unit" and "field" ({"on":[...],"of":[...]}: which fields are taken).
std::string params_json(const Schema& schema);

}  // namespace sg
