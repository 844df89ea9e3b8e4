// SPDX-License-Identifier: Apache-2.0
#include "io/volume/nrrd_header.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "data/patient/patient_frame.h"
#include "io/text/text_scan.h"
#include "io/volume/direction.h"

namespace sg {

namespace {

struct Parser {
  NrrdHeader h;
  std::string_view text;
  size_t line = 0;
  int space_dimension = 0;
  bool has_type = false, has_encoding = false, has_endian = false;

  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    fail_data(fmt::format("line {}: {}", line, what), h.path, hint);
  }

  void need_axes(std::string_view field) const {
    if (h.axes.empty()) fail(fmt::format("'{}' before 'dimension'", field));
  }
  std::vector<std::string_view> per_axis(std::string_view field, std::string_view value) const {
    need_axes(field);
    const auto w = words(value);
    if (w.size() != h.axes.size()) fail(fmt::format("'{}' has {} entries for {} axes", field, w.size(), h.axes.size()));
    return w;
  }
  std::vector<double> numbers(std::string_view field, std::string_view value) const {
    std::vector<double> r;
    for (std::string_view w : per_axis(field, value)) {
      const auto d = parse_double(w);
      if (!d) fail(fmt::format("'{}': '{}' is not a number", field, w));
      r.push_back(*d);
    }
    return r;
  }
  // "(a,b,c)" from the front of s.
  Vec3 vector(std::string_view field, std::string_view& s) const {
    const size_t close = s.find(')');
    if (s.empty() || s[0] != '(' || close == std::string_view::npos)
      fail(fmt::format("'{}': '{}' is not a vector like (1,0,0)", field, s.substr(0, 40)));
    const auto parts = split(s.substr(1, close - 1), ',');
    if (parts.empty() || parts.size() > 4 || (space_dimension > 0 && parts.size() != size_t(space_dimension)))
      fail(fmt::format("'{}' has a vector of {} numbers in a space of {}", field, parts.size(), space_dimension));
    Vec3 v;
    for (size_t i = 0; i < parts.size(); ++i) {
      const auto d = parse_double(parts[i]);
      if (!d) fail(fmt::format("'{}': '{}' is not a number", field, parts[i]));
      if (i < 3) v[int(i)] = *d;
    }
    s = trim(s.substr(close + 1));
    return v;
  }
  // Quoted words, for labels and units.
  std::vector<std::string> labels(std::string_view value) const {
    try {
      return quoted_words(value);
    } catch (const Error&) {
      fail("a closing quote is missing");
    }
  }

