// SPDX-License-Identifier: Apache-2.0
#include "io/surface/obj_parse.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/text.h"
#include "io/text/text_scan.h"

namespace sg {

namespace {

// The line at p without its end; lines that end in a backslash are joined in `joined`. Moves p behind it.
std::string_view logical_line(const char*& p, const char* end, std::string& joined) {
  auto continued = [](const char* begin, const char* e) {
    while (e > begin && e[-1] == '\r') --e;
    return e > begin && e[-1] == '\\' ? e - 1 : nullptr;
  };
  const char* begin = p;
  const char* e = line_end(p, end);
  p = e < end ? e + 1 : end;
  const char* cut = continued(begin, e);
  if (!cut) return {begin, size_t(e - begin)};
  joined.assign(begin, cut);
  while (cut && p < end) {
    begin = p;
    e = line_end(p, end);
    p = e < end ? e + 1 : end;
    cut = continued(begin, e);
    joined += ' ';
    joined.append(begin, cut ? cut : e);
  }
  return joined;
}

struct Parser {
  std::string_view text;
  const std::string& where;
  ObjChunk& out;
  const char* line_begin = nullptr;

  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    fail_data(fmt::format("line {}: {}", line_number(text, size_t(line_begin - text.data())), what), where, hint);
  }

  // Up to `most` numbers; returns how many there are.
  int numbers(const char* p, const char* end, float* v, int most) const {
    int n = 0;
    while (n < most) {
      p = skip_blanks(p, end);
      if (p == end || *p == '#') break;
      const char* word = p;
      if (!scan_number(p, end, v[n]) || (p < end && !is_blank(*p)))
        fail(fmt::format("'{}' is not a number", std::string_view(word, std::min<size_t>(40, size_t(skip_word(word, end) - word)))));
      ++n;
    }
    return n;
  }

  void vertex(const char* p, const char* end) {
    float v[8];
    const int n = numbers(p, end, v, 8);
    if (n < 3) fail(fmt::format("a vertex has {} numbers", n), "v x y z");
    if (!(std::abs(v[0]) <= 3.4e38f && std::abs(v[1]) <= 3.4e38f && std::abs(v[2]) <= 3.4e38f))
      fail(fmt::format("the position {} {} {} is not finite", v[0], v[1], v[2]));
    out.xyz.insert(out.xyz.end(), v, v + 3);
    // x y z [w] or x y z r g b: a weight means nothing for polygons.
    if (n >= 6 || !out.colors.empty()) {
      const float none = std::nanf("");
      out.colors.resize(out.xyz.size() - 3, none);
      if (n >= 6) out.colors.insert(out.colors.end(), v + 3, v + 6);
      else out.colors.insert(out.colors.end(), 3, none);
    }
  }

  // One index of a corner; `count` is how many elements the chunk has so far.
  int32_t index(const char*& p, const char* end, size_t count, const char* what) const {
    int64_t i = 0;
    const char* word = p;
    if (!scan_number(p, end, i))
      fail(fmt::format("'{}' is not a valid {} index", std::string_view(word, std::min<size_t>(40, size_t(skip_word(word, end) - word))),
                       what));
    if (i == 0) fail(fmt::format("the {} index is 0", what), "indices count from 1, or from -1 backwards");
    if (i > INT32_MAX || i < -int64_t(INT32_MAX / 4)) fail(fmt::format("{} index {} is out of range", what, i));
    return i > 0 ? int32_t(i - 1) : int32_t(obj_relative + int64_t(count) + i);
  }

