// SPDX-License-Identifier: Apache-2.0
#include "io/surface/ply_body.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/text/text_scan.h"

namespace sg {

PlyHeader parse_ply_header(const MappedFile& file) {
  PlyHeader h;
  h.path = file.path();
  const char *base = reinterpret_cast<const char*>(file.data()), *p = base, *end = base + file.size();
  size_t number = 0;
  bool has_format = false;
  auto fail = [&](const std::string& what, const std::string& hint = {}) {
    fail_data(fmt::format("line {}: {}", number, what), h.path, hint);
  };
  auto type_of = [&](std::string_view name) {
    ElementType t = ElementType::f32;
    if (!parse_element_type(name, t)) fail(fmt::format("unknown type '{}'", name), "char uchar short ushort int uint float double");
    return t;
  };
  while (p < end) {
    const char* e = line_end(p, end);
    ++number;
    if (e - p > 65536) fail("the line is longer than 64 KiB");
    const std::string_view line = trim({p, size_t(e - p)});
    p = e < end ? e + 1 : end;
    const auto w = words(line);
    if (number == 1) {
      if (w.size() != 1 || w[0] != "ply") fail("the file does not begin with 'ply'");
      continue;
    }
    if (w.empty()) continue;
    if (w[0] == "end_header") {
      if (!has_format) fail("the header has no 'format'");
      h.body = size_t(p - base);
      return h;
    }
    if (w[0] == "comment" || w[0] == "obj_info") {
      h.notes.emplace_back(std::string(w[0]), std::string(trim(line.substr(w[0].size()))));
    } else if (w[0] == "format") {
      const std::string_view f = w.size() > 1 ? w[1] : std::string_view();
      if (f == "ascii") h.encoding = PlyHeader::Encoding::ascii;
      else if (f == "binary_little_endian") h.encoding = PlyHeader::Encoding::little;
      else if (f == "binary_big_endian") h.encoding = PlyHeader::Encoding::big;
      else fail(fmt::format("unknown format '{}'", f), "use ascii, binary_little_endian or binary_big_endian");
      has_format = true;
    } else if (w[0] == "element") {
      const auto n = w.size() == 3 ? parse_int(w[2]) : std::nullopt;
      if (!n || *n < 0) fail(fmt::format("'{}' is not of the form 'element NAME COUNT'", line));
      h.elements.push_back({std::string(w[1]), size_t(*n), {}, -1, {}});
    } else if (w[0] == "property") {
      if (h.elements.empty()) fail("a property precedes the first element");
      PlyProperty q;
      if (w.size() == 5 && w[1] == "list") {
        q.list = true;
        q.count_type = type_of(w[2]);
        if (is_float(q.count_type)) fail("the length of a list cannot be a float");
        q.type = type_of(w[3]);
        q.name = w[4];
      } else if (w.size() == 3) {
        q.type = type_of(w[1]);
        q.name = w[2];
      } else {
        fail(fmt::format("'{}' is not of the form 'property TYPE NAME' or 'property list TYPE TYPE NAME'", line));
      }
      h.elements.back().properties.push_back(std::move(q));
    } else {
      fail(fmt::format("unknown keyword '{}' in the header", w[0].substr(0, 40)));
    }
  }
  fail_data("the file ends inside its header", h.path, "a PLY header ends with 'end_header'");
}

void check_ply_counts(const MappedFile& file, const PlyHeader& h) {
  uint64_t least = 0;
  for (const PlyElement& e : h.elements) {
    uint64_t row = 0, all = 0;
    for (const PlyProperty& p : e.properties)
      row += h.encoding == PlyHeader::Encoding::ascii ? 2 : element_size(p.list ? p.count_type : p.type);
    if (!multiply(row, e.count, all) || !add(least, all, least) || least > file.size() - h.body + 1)
      fail_data(fmt::format("{} {} rows do not fit into the {} bytes after the header", e.count, e.name, file.size() - h.body), h.path,
                "the file is truncated or its counts are wrong");
  }
}

namespace {

template <class F>
decltype(auto) with_type(ElementType t, F&& f) {
  switch (t) {
    case ElementType::u8: return f(uint8_t());
    case ElementType::i8: return f(int8_t());
    case ElementType::u16: return f(uint16_t());
    case ElementType::i16: return f(int16_t());
    case ElementType::u32: return f(uint32_t());
    case ElementType::i32: return f(int32_t());
    case ElementType::u64: return f(uint64_t());
    case ElementType::i64: return f(int64_t());
    case ElementType::f32: return f(float());
    default: return f(double());
  }
}

double load_double(const std::byte* p, ElementType t, bool big) {
  return with_type(t, [&](auto zero) { return double(load<decltype(zero)>(p, big)); });
}
int64_t load_index(const std::byte* p, ElementType t, bool big) {
  return with_type(t, [&](auto zero) -> int64_t {
    using T = decltype(zero);
    const T v = load<T>(p, big);
    if constexpr (std::is_floating_point_v<T>) return v >= T(-1e18) && v <= T(1e18) ? int64_t(v) : -1;
    else return int64_t(v);
  });
}
// An id that does not fit into 32 bits becomes -1, which make_dataset refuses.
int32_t narrow(int64_t v) { return v >= INT32_MIN && v <= INT32_MAX ? int32_t(v) : -1; }

void store_double(std::byte* out, ElementType t, double v) {
  with_type(t, [&](auto zero) {
    using T = decltype(zero);
    T x{};
    if constexpr (std::is_floating_point_v<T>) x = T(v);
    else if (v == v)
      x = v <= double(std::numeric_limits<T>::min())   ? std::numeric_limits<T>::min()
          : v >= double(std::numeric_limits<T>::max()) ? std::numeric_limits<T>::max()
                                                       : T(v);
    std::memcpy(out, &x, sizeof x);
  });
}

template <class T>
void copy_typed(const std::byte* in, size_t in_stride, std::byte* out, size_t out_stride, size_t n, bool big) {
  if (big) {
    for (size_t i = 0; i < n; ++i) {
      const T v = load<T>(in + i * in_stride, true);
      std::memcpy(out + i * out_stride, &v, sizeof(T));
    }
  } else {
    for (size_t i = 0; i < n; ++i) std::memcpy(out + i * out_stride, in + i * in_stride, sizeof(T));
  }
}

// n values of one property.
void copy_column(const PlyProperty& p, const std::byte* in, size_t in_stride, std::byte* out, size_t n, bool big) {
  if (p.type == p.out_type) {
    switch (element_size(p.type)) {
      case 1: return copy_typed<uint8_t>(in, in_stride, out, p.out_stride, n, false);
      case 2: return copy_typed<uint16_t>(in, in_stride, out, p.out_stride, n, big);
      case 4: return copy_typed<uint32_t>(in, in_stride, out, p.out_stride, n, big);
      default: return copy_typed<uint64_t>(in, in_stride, out, p.out_stride, n, big);
    }
  }
  for (size_t i = 0; i < n; ++i) store_double(out + i * p.out_stride, p.out_type, load_double(in + i * in_stride, p.type, big));
}

void copy_ids(const PlyProperty& p, const std::byte* in, int32_t* out, size_t n, bool big) {
  if (!big && (p.type == ElementType::i32 || p.type == ElementType::u32)) {
    std::memcpy(out, in, n * 4);
    return;
  }
  const size_t size = element_size(p.type);
  for (size_t i = 0; i < n; ++i) out[i] = narrow(load_index(in + i * size, p.type, big));
}

constexpr size_t rows_per_chunk = 16384;

[[noreturn]] void cut_off(const PlyHeader& h, const PlyElement& e, size_t row) {
  fail_data(fmt::format("the file ends in {} {} of {}", e.name, row, e.count), h.path);
}

// Rows of equal length: all lists of a property have as many entries as in row 0. Returns the bytes of a row, or 0 when the
// rows differ. `at` and `entries` get the place of each property in a row and the entries of each list.
size_t uniform_row(const PlyElement& e, const std::byte* p, size_t room, bool big, std::vector<size_t>& at, std::vector<size_t>& entries) {
  uint64_t row = 0;
  at.clear(), entries.clear();
  for (const PlyProperty& q : e.properties) {
    at.push_back(row);
    size_t n = 1;
    if (q.list) {
      const size_t c = element_size(q.count_type);
      if (room - row < c) return 0;
      const int64_t have = load_index(p + row, q.count_type, big);
      if (have < 0 || uint64_t(have) > room || have > INT32_MAX) return 0;
      n = size_t(have);
      row += c;
    }
    entries.push_back(n);
    row += n * element_size(q.type);
    if (row > room) return 0;
  }
  uint64_t all = 0;
  if (row == 0 || !multiply(row, e.count, all) || all > room) return 0;
  for (size_t k = 0; k < e.properties.size(); ++k) {
    const PlyProperty& q = e.properties[k];
    if (!q.list) continue;
    const bool same = parallel_reduce(
        e.count, rows_per_chunk, true,
        [&](size_t begin, size_t end) {
          bool ok = true;
          if (q.count_type == ElementType::u8 || q.count_type == ElementType::i8) {
            const auto want = std::byte(entries[k]);
            for (size_t i = begin; i < end; ++i) ok &= p[i * row + at[k]] == want;
          } else {
            for (size_t i = begin; i < end && ok; ++i) ok = load_index(p + i * row + at[k], q.count_type, big) == int64_t(entries[k]);
          }
          return ok;
        },
        [](bool a, bool b) { return a && b; });
    if (!same) return 0;
  }
  return row;
}

Array make_offsets(std::vector<size_t>& lengths, size_t& total) {
  // lengths has one entry more than there are rows, the last one 0.
  total = exclusive_scan(lengths);
  auto copy = [&](auto zero) {
    using T = decltype(zero);
    T* out = nullptr;
    Array a = Array::make<T>(lengths.size(), 1, &out);
    parallel_for(lengths.size(), 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) out[i] = T(lengths[i]);
    });
    return a;
  };
  return total <= size_t(INT32_MAX) ? copy(int32_t()) : copy(int64_t());
}