  void field(const std::string& name, std::string_view value);
  bool geometry_field(const std::string& name, std::string_view value);
  void data_file(std::string_view value, const char*& p, const char* end);
};

bool parse_type(std::string_view value, ElementType& t) {
  std::string key = to_lower(trim(value));
  struct {
    std::string_view name;
    ElementType type;
  } static constexpr more[] = {{"signed char", ElementType::i8},
                               {"int8_t", ElementType::i8},
                               {"uint8_t", ElementType::u8},
                               {"short int", ElementType::i16},
                               {"signed short", ElementType::i16},
                               {"signed short int", ElementType::i16},
                               {"int16_t", ElementType::i16},
                               {"unsigned short int", ElementType::u16},
                               {"uint16_t", ElementType::u16},
                               {"signed int", ElementType::i32},
                               {"int32_t", ElementType::i32},
                               {"uint32_t", ElementType::u32},
                               {"long long", ElementType::i64},
                               {"long long int", ElementType::i64},
                               {"signed long long", ElementType::i64},
                               {"signed long long int", ElementType::i64},
                               {"int64_t", ElementType::i64},
                               {"unsigned long long", ElementType::u64},
                               {"unsigned long long int", ElementType::u64},
                               {"uint64_t", ElementType::u64}};
  for (const auto& e : more)
    if (e.name == key) return t = e.type, true;
  if (key == "long" || key == "unsigned long" || key == "byte") return false;  // NRRD has no such types: their size differs
  return parse_element_type(key, t);
}

bool Parser::geometry_field(const std::string& name, std::string_view value) {
  if (name == "spacings") {
    const auto v = numbers(name, value);
    for (size_t a = 0; a < v.size(); ++a) h.axes[a].spacing = v[a];
  } else if (name == "axis mins" || name == "axismins") {
    const auto v = numbers(name, value);
    for (size_t a = 0; a < v.size(); ++a) h.axes[a].min = v[a];
  } else if (name == "axis maxs" || name == "axismaxs") {
    const auto v = numbers(name, value);
    for (size_t a = 0; a < v.size(); ++a) h.axes[a].max = v[a];
  } else if (name == "space directions") {
    need_axes(name);
    std::string_view s = trim(value);
    for (NrrdAxis& axis : h.axes) {
      if (s.empty()) fail(fmt::format("'space directions' has fewer than {} entries", h.axes.size()));
      if (s.size() >= 4 && equal_ignoring_case(s.substr(0, 4), "none")) {
        axis.no_direction = true;
        s = trim(s.substr(4));
        continue;
      }
      const Vec3 v = vector(name, s);
      // A vector of NaN means "none" in files of some programs.
      if (std::isnan(v.x) && std::isnan(v.y)) axis.no_direction = true;
      else axis.direction = v, axis.has_direction = true;
    }
    if (!s.empty()) fail(fmt::format("'space directions' has more than {} entries", h.axes.size()));
  } else if (name == "space origin") {
    std::string_view s = trim(value);
    h.origin = vector(name, s);
    h.has_origin = std::isfinite(h.origin.x) && std::isfinite(h.origin.y) && std::isfinite(h.origin.z);
  } else if (name == "space dimension") {
    const auto v = parse_int(value);
    if (!v || *v < 1 || *v > 4) fail(fmt::format("'space dimension' is '{}'", value));
    space_dimension = int(*v);
  } else if (name == "space") {
    const std::string s = to_lower(value);
    // The spaces with time have four coordinates, all others three.
    space_dimension = s.find("time") != std::string::npos || s == "rast" || s == "last" || s == "lpst" ? 4 : 3;
    h.space = std::string(trim(value));
  } else {
    return false;
  }
  return true;
}

void Parser::field(const std::string& name, std::string_view value) {
  if (geometry_field(name, value)) return;
  if (name == "type") {
    if (equal_ignoring_case(value, "block")) fail("the type 'block' contains no numbers");
    if (!parse_type(value, h.type)) fail(fmt::format("unknown type '{}'", value), "use e.g. int16, uint8, float or double");
    has_type = true;
  } else if (name == "dimension") {
    const auto v = parse_int(value);
    if (!v || *v < 1 || *v > 16) fail(fmt::format("'dimension' is '{}'", value), "1 to 16");
    if (!h.axes.empty()) fail("has a second 'dimension'");
    h.axes.resize(size_t(*v));
  } else if (name == "sizes") {
    const auto w = per_axis(name, value);
    for (size_t a = 0; a < w.size(); ++a) {
      const auto v = parse_int(w[a]);
      if (!v || *v < 1) fail(fmt::format("'sizes': '{}' is not a valid size", w[a]));
      h.axes[a].size = size_t(*v);
    }
  } else if (name == "encoding") {
    const std::string e = to_lower(trim(value));
    if (e == "raw") h.encoding = BrickEncoding::raw;
    else if (e == "ascii" || e == "text" || e == "txt") h.encoding = BrickEncoding::text;
    else if (e == "hex") h.encoding = BrickEncoding::hex;
    else if (e == "gzip" || e == "gz") h.encoding = BrickEncoding::gzip;
    else if (e == "bzip2" || e == "bz2") h.encoding = BrickEncoding::bzip2;
    else fail(fmt::format("unknown encoding '{}'", value), "use raw, ascii, hex, gzip or bzip2");
    has_encoding = true;
  } else if (name == "endian") {
    const std::string e = to_lower(trim(value));
    if (e != "little" && e != "big") fail(fmt::format("'endian' is '{}'", value), "use little or big");
    h.big_endian = e == "big";
    has_endian = true;
  } else if (name == "byte skip" || name == "byteskip") {
    const auto v = parse_int(value);
    if (!v) fail(fmt::format("'byte skip' is '{}'", value));
    h.byte_skip = *v;
  } else if (name == "line skip" || name == "lineskip") {
    const auto v = parse_int(value);
    if (!v || *v < 0) fail(fmt::format("'line skip' is '{}'", value));
    h.line_skip = size_t(*v);
  } else if (name == "kinds" || name == "centerings" || name == "centers") {
    const auto w = per_axis(name, value);
    for (size_t a = 0; a < w.size(); ++a) (name == "kinds" ? h.axes[a].kind : h.axes[a].centering) = to_lower(w[a]);
  } else if (name == "labels" || name == "units") {
    need_axes(name);
    const auto w = labels(value);
    if (w.size() != h.axes.size()) fail(fmt::format("'{}' has {} entries for {} axes", name, w.size(), h.axes.size()));
    for (size_t a = 0; a < w.size(); ++a) (name == "labels" ? h.axes[a].label : h.axes[a].units) = w[a];
    h.notes.emplace_back(name, std::string(value));
  } else if (name == "sample units" || name == "sampleunits") {
    h.sample_units = std::string(trim(value));
    if (h.sample_units.size() > 1 && h.sample_units.front() == '"' && h.sample_units.back() == '"')
      h.sample_units = h.sample_units.substr(1, h.sample_units.size() - 2);
  } else if (name == "old min" || name == "oldmin" || name == "old max" || name == "oldmax" || name == "block size" ||
             name == "blocksize" || name == "thicknesses") {
    // old min and max describe a quantisation that has been done; values are given as stored.
  } else if (name == "measurement frame") {
    h.notes.emplace_back("measurement frame in the file", std::string(value));
    if (space_dimension != 3) return;
    std::string_view s = trim(value);
    Mat3 frame;
    for (int a = 0; a < 3; ++a) {
      const Vec3 v = vector(name, s);
      for (int r = 0; r < 3; ++r) frame.m[r][a] = v[r];
    }
    if (std::isfinite(determinant(frame))) h.measurement_frame = frame;
  } else if (name == "content" || name == "space units" || name == "number" || name == "min" || name == "max") {
    h.notes.emplace_back(name, std::string(value));
  } else {
    fail(fmt::format("unknown field '{}'", name), "user keys are written with := instead of :");
  }
}

// "name", "pattern min max step [subdim]" or "LIST [subdim]" with one name per line to the end of the header.
void Parser::data_file(std::string_view value, const char*& p, const char* end) {
  const auto w = words(value);
  if (w.empty()) fail("'data file' has no name");
  auto number = [&](std::string_view s) {
    const auto v = parse_int(s);
    if (!v) fail(fmt::format("'data file': '{}' is not a whole number", s), "write pattern min max step, e.g. slice%03d.raw 1 93 1");
    return *v;
  };
  auto set_subdim = [&](std::string_view s) {
    const int64_t v = number(s);
    if (v < 1 || (!h.axes.empty() && v > int64_t(h.axes.size()))) fail(fmt::format("'data file': {} dimensions per file", v));
    h.subdim = size_t(v);
  };
  if (w[0] == "LIST") {
    if (w.size() > 1) set_subdim(w[1]);
    while (p < end) {
      const char* e = line_end(p, end);
      const std::string_view name = trim({p, size_t(e - p)});
      p = e < end ? e + 1 : end;
      ++line;
      if (!name.empty()) h.data_files.emplace_back(name);
      if (h.data_files.size() > 1000000) fail("has more than a million data files");
    }
    if (h.data_files.empty()) fail("'data file: LIST' is not followed by names");
  } else if (w.size() >= 4 && w[0].find('%') != std::string_view::npos) {
    h.data_files = pattern_names(std::string(w[0]), number(w[1]), number(w[2]), number(w[3]), h.path);
    if (w.size() > 4) set_subdim(w[4]);
  } else {
    h.data_files.emplace_back(trim(value));
  }
}

std::string unescaped(std::string_view s) {
  std::string r;
  for (size_t i = 0; i < s.size(); ++i) {
    if (s[i] == '\\' && i + 1 < s.size() && (s[i + 1] == 'n' || s[i + 1] == '\\')) r += s[++i] == 'n' ? '\n' : '\\';
    else r += s[i];
  }
  return r;
}

}  // namespace

