// SPDX-License-Identifier: Apache-2.0
#include "io/plot3d/layout.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/parallel.h"
#include "io/text/number_text.h"
#include "io/text/text_scan.h"

namespace sg::plot3d {

namespace {

bool is_number_character(char c) {
  return is_space(c) || is_digit(c) || std::string_view("+-.,eEdDnNaAiIfF").find(c) != std::string_view::npos;
}

/// Tries one combination.
class Fit {
 public:
  Fit(const Numbers& n, Kind kind, Layout l) : n_(n), kind_(kind), l_(std::move(l)) {}

  std::optional<Layout> run() {
    const size_t word = n_.integer_size();
    int64_t grids = 1;
    if (l_.multi && !(open(word) && take_integer(grids) && close())) return {};
    if (grids < 1 || uint64_t(grids) > n_.size() / word) return {};
    const size_t per_grid = size_t(l_.dimensions) + (kind_ == Kind::function ? 1 : 0);
    if (!open(size_t(grids) * per_grid * word)) return {};
    for (int64_t g = 0; g < grids; ++g)
      if (!sizes()) return {};
    if (!close()) return {};
    for (size_t g = 0; g < size_t(grids); ++g)
      if (!data(g)) return {};
    if (at_ != n_.size() && !n_.is_padding(at_)) return {};
    return std::move(l_);
  }

 private:
  bool take_integer(int64_t& v) {
    const auto i = n_.integer(at_, l_.big_endian);
    if (!i) return false;
    v = *i, at_ += n_.integer_size();
    return true;
  }

  // Record marks, where the layout has them.
  bool open(uint64_t bytes) {
    record_ = bytes;
    if (bytes > n_.size() - at_) return false;
    if (!l_.records) return true;
    int64_t mark = 0;
    return bytes + 8 <= n_.size() - at_ && take_integer(mark) && uint64_t(uint32_t(mark)) == bytes;
  }
  bool close() {
    int64_t mark = 0;
    return !l_.records || (take_integer(mark) && uint64_t(uint32_t(mark)) == record_);
  }

  bool sizes() {
    std::array<size_t, 3> size{1, 1, 1};
    uint64_t points = 1;
    for (size_t a = 0; a < size_t(l_.dimensions); ++a) {
      int64_t v = 0;
      if (!take_integer(v) || v < 1 || !multiply(points, uint64_t(v), points) || points > n_.size()) return false;
      size[a] = size_t(v);
    }
    int64_t fields = l_.dimensions + 2;
    if (kind_ == Kind::function && (!take_integer(fields) || fields < 1 || fields > 100000)) return false;
    l_.sizes.push_back(size);
    l_.fields.push_back(int(fields));
    return true;
  }

  bool data(size_t g) {
    const auto& s = l_.sizes[g];
    const uint64_t points = uint64_t(s[0]) * s[1] * s[2], real = n_.real_size(l_);
    if (kind_ == Kind::solution) {
      if (!open(4 * real)) return false;
      l_.begin.push_back(at_);
      at_ += 4 * real;
      if (!close()) return false;
    }
    uint64_t tuple = uint64_t(kind_ == Kind::grid ? l_.dimensions : l_.fields[g]) * real, bytes = 0;
    if (kind_ == Kind::grid && l_.iblank) tuple += n_.integer_size();
    if (!multiply(points, tuple, bytes) || !open(bytes)) return false;
    if (kind_ != Kind::solution) l_.begin.push_back(at_);
    at_ += bytes;
    return close();
  }

