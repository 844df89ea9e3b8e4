// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_legacy_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "base/bytes.h"
#include "base/text/text.h"
#include "io/vtk/vtk_numbers.h"

namespace sg::vtk {

void LegacyText::fail(std::string problem, std::string hint) const {
  const size_t at = std::min(at_, all_.size());
  if (binary) fail_data(std::move(problem), fmt::format("{}: byte {}", file_.path(), at), std::move(hint));
  const auto line = std::count(all_.begin(), all_.begin() + ptrdiff_t(at), '\n') + 1;
  fail_data(std::move(problem), fmt::format("{}: line {}", file_.path(), line), std::move(hint));
}

std::string_view LegacyText::line() {
  const size_t end = std::min(all_.find('\n', at_), all_.size());
  std::string_view r = all_.substr(at_, end - at_);
  at_ = std::min(end + 1, all_.size());
  if (!r.empty() && r.back() == '\r') r.remove_suffix(1);
  return r;
}

void LegacyText::skip_blanks() {
  while (at_ < all_.size() && blank(all_[at_])) ++at_;
}

std::string_view LegacyText::word() {
  skip_blanks();
  const size_t begin = at_;
  while (at_ < all_.size() && !blank(all_[at_])) ++at_;
  return all_.substr(begin, at_ - begin);
}

std::string_view LegacyText::peek() {
  const size_t at = at_;
  const std::string_view w = word();
  at_ = at;
  return w;
}

std::string_view LegacyText::need_word(std::string_view what) {
  const std::string_view w = word();
  if (w.empty()) fail(fmt::format("the file ends where {} was expected", what), "the file is truncated");
  return w;
}

double LegacyText::number(std::string_view what) {
  const std::string_view w = need_word(what);
  const auto v = parse_double(w);
  if (!v) fail(fmt::format("found '{}' instead of {}", w.substr(0, 40), what));
  return *v;
}

size_t LegacyText::count(std::string_view what) {
  const std::string_view w = need_word(what);
  size_t v = 0;
  const auto r = std::from_chars(w.data(), w.data() + w.size(), v);
  if (r.ec != std::errc{} || r.ptr != w.data() + w.size())
    fail(fmt::format("found '{}' instead of {}", w.substr(0, 40), what), "it must be a non-negative whole number");
  return v;
}

const std::byte* LegacyText::take(uint64_t bytes, std::string_view what) {
  if (bytes > all_.size() - at_)
    fail(fmt::format("{} needs {} bytes but the file has only {} more", what, bytes, all_.size() - at_),
         "the file is truncated or the count is wrong");
  const std::byte* p = file_.data() + at_;
  at_ += bytes;
  return p;
}

Array LegacyText::text_array(ElementType type, size_t tuples, size_t components, std::string_view what) {
  // A number takes a character and a blank, so larger counts are rejected before memory is allocated.
  const size_t rest = all_.size() - at_;
  size_t n = 0;
  if (__builtin_mul_overflow(tuples, components, &n) || n > (rest + 1) / 2)
    fail(fmt::format("{} has {} x {} numbers but the file has only {} more bytes", what, tuples, components, rest),
         "the file is truncated or the count is wrong");
  std::byte* out = nullptr;
  Array a = Array::make_raw(type, tuples, int(components), &out);
  const NumbersEnd end = parse_numbers(all_.substr(at_), type, n, out);
  if (end.parsed < n) {
    if (!end.bad) {
      at_ = all_.size();
      fail(fmt::format("{}: the file ends after {} of {} numbers", what, end.parsed, n), "the file is truncated");
    }
    at_ = size_t(end.bad - all_.data());
    fail(fmt::format("{}: '{}' is not a valid {} number ({} of {})", what, peek().substr(0, 40), element_name(type), end.parsed + 1, n));
  }
  if (end.next) at_ = size_t(end.next - all_.data());
  return a;
}

Array LegacyText::bits(size_t tuples, size_t components, std::string_view what) {
  if (!binary) return text_array(ElementType::u8, tuples, components, what);
  uint64_t n = 0;
  if (!multiply(tuples, components, n)) fail(fmt::format("{} has {} x {} bits", what, tuples, components));
  const std::byte* from = take(n / 8 + (n % 8 != 0), what);
  uint8_t* out = nullptr;
  Array a = Array::make<uint8_t>(tuples, int(components), &out);
  for (size_t i = 0; i < n; ++i) out[i] = uint8_t(from[i / 8] >> (7 - i % 8)) & 1;
  return a;
}

ElementType LegacyText::number_type(std::string_view type_name, std::string_view what) const {
  // Ids are written as int, whatever their size in memory.
  if (equal_ignoring_case(type_name, "vtkidtype")) return binary ? ElementType::i32 : ElementType::i64;
  if (equal_ignoring_case(type_name, "bit")) return ElementType::u8;
  std::string_view plain = type_name;  // "vtktypeuint64" is "uint64"
  if (plain.size() > 7 && equal_ignoring_case(plain.substr(0, 7), "vtktype")) plain.remove_prefix(7);
  ElementType type{};
  if (!parse_element_type(plain, type))
    fail(fmt::format("{} has the unknown type '{}'", what, type_name.substr(0, 40)),
         "supported: bit, char, short, int, long, their unsigned forms, float, double, vtkIdType, vtktypeint64");
  return type;
}

Array LegacyText::array(std::string_view type_name, size_t tuples, size_t components, std::string_view what) {
  if (components == 0 || components > 1u << 20) fail(fmt::format("{} has {} components", what, components));
  const ElementType type = number_type(type_name, what);
  if (binary) line();
  Array a;
  if (equal_ignoring_case(type_name, "bit")) {
    a = bits(tuples, components, what);
  } else if (!binary) {
    a = text_array(type, tuples, components, what);
  } else {
    uint64_t n = 0, bytes = 0;
    if (!multiply(tuples, components, n) || !multiply(n, element_size(type), bytes))
      fail(fmt::format("{} has {} x {} numbers", what, tuples, components));
    const std::byte* from = take(bytes, what);
    std::byte* out = nullptr;
    a = Array::make_raw(type, tuples, int(components), &out);
    read_swapped(file_, size_t(from - file_.data()), n, element_size(type), out);
    if (equal_ignoring_case(type_name, "vtkidtype")) a = a.converted(ElementType::i64);
  }
  if (equal_ignoring_case(peek(), "METADATA")) word(), skip_metadata();
  return a;
}

ElementType LegacyText::skip_array(std::string_view type_name, size_t tuples, size_t components, std::string_view what) {
  if (components == 0 || components > 1u << 20) fail(fmt::format("{} has {} components", what, components));
  const ElementType type = number_type(type_name, what);
  const bool bit = equal_ignoring_case(type_name, "bit");
  uint64_t n = 0, bytes = 0;
  if (!multiply(tuples, components, n) || !multiply(n, element_size(type), bytes))
    fail(fmt::format("{} has {} x {} numbers", what, tuples, components));
  if (binary) {
    line();
    take(bit ? n / 8 + (n % 8 != 0) : bytes, what);
  } else {
    for (uint64_t i = 0; i < n; ++i)
      if (word().empty()) fail(fmt::format("{}: the file ends after {} of {} numbers", what, i, n), "the file is truncated");
  }
  if (equal_ignoring_case(peek(), "METADATA")) word(), skip_metadata();
  return equal_ignoring_case(type_name, "vtkidtype") ? ElementType::i64 : type;
}

const std::byte* LegacyText::in_place(std::string_view type_name, size_t n, ElementType& type) const {
  if (!binary || equal_ignoring_case(type_name, "bit")) return nullptr;
  type = number_type(type_name, "an array");
  LegacyText ahead = *this;
  ahead.line();
  uint64_t bytes = 0;
  if (!multiply(n, element_size(type), bytes) || bytes > all_.size() - ahead.at_) return nullptr;
  return file_.data() + ahead.at_;
}

void LegacyText::skip_metadata() {
  line();
  while (!at_end() && !trim(line()).empty()) {
  }
}

std::vector<std::string> LegacyText::strings(size_t n, std::string_view what) {
  line();
  if (n > all_.size() - at_)  // each takes a byte at least
    fail(fmt::format("{} has {} strings but the file has only {} more bytes", what, n, all_.size() - at_),
         "the file is truncated or the count is wrong");
  std::vector<std::string> all;
  for (size_t i = 0; i < n; ++i) {
    if (at_end()) fail(fmt::format("{}: the file ends after {} of {} strings", what, i, n), "the file is truncated");
    if (!binary) {
      all.push_back(decode_name(line()));
      continue;
    }
    // The two high bits of the first byte give the number of bytes of the length: 8, 4, 2 or 1.
    const unsigned lead = static_cast<unsigned char>(all_[at_]) >> 6;
    const size_t width = size_t(8) >> lead;
    const std::byte* p = take(width, "the length of a string");
    uint64_t length = uint64_t(p[0]) & 63;
    for (size_t k = 1; k < width; ++k) length = length << 8 | uint64_t(p[k]);
    const std::byte* from = take(length, "a string");
    all.emplace_back(reinterpret_cast<const char*>(from), length);
  }
  if (equal_ignoring_case(peek(), "METADATA")) word(), skip_metadata();
  return all;
}

std::string decode_name(std::string_view name) {
  std::string r;
  for (size_t i = 0; i < name.size(); ++i) {
    unsigned v = 0;
    if (name[i] == '%' && i + 2 < name.size()) {
      const auto e = std::from_chars(name.data() + i + 1, name.data() + i + 3, v, 16);
      if (e.ec == std::errc{} && e.ptr == name.data() + i + 3) {
        r += char(v);
        i += 2;
        continue;
      }
    }
    r += name[i];
  }
  return r;
}

}  // namespace sg::vtk
