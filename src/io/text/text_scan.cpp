// SPDX-License-Identifier: Apache-2.0
#include "io/text/text_scan.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace sg {

namespace detail {

template <class T>
const char* slow_number(const char* p, const char* end, T& v) {
  const char* q = p;
  if (q < end && *q == '+') ++q;
  if (q == end || (q != p && *q == '-')) return nullptr;
  const auto r = std::from_chars(q, end, v);
  if (r.ec == std::errc()) {
    // from_chars stops in "1.#IND" and reads "nano" as nan: the whole word counts.
    return r.ptr == end || is_space(*r.ptr) || *r.ptr == ',' || *r.ptr == '/' ? r.ptr : is_digit(r.ptr[-1]) ? r.ptr : nullptr;
  }
  if (r.ec != std::errc::result_out_of_range) return nullptr;
  Decimal d;  // too large or too small: the exponent of the leading digit decides
  if (!scan_decimal(p, end, d)) return nullptr;
  ptrdiff_t lead = d.exponent;
  bool point = false, counting = false;
  for (const char* c = q + (*q == '-'); c < r.ptr && (is_digit(*c) || *c == '.'); ++c) {
    if (*c == '.') point = true;
    else if (counting || *c != '0') counting = true, ++lead;
  }
  (void)point;
  v = lead > 0 ? T(HUGE_VAL) : T(0);
  if (d.negative) v = -v;
  return r.ptr;
}

const char* slow_double(const char* p, const char* end, double& v) { return slow_number(p, end, v); }
const char* slow_float(const char* p, const char* end, float& v) { return slow_number(p, end, v); }

}  // namespace detail

std::vector<size_t> text_chunks(std::string_view text, size_t grain, bool words, bool continued) {
  std::vector<size_t> borders{0};
  const char* base = text.data();
  const char* end = base + text.size();
  for (size_t at = grain; at < text.size(); at += grain) {
    if (at <= borders.back()) continue;
    const char* p = base + at - 1;  // a line that begins at `at` exactly is found too
    if (words) {
      while (p < end && !is_space(*p)) ++p;
    } else {
      for (;;) {
        p = line_end(p, end);
        if (!continued || p == end) break;
        const char* last = p;
        while (last > base && last[-1] == '\r') --last;
        if (last == base || last[-1] != '\\') break;
        ++p;
      }
    }
    if (p >= end) break;
    borders.push_back(size_t(p + 1 - base));
  }
  if (text.size() > borders.back()) borders.push_back(text.size());
  return borders;
}

size_t line_number(std::string_view text, size_t at) {
  at = std::min(at, text.size());
  return 1 + size_t(std::count(text.begin(), text.begin() + ptrdiff_t(at), '\n'));
}

namespace {

bool separates(char c) { return is_space(c) || c == ','; }

// One number of type T at p; false when it is none or does not fit.
template <class T>
bool scan_element(const char*& p, const char* end, T& v) {
  if constexpr (std::is_floating_point_v<T>) {
    return scan_number(p, end, v);
  } else {
    const char* q = p;
    int64_t i = 0;
    if (scan_number(q, end, i) && (q == end || separates(*q))) {
      if (!std::in_range<T>(i)) return false;
      v = T(i), p = q;
      return true;
    }
    const auto r = std::from_chars(p + (p < end && *p == '+'), end, v);  // 19 and 20 digits
    if (r.ec == std::errc() && (r.ptr == end || separates(*r.ptr))) {
      p = r.ptr;
      return true;
    }
    double d = 0;  // whole numbers written as "3.0" or "1e3"
    if (!scan_number(p, end, d) || d != std::floor(d) || !(d >= double(std::numeric_limits<T>::min())) ||
        !(d < double(std::numeric_limits<T>::max())))
      return false;
    v = T(d);
    return true;
  }
}

template <class T>
Array parse_typed(std::string_view text, size_t count, int components, const std::string& where, size_t lines_before) {
  const size_t total = count * size_t(components);
  const std::vector<size_t> borders = text_chunks(text, 1 << 18, true);
  const size_t chunks = borders.size() - 1;
  std::vector<size_t> first(chunks);
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    size_t n = 0;
    bool inside = false;
    for (size_t i = borders[c]; i < borders[c + 1]; ++i) {
      const bool word = !separates(text[i]);
      n += size_t(word && !inside);
      inside = word;
    }
    first[c] = n;
  });
  const size_t found = exclusive_scan(first);
  if (found < total) fail_data(fmt::format("has {} numbers, but {} are needed", found, total), where);
  T* out = nullptr;
  Array a = Array::make<T>(count, components, &out);
  parallel_for(chunks, 1, [&](size_t c, size_t) {
    const char *p = text.data() + borders[c], *end = text.data() + borders[c + 1];
    for (size_t i = first[c]; i < total; ++i) {
      while (p < end && separates(*p)) ++p;
      if (p == end) break;
      const char* word = p;
      if (!scan_element(p, end, out[i]) || (p < end && !separates(*p)))
        fail_data(fmt::format("line {}: '{}' is not a valid {}", lines_before + line_number(text, size_t(word - text.data())),
                              std::string_view(word, std::min<size_t>(40, size_t(skip_word(word, end) - word))),
                              element_name(element_type_of<T>())),
                  where);
    }
  });
  return a;
}

}  // namespace

Array parse_numbers(std::string_view text, ElementType type, size_t count, int components, const std::string& where, size_t lines_before) {
  size_t total = 0;
  if (__builtin_mul_overflow(count, size_t(components), &total) || total > text.size() / 2 + 1)
    fail_data(fmt::format("{} bytes of text cannot hold {} x {} numbers", text.size(), count, components), where);
  switch (type) {
    case ElementType::u8: return parse_typed<uint8_t>(text, count, components, where, lines_before);
    case ElementType::i8: return parse_typed<int8_t>(text, count, components, where, lines_before);
    case ElementType::u16: return parse_typed<uint16_t>(text, count, components, where, lines_before);
    case ElementType::i16: return parse_typed<int16_t>(text, count, components, where, lines_before);
    case ElementType::u32: return parse_typed<uint32_t>(text, count, components, where, lines_before);
    case ElementType::i32: return parse_typed<int32_t>(text, count, components, where, lines_before);
    case ElementType::u64: return parse_typed<uint64_t>(text, count, components, where, lines_before);
    case ElementType::i64: return parse_typed<int64_t>(text, count, components, where, lines_before);
    case ElementType::f32: return parse_typed<float>(text, count, components, where, lines_before);
    case ElementType::f64: return parse_typed<double>(text, count, components, where, lines_before);
  }
  fail_internal("parse_numbers: unknown element type");
}

}  // namespace sg
