// SPDX-License-Identifier: Apache-2.0
#include "io/openfoam/foam_file.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/bytes/inflate.h"
#include "io/text/number_text.h"
#include "io/text/text_scan.h"

namespace sg::openfoam {

namespace {

bool is_punctuation(char c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == '[' || c == ']' || c == ';'; }

// Numbers of one element of a List<type>; 0 for a type that is not written as bytes.
int components_of(std::string_view type) {
  if (type == "scalar" || type == "sphericalTensor" || type == "label") return 1;
  if (type == "vector") return 3;
  if (type == "symmTensor") return 6;
  return type == "tensor" ? 9 : 0;
}

const char* skip_blanks_and_ends(const char* p, const char* end) {
  while (p < end && is_space(*p)) ++p;
  return p;
}

}  // namespace

std::string existing(const std::string& path) {
  if (file_exists(path) && !is_folder(path)) return path;
  return file_exists(path + ".gz") ? path + ".gz" : std::string();
}

bool FoamFile::has_header(const std::string& path) {
  try {
    FoamFile f(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

FoamFile::FoamFile(const std::string& path) : path_(existing(path)) {
  if (path_.empty()) path_ = path;
  file_ = MappedFile(path_);
  owner_ = file_.owner();
  text_ = file_.text();
  if (text_.size() > 18 && text_.starts_with("\x1f\x8b")) {
    // The last four bytes of a gzip file are the length of what was packed.
    const size_t need = load<uint32_t>(text_.data() + text_.size() - 4);
    check_ratio(Codec::gzip, text_.size(), need, path_);
    std::byte* out = nullptr;
    unpacked_ = Buffer::allocate(std::max<size_t>(need, 1), &out);
    unpack(Codec::gzip, {file_.data(), file_.size()}, {}, out, need, path_);
    owner_ = unpacked_.owner;
    text_ = {reinterpret_cast<const char*>(out), need};
  }
  read_header();
}

void FoamFile::fail(const std::string& problem, const std::string& hint) const {
  const std::string where = binary_ ? fmt::format("byte {}", at_) : fmt::format("line {}", line_number(text_, at_));
  fail_data(where + ": " + problem, path_, hint);
}

void FoamFile::read_header() {
  if (next() != "FoamFile") fail("does not begin with a FoamFile header");
  expect("{", "the header");
  for (;;) {
    const std::string key(next());
    if (key == "}") break;
    if (key.empty()) fail("ends within its header");
    std::string value(next());
    if (key == "class") class_ = value;
    if (key == "format") {
      if (value != "ascii" && value != "binary") fail(fmt::format("format '{}' is not supported", value), "use ascii or binary");
      binary_ = value == "binary";
    }
    if (key == "arch") {
      big_endian_ = value.find("MSB") != std::string::npos;
      if (value.find("label=64") != std::string::npos) label_bytes_ = 8;
      if (value.find("scalar=32") != std::string::npos) scalar_bytes_ = 4;
    }
    if (value == "{") fail("a header has no dictionaries");
    while (value != ";") {
      value = next();
      if (value.empty()) fail("ends within its header");
    }
  }
}

void FoamFile::skip_blanks() {
  for (;;) {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    if (text_.substr(at_).starts_with("//")) at_ = std::min(text_.find('\n', at_), text_.size());
    else if (text_.substr(at_).starts_with("/*")) {
      const size_t end = text_.find("*/", at_ + 2);
      at_ = end == std::string_view::npos ? text_.size() : end + 2;
    } else return;
  }
}

std::string_view FoamFile::next() {
  skip_blanks();
  if (at_ >= text_.size()) return {};
  const size_t begin = at_;
  if (is_punctuation(text_[at_])) return ++at_, text_.substr(begin, 1);
  if (text_[at_] == '"') {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    if (at_ >= text_.size()) fail("a string has no end");
    return ++at_, text_.substr(begin, at_ - begin);
  }
  // Words may hold balanced parentheses: "div(phi,U)"; a list begins behind a number.
  int depth = 0;
  const bool number = is_digit(text_[at_]) || text_[at_] == '-' || text_[at_] == '+' || text_[at_] == '.';
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_space(c)) break;
    if (c == '(' && !number && at_ > begin) ++depth;
    else if (c == ')' && depth > 0) --depth;
    else if (is_punctuation(c)) break;
  }
  return text_.substr(begin, at_ - begin);
}

std::string_view FoamFile::peek() {
  const size_t at = at_;
  const std::string_view t = next();
  at_ = at;
  return t;
}

void FoamFile::expect(std::string_view token, std::string_view what) {
  const std::string_view t = next();
  if (t != token) fail(fmt::format("found '{}' where '{}' of {} was expected", t.substr(0, 40), token, what));
}

void FoamFile::skip_entry() {
  size_t depth = 0;
  for (;;) {
    const std::string_view t = next();
    if (t.empty()) fail("ends within an entry");
    if (t == "{" || t == "(" || t == "[") ++depth;
    else if (t == "}" || t == ")" || t == "]") {
      if (depth == 0) fail(fmt::format("'{}' does not close anything", t));
      if (--depth == 0 && t == "}") {
        if (peek() == ";") next();
        return;
      }
    } else if (t == ";" && depth == 0) return;
    else if (t[0] == '#' || t[0] == '$') remember_directive(t);
    else if (binary_ && t.starts_with("List<") && t.ends_with('>')) skip_binary_list(t.substr(5, t.size() - 6));
  }
}

void FoamFile::skip_binary_list(std::string_view type) {
  const int k = components_of(type);
  if (k == 0) return;
  size_t n = 0;
  bool uniform = false;
  if (!open_list(n, uniform, "a list")) return;
  if (!uniform) take_bytes(n, uint64_t(type == "label" ? label_bytes_ : scalar_bytes_) * uint64_t(k), "a list");
  else
    while (peek() != "}" && !peek().empty()) next();
  close_list(uniform, "a list");
}

void FoamFile::skip_directive() { at_ = std::min(text_.find('\n', at_), text_.size()); }

size_t FoamFile::count(std::string_view what) {
  const std::string_view t = next();
  const auto n = parse_int(t);
  if (!n || *n < 0) fail(fmt::format("found '{}' where {} was expected", t.substr(0, 40), what));
  return size_t(*n);
}

double FoamFile::real(std::string_view what) {
  const std::string_view t = next();
  const auto v = parse_double(t);
  if (!v) fail(fmt::format("'{}' is not a number ({})", t.substr(0, 40), what));
  return *v;
}

// N( or N{ ; false for an empty list without parentheses.
bool FoamFile::open_list(size_t& n, bool& uniform, std::string_view what) {
  n = peek() == "(" ? 0 : count(fmt::format("the length of {}", what));
  const std::string_view t = peek();
  uniform = t == "{";
  if (n == 0 && t != "(" && t != "{") return false;
  if (t != "(" && t != "{") fail(fmt::format("found '{}' where '(' of {} was expected", t.substr(0, 40), what));
  next();
  return true;
}

void FoamFile::close_list(bool uniform, std::string_view what) { expect(uniform ? "}" : ")", what); }

std::string_view FoamFile::take_bytes(uint64_t n, uint64_t each, std::string_view what) {
  uint64_t bytes = 0;
  if (!multiply(n, each, bytes) || bytes > text_.size() - at_)
    fail(fmt::format("{} of {} values of {} bytes does not fit the {} bytes left", what, n, each, text_.size() - at_));
  at_ += bytes;
  return text_.substr(at_ - bytes, bytes);
}

std::vector<int32_t> FoamFile::labels(std::string_view what) {
  size_t n = 0;
  bool uniform = false;
  std::vector<int32_t> v;
  if (!open_list(n, uniform, what)) return v;
  auto narrow = [&](int64_t x) {
    if (x < INT32_MIN || x > INT32_MAX) fail(fmt::format("{}: {} is beyond 2^31", what, x));
    return int32_t(x);
  };
  if (binary_ && !uniform) {
    const std::string_view bytes = take_bytes(n, uint64_t(label_bytes_), what);
    v.resize(n);
    for (size_t i = 0; i < n; ++i)
      v[i] =
          label_bytes_ == 8 ? narrow(load<int64_t>(bytes.data() + 8 * i, big_endian_)) : load<int32_t>(bytes.data() + 4 * i, big_endian_);
  } else if (uniform) {
    // One number applies to all: a list of any length from a few bytes, so it must be in proportion to the file.
    const std::string_view t = next();
    const auto x = parse_int(t);
    if (!x) fail(fmt::format("'{}' is not a whole number ({})", t.substr(0, 40), what));
    if (n > file_.size() * 1000) fail(fmt::format("{} of {} equal numbers is too long for its file", what, n));
    v.assign(n, narrow(*x));
  } else {
    if (n > text_.size() - at_) fail(fmt::format("{} of {} numbers does not fit the {} bytes left", what, n, text_.size() - at_));
    v.resize(n);
    read_text(n, 1, v.data(), what);
  }
  close_list(uniform, what);
  return v;
}

Array FoamFile::tuples(int components, std::string_view what) {
  size_t n = 0;
  bool uniform = false;
  if (!open_list(n, uniform, what)) return Array::from_vector(std::vector<float>(), components);
  std::byte* out = nullptr;
  Array a;
  const auto k = uint64_t(components);
  if (uniform) {
    if (n > file_.size() * 1000) fail(fmt::format("{} of {} equal values is too long for its file", what, n));
    std::vector<double> one;
    if (components > 1) expect("(", what);
    for (int c = 0; c < components; ++c) one.push_back(real(what));
    if (components > 1) expect(")", what);
    a = Array::make_raw(ElementType::f32, n, components, &out);
    for (size_t i = 0; i < n * k; ++i) reinterpret_cast<float*>(out)[i] = float(one[i % k]);
  } else if (binary_) {
    const auto size = uint64_t(scalar_bytes_);
    const std::string_view bytes = take_bytes(n, k * size, what);
    const ElementType type = scalar_bytes_ == 8 ? ElementType::f64 : ElementType::f32;
    if (!big_endian_ && reinterpret_cast<uintptr_t>(bytes.data()) % size == 0) {
      a = Array({owner_, reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()}, type, n, components);
    } else {
      a = Array::make_raw(type, n, components, &out);
      if (big_endian_) swap_bytes_copy(out, bytes.data(), n * k, size);
      else std::memcpy(out, bytes.data(), bytes.size());
    }
  } else {
    if (n > (text_.size() - at_) / (2 * k) + 1)
      fail(fmt::format("{} of {} values does not fit the {} bytes left", what, n, text_.size() - at_));
    const ElementType type = text_type();
    a = Array::make_raw(type, n, components, &out);
    if (type == ElementType::f64) read_text(n, components, reinterpret_cast<double*>(out), what);
    else read_text(n, components, reinterpret_cast<float*>(out), what);
  }
  close_list(uniform, what);
  return a;
}

// Decided once, at the first list, so that all lists of a file have one type.
ElementType FoamFile::text_type() {
  if (!text_type_) text_type_ = real_type_of(text_.substr(at_));
  return *text_type_;
}

// Null when the text does not hold n tuples.
template <class T>
const char* FoamFile::scan_tuples(const char* p, const char* end, size_t n, int components, T* out) const {
  auto blanks = [&] {
    while (p < end && is_space(*p)) ++p;
  };
  for (size_t i = 0; i < n; ++i) {
    blanks();
    if (components > 1 && (p == end || *p++ != '(')) return nullptr;
    for (int c = 0; c < components; ++c) {
      blanks();
      if constexpr (std::is_integral_v<T>) {
        int64_t v = 0;
        if (!scan_number(p, end, v) || v < INT32_MIN || v > INT32_MAX) return nullptr;
        *out++ = T(v);
      } else if (!scan_number(p, end, *out++)) {
        return nullptr;
      }
    }
    blanks();
    if (components > 1 && (p == end || *p++ != ')')) return nullptr;
  }
  return p;
}

template <class T>
void FoamFile::read_text(size_t n, int components, T* out, std::string_view what) {
  const char* const end = text_.data() + text_.size();
  const char* const begin = text_.data() + at_;
  // Long lists have one tuple a line and end in a line ")": such lines are read in parallel.
  const size_t close = n >= 1 << 15 ? text_.find("\n)", at_) : std::string_view::npos;
  if (close != std::string_view::npos) {
    std::string_view body = text_.substr(at_, close + 1 - at_);
    const size_t first = body.find_first_not_of(" \t\r\n");
    if (first != std::string_view::npos) body.remove_prefix(first);
    const std::vector<size_t> borders = text_chunks(body, 1 << 18);
    std::vector<size_t> lines(borders.size() - 1);
    parallel_for(lines.size(), 1, [&](size_t c, size_t) {
      lines[c] = size_t(std::count(body.begin() + ptrdiff_t(borders[c]), body.begin() + ptrdiff_t(borders[c + 1]), '\n'));
    });
    std::vector<size_t> start = lines;
    if (exclusive_scan(start) == n) {
      std::vector<uint8_t> good(lines.size());
      parallel_for(lines.size(), 1, [&](size_t c, size_t) {
        const char* const stop = body.data() + borders[c + 1];
        const char* p = scan_tuples(body.data() + borders[c], stop, lines[c], components, out + start[c] * size_t(components));
        good[c] = p && skip_blanks_and_ends(p, stop) == stop;
      });
      if (std::all_of(good.begin(), good.end(), [](uint8_t g) { return g != 0; })) {
        at_ = close + 1;
        return;
      }
    }
  }
  const char* p = scan_tuples(begin, end, n, components, out);
  if (!p) fail(fmt::format("{} is not a list of {} values of {} numbers", what, n, components));
  at_ = size_t(p - text_.data());
}

void FoamFile::faces(std::vector<int64_t>& begin, std::vector<int32_t>& ids) {
  begin.assign(1, 0);
  ids.clear();
  if (class_ == "faceCompactList") {
    const std::vector<int32_t> offsets = labels("the starts of faces");
    ids = labels("the points of faces");
    begin.assign(offsets.begin(), offsets.end());
    if (begin.empty()) begin.assign(1, 0);
    if (begin.front() != 0 || begin.back() != int64_t(ids.size())) fail("the starts of faces do not match their points");
    for (size_t i = 1; i < begin.size(); ++i)
      if (begin[i] < begin[i - 1]) fail(fmt::format("face {} ends before it begins", i - 1));
    return;
  }
  size_t n = 0;
  bool uniform = false;
  if (!open_list(n, uniform, "faces")) return;
  if (uniform) fail("faces cannot all be equal");
  if (n > text_.size() - at_) fail(fmt::format("{} faces do not fit the {} bytes left", n, text_.size() - at_));
  begin.reserve(n + 1);
  for (size_t f = 0; f < n; ++f) {
    const size_t k = count("the number of points of a face");
    expect("(", "a face");
    if (binary_) {
      const std::string_view bytes = take_bytes(k, uint64_t(label_bytes_), "a face");
      for (size_t i = 0; i < k; ++i) {
        const int64_t v =
            label_bytes_ == 8 ? load<int64_t>(bytes.data() + 8 * i, big_endian_) : load<int32_t>(bytes.data() + 4 * i, big_endian_);
        ids.push_back(v < 0 || v > INT32_MAX ? -1 : int32_t(v));
      }
    } else {
      if (k > (text_.size() - at_) / 2 + 1) fail(fmt::format("a face of {} points does not fit", k));
      ids.resize(ids.size() + k);
      const char* p = scan_tuples(text_.data() + at_, text_.data() + text_.size(), k, 1, ids.data() + ids.size() - k);
      if (!p) fail("a face is not a list of whole numbers");
      at_ = size_t(p - text_.data());
    }
    expect(")", "a face");
    begin.push_back(int64_t(ids.size()));
  }
  expect(")", "faces");
}

}  // namespace sg::openfoam
