// SPDX-License-Identifier: Apache-2.0
#include "io/geojson/properties.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text/text.h"
#include "io/mesh/unread.h"
#include "io/text/word_categories.h"

namespace sg::geojson {

namespace {

constexpr const char* no_value = "(no value)";

// Numbers that some writers quote; "007" and "+4" are codes.
std::optional<double> quoted_number(const std::string& s) {
  const size_t first = s.starts_with('-') ? 1 : 0;
  if (s.size() <= first || s[first] < '0' || s[first] > '9' || s.size() > 40) return {};
  if (s[first] == '0' && s.size() > first + 1 && s[first + 1] != '.') return {};
  const auto v = parse_double(s);
  return v && std::isfinite(*v) ? v : std::nullopt;
}

std::optional<double> number_of(const Json& v) {
  if (v.is_number()) return v.number();
  if (v.is_bool()) return v.boolean() ? 1 : 0;
  return v.is_text() ? quoted_number(v.text()) : std::nullopt;
}

std::string word_of_property(const Json& v) {
  if (v.is_text()) return v.text().empty() ? no_value : v.text();
  if (v.is_bool()) return v.boolean() ? "true" : "false";
  return v.is_real() ? exact_number(v.number()) : v.dump();
}

template <class T>
Array gathered(const std::vector<double>& values, std::span<const int32_t> feature) {
  T* out = nullptr;
  Array a = Array::make<T>(feature.size(), 1, &out);
  for (size_t i = 0; i < feature.size(); ++i) out[i] = T(values[size_t(feature[i])]);
  return a;
}

}  // namespace

void Properties::add(size_t feature, const Json& properties) {
  for (const auto& [name, value] : properties.members()) set(feature, name, value);
}

void Properties::set(size_t feature, const std::string& name, const Json& value) {
  const auto [at, is_new] = index_.emplace(name, columns_.size());
  if (is_new) columns_.push_back({name, {}});
  if (!value.is_null()) columns_[at->second].values.emplace_back(feature, &value);
}

void Properties::add_fields(std::span<const int32_t> feature, Association on, size_t features, const ReadOptions& options, Context& context,
                            DatasetParts& parts) const {
  std::string nested;
  for (const Column& c : columns_) {
    context.check();
    if (!is_wanted(options.fields, c.name)) continue;
    const auto is_nested = [](const auto& v) { return v.second->is_list() || v.second->is_object(); };
    if (std::any_of(c.values.begin(), c.values.end(), is_nested)) {
      nested += (nested.empty() ? "'" : ", '") + c.name + "'";
      continue;
    }
    if (c.values.empty()) continue;
    std::vector<double> numbers(features, std::numeric_limits<double>::quiet_NaN());
    bool numeric = true, whole = true;
    double lo = 0, hi = 0;
    for (const auto& [f, v] : c.values) {
      const auto x = number_of(*v);
      if (!(numeric = x.has_value())) break;
      whole = whole && !v->is_real() && *x == std::round(*x) && std::abs(*x) < 9e15;
      lo = std::min(lo, *x), hi = std::max(hi, *x);
      numbers[f] = *x;
    }
    if (numeric) {
      for (const int32_t f : feature) whole = whole && !std::isnan(numbers[size_t(f)]);
      const bool narrow = lo >= INT32_MIN && hi <= INT32_MAX;
      Array a = !whole   ? gathered<double>(numbers, feature)
                : narrow ? gathered<int32_t>(numbers, feature)
                         : gathered<int64_t>(numbers, feature);
      parts.fields.add({c.name, on, std::move(a), "", Role::none});
      continue;
    }
    std::vector<std::string> words(features, no_value);
    for (const auto& [f, v] : c.values) words[f] = word_of_property(*v);
    const auto categories = word_categories(c.name, words);
    if (!categories) {
      context.info(fmt::format("the strings '{}' are left out: more than {} different ones are no categories", c.name, most_categories));
      continue;
    }
    int32_t* out = nullptr;
    Array a = Array::make<int32_t>(feature.size(), 1, &out);
    for (size_t i = 0; i < feature.size(); ++i) out[i] = categories->numbers[size_t(feature[i])];
    parts.fields.add({c.name, on, std::move(a), "", Role::labels});
    parts.notes.push_back(categories->note);
  }
  if (!nested.empty()) context.info(fmt::format("properties that are lists or objects are left out: {}", nested.substr(0, 400)));
}

}  // namespace sg::geojson
