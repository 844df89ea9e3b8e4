// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/bytes.h"
#include "base/parallel.h"

namespace sg::vtk {

namespace {

constexpr size_t chunk_bytes = size_t(1) << 18;
constexpr size_t chunks_per_window = 64;

// Words that start in [begin, end) of the text.
size_t word_starts(std::string_view text, size_t begin, size_t end) {
  size_t n = 0;
  if (begin == 0 && end > 0) n = !blank(text[begin++]);
  // Sums of up to 128 neighbours fit a byte, which lets the compiler compare 16 or more characters at once.
  for (size_t i = begin; i < end;) {
    const char* p = text.data() + i;
    const size_t m = std::min<size_t>(end - i, 128);
    uint8_t starts = 0;
    for (size_t j = 0; j < m; ++j) starts = uint8_t(starts + uint8_t(blank(p[ptrdiff_t(j) - 1]) & !blank(p[j])));
    n += starts;
    i += m;
  }
  return n;
}

// What from_chars refuses: a plus sign, values that under- or overflow, Windows' names of infinities and NaN.
bool parse_odd_float(std::string_view word, double& v) {
  bool negative = false;
  if (!word.empty() && (word[0] == '+' || word[0] == '-')) {
    negative = word[0] == '-';
    word.remove_prefix(1);
  }
  if (word.empty() || word[0] == '+' || word[0] == '-') return false;
  if (word.starts_with("1.#")) {
    v = word.starts_with("1.#INF") ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
  } else {
    const auto r = std::from_chars(word.data(), word.data() + word.size(), v);
    if (r.ptr != word.data() + word.size()) return false;
    if (r.ec == std::errc::result_out_of_range) {
      v = std::strtod(std::string(word).c_str(), nullptr);
    } else if (r.ec != std::errc{}) {
      return false;
    }
  }
  if (negative) v = -v;
  return true;
}

// "3." or "3e0" where a whole number is expected.
template <class T>
bool parse_odd_integer(std::string_view word, T& out) {
  if (!word.empty() && word[0] == '+') {
    const auto r = std::from_chars(word.data() + 1, word.data() + word.size(), out);
    if (r.ec == std::errc{} && r.ptr == word.data() + word.size()) return true;
  }
  double v = 0;
  if (!parse_odd_float(word, v) || v != std::floor(v)) return false;
  constexpr double limit = double(std::numeric_limits<T>::max() / 2 + 1) * 2;  // the first value that does not fit, exact
  if (v < double(std::numeric_limits<T>::min()) || v >= limit) return false;
  out = T(v);
  return true;
}

template <class T>
bool parse_word(const char* p, const char* end, T& out, const char** next) {
  const auto r = std::from_chars(p, end, out);
  if (r.ec == std::errc{} && (r.ptr == end || blank(*r.ptr))) {
    *next = r.ptr;
    return true;
  }
  const char* stop = p;
  while (stop < end && !blank(*stop)) ++stop;
  *next = stop;
  const std::string_view word(p, size_t(stop - p));
  if constexpr (std::is_floating_point_v<T>) {
    double v = 0;
    if (!parse_odd_float(word, v)) return false;
    out = T(v);
    return true;
  } else {
    return parse_odd_integer(word, out);
  }
}

// Reads n words from p on.
template <class T>
NumbersEnd parse_run(const char* p, const char* end, size_t n, T* out) {
  for (size_t i = 0; i < n; ++i) {
    while (p < end && blank(*p)) ++p;
    if (p == end) return {i, p, nullptr};
    const char* next = nullptr;
    if (!parse_word(p, end, out[i], &next)) return {i, p, p};
    p = next;
  }
  return {n, p, nullptr};
}

template <class T>
NumbersEnd parse_typed(std::string_view text, size_t count, T* out) {
  const char* const end = text.data() + text.size();
  if (count < 4096) return parse_run(text.data(), end, count, out);
  size_t done = 0, at = 0;
  // Windows keep the counting pass near the numbers that are wanted: the text may hold many more arrays.
  while (done < count && at < text.size()) {
    const size_t guess = std::max(chunk_bytes, (count - done) * 12);
    const size_t window = std::min({text.size() - at, chunks_per_window * chunk_bytes, guess});
    const size_t chunks = (window + chunk_bytes - 1) / chunk_bytes;
    auto limit = [&](size_t chunk) { return at + std::min(window, chunk * chunk_bytes); };
    std::vector<size_t> first(chunks);
    parallel_for(chunks, 1, [&](size_t c, size_t) { first[c] = word_starts(text, limit(c), limit(c + 1)); });
    const size_t words = exclusive_scan(first);
    const size_t take = std::min(words, count - done);
    std::vector<NumbersEnd> ends(chunks);
    parallel_for(chunks, 1, [&](size_t c, size_t) {
      if (first[c] >= take) return;
      size_t p = limit(c);  // skip the tail of a word that started in the chunk before
      if (p > 0 && !blank(text[p - 1]))
        while (p < text.size() && !blank(text[p])) ++p;
      const size_t n = (c + 1 < chunks ? std::min(first[c + 1], take) : take) - first[c];
      ends[c] = parse_run(text.data() + p, end, n, out + done + first[c]);
    });
    const char* last = text.data() + limit(chunks);
    for (size_t c = 0; c < chunks && first[c] < take; ++c) {
      if (ends[c].bad) return {done + first[c] + ends[c].parsed, ends[c].bad, ends[c].bad};
      if (ends[c].next) last = ends[c].next;
    }
    done += take;
    if (done == count) return {count, last, nullptr};
    at = limit(chunks);
  }
  return {done, end, nullptr};
}

template <class T>
void append_number(std::string& s, T v) {
  char b[40];
  s.append(b, size_t(std::to_chars(b, b + sizeof b, v).ptr - b));
}

}  // namespace

NumbersEnd parse_numbers(std::string_view text, ElementType type, size_t count, std::byte* out) {
  switch (type) {
    case ElementType::u8: return parse_typed(text, count, reinterpret_cast<uint8_t*>(out));
    case ElementType::i8: return parse_typed(text, count, reinterpret_cast<int8_t*>(out));
    case ElementType::u16: return parse_typed(text, count, reinterpret_cast<uint16_t*>(out));
    case ElementType::i16: return parse_typed(text, count, reinterpret_cast<int16_t*>(out));
    case ElementType::u32: return parse_typed(text, count, reinterpret_cast<uint32_t*>(out));
    case ElementType::i32: return parse_typed(text, count, reinterpret_cast<int32_t*>(out));
    case ElementType::u64: return parse_typed(text, count, reinterpret_cast<uint64_t*>(out));
    case ElementType::i64: return parse_typed(text, count, reinterpret_cast<int64_t*>(out));
    case ElementType::f32: return parse_typed(text, count, reinterpret_cast<float*>(out));
    case ElementType::f64: return parse_typed(text, count, reinterpret_cast<double*>(out));
  }
  fail_internal("parse_numbers: unknown element type");
}

size_t count_words(std::string_view text) {
  return parallel_reduce(
      text.size(), chunk_bytes, size_t(0), [&](size_t begin, size_t end) { return word_starts(text, begin, end); },
      [](size_t a, size_t b) { return a + b; });
}

std::string format_numbers(const Array& a, size_t per_line) {
  const size_t n = a.count() * size_t(a.components());
  const size_t grain = std::max<size_t>(per_line, 1) * 4096;
  std::vector<std::string> parts((n + grain - 1) / grain);
  dispatch(a, [&](auto v) {
    parallel_for(n, grain, [&](size_t begin, size_t end) {
      std::string s;
      s.reserve((end - begin) * 12);
      for (size_t i = begin; i < end; ++i) {
        append_number(s, v.data[i]);
        s += (i + 1) % per_line == 0 || i + 1 == n ? '\n' : ' ';
      }
      parts[begin / grain] = std::move(s);
    });
  });
  std::string text;
  for (const std::string& s : parts) text += s;
  return text;
}

void read_swapped(const MappedFile& file, size_t offset, size_t n, size_t size, std::byte* out) {
  parallel_for(n, (size_t(1) << 19) / size, [&](size_t begin, size_t end) {
    file.copy_to(out + begin * size, offset + begin * size, (end - begin) * size);
    swap_bytes(out + begin * size, end - begin, size);
  });
}

}  // namespace sg::vtk