  void cell(ObjCell kind, const char* p, const char* end) {
    ObjCells& c = out.cells[size_t(kind)];
    const size_t before = c.v.size();
    for (;;) {
      p = skip_blanks(p, end);
      if (p == end || *p == '#') break;
      c.v.push_back(index(p, end, out.xyz.size() / 3, "vertex"));
      int32_t t = obj_none, n = obj_none;
      if (p < end && *p == '/') {
        ++p;
        if (p < end && *p != '/' && !is_blank(*p)) t = index(p, end, out.tcoords.size() / 2, "texture coordinate");
        if (p < end && *p == '/') {
          ++p;
          if (p < end && !is_blank(*p)) n = index(p, end, out.normals.size() / 3, "normal");
        }
      }
      if (p < end && !is_blank(*p))
        fail(fmt::format("'{}' follows an index", std::string_view(p, std::min<size_t>(40, size_t(skip_word(p, end) - p)))),
             "write corners as 1, 1/2, 1//3 or 1/2/3");
      if (t != obj_none || !c.t.empty()) c.t.resize(c.v.size() - 1, obj_none), c.t.push_back(t);
      if (n != obj_none || !c.n.empty()) c.n.resize(c.v.size() - 1, obj_none), c.n.push_back(n);
    }
    const size_t have = c.v.size() - before, need = kind == ObjCell::polygon ? 3 : kind == ObjCell::line ? 2 : 1;
    if (have < need)
      fail(fmt::format("a {} has {} corner{}",
                       kind == ObjCell::polygon ? "face"
                       : kind == ObjCell::line  ? "line"
                                                : "point",
                       have, have == 1 ? "" : "s"),
           fmt::format("it needs at least {}", need));
    c.lengths.push_back(uint32_t(have));
  }

  void mark(bool material, std::string_view name) {
    ObjMark m;
    m.material = material;
    m.name = name;
    for (size_t k = 0; k < 3; ++k) m.cells[k] = out.cells[k].lengths.size();
    out.marks.push_back(m);
  }
};

// The kind of cell that a statement makes; false for any other statement.
bool is_cell(std::string_view word, ObjCell& kind) {
  if (word == "f" || word == "fo") kind = ObjCell::polygon;
  else if (word == "l") kind = ObjCell::line;
  else if (word == "p") kind = ObjCell::vertex;
  else return false;
  return true;
}

}  // namespace

void parse_obj_chunk(std::string_view text, size_t begin, size_t end_at, const std::string& where, ObjChunk& out) {
  const char *p = text.data() + begin, *end = text.data() + end_at;
  Parser parser{text, where, out};
  std::string joined;
  while (p < end) {
    parser.line_begin = p;
    const std::string_view line = logical_line(p, end, joined);
    const char* line_stop = line.data() + line.size();
    const char* word = skip_blanks(line.data(), line_stop);
    const char* rest = skip_word(word, line_stop);
    const std::string_view w(word, size_t(rest - word));
    if (w.empty() || w[0] == '#') continue;
    ObjCell kind;
    if (w == "v") {
      parser.vertex(rest, line_stop);
    } else if (is_cell(w, kind)) {
      parser.cell(kind, rest, line_stop);
    } else if (w == "vn") {
      float v[3];
      if (parser.numbers(rest, line_stop, v, 3) < 3) parser.fail("a normal needs three numbers");
      out.normals.insert(out.normals.end(), v, v + 3);
    } else if (w == "vt") {
      float v[3] = {0, 0, 0};
      if (parser.numbers(rest, line_stop, v, 3) < 1) parser.fail("a texture coordinate has no number");
      out.tcoords.insert(out.tcoords.end(), v, v + 2);
    } else if (w == "g" || w == "usemtl" || w == "mtllib") {
      // Names point into the file, which outlives the chunks; a continued one would not, and is cut at the backslash.
      const char* name_end = line_end(parser.line_begin, end);
      std::string_view name = trim(std::string_view(parser.line_begin, size_t(name_end - parser.line_begin)));
      name = trim(name.substr(std::min(name.size(), w.size())));
      if (w == "mtllib") out.libraries.push_back(name);
      else parser.mark(w == "usemtl", name);
    }
  }
}

size_t obj_cell_line(std::string_view text, size_t begin, size_t end_at, ObjCell kind, size_t k) {
  const char *p = text.data() + begin, *end = text.data() + end_at;
  std::string joined;
  while (p < end) {
    const char* line_begin = p;
    const std::string_view line = logical_line(p, end, joined);
    const char* word = skip_blanks(line.data(), line.data() + line.size());
    ObjCell is;
    if (is_cell({word, size_t(skip_word(word, line.data() + line.size()) - word)}, is) && is == kind && k-- == 0)
      return line_number(text, size_t(line_begin - text.data()));
  }
  return line_number(text, end_at);
}

}  // namespace sg
