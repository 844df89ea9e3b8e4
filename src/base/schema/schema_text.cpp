// SPDX-License-Identifier: Apache-2.0
// Text as one way to state parameters.
#include <fmt/core.h>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "base/text/text.h"

namespace sg {

namespace {

// Reads text as the type of a parameter; set_value() decides what fits.
class Parse {
 public:
  Parse(const ParamDecl& decl, std::string where, std::string_view text)
      : decl_(decl), where_(std::move(where)), given_(text), text_(trim(text)) {}

  Value operator()() const {
    if (decl_.ref.optional() && text_ == "auto") return {};
    switch (decl_.ref.type()) {
      case ParamType::boolean: return boolean();
      case ParamType::integer: return integer(text_);
      case ParamType::number: return number(text_);
      case ParamType::word: return std::string(decl_.unit_.ends_with("file") ? given_ : text_);
      case ParamType::field: return std::string(given_);  // blanks at its ends may belong to it
      case ParamType::point:
        if (split(text_, ',').size() != 3) fail("three numbers like 0,0,1", text_);
        [[fallthrough]];
      case ParamType::numbers: return list<double>([&](std::string_view t) { return number(t); });
      case ParamType::integers: return list<int64_t>([&](std::string_view t) { return integer(t); });
      case ParamType::words: return list<std::string>([](std::string_view t) { return std::string(t); });
    }
    return {};
  }

 private:
  [[noreturn]] void fail(const std::string& wanted, std::string_view part) const {
    fail_usage(part == text_ ? fmt::format("'{}' is not {}", text_, wanted) : fmt::format("'{}' in '{}' is not {}", part, text_, wanted),
               where_);
  }
  bool boolean() const {
    const auto v = parse_bool(text_);
    if (!v) fail("true or false", text_);
    return *v;
  }
  double number(std::string_view t) const {
    const auto v = parse_double(t);
    if (!v) fail(number_text(decl_), t);
    return *v;
  }
  int64_t integer(std::string_view t) const {
    const auto v = parse_int(t);
    if (!v) fail("a whole number", t);
    return *v;
  }
  template <class T, class F>
  std::vector<T> list(F&& element) const {
    std::vector<T> r;
    for (const std::string_view t : split(text_, ',')) r.push_back(element(t));
    return r;
  }

  const ParamDecl& decl_;
  std::string where_;
  std::string_view given_, text_;  // with the blanks around it, and without them
};

}  // namespace

void set_param(Schema& schema, std::string_view name, std::string_view text, std::string_view owner) {
  const ParamDecl* decl = schema.find(name);
  const Value value = decl ? Parse(*decl, owner.empty() ? std::string(name) : fmt::format("{} {}", owner, name), text)() : Value{};
  set_value(schema, name, value, owner, trim(text));
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
        if (decl && decl->ref.type() != ParamType::boolean)
          fail_usage(fmt::format("'{}' needs a value", w), std::string(owner), fmt::format("write {}={}", w, param_text(*decl)));
        set_param(schema, w, "true", owner);
      }
    } catch (const Error& e) {
      problems += (problems.empty() ? "" : "; ") + std::string(e.what());
    }
  }
  if (!problems.empty()) fail_usage(problems);
}

std::string param_text(const ParamDecl& decl) { return value_text(decl.ref.get()); }

std::vector<std::string> changed_words(const ParamSet& params) {
  const ParamSet plain = params.fresh();
  std::vector<std::string> words;
  for (size_t i = 0; i < params.schema.decls().size(); ++i)
    if (const ParamDecl& d = params.schema.decls()[i]; d.ref.get() != plain.schema.decls()[i].ref.get())
      words.push_back(d.name + "=" + param_text(d));
  return words;
}

std::string params_text(const Schema& schema) {
  std::string r;
  for (const ParamDecl& d : schema.decls()) r += d.name + "=" + param_text(d) + "\n";
  return r;
}

}  // namespace sg