// One element of a binary file; returns the byte behind it.
size_t decode_binary(const MappedFile& file, const PlyHeader& h, PlyElement& e, size_t begin, Context& context) {
  const bool big = h.encoding == PlyHeader::Encoding::big;
  const std::byte* base = file.data() + begin;
  const size_t room = file.size() - begin;
  if (e.count == 0 || e.properties.empty()) return begin;
  std::vector<size_t> at, entries;
  size_t row = uniform_row(e, base, room, big, at, entries);
  if (row > 0 && e.wanted_list >= 0 && entries[size_t(e.wanted_list)] == 0) row = 0;  // cells without points need offsets
  if (row > 0) {
    const bool lists = e.wanted_list >= 0;
    const auto l = size_t(std::max(e.wanted_list, 0));
    const size_t n = lists ? entries[l] : 0;
    int32_t* ids = nullptr;
    if (lists) {
      e.lists.ids = Array::make<int32_t>(e.count * n, 1, &ids);
      e.lists.fixed = int(n);
    }
    parallel_for(
        e.count, rows_per_chunk,
        [&](size_t first, size_t last) {
          for (size_t k = 0; k < e.properties.size(); ++k)
            if (const PlyProperty& p = e.properties[k]; p.out)
              copy_column(p, base + first * row + at[k], row, p.out + first * p.out_stride, last - first, big);
          if (!lists) return;
          const PlyProperty& p = e.properties[l];
          const std::byte* in = base + at[l] + element_size(p.count_type);
          if (n == 3 && !big && element_size(p.type) == 4 && !is_float(p.type)) {
            for (size_t i = first; i < last; ++i) std::memcpy(ids + i * 3, in + i * row, 12);
          } else {
            for (size_t i = first; i < last; ++i) copy_ids(p, in + i * row, ids + i * n, n, big);
          }
        },
        &context);
    return begin + row * e.count;
  }
  // Rows of different lengths: one serial walk finds where each begins.
  std::vector<size_t> starts(e.count + 1), lengths(e.count + 1, 0);
  size_t p = 0;
  for (size_t i = 0; i < e.count; ++i) {
    starts[i] = p;
    for (size_t k = 0; k < e.properties.size(); ++k) {
      const PlyProperty& q = e.properties[k];
      size_t bytes = element_size(q.type);
      if (q.list) {
        const size_t c = element_size(q.count_type);
        if (room - p < c) cut_off(h, e, i);
        const int64_t n = load_index(base + p, q.count_type, big);
        if (n < 0) fail_data(fmt::format("{} {} has a list of {} entries", e.name, i, n), h.path);
        p += c;
        if (uint64_t(n) > room) cut_off(h, e, i);
        bytes *= size_t(n);
        if (int(k) == e.wanted_list) lengths[i] = size_t(n);
      }
      if (room - p < bytes) cut_off(h, e, i);
      p += bytes;
    }
  }
  starts[e.count] = p;
  int32_t* ids = nullptr;
  if (e.wanted_list >= 0) {
    size_t total = 0;
    e.lists.offsets = make_offsets(lengths, total);
    e.lists.ids = Array::make<int32_t>(total, 1, &ids);
  }
  parallel_for(
      e.count, rows_per_chunk,
      [&](size_t first, size_t last) {
        for (size_t i = first; i < last; ++i) {
          const std::byte* in = base + starts[i];
          for (size_t k = 0; k < e.properties.size(); ++k) {
            const PlyProperty& q = e.properties[k];
            size_t n = 1;
            if (q.list) n = size_t(load_index(in, q.count_type, big)), in += element_size(q.count_type);
            if (q.out) copy_column(q, in, 0, q.out + i * q.out_stride, 1, big);
            if (int(k) == e.wanted_list) copy_ids(q, in, ids + lengths[i], n, big);
            in += n * element_size(q.type);
          }
        }
      },
      &context);
  return begin + p;
}

