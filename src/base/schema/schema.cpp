// SPDX-License-Identifier: Apache-2.0
// The declarations, and the checks that every value passes, from whichever door.
#include "base/schema/schema.h"

#include <utility>

#include <fmt/core.h>

#include "base/error.h"
#include "base/schema/color_params.h"
#include "base/schema/other_words.h"
#include "base/text/text.h"

namespace sg {

namespace {

// What a value is compared with, and named by when it does not fit.
class Check {
 public:
  Check(const ParamDecl& decl, std::string where, const Value& value, std::string_view written)
      : decl_(decl), where_(std::move(where)), given_(value), written_(written.empty() ? value_text(value) : std::string(written)) {}

  // The same value as the alternative that the parameter holds.
  Value operator()() const {
    if (std::holds_alternative<std::monostate>(given_)) {
      if (!decl_.ref.optional()) fail_usage("needs a value", where_);
      return given_;
    }
    switch (decl_.ref.type()) {
      case ParamType::boolean:
        if (!std::holds_alternative<bool>(given_)) fail("true or false");
        return given_;
      case ParamType::integer: return in_range(integer());
      case ParamType::number: return in_range(number(given_));
      case ParamType::word: return choice(text());
      case ParamType::field: return text();
      case ParamType::point: {
        auto v = numbers();
        if (v.size() != 3) fail("three numbers like 0,0,1");
        return v;
      }
      case ParamType::numbers: return counted(numbers());
      case ParamType::integers: return counted(integers());
      case ParamType::words: return counted(words());
    }
    return given_;
  }

 private:
  [[noreturn]] void fail(const std::string& wanted) const { fail(wanted, written_); }
  // `part` is the element of a list that is wrong.
  [[noreturn]] void fail(const std::string& wanted, const std::string& part) const {
    fail_usage(
        part == written_ ? fmt::format("'{}' is not {}", part, wanted) : fmt::format("'{}' in '{}' is not {}", part, written_, wanted),
        where_);
  }
  // How an element is told: unquoted, as written.
  std::string told(const Value& element) const { return given_.index() == element.index() ? written_ : value_text(element); }

  double number(const Value& v) const {
    if (auto* i = std::get_if<int64_t>(&v)) return double(*i);
    if (auto* d = std::get_if<double>(&v)) return *d;
    fail(number_text(decl_));
  }
  int64_t whole(double d) const {
    if (!(d == std::floor(d) && std::abs(d) < 0x1p63)) fail("a whole number", told(d));
    return int64_t(d);
  }
  int64_t integer() const {
    if (auto* d = std::get_if<double>(&given_)) return whole(*d);
    if (auto* i = std::get_if<int64_t>(&given_)) return *i;
    fail("a whole number");
  }
  std::string text() const {
    if (auto* s = std::get_if<std::string>(&given_)) return *s;
    if (decl_.ref.words().empty() && decl_.choices_.empty()) return value_text(given_);  // '300' may be a word, too
    fail("a word");
  }

  double in_range(double v) const {
    if (!(v >= decl_.lo && v <= decl_.hi) || (decl_.lo_open && v == decl_.lo) || (decl_.hi_open && v == decl_.hi)) {
      const std::string range = range_text(decl_);
      fail("in range: it must be " + (range.empty() ? "a number, not NaN" : range), told(v));
    }
    return v;
  }
  int64_t in_range(int64_t v) const {
    const double d = double(v);
    if (d < decl_.lo || d > decl_.hi || (decl_.lo_open && d == decl_.lo) || (decl_.hi_open && d == decl_.hi))
      fail("in range: it must be " + range_text(decl_), told(v));
    if (v < decl_.ref.least() || v > decl_.ref.most()) fail("a number of at most 2^31", told(v));
    return v;
  }
  std::string choice(const std::string& word) const {
    if (decl_.choices_.empty()) return word;
    for (const std::string& c : decl_.choices_)
      if (equal_ignoring_case(c, word)) return c;
    fail_usage(fmt::format("'{}' is not one of the choices", word), where_, other_word_hint(word, decl_.choices_));
  }