  const Numbers& n_;
  Kind kind_;
  Layout l_;
  size_t at_ = 0;
  uint64_t record_ = 0;
};

// Integers and floats read as one another give absurd values: coordinates must be usual numbers, blanking small ones and not all 0.
bool plausible(const Numbers& n, const Layout& l) {
  constexpr size_t most = 2048;
  for (size_t g = 0; g < l.sizes.size(); ++g) {
    const size_t points = l.sizes[g][0] * l.sizes[g][1] * l.sizes[g][2], reals = points * size_t(l.dimensions);
    const size_t step = std::max<size_t>(reals / most, 1);
    size_t good = 0, seen = 0;
    for (size_t i = 0; i < reals; i += step, ++seen) {
      const double v = std::fabs(n.real(l, l.begin[g] + i * n.real_size(l)));
      good += size_t(v == 0 || (v > 1e-30 && v < 1e30));  // false for NaN
    }
    if (good * 100 < seen * 99) return false;
    if (!l.iblank) continue;
    const size_t at = l.begin[g] + reals * n.real_size(l);
    bool any = false;
    for (size_t i = 0; i < points; i += std::max<size_t>(points / most, 1)) {
      const auto v = n.integer(at + i * n.integer_size(), l.big_endian);
      if (!v || *v < -1000000 || *v > 1000000) return false;
      any = any || *v != 0;
    }
    if (!any) return false;
  }
  return true;
}

}  // namespace

std::string Layout::describe() const {
  return fmt::format("{}{}, {} grid{}, {}D{}{}",
                     text         ? "text"
                     : big_endian ? "big-endian"
                                  : "little-endian",
                     records ? " with Fortran records" : "", sizes.size(), sizes.size() == 1 ? "" : "s", dimensions,
                     text              ? ""
                     : real_bytes == 8 ? ", double"
                                       : ", single",
                     iblank ? ", iblank" : "");
}

Numbers::Numbers(MappedFile file) : file_(std::move(file)), bytes_(file_.data(), file_.size()) { look(); }
Numbers::Numbers(std::span<const std::byte> bytes) : bytes_(bytes) { look(); }

void Numbers::look() {
  const std::string_view t(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  text_ = !t.empty();
  for (size_t i = 0; i < std::min<size_t>(t.size(), 4096) && text_; ++i) text_ = is_number_character(t[i]);
  if (!text_) return;
  size_t words = 0;
  bool inside = false;
  for (const char c : t) {
    if (!is_number_character(c)) return;  // no numbers only: fits no layout, as there are no values
    const bool word = !is_space(c) && c != ',';
    words += size_t(word && !inside);
    inside = word;
  }
  try {
    values_ = parse_numbers(t, ElementType::f64, words, 1, path());
  } catch (const Error&) {
    values_ = Array();
  }
  text_type_ = real_type_of(t);
}

std::optional<int64_t> Numbers::integer(size_t at, bool big_endian) const {
  if (at + integer_size() > size()) return {};
  if (!text_) return load<int32_t>(bytes_.data() + at, big_endian);
  const double v = values_.view<double>()[at];
  if (v != std::floor(v) || std::fabs(v) > 1e15) return {};
  return int64_t(v);
}

bool Numbers::is_padding(size_t at) const {
  constexpr size_t block = 512;
  if (text_ || bytes_.size() % block != 0 || bytes_.size() - at >= block) return false;
  return std::all_of(bytes_.begin() + ptrdiff_t(at), bytes_.end(), [](std::byte b) { return b == std::byte(0); });
}

double Numbers::real(const Layout& l, size_t at) const {
  if (text_) return values_.view<double>()[at];
  const std::byte* p = bytes_.data() + at;
  return l.real_bytes == 8 ? load<double>(p, l.big_endian) : double(load<float>(p, l.big_endian));
}

void Numbers::copy(const Layout& l, size_t at, size_t count, ElementType type, std::byte* out, size_t stride) const {
  parallel_for(count, 1 << 16, [&](size_t begin, size_t end) {
    if (type == ElementType::f64 && !text_) {
      for (size_t i = begin; i < end; ++i)
        reinterpret_cast<double*>(out)[i * stride] = load<double>(bytes_.data() + at + 8 * i, l.big_endian);
    } else if (type == ElementType::f32 && !text_) {
      for (size_t i = begin; i < end; ++i)
        reinterpret_cast<float*>(out)[i * stride] = load<float>(bytes_.data() + at + 4 * i, l.big_endian);
    } else {
      const auto v = values_.view<double>();
      for (size_t i = begin; i < end; ++i)
        if (type == ElementType::f64) reinterpret_cast<double*>(out)[i * stride] = v[at + i];
        else reinterpret_cast<float*>(out)[i * stride] = float(v[at + i]);
    }
  });
}

std::optional<Layout> find_layout(const Numbers& n, Kind kind, const Layout* grid) {
  std::vector<Layout> tries;
  // The likelier comes first; a solution is mostly laid out as its grid.
  if (grid && !grid->text) tries.push_back(*grid);
  for (const int dimensions : {3, 2})
    for (const bool multi : {false, true})
      for (const bool iblank : {false, true})
        for (const bool records : {false, true})
          for (const bool big : {false, true})
            for (const int real : {4, 8}) {
              if (iblank && kind != Kind::grid) continue;
              if (n.is_text() && (records || big || real == 8)) continue;
              if (grid && grid->dimensions != dimensions) continue;
              Layout l;
              l.big_endian = big, l.records = records, l.multi = multi, l.iblank = iblank, l.dimensions = dimensions, l.real_bytes = real;
              tries.push_back(l);
            }
  for (Layout& l : tries) {
    l.text = n.is_text();
    l.sizes.clear(), l.fields.clear(), l.begin.clear();
    if (kind != Kind::grid) l.iblank = false;
    std::optional<Layout> fit = Fit(n, kind, l).run();
    if (!fit || (grid && fit->sizes != grid->sizes)) continue;
    if (kind == Kind::grid && !plausible(n, *fit)) continue;
    return fit;
  }
  return {};
}

}  // namespace sg::plot3d
