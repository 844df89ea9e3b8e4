// SPDX-License-Identifier: Apache-2.0
#include "io/ensight/stream.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/text/text_scan.h"
#include "io/vtk/vtk_numbers.h"

namespace sg::ensight {

namespace {

constexpr size_t line_bytes = 80;
constexpr std::string_view begin_step = "BEGIN TIME STEP";

std::string_view until_zero(std::string_view s) { return trim(s.substr(0, std::min(s.find('\0'), s.size()))); }

// Fortran may drop the E before an exponent of three digits: 3.300003+000.
bool bare_exponent(const char* p, const char* end, int& exponent) {
  if (end - p < 4 || (*p != '+' && *p != '-')) return false;
  for (int i = 1; i < 4; ++i)
    if (!is_digit(p[i])) return false;
  if (end - p > 4 && !is_space(p[4])) return false;
  exponent = ((p[1] - '0') * 10 + (p[2] - '0')) * 10 + (p[3] - '0');
  if (*p == '-') exponent = -exponent;
  return true;
}

// One number in a text whose columns may touch.
bool scan_column(const char*& p, const char* end, float& v) {
  double d = 0;
  if (!scan_number(p, end, d)) return false;
  int exponent = 0;
  if (bare_exponent(p, end, exponent)) d *= std::pow(10.0, exponent), p += 4;
  v = float(d);
  return true;
}

// Integers of ten columns each: a word of more than ten characters holds several.
bool scan_column(const char*& p, const char* end, int32_t& v) {
  const auto length = size_t(skip_word(p, end) - p);
  const char* stop = p + (length > 10 ? (length % 10 ? length % 10 : 10) : length);
  const auto r = std::from_chars(p, stop, v);
  if (r.ec != std::errc() || r.ptr != stop) return false;
  p = stop;
  return true;
}

}  // namespace

Form Stream::form_of(const MappedFile& file) {
  const std::string_view t = file.text();
  if (to_lower(t.substr(0, 80)).starts_with("c binary")) return Form::c_binary;
  for (const bool big : {false, true})
    if (t.size() >= 84 && load<uint32_t>(t.data(), big) == line_bytes && to_lower(t.substr(4, 80)).starts_with("fortran binary"))
      return Form::fortran_binary;
  return Form::ascii;
}

Stream::Stream(MappedFile file, Form form) : path_(file.path()), file_(std::move(file)), form_(form), all_(file_.text()) {
  if (form_ == Form::fortran_binary) unframe();
}

void Stream::fail(const std::string& problem, const std::string& hint) const {
  const std::string where = form_ == Form::ascii ? fmt::format("line {}", line_number(all_, at_)) : fmt::format("byte {}", at_);
  fail_data(where + ": " + problem, path_, hint);
}

// Copies what is between the record markers, so that the rest is read like C binary.
void Stream::unframe() {
  const std::string_view t = file_.text();
  if (t.size() < 4) fail_data("is too short for Fortran records", path_);
  big_endian_ = load<uint32_t>(t.data()) != line_bytes && load<uint32_t>(t.data(), true) == line_bytes;
  order_known_ = true;
  std::byte* out = nullptr;
  unframed_ = Buffer::allocate(t.size(), &out);
  size_t at = 0, used = 0;
  while (at < t.size()) {
    if (t.size() - at < 8) fail_data(fmt::format("byte {}: a Fortran record is cut off", at), path_);
    const uint64_t n = load<uint32_t>(t.data() + at, big_endian_);
    if (n > t.size() - at - 8 || load<uint32_t>(t.data() + at + 4 + n, big_endian_) != n)
      fail_data(fmt::format("byte {}: a Fortran record of {} bytes does not end with that length", at, n), path_);
    std::memcpy(out + used, t.data() + at + 4, n);
    used += n, at += n + 8;
  }
  all_ = {reinterpret_cast<const char*>(out), used};
}

void Stream::seek_step(int64_t k) {
  at_ = 0;
  size_t at = 0;
  for (int64_t i = 0;; ++i) {
    const void* found = at < all_.size() ? ::memmem(all_.data() + at, all_.size() - at, begin_step.data(), begin_step.size()) : nullptr;
    if (!found) fail(fmt::format("there is no time step {}", k), fmt::format("it has {} markers '{}'", i, begin_step));
    at = size_t(static_cast<const char*>(found) - all_.data());
    if (i == k) break;
    at += begin_step.size();
  }
  at_ = at;
  keyword("BEGIN TIME STEP");
}

bool Stream::at_end() {
  if (form_ != Form::ascii) return at_ >= all_.size();
  while (at_ < all_.size() && is_space(all_[at_])) ++at_;
  return at_ >= all_.size();
}

std::string Stream::line(std::string_view what) {
  if (form_ != Form::ascii) return std::string(until_zero({take(line_bytes, what), line_bytes}));
  if (at_ >= all_.size()) fail(fmt::format("ends where {} was expected", what));
  const size_t end = std::min(all_.find('\n', at_), all_.size());
  const std::string_view s = trim(all_.substr(at_, end - at_));
  at_ = std::min(end + 1, all_.size());
  return std::string(s);
}

std::string Stream::peek() {
  const size_t at = at_;
  if (at_end() || (form_ != Form::ascii && all_.size() - at_ < line_bytes)) return at_ = at, std::string();
  std::string s = line("a line");
  at_ = at;
  return s;
}

std::string Stream::keyword(std::string_view what) {
  at_end();  // skips empty lines
  return line(what);
}

const char* Stream::take(size_t n, std::string_view what) {
  if (n > all_.size() - at_)
    fail(fmt::format("ends where {} was expected: {} bytes are needed, but there are {}", what, n, all_.size() - at_));
  at_ += n;
  return all_.data() + at_ - n;
}

// The first integer of a file is the number of a part: small in the right byte order.
void Stream::guess_order(const char* p) {
  if (order_known_) return;
  big_endian_ = load<uint32_t>(p, true) < load<uint32_t>(p);
  order_known_ = true;
}

void Stream::need_text(size_t n, std::string_view what) const {
  if (n > (all_.size() - at_) / 2 + 1) fail(fmt::format("ends before {}: {} numbers are needed", what, n));
}

void Stream::end_line() {
  const char* const end = all_.data() + all_.size();
  const char* p = skip_blanks(all_.data() + at_, end);
  if (p < end && *p == '\n') at_ = size_t(p + 1 - all_.data());
}

template <class T>
void Stream::read_text(size_t n, T* out, std::string_view what) {
  const vtk::NumbersEnd e = vtk::parse_numbers(all_.substr(at_), element_type_of<T>(), n, reinterpret_cast<std::byte*>(out));
  const char* const end = all_.data() + all_.size();
  const char* p = e.bad ? e.bad : e.next ? e.next : all_.data() + at_;
  for (size_t i = e.parsed; i < n; ++i) {
    while (p < end && is_space(*p)) ++p;
    const char* word = p;
    if (!scan_column(p, end, out[i])) {
      at_ = size_t(word - all_.data());
      fail(word == end ? fmt::format("ends within {}: number {} of {}", what, i, n)
                       : fmt::format("'{}' is not a number ({}, {} of {})",
                                     std::string_view(word, std::min<size_t>(30, size_t(skip_word(word, end) - word))), what, i, n));
    }
  }
  at_ = size_t(p - all_.data());
  end_line();
}

int32_t Stream::integer(std::string_view what) { return integers(1, what)[0]; }

size_t Stream::count(std::string_view what, size_t bytes) {
  const size_t at = at_;
  const int64_t n = integer(what);
  // ASCII numbers take at least two characters each.
  const size_t least = form_ == Form::ascii ? std::max<size_t>(bytes / 2, 1) : bytes;
  if (n < 0 || uint64_t(n) > (all_.size() - at_ + 1) / std::max<size_t>(least, 1)) {
    const size_t left = all_.size() - at_;
    at_ = at;
    fail(fmt::format("{} of {} do not fit the {} bytes left", what, n, left));
  }
  return size_t(n);
}

std::vector<int32_t> Stream::integers(size_t n, std::string_view what) {
  if (form_ == Form::ascii) {
    need_text(n, what);
    std::vector<int32_t> v(n);
    read_text(n, v.data(), what);
    return v;
  }
  uint64_t bytes = 0;
  if (!multiply(n, 4, bytes)) fail(fmt::format("{} numbers of {}", n, what));
  const char* p = take(bytes, what);
  if (n == 0) return {};
  guess_order(p);
  std::vector<int32_t> v(n);
  std::memcpy(v.data(), p, bytes);
  if (big_endian_) swap_bytes(v.data(), n, 4);
  return v;
}

Array Stream::reals(size_t n, std::string_view what) {
  float* out = nullptr;
  if (form_ == Form::ascii) {
    need_text(n, what);
    Array a = Array::make<float>(n, 1, &out);
    read_text(n, out, what);
    return a;
  }
  uint64_t bytes = 0;
  if (!multiply(n, 4, bytes)) fail(fmt::format("{} numbers of {}", n, what));
  const char* p = take(bytes, what);
  if (!big_endian_ && reinterpret_cast<uintptr_t>(p) % 4 == 0) {
    const auto owner = form_ == Form::fortran_binary ? unframed_.owner : file_.owner();
    return Array({owner, reinterpret_cast<const std::byte*>(p), bytes}, ElementType::f32, n);
  }
  Array a = Array::make<float>(n, 1, &out);
  if (big_endian_) swap_bytes_copy(out, p, n, 4);
  else std::memcpy(out, p, bytes);
  return a;
}

void Stream::skip_numbers(size_t n, std::string_view what) {
  uint64_t bytes = 0;
  if (form_ == Form::ascii) reals(n, what);
  else if (!multiply(n, 4, bytes)) fail(fmt::format("{} numbers of {}", n, what));
  else take(bytes, what);
}

}  // namespace sg::ensight