// Scans one number of an ASCII row; false at the end of the line or at something that is not a number.
template <class T>
bool next_number(const char*& p, const char* end, T& v) {
  p = skip_blanks(p, end);
  if constexpr (std::is_same_v<T, int64_t>) {
    const char* q = p;
    if (scan_number(q, end, v) && (q == end || is_blank(*q))) return p = q, true;
    double d = 0;  // "3.0"
    if (!scan_number(p, end, d) || !(std::abs(d) < 1e18)) return false;
    v = int64_t(d);
  } else {
    if (!scan_number(p, end, v)) return false;
  }
  return p == end || is_blank(*p);
}

// Rows of one chunk of lines: lists are kept here until all lengths are known.
struct AsciiRows {
  std::vector<std::vector<int32_t>> ids;  ///< per element
};

struct AsciiReader {
  const PlyHeader& h;
  std::string_view text;                     ///< the whole file
  std::vector<size_t> first_row;             ///< line (blank ones not counted) at which each element begins
  std::vector<std::vector<size_t>> lengths;  ///< per element and row, where lists are wanted

  [[noreturn]] void fail(const char* at, const std::string& what) const {
    fail_data(fmt::format("line {}: {}", line_number(text, size_t(at - text.data())), what), h.path);
  }

  void row(size_t element, size_t i, const char* p, const char* end, AsciiRows& out) {
    const char* begin = p;
    const PlyElement& e = h.elements[element];
    for (size_t k = 0; k < e.properties.size(); ++k) {
      const PlyProperty& q = e.properties[k];
      if (q.list) {
        int64_t n = 0;
        if (!next_number(p, end, n) || n < 0) fail(begin, fmt::format("{} {}: the list '{}' has no length", e.name, i, q.name));
        if (n > end - p) fail(begin, fmt::format("{} {}: the list '{}' announces {} entries", e.name, i, q.name, n));
        const bool wanted = int(k) == e.wanted_list;
        if (wanted) lengths[element][i] = size_t(n);
        for (int64_t j = 0; j < n; ++j) {
          int64_t v = 0;
          double d = 0;
          if (wanted ? !next_number(p, end, v) : !next_number(p, end, d))
            fail(begin, fmt::format("{} {}: the list '{}' does not have the {} numbers it announces", e.name, i, q.name, n));
          if (wanted) out.ids[element].push_back(narrow(v));
        }
      } else if (q.out && q.out_type == ElementType::f32) {
        float v = 0;
        if (!next_number(p, end, v)) fail(begin, fmt::format("{} {}: '{}' has no number", e.name, i, q.name));
        std::memcpy(q.out + i * q.out_stride, &v, 4);
      } else {
        double v = 0;
        if (!next_number(p, end, v)) fail(begin, fmt::format("{} {}: '{}' has no number", e.name, i, q.name));
        if (q.out) store_double(q.out + i * q.out_stride, q.out_type, v);
      }
    }
  }
};