  template <class T>
  std::vector<T> counted(std::vector<T> list) const {
    if (list.size() < decl_.least_items || list.size() > decl_.most_items) fail("a list of " + items_text(decl_));
    return list;
  }
  std::vector<double> numbers() const {
    std::vector<double> r;
    if (auto* list = std::get_if<std::vector<double>>(&given_)) r = *list;
    else if (auto* whole = std::get_if<std::vector<int64_t>>(&given_)) r.assign(whole->begin(), whole->end());
    else r = {number(given_)};
    for (const double v : r) in_range(v);
    return r;
  }
  std::vector<int64_t> integers() const {
    std::vector<int64_t> r;
    if (auto* list = std::get_if<std::vector<int64_t>>(&given_)) r = *list;
    else if (auto* numbers = std::get_if<std::vector<double>>(&given_))
      for (const double v : *numbers) r.push_back(whole(v));
    else r = {integer()};
    for (const int64_t v : r) in_range(v);
    return r;
  }
  std::vector<std::string> words() const {
    std::vector<std::string> r;
    if (auto* list = std::get_if<std::vector<std::string>>(&given_)) r = *list;
    else r = {text()};
    for (std::string& w : r) w = choice(w);
    return r;
  }

  const ParamDecl& decl_;
  std::string where_;
  const Value& given_;
  std::string written_;
};

}  // namespace

// A name stands for one parameter: words could reach but the first of two.
ParamDecl& Schema::add(std::string name, ParamRef ref, std::string doc) {
  if (find(name)) fail_internal(fmt::format("parameter '{}' is declared twice", name));
  ParamDecl d{std::move(name), ref, std::move(doc), {}, -HUGE_VAL, HUGE_VAL, false, false, {}, {}, 0, SIZE_MAX, false, false};
  if (ref.least() == 0) d.lo = 0;
  for (const std::string_view w : ref.words()) d.choices_.emplace_back(w);
  return decls_.emplace_back(std::move(d));
}

const ParamDecl* Schema::find(std::string_view name) const {
  for (const ParamDecl& d : decls_)
    if (d.name == name) return &d;
  return nullptr;
}

ParamDecl* Schema::find(std::string_view name) { return const_cast<ParamDecl*>(std::as_const(*this).find(name)); }

bool Schema::stated(std::string_view name) const {
  const ParamDecl* d = find(name);
  return d && d->stated;
}

ParamSet copy_of(const ParamSet& params) {
  ParamSet copy = params.fresh();
  for (size_t i = 0; i < copy.schema.decls().size(); ++i) {
    const ParamDecl& from = params.schema.decls()[i];
    ParamDecl& to = copy.schema.decls()[i];
    to.ref.set(from.ref.get()), to.stated = from.stated;
  }
  return copy;
}

std::string items_text(const ParamDecl& d) {
  if (d.least_items == d.most_items) return std::to_string(d.least_items);
  if (d.most_items == SIZE_MAX) return d.least_items > 0 ? fmt::format("at least {}", d.least_items) : "";
  return fmt::format("{} to {}", d.least_items, d.most_items);
}

std::string range_text(const ParamDecl& d) {
  if (d.lo == -HUGE_VAL && d.hi == HUGE_VAL) return "";
  if (d.hi == HUGE_VAL) return (d.lo_open ? "above " : "at least ") + exact_number(d.lo);
  if (d.lo == -HUGE_VAL) return (d.hi_open ? "below " : "at most ") + exact_number(d.hi);
  if (d.lo_open || d.hi_open)
    return (d.lo_open ? "above " : "at least ") + exact_number(d.lo) + (d.hi_open ? " and below " : " and at most ") + exact_number(d.hi);
  return "from " + exact_number(d.lo) + " to " + exact_number(d.hi);
}

void set_value(Schema& schema, std::string_view name, const Value& value, std::string_view owner, std::string_view written) {
  ParamDecl* decl = schema.find(name);
  if (!decl) {
    std::vector<std::string> names;
    for (const ParamDecl& d : schema.decls()) names.push_back(d.name);
    fail_usage(fmt::format("unknown parameter '{}'", name), std::string(owner), other_word_hint(name, names));
  }
  decl->ref.set(Check(*decl, owner.empty() ? std::string(name) : fmt::format("{} {}", owner, name), value, written)());
  decl->stated = true;
}

}  // namespace sg
