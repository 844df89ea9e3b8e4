// SPDX-License-Identifier: Apache-2.0
#include "io/write_losses.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

namespace {

constexpr size_t most_named = 20;  // in one list; then how many more

template <class To, class From>
bool same_after(From x) {
  if constexpr (std::is_floating_point_v<From>) {
    if (std::isnan(x)) return std::is_floating_point_v<To>;
    if constexpr (std::is_floating_point_v<To>) return From(To(x)) == x;
    else return x >= From(std::numeric_limits<To>::lowest()) && x < From(std::numeric_limits<To>::max()) && From(To(x)) == x;
  } else if constexpr (std::is_floating_point_v<To>) {
    // Beyond the largest integer, rounding cannot be undone.
    const To y = To(x);
    constexpr To end = To(2) * To(From(1) << (sizeof(From) * 8 - (std::is_signed_v<From> ? 2 : 1)));
    return y < end && From(y) == x;
  } else {
    return std::in_range<To>(x);
  }
}

template <class To>
bool all_same_after(const Array& a) {
  return dispatch(a, [&](auto v) {
    return parallel_reduce(
        v.count, 1 << 15, true,
        [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i)
            for (int c = 0; c < v.components; ++c)
              if (!same_after<To>(v(i, c))) return false;
          return true;
        },
        [](bool x, bool y) { return x && y; });
  });
}

std::string quoted_name(const Field& f) { return "'" + f.name + "'"; }

std::string_view place_of(Association a) { return a == Association::cell ? "cells" : a == Association::whole ? "whole" : "points"; }

}  // namespace

bool survives(const Array& a, ElementType type) {
  if (a.type() == type) return true;
  switch (type) {
    case ElementType::u8: return all_same_after<uint8_t>(a);
    case ElementType::i8: return all_same_after<int8_t>(a);
    case ElementType::u16: return all_same_after<uint16_t>(a);
    case ElementType::i16: return all_same_after<int16_t>(a);
    case ElementType::u32: return all_same_after<uint32_t>(a);
    case ElementType::i32: return all_same_after<int32_t>(a);
    case ElementType::u64: return all_same_after<uint64_t>(a);
    case ElementType::i64: return all_same_after<int64_t>(a);
    case ElementType::f32: return all_same_after<float>(a);
    case ElementType::f64: return all_same_after<double>(a);
  }
  return false;
}

bool survives_f32(const Points& points) {
  if (points.origin == Vec3()) return survives(points.xyz, ElementType::f32);
  for (size_t i = 0; i < points.count(); ++i) {
    const Vec3 p = points.at(i);
    for (int c = 0; c < 3; ++c)
      if (!same_after<float>(p[c])) return false;
  }
  return true;
}

void WriteLosses::add(std::string_view verb, std::string item) {
  auto list = std::find_if(said_.begin(), said_.end(), [&](const auto& s) { return s.first == verb; });
  if (list == said_.end()) list = said_.insert(said_.end(), {std::string(verb), {}});
  if (std::find(list->second.begin(), list->second.end(), item) == list->second.end()) list->second.push_back(std::move(item));
}

void WriteLosses::leaves_out(const Field& f) { add("leaves out", fmt::format("{} ({})", quoted_name(f), place_of(f.association))); }

void WriteLosses::leaves_out(const Dataset& d, Association a) {
  for (const Field& f : d.fields())
    if (f.association == a) leaves_out(f);
}

void WriteLosses::keeps_only(const Dataset& d, const Field& kept, bool keeps_unit) {
  for (const Field& f : d.fields())
    if (&f != &kept) leaves_out(f);
  if (!keeps_unit) drops_unit(kept);
}

const Field& WriteLosses::one_point_field(const Dataset& d, bool keeps_unit) {
  const Field* chosen = nullptr;
  for (const Field& f : d.fields())
    if (f.association == Association::point && (!chosen || (f.role == Role::scalars && chosen->role != Role::scalars))) chosen = &f;
  if (!chosen)
    fail_usage("there is no point field to write", path_,
               fmt::format("a {} file holds one array of numbers at the points of a uniform grid", format_));
  keeps_only(d, *chosen, keeps_unit);
  return *chosen;
}

void WriteLosses::rounds(const Field& f, ElementType type) {
  if (!survives(f.array, type)) rounds(quoted_name(f), f.array.type(), type);
}

void WriteLosses::rounds(std::string_view what, ElementType from, ElementType to) {
  add("rounds", fmt::format("{} ({} to {})", what, element_name(from), element_name(to)));
}

void WriteLosses::renames(const Field& f, std::string_view name) {
  if (f.name != name) add("renames", fmt::format("{} to '{}'", quoted_name(f), name));
}

void WriteLosses::splits(const Field& f) { add("split into components", quoted_name(f)); }

void WriteLosses::drops_unit(const Field& f) {
  if (!f.unit.empty()) add("drops the units of", quoted_name(f));
}

void WriteLosses::also(std::string sentence) { add(sentence, ""); }

void WriteLosses::tell(Context& context) const {
  if (said_.empty()) return;
  std::string text;
  for (const auto& [verb, items] : said_) {
    text += (text.empty() ? "" : "; ") + verb;
    for (size_t i = 0; i < std::min(items.size(), most_named); ++i)
      if (!items[i].empty()) text += (i ? ", " : " ") + items[i];
    if (items.size() > most_named) text += fmt::format(" and {} more", items.size() - most_named);
  }
  context.warn(fmt::format("{}: {} {}", path_, format_, text));
}

}  // namespace sg