void decode_ascii(const MappedFile& file, PlyHeader& h, size_t elements, Context& context) {
  const std::string_view text = file.text(), body = text.substr(h.body);
  const std::vector<size_t> borders = text_chunks(body, 1 << 17);
  const size_t chunks = borders.size() - 1;
  auto for_lines = [&](size_t c, auto&& f) {
    const char *p = body.data() + borders[c], *end = body.data() + borders[c + 1];
    while (p < end) {
      const char* e = line_end(p, end);
      if (skip_blanks(p, e) < e) f(p, e);
      p = e < end ? e + 1 : end;
    }
  };
  std::vector<size_t> first_line(chunks);
  parallel_for(
      chunks, 1,
      [&](size_t c, size_t) {
        size_t n = 0;
        for_lines(c, [&](const char*, const char*) { ++n; });
        first_line[c] = n;
      },
      &context);
  const size_t lines = exclusive_scan(first_line);
  AsciiReader r{h, text, {}, std::vector<std::vector<size_t>>(elements)};
  size_t rows = 0;
  for (size_t e = 0; e < elements; ++e) {
    r.first_row.push_back(rows);
    const PlyElement& element = h.elements[e];
    if (!element.properties.empty()) rows += element.count;
    if (rows > lines)
      fail_data(fmt::format("{} lines of numbers follow the header, but at least {} are announced", lines, rows), h.path,
                "the file is truncated or its counts are wrong");
    if (element.wanted_list >= 0) r.lengths[e].assign(element.count + 1, 0);
  }
  r.first_row.push_back(rows);
  std::vector<AsciiRows> parts(chunks);
  parallel_for(
      chunks, 1,
      [&](size_t c, size_t) {
        parts[c].ids.resize(elements);
        size_t line = first_line[c], e = 0;
        for_lines(c, [&](const char* p, const char* end) {
          if (line >= rows) return;
          while (line >= r.first_row[e + 1]) ++e;
          r.row(e, line - r.first_row[e], p, end, parts[c]);
          ++line;
        });
      },
      &context);
  for (size_t e = 0; e < elements; ++e) {
    PlyElement& element = h.elements[e];
    if (element.wanted_list < 0) continue;
    std::vector<size_t> at(chunks);
    for (size_t c = 0; c < chunks; ++c) at[c] = parts[c].ids[e].size();
    int32_t* ids = nullptr;
    element.lists.ids = Array::make<int32_t>(exclusive_scan(at), 1, &ids);
    parallel_for(chunks, 1, [&](size_t c, size_t) {
      if (!parts[c].ids[e].empty()) std::memcpy(ids + at[c], parts[c].ids[e].data(), parts[c].ids[e].size() * 4);
    });
    const std::vector<size_t>& n = r.lengths[e];
    if (element.count > 0 && n[0] > 0 && std::all_of(n.begin(), n.end() - 1, [&](size_t v) { return v == n[0]; })) {
      element.lists.fixed = int(n[0]);
    } else {
      size_t total = 0;
      element.lists.offsets = make_offsets(r.lengths[e], total);
    }
  }
}

}  // namespace

void decode_ply(const MappedFile& file, PlyHeader& h, Context& context) {
  size_t elements = 0;
  for (size_t e = 0; e < h.elements.size(); ++e) {
    bool wanted = h.elements[e].wanted_list >= 0;
    for (const PlyProperty& p : h.elements[e].properties) wanted = wanted || p.out;
    if (wanted) elements = e + 1;
  }
  if (h.encoding == PlyHeader::Encoding::ascii) return decode_ascii(file, h, elements, context);
  size_t at = h.body;
  for (size_t e = 0; e < elements; ++e) at = decode_binary(file, h, h.elements[e], at, context);
}

}  // namespace sg
