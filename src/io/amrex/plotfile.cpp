// SPDX-License-Identifier: Apache-2.0
#include "io/amrex/plotfile.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "io/text/text_scan.h"

namespace sg::amrex {

namespace {

/// The lines and words of one header.
class Text {
 public:
  explicit Text(const std::string& path) : file_(path), rest_(file_.text()) {}

  std::string_view rest() const { return rest_; }
  void drop(std::string_view rest) { rest_ = rest; }

  [[noreturn]] void fail(const std::string& problem) const {
    fail_data(fmt::format("line {}: {}", line_number(file_.text(), file_.size() - rest_.size()), problem), file_.path());
  }
  std::string_view line(std::string_view what) {
    if (rest_.empty()) fail(fmt::format("ends where {} was expected", what));
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    const std::string_view l = trim(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return l;
  }
  std::string_view word(std::string_view what) {
    size_t b = 0;
    while (b < rest_.size() && is_space(rest_[b])) ++b;
    size_t e = b;
    while (e < rest_.size() && !is_space(rest_[e])) ++e;
    if (b == e) fail(fmt::format("ends where {} was expected", what));
    const std::string_view w = rest_.substr(b, e - b);
    rest_.remove_prefix(e);
    return w;
  }
  double real(std::string_view what) {
    const std::string_view w = word(what);
    const auto v = parse_double(w);
    if (!v) fail(fmt::format("'{}' is not a number ({})", w.substr(0, 40), what));
    return *v;
  }
  int64_t integer(std::string_view what, int64_t least, int64_t most) {
    const std::string_view w = word(what);
    const auto v = parse_int(w);
    if (!v || *v < least || *v > most) fail(fmt::format("found '{}' where {} was expected ({} to {})", w.substr(0, 40), what, least, most));
    return *v;
  }
  size_t size() const { return file_.size(); }
  const std::string& path() const { return file_.path(); }

 private:
  MappedFile file_;
  std::string_view rest_;
};

// Refinement ratios: "2 2" or "(2,2,4) (2,2,2)".
void take_ratios(Text& t, Plotfile& p) {
  std::string_view line = t.line("refinement ratios");
  if (p.levels.size() < 2) return;
  for (size_t l = 1; l < p.levels.size(); ++l) {
    line = trim(line);
    auto& r = p.levels[l].ratio;
    if (line.starts_with('(')) {
      const size_t end = line.find(')');
      const auto parts = split(line.substr(1, std::min(end, line.size()) - 1), ',');
      if (end == std::string_view::npos || int(parts.size()) != p.dimension) t.fail("a refinement ratio is not of the form (x,y,z)");
      for (size_t a = 0; a < parts.size(); ++a) r[a] = int(parse_int(parts[a]).value_or(0));
      line.remove_prefix(end + 1);
    } else {
      const auto w = words(line);
      if (w.empty()) t.fail(fmt::format("{} levels need {} refinement ratios", p.levels.size(), p.levels.size() - 1));
      for (size_t a = 0; a < size_t(p.dimension); ++a) r[a] = int(parse_int(w[0]).value_or(0));
      line.remove_prefix(size_t(w[0].data() - line.data()) + w[0].size());
    }
    for (size_t a = 0; a < size_t(p.dimension); ++a)
      if (r[a] < 1 || r[a] > 1024) t.fail(fmt::format("a refinement ratio is {}", r[a]));
  }
}

void take_domains(Text& t, Plotfile& p) {
  for (size_t l = 0; l < p.levels.size(); ++l) {
    std::string_view rest = t.rest();
    Box b;
    while (!rest.empty() && is_space(rest[0])) rest.remove_prefix(1);
    if (!take_box(rest, p.dimension, b)) t.fail(fmt::format("expected the domain of level {}, like ((0,0,0) (7,7,7) (0,0,0))", l));
    t.drop(rest);
    if (l == 0) p.domain = b;
  }
}

void read_cell_header(const std::string& path, const Plotfile& p, Level& level, size_t boxes) {
  Text t(path);
  t.integer("the version of VisMF", 0, 100);
  t.integer("how the file was written", 0, 100);
  const int64_t components = t.integer("the number of components", 0, 1000000);
  if (uint64_t(components) != p.names.size()) t.fail(fmt::format("{} components, but the plotfile names {}", components, p.names.size()));
  std::string_view ghosts = t.word("ghost cells");  // "0", or per axis "(0,0,0)"
  (void)ghosts;
  const std::string_view count = t.word("'(boxes 0'");
  const auto n = count.starts_with('(') ? parse_int(count.substr(1)) : std::nullopt;
  if (!n || *n < 0 || uint64_t(*n) != boxes) t.fail(fmt::format("found '{}' where '({} 0' was expected", count.substr(0, 40), boxes));
  t.word("0");
  for (size_t b = 0; b < boxes; ++b) {
    std::string_view rest = t.rest();
    while (!rest.empty() && is_space(rest[0])) rest.remove_prefix(1);
    Box box;
    if (!take_box(rest, p.dimension, box)) t.fail(fmt::format("expected box {}, like ((0,0,0) (7,7,7) (0,0,0))", b));
    t.drop(rest);
    level.boxes.push_back(box);
  }
  if (t.word("')'") != ")") t.fail("has more boxes than announced");
  if (uint64_t(t.integer("the number of FABs", 0, INT64_MAX)) != boxes) t.fail(fmt::format("{} boxes need as many FABs", boxes));
  for (size_t b = 0; b < boxes; ++b) {
    if (t.word("'FabOnDisk:'") != "FabOnDisk:") t.fail("expected 'FabOnDisk: FILE BYTE'");
    Fab f;
    f.file = named_file(path, t.word("a file name"));
    f.offset = uint64_t(t.integer("a byte", 0, INT64_MAX));
    level.fabs.push_back(std::move(f));
  }
}

}  // namespace

bool take_box(std::string_view& text, int dimension, Box& box) {
  const char *p = text.data(), *end = p + text.size();
  auto expect = [&](char c) {
    while (p < end && is_space(*p)) ++p;
    return p < end && *p == c ? (++p, true) : false;
  };
  auto triple = [&](std::array<long long, 3>& v) {
    if (!expect('(')) return false;
    for (int a = 0; a < dimension; ++a) {
      if (a && !expect(',')) return false;
      while (p < end && is_space(*p)) ++p;
      int64_t x = 0;
      if (!scan_number(p, end, x) || x < -(1ll << 40) || x > (1ll << 40)) return false;
      v[size_t(a)] = x;
    }
    return expect(')');
  };
  std::array<long long, 3> centering{0, 0, 0};
  if (!expect('(') || !triple(box.lo) || !triple(box.hi) || !triple(centering) || !expect(')')) return false;
  for (int a = 0; a < dimension; ++a)
    if (box.hi[size_t(a)] < box.lo[size_t(a)] || centering[size_t(a)] != 0) return false;
  text = {p, size_t(end - p)};
  return true;
}

Plotfile read_headers(const std::string& folder) {
  Text t(folder + "/Header");
  Plotfile p;
  t.line("the version");
  const int64_t names = t.integer("the number of variables", 0, int64_t(std::min<size_t>(t.size(), 1000000)));
  t.line("the end of the line");
  for (int64_t i = 0; i < names; ++i) p.names.emplace_back(t.line("the name of a variable"));
  p.dimension = int(t.integer("the dimension", 1, 3));
  if (p.dimension == 1) t.fail("plotfiles of one dimension are not supported");
  p.time = t.real("the time");
  const int64_t finest = t.integer("the finest level", 0, 63);
  p.levels.resize(size_t(finest) + 1);
  for (int a = 0; a < p.dimension; ++a) p.lo[a] = t.real("the domain's lower corner");
  for (int a = 0; a < p.dimension; ++a) t.real("the domain's upper corner");
  t.line("the end of the line");
  take_ratios(t, p);
  take_domains(t, p);
  for (int64_t l = 0; l <= finest; ++l) t.integer("a step number", INT64_MIN, INT64_MAX);
  for (Level& l : p.levels)
    for (int a = 0; a < p.dimension; ++a) {
      l.spacing[a] = t.real("the spacing");
      if (!(l.spacing[a] > 0) || !std::isfinite(l.spacing[a])) t.fail(fmt::format("a spacing is {}", l.spacing[a]));
    }
  const int64_t coordinates = t.integer("the kind of coordinates", 0, 2);
  (void)coordinates;  // 1 cylindrical (r, z), 2 spherical: drawn as they are counted
  t.integer("the width of the border", INT64_MIN, INT64_MAX);
  for (size_t l = 0; l < p.levels.size(); ++l) {
    t.integer("the number of a level", int64_t(l), int64_t(l));
    const auto boxes = size_t(t.integer("the number of boxes", 0, int64_t(t.size())));
    t.real("the time of a level");
    t.integer("the step of a level", INT64_MIN, INT64_MAX);
    for (size_t i = 0; i < boxes * size_t(p.dimension) * 2; ++i) t.real("a box in space");
    const std::string path = folder + "/" + std::string(t.word("the path of a level"));
    read_cell_header(path + "_H", p, p.levels[l], boxes);
  }
  return p;
}

}  // namespace sg::amrex
