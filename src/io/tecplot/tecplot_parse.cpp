// SPDX-License-Identifier: Apache-2.0
// The grammar: statements begin with a keyword at the begin of a line (TITLE, VARIABLES, ZONE, TEXT, GEOMETRY, ...), values follow
// their ZONE. Source: Tecplot 360 Data Format Guide, "ASCII Data".
#include "io/tecplot/tecplot_parse.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/error.h"
#include "base/text/text.h"
#include "io/text/text_scan.h"

namespace sg::tecplot {

size_t Zone::cells() const {
  if (!ordered()) return elements;
  size_t n = 1;
  for (size_t d : dims) n *= std::max<size_t>(d - 1, 1);
  return n;
}

size_t Zone::corners() const {
  return type == "FELINESEG" ? 2 : type == "FETRIANGLE" ? 3 : type == "FEQUADRILATERAL" || type == "FETETRAHEDRON" ? 4 : 8;
}

namespace {

std::string upper(std::string_view s) {
  std::string r(s);
  for (char& c : r)
    if (c >= 'a' && c <= 'z') c = char(c - 32);
  return r;
}

class Parser {
 public:
  Parser(std::string_view text, const std::string& where) : text_(text), p_(text.data()), end_(text.data() + text.size()), where_(where) {}

  File parse() {
    while (skip(), p_ < end_) {
      const std::string w = upper(name());
      if (w == "TITLE") {
        equals();
        file_.title = string();
      } else if (w == "VARIABLES") {
        equals();
        variables();
      } else if (w == "FILETYPE") {
        equals();
        if (const std::string t = upper(string()); t == "SOLUTION")
          fail("the file contains only a solution", "write the grid and the solution to one file");
      } else if (w == "ZONE") {
        zone();
      } else if (w.empty()) {
        fail(fmt::format("found '{}' where a statement was expected", word()), "use TITLE, VARIABLES or ZONE");
      } else {  // TEXT, GEOMETRY, DATASETAUXDATA, ...: nothing of the data
        skip_statement();
      }
    }
    if (file_.zones.empty()) fail("has no zones");
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    fail_data(fmt::format("line {}: {}", line_number(text_, size_t(p_ - text_.data())), what), where_, hint);
  }
  static bool separates(char c) { return is_space(c) || c == ','; }
  void skip() {
    while (p_ < end_) {
      if (separates(*p_)) ++p_;
      else if (*p_ == '#') p_ = line_end(p_, end_);
      else return;
    }
  }
  std::string_view word() {
    const char* b = p_;
    while (p_ < end_ && !separates(*p_)) ++p_;
    return std::string_view(b, size_t(p_ - b)).substr(0, 60);
  }
  static bool in_name(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
  std::string_view name() {
    const char* b = p_;
    if (p_ < end_ && in_name(*p_))
      while (p_ < end_ && (in_name(*p_) || is_digit(*p_))) ++p_;
    return {b, size_t(p_ - b)};
  }
  void equals() {
    skip();
    if (p_ == end_ || *p_ != '=') fail("'=' is missing");
    ++p_;
    skip();
  }
  /// "..." or '...' or a word.
  std::string string() {
    skip();
    if (p_ < end_ && (*p_ == '"' || *p_ == '\'')) {
      const char quote = *p_++;
      const char* b = p_;
      while (p_ < end_ && *p_ != quote) ++p_;
      std::string r(b, p_);
      if (p_ == end_) fail("a string has no closing quote");
      ++p_;
      return r;
    }
    return std::string(word());
  }
  /// The inside of (...), nested.
  std::string_view brackets() {
    skip();
    if (p_ == end_ || *p_ != '(') return word();
    const char* b = ++p_;
    int depth = 1;
    while (p_ < end_ && (depth += *p_ == '(' ? 1 : *p_ == ')' ? -1 : 0) > 0) ++p_;
    if (p_ == end_) fail("')' is missing");
    return {b, size_t(p_++ - b)};
  }
  void skip_statement() {
    p_ = line_end(p_, end_);
    for (;;) {  // its other lines: anything up to the next statement that matters
      const char* q = p_;
      while (q < end_ && is_space(*q)) ++q;
      if (q == end_ || is_keyword(q)) {
        p_ = q;
        return;
      }
      p_ = line_end(q, end_);
    }
  }
  bool is_keyword(const char* q) const {
    const std::string_view rest(q, size_t(end_ - q));
    for (const char* k : {"TITLE", "VARIABLES", "ZONE", "TEXT", "GEOMETRY", "DATASETAUXDATA", "VARAUXDATA", "CUSTOMLABELS", "FILETYPE"})
      if (equal_ignoring_case(rest.substr(0, std::string_view(k).size()), k)) return true;
    return false;
  }

  void variables() {
    for (;;) {
      skip();
      if (p_ == end_) return;
      if (*p_ == '"' || *p_ == '\'') {
        file_.variables.push_back(string());
        continue;
      }
      if (is_keyword(p_)) return;
      const char* before = p_;
      std::string w = string();
      if (w.find('=') != std::string::npos) {
        p_ = before;
        return;
      }
      file_.variables.push_back(w);
      if (file_.variables.size() > 10000) fail("more than 10000 variables");
    }
  }

  size_t count(const char* what) {
    equals();
    int64_t n = 0;
    if (!scan_number(p_, end_, n) || n < 0 || uint64_t(n) > uint64_t(1) << 40) fail(fmt::format("{} is not a valid count", what));
    return size_t(n);
  }

  /// Numbers of variables in "[1-3,5]" or "4", from 0.
  std::vector<size_t> variable_set(std::string_view s) const {
    std::vector<size_t> r;
    for (char c : {'[', ']'})
      while (s.find(c) != std::string_view::npos) s = s.front() == c ? s.substr(1) : s.substr(0, s.find(c));
    for (std::string_view part : split(s, ',')) {
      const size_t dash = part.find('-');
      const auto lo = parse_int(part.substr(0, dash)), hi = dash == std::string_view::npos ? lo : parse_int(part.substr(dash + 1));
      if (!lo || !hi || *lo < 1 || *hi < *lo || *hi > int64_t(file_.variables.size())) fail(fmt::format("variables '{}'", s));
      for (int64_t v = *lo; v <= *hi; ++v) r.push_back(size_t(v - 1));
    }
    return r;
  }

  /// Items of a list like "[1-3]=1,[4]=2" or "NODAL,3*CELLCENTERED": commas inside brackets do not count.
  static std::vector<std::string_view> items(std::string_view s) {
    std::vector<std::string_view> r;
    size_t begin = 0;
    int depth = 0;
    for (size_t i = 0; i <= s.size(); ++i) {
      if (i < s.size() && s[i] == '[') ++depth;
      if (i < s.size() && s[i] == ']') --depth;
      if (i == s.size() || ((s[i] == ',' || is_space(s[i])) && depth == 0)) {
        if (const auto item = trim(s.substr(begin, i - begin)); !item.empty()) r.push_back(item);
        begin = i + 1;
      }
    }
    return r;
  }

  void set_locations(std::string_view s, Zone& z) {
    size_t next = 0;
    for (std::string_view item : items(s)) {
      const size_t eq = item.find('=');
      if (eq != std::string_view::npos) {
        const bool cells = upper(trim(item.substr(eq + 1))) == "CELLCENTERED";
        for (size_t v : variable_set(trim(item.substr(0, eq)))) z.at_cells[v] = cells;
        continue;
      }
      size_t times = 1;
      if (const size_t star = item.find('*'); star != std::string_view::npos) {
        times = size_t(std::clamp<int64_t>(parse_int(item.substr(0, star)).value_or(1), 0, 10000));
        item = item.substr(star + 1);
      }
      for (; times > 0 && next < z.at_cells.size(); --times) z.at_cells[next++] = upper(item) == "CELLCENTERED";
    }
  }

  /// Data of a zone's header besides the zone itself.
  struct ZoneHeader {
    std::vector<std::pair<size_t, size_t>> shared;  ///< variable, zone
    std::vector<bool> passive;
    std::optional<size_t> connectivity_of;
    std::string element;
  };

  void zone_key(const std::string& key, Zone& z, ZoneHeader& h) {
    if (key == "I" || key == "J" || key == "K") z.dims[size_t(key[0] - 'I')] = count(key.c_str());
    else if (key == "N" || key == "NODES") z.nodes = count("N");
    else if (key == "E" || key == "ELEMENTS") z.elements = count("E");
    else if (key == "T") equals(), z.title = string();
    else if (key == "ET") equals(), h.element = upper(string());
    else if (key == "ZONETYPE") equals(), z.type = upper(string());
    else if (key == "F" || key == "DATAPACKING") {
      equals();
      const std::string f = upper(string());
      z.block = f.ends_with("BLOCK");
      if (f.starts_with("FE")) z.type = "FE";
    } else if (key == "SOLUTIONTIME") {
      equals();
      double t = 0;
      if (!scan_number(p_, end_, t)) fail("SOLUTIONTIME is not a number");
      z.time = t;
    } else if (key == "VARLOCATION") equals(), set_locations(brackets(), z);
    else if (key == "DT") {
      equals();
      size_t v = 0;
      for (std::string_view t : items(brackets())) {
        if (v < z.wide.size()) z.wide[v] = upper(t).ends_with("DOUBLE") || upper(t) == "LONGINT";
        ++v;
      }
    } else if (key == "PASSIVEVARLIST") {
      equals();
      for (size_t v : variable_set(brackets_or_set())) h.passive[v] = true;
    } else if (key == "VARSHARELIST") {
      equals();
      share(brackets(), h.shared);
    } else if (key == "CONNECTIVITYSHAREZONE") {
      h.connectivity_of = count(key.c_str());
    } else {
      equals();
      if (p_ < end_ && *p_ == '(') brackets();
      else string();
    }
  }

  void zone() {
    if (file_.variables.empty()) fail("a zone precedes the variables", "VARIABLES = \"X\", \"Y\", ...");
    Zone z;
    const size_t n = file_.variables.size();
    z.type = "ORDERED";
    z.at_cells.assign(n, false), z.wide.assign(n, false);
    ZoneHeader h;
    h.passive.assign(n, false);
    for (;;) {
      skip();
      if (p_ == end_ || !in_name(*p_)) break;
      const char* before = p_;
      const std::string key = upper(name());
      const char* q = p_;
      while (q < end_ && is_blank(*q)) ++q;
      if (key == "AUXDATA") {
        p_ = line_end(p_, end_);
        continue;
      }
      if (q == end_ || *q != '=') {
        if (key == "NAN" || key == "INF") {
          p_ = before;
          break;
        }
        fail(fmt::format("'{}' has no value in a ZONE", key));
      }
      zone_key(key, z, h);
    }
    finish_type(z, h.element);
    values(z, h.shared, h.passive);
    if (!z.ordered()) connectivity(z, h.connectivity_of);
    file_.zones.push_back(std::move(z));
  }

  std::string_view brackets_or_set() {
    if (p_ < end_ && *p_ == '[') {
      const char* b = p_;
      while (p_ < end_ && *p_ != ']') ++p_;
      if (p_ < end_) ++p_;
      return {b, size_t(p_ - b)};
    }
    return brackets();
  }

  void share(std::string_view s, std::vector<std::pair<size_t, size_t>>& shared) const {
    for (std::string_view item : items(s)) {
      const size_t eq = item.find('=');
      const auto zone = eq == std::string_view::npos ? std::optional<int64_t>(1) : parse_int(trim(item.substr(eq + 1)));
      if (!zone || *zone < 1 || uint64_t(*zone) > file_.zones.size())
        fail(fmt::format("VARSHARELIST '{}' does not name an earlier zone", item));
      for (size_t v : variable_set(trim(item.substr(0, eq)))) shared.emplace_back(v, size_t(*zone - 1));
    }
  }

  void finish_type(Zone& z, const std::string& element) {
    if (!element.empty()) z.type = element.starts_with("FE") ? element : "FE" + element;
    static constexpr const char* known[] = {"ORDERED", "FELINESEG", "FETRIANGLE", "FEQUADRILATERAL", "FETETRAHEDRON", "FEBRICK"};
    if (std::find(std::begin(known), std::end(known), z.type) == std::end(known))
      fail(fmt::format("zone type '{}' is not supported", z.type),
           "ORDERED, FELINESEG, FETRIANGLE, FEQUADRILATERAL, FETETRAHEDRON, FEBRICK");
    uint64_t points = z.nodes;
    if (z.ordered()) {
      for (size_t& d : z.dims) d = std::max<size_t>(d, 1);
      if (!multiply(z.dims[0], z.dims[1], points) || !multiply(points, z.dims[2], points)) points = UINT64_MAX;
    }
    // A repeat count ("1000*0.5") may stand for many values, but not for an arbitrary number.
    const auto left = uint64_t(end_ - p_);
    if (points > 64 * left + 1024 || z.elements > left)
      fail(fmt::format("a zone of {} points and {} elements is followed by only {} bytes", points, z.elements, left));
    if (points == 0) fail("a zone has no points");
  }

  /// The next number, with what is left of a repeat count.
  double value() {
    if (repeat_ > 0) {
      --repeat_;
      return repeated_;
    }
    skip();
    double v = 0;
    const char* begin = p_;
    if (!scan_number(p_, end_, v)) {
      p_ = begin;
      fail(fmt::format("found '{}' where a value was expected", word()));
    }
    if (p_ < end_ && *p_ == '*') {
      if (!(v >= 1 && v <= 1e12)) fail("a repeat count is invalid");
      const auto times = uint64_t(v);
      ++p_;
      if (!scan_number(p_, end_, v)) fail("a repeat count has no value");
      repeat_ = times - 1;
      repeated_ = v;
    }
    if (p_ < end_ && !separates(*p_)) {
      p_ = begin;
      fail(fmt::format("found '{}' where a value was expected", word()));
    }
    return v;
  }

  void values(Zone& z, const std::vector<std::pair<size_t, size_t>>& shared, const std::vector<bool>& passive) {
    const size_t n = file_.variables.size();
    z.values.resize(n);
    std::vector<size_t> own;
    std::vector<bool> taken = passive;
    for (auto [v, zone] : shared) {
      z.values[v] = file_.zones[zone].values[v];
      z.at_cells[v] = file_.zones[zone].at_cells[v];
      taken[v] = true;
      if (!z.values[v].empty() && z.values[v].size() != (z.at_cells[v] ? z.cells() : z.points()))
        fail(fmt::format("'{}' is shared with a zone of a different size", file_.variables[v]));
    }
    for (size_t v = 0; v < n; ++v)
      if (!taken[v]) own.push_back(v);
    repeat_ = 0;
    if (z.block) {
      for (size_t v : own) {
        const size_t count = z.at_cells[v] ? z.cells() : z.points();
        for (size_t i = 0; i < count; ++i) z.values[v].push_back(value());
      }
    } else {
      for (size_t v : own)
        if (z.at_cells[v]) fail("a zone in POINT format has cell values", "BLOCK");
      for (size_t i = 0; i < z.points(); ++i)
        for (size_t v : own) z.values[v].push_back(value());
    }
    if (repeat_ > 0) fail("a repeat count exceeds the end of the zone");
  }

  void connectivity(Zone& z, std::optional<size_t> from) {
    if (from) {
      if (*from < 1 || *from > file_.zones.size()) fail("CONNECTIVITYSHAREZONE does not name an earlier zone");
      const Zone& other = file_.zones[*from - 1];
      if (other.type != z.type || other.nodes != z.nodes) fail("CONNECTIVITYSHAREZONE names a zone of a different kind");
      z.connectivity = other.connectivity;
      z.elements = other.elements;
      return;
    }
    for (size_t i = 0; i < z.elements * z.corners(); ++i) {
      skip();
      int64_t id = 0;
      if (!scan_number(p_, end_, id)) fail(fmt::format("found '{}' where a node was expected", word()));
      if (id < 1 || uint64_t(id) > z.nodes) fail(fmt::format("node {} does not exist", id), fmt::format("there are {}, from 1", z.nodes));
      z.connectivity.push_back(id - 1);
    }
  }

  std::string_view text_;
  const char *p_, *end_;
  std::string where_;
  File file_;
  uint64_t repeat_ = 0;
  double repeated_ = 0;
};

}  // namespace

File parse(std::string_view text, const std::string& where) { return Parser(text, where).parse(); }

}  // namespace sg::tecplot