NrrdHeader parse_nrrd_header(const MappedFile& file) {
  Parser parser;
  NrrdHeader& h = parser.h;
  h.path = file.path();
  const char *base = reinterpret_cast<const char*>(file.data()), *p = base, *end = base + file.size();
  std::string comments;
  bool blank_line = false;
  while (p < end) {
    const char* e = line_end(p, end);
    ++parser.line;
    if (e - p > (1 << 24)) parser.fail("the line is longer than 16 MiB");
    std::string_view line(p, size_t(e - p));
    p = e < end ? e + 1 : end;
    while (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (parser.line == 1) {
      if (line.size() != 8 || !line.starts_with("NRRD000") || !is_digit(line[7]))
        parser.fail("the file does not begin with NRRD0001 to NRRD0005");
      continue;
    }
    if (line.empty()) {
      blank_line = true;
      break;
    }
    if (line[0] == '#') {
      if (const auto c = trim(line.substr(1)); !c.empty() && !c.starts_with("Complete NRRD file format") && !c.starts_with("http"))
        comments += (comments.empty() ? "" : "\n") + std::string(c);
      continue;
    }
    const size_t colon = line.find(':');
    if (colon == std::string_view::npos || colon == 0)
      parser.fail(fmt::format("'{}' is neither 'field: value' nor 'key:=value'", line.substr(0, 60)));
    if (colon + 1 < line.size() && line[colon + 1] == '=') {
      std::string key = unescaped(line.substr(0, colon)), text = unescaped(line.substr(colon + 2));  // blanks count
      if (key == nrrd_name_key) h.field_name = std::move(text);
      else h.notes.emplace_back(std::move(key), std::move(text));
      continue;
    }
    const std::string name = to_lower(trim(line.substr(0, colon)));
    const std::string_view value = trim(line.substr(colon + 1));
    if (name == "data file" || name == "datafile") parser.data_file(value, p, end);
    else parser.field(name, value);
  }
  if (!comments.empty()) h.notes.emplace_back("comment", comments);
  auto missing = [&](const char* what) { fail_data(fmt::format("the header has no '{}'", what), h.path); };
  if (!parser.has_type) missing("type");
  if (h.axes.empty()) missing("dimension");
  for (const NrrdAxis& a : h.axes)
    if (a.size == 0) missing("sizes");
  if (!parser.has_encoding) missing("encoding");
  if (h.data_files.empty() && !blank_line)
    fail_data("the file ends inside its header", h.path,
              "an empty line ends the header of an attached file; a detached one has a 'data file'");
  h.data_begin = size_t(p - base);
  return std::move(parser.h);
}

namespace {

// Bytes with three or four of them first, and many along all other axes.
bool is_picture(const NrrdHeader& h) {
  constexpr size_t least = 16;
  const auto& axes = h.axes;
  return h.type == ElementType::u8 && axes.size() >= 3 && (axes[0].size == 3 || axes[0].size == 4) && std::isnan(axes[0].spacing) &&
         std::all_of(axes.begin() + 1, axes.end(), [](const NrrdAxis& a) { return a.size >= least; });
}

}  // namespace

void classify_axes(NrrdHeader& h) {
  enum class Is { unknown, space, time, components };
  const size_t n = h.axes.size();
  std::vector<Is> is(n, Is::unknown);
  bool some_spacing = false;
  for (const NrrdAxis& a : h.axes) some_spacing = some_spacing || a.spacing == a.spacing;
  for (size_t i = 0; i < n; ++i) {
    const NrrdAxis& a = h.axes[i];
    if (a.has_direction || a.kind == "domain" || a.kind == "space") is[i] = Is::space;
    else if (a.kind == "time") is[i] = Is::time;
    else if (a.no_direction || !(a.kind.empty() || a.kind == "none" || a.kind == "???")) is[i] = Is::components;
    else if (i == 0 && is_picture(h)) is[i] = Is::components;
    else if (i == 0 && n >= 2 && some_spacing && a.spacing != a.spacing) is[i] = Is::components;
    else is[i] = Is::space;
  }
  auto spaces = [&] { return size_t(std::count(is.begin(), is.end(), Is::space)); };
  for (size_t i = 0; i < n; ++i)
    if (is[i] == Is::time) is[i] = spaces() < 3 ? Is::space : Is::components;
  if (spaces() > 3 && is[0] == Is::space && h.axes[0].size <= 9 && h.axes[0].size < h.axes[n - 1].size) is[0] = Is::components;
  for (size_t i = n; i-- > 0 && spaces() > 3;)
    if (is[i] == Is::space) is[i] = Is::components;
  for (size_t i = 0; i < n; ++i) h.axes[i].is_space = is[i] == Is::space;
}

UniformGrid nrrd_grid(const NrrdHeader& h) {
  UniformGrid g;
  Vec3 direction[3];
  size_t n = 0;
  bool all_directions = true;
  for (const NrrdAxis& a : h.axes) {
    if (!a.is_space) continue;
    const int k = int(n);
    g.dims[n] = a.size;
    if (a.has_direction) {
      direction[n] = a.direction;
      g.spacing[k] = length(a.direction);
    } else {
      all_directions = false;
      const bool range = a.min == a.min && a.max == a.max && a.max != a.min;
      // Samples of cells lie in the middle of their share of min..max, samples of nodes at both ends.
      const bool cell = a.centering == "cell";
      if (a.spacing == a.spacing) g.spacing[k] = a.spacing;
      else if (range && (cell || a.size > 1)) g.spacing[k] = (a.max - a.min) / double(cell ? a.size : a.size - 1);
      if (a.min == a.min) g.origin[k] = a.min + (cell ? 0.5 * g.spacing[k] : 0);
    }
    ++n;
  }
  if (all_directions && n > 0) g.direction = direction_of(direction, int(n), h.path);
  if (h.has_origin) g.origin = h.origin;
  turn(g, patient_axes(h.space).value_or(PatientAxes()));
  return g;
}

}  // namespace sg
