// SPDX-License-Identifier: Apache-2.0
#include "cli/info.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/info_names.h"
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "io/scene/file_scene.h"

namespace sg {

namespace {

std::string number(double v) { return std::isfinite(v) ? exact_number(v) : "null"; }

std::string range_json(const FieldStats& s) {
  std::string r = "[";
  for (size_t c = 0; c < s.range.size(); ++c)
    r += (c ? "," : "") + (s.range[c].empty() ? std::string("null") : "[" + number(s.range[c].lo) + "," + number(s.range[c].hi) + "]");
  return r + "]";
}

std::string bounds_json(const Box3& b) {
  if (b.empty()) return "null";
  return "[" + number(b.lo.x) + "," + number(b.hi.x) + "," + number(b.lo.y) + "," + number(b.hi.y) + "," + number(b.lo.z) + "," +
         number(b.hi.z) + "]";
}

std::string times_json(const std::vector<double>& times) {
  std::string r = "[";
  for (size_t i = 0; i < times.size(); ++i) r += (i ? "," : "") + number(times[i]);
  return r + "]";
}

std::string dataset_json(const Dataset& d, bool quick, const std::vector<double>* times) {
  std::string r = fmt::format("\"kind\":\"{}\",\"dims\":[", d.kind());
  if (is_lattice(d.mesh())) {
    const auto n = lattice_dims(d.mesh());
    r += fmt::format("{},{},{}", n[0], n[1], n[2]);
  }
  r += fmt::format("],\"points\":{},\"cells\":{},\"cell_types\":{{", d.point_count(), d.cell_count());
  bool first = true;
  for (const auto& [name, count] : cell_type_counts(d.mesh())) {
    r += fmt::format("{}\"{}\":{}", first ? "" : ",", name, count);
    first = false;
  }
  r += "},\"bounds\":" + bounds_json(d.bounds());
  if (auto* g = d.as<UniformGrid>()) {
    r += fmt::format(",\"origin\":[{},{},{}]", number(g->origin.x), number(g->origin.y), number(g->origin.z));
    r += fmt::format(",\"spacing\":[{},{},{}],\"direction\":[", number(g->spacing.x), number(g->spacing.y), number(g->spacing.z));
    for (int i = 0; i < 9; ++i) r += (i ? "," : "") + number(g->direction.m[i / 3][i % 3]);
    r += "]";
    if (in_patient_frame(d)) r += fmt::format(",\"axes\":\"{}\"", axis_letters(g->direction));
  }
  if (in_patient_frame(d)) r += ",\"frame\":\"LPS\"";
  for (const auto& [key, value] : d.notes())
    if (key == cameras_note || key == lights_note) r += fmt::format(",\"{}\":{}", key, json_string(value));
  r += ",\"fields\":[";
  first = true;
  for (const Field& f : d.fields()) {
    r += fmt::format("{}{{\"name\":{},\"association\":\"{}\",\"type\":\"{}\",\"components\":{}", first ? "" : ",", json_string(f.name),
                     association_name(f.association), element_name(f.array.type()), f.components());
    if (f.association == Association::whole) r += fmt::format(",\"tuples\":{}", f.array.count());
    if (!f.unit.empty()) r += ",\"unit\":" + json_string(f.unit);
    r += names_json(d, f);
    if (!quick) {
      const FieldStats& s = d.stats(f);
      r += fmt::format(",\"range\":{},\"nan\":{}", range_json(s), s.nan);
      if (s.infinite) r += fmt::format(",\"infinite\":{}", s.infinite);
    }
    r += "}";
    first = false;
  }
  if (times && !times->empty()) return r + "],\"time\":" + (d.time() ? number(*d.time()) : "null") + ",\"times\":" + times_json(*times);
  return r + "],\"times\":[" + (d.time() ? number(*d.time()) : std::string()) + "]";
}

std::string table_json(const Table& t) {
  std::string r = "\"kind\":\"table\",\"columns\":[";
  for (size_t i = 0; i < t.columns.size(); ++i) {
    const Field& f = t.columns[i];
    const auto* labels = t.words(i);
    r += fmt::format("{}{{\"name\":{},\"type\":\"{}\",\"rows\":{}", i ? "," : "", json_string(f.name),
                     labels ? "words" : element_name(f.array.type()), f.array.count());
    if (labels) r += fmt::format(",\"distinct\":{}}}", labels->size());
    else r += ",\"range\":" + range_json(field_stats(f.array)) + "}";
  }
  return r + "]";
}

std::string data_json(const Data& data, bool quick, const std::vector<double>* times) {
  if (auto* d = std::get_if<DatasetPtr>(&data)) return dataset_json(**d, quick, times);
  if (auto* t = std::get_if<TablePtr>(&data)) return table_json(**t);
  std::string r = "\"kind\":\"collection\",\"parts\":[";
  const auto& parts = std::get<CollectionPtr>(data)->parts;
  for (size_t i = 0; i < parts.size(); ++i)
    r += (i ? ",{\"name\":" : "{\"name\":") + json_string(parts[i].name) + "," + data_json(parts[i].data, quick, nullptr) + "}";
  return r + "]" + (times ? ",\"times\":" + times_json(*times) : "");
}

std::string range_text(const Range& r) {
  if (r.empty()) return "no finite value";
  return r.lo == r.hi ? short_number(r.lo) + " (constant)" : short_number(r.lo) + " .. " + short_number(r.hi);
}

std::string field_line(const Dataset& d, const Field& f, size_t width, bool quick) {
  std::string type(element_name(f.array.type()));
  if (f.components() > 1) type += fmt::format(" x{}", f.components());
  std::string line = fmt::format("  {:<{}}  {:<5}  {:<8}", printable(f.name), width, association_name(f.association), type);
  if (f.association == Association::whole) line += fmt::format("  {} values", f.array.count());
  if (!quick) {
    const FieldStats& s = d.stats(f);
    if (f.components() == 1) line += "  " + range_text(s.range[0]);
    else if (f.components() <= 4) {
      line += "  ";
      for (int c = 0; c < f.components(); ++c) line += (c ? ", " : "") + range_text(s.range[size_t(c)]);
      line += "; length " + range_text(s.magnitude);
    } else {
      Range all;
      for (const Range& r : s.range) all.add(r);
      line += "  " + range_text(all) + " over all components";
    }
    if (!f.unit.empty()) line += " " + printable(f.unit);
    if (s.nan) line += fmt::format("; {} NaN", s.nan);
    if (s.infinite) line += fmt::format("; {} infinite", s.infinite);
  }
  return line + names_text(d, f, quick) + "\n";
}

std::string dataset_text(const Dataset& d, const std::string& name, bool quick) {
  std::string r = printable(name) + "\n  mesh    " + std::string(d.kind());
  if (is_lattice(d.mesh())) {
    const auto n = lattice_dims(d.mesh());
    r += fmt::format(" {} x {} x {}", n[0], n[1], n[2]);
  }
  r += fmt::format(", {} points, {} cells", d.point_count(), d.cell_count());
  const auto types = cell_type_counts(d.mesh());
  if (!types.empty()) {
    r += "\n  cells   ";
    for (size_t i = 0; i < types.size(); ++i) r += fmt::format("{}{} {}", i ? ", " : "", types[i].first, types[i].second);
  }
  const Box3& b = d.bounds();
  if (b.empty()) r += "\n  bounds  none";
  else
    r += fmt::format("\n  bounds  x {} .. {}, y {} .. {}, z {} .. {}", short_number(b.lo.x), short_number(b.hi.x), short_number(b.lo.y),
                     short_number(b.hi.y), short_number(b.lo.z), short_number(b.hi.z));
  if (auto* g = d.as<UniformGrid>()) {
    r += fmt::format("\n  spacing {} x {} x {}", short_number(g->spacing.x), short_number(g->spacing.y), short_number(g->spacing.z));
    if (!(g->direction == Mat3{})) r += ", turned";
  }
  if (in_patient_frame(d)) {
    r += "\n  patient x to the left, y to the back, z to the head (LPS)";
    if (auto* g = d.as<UniformGrid>()) {
      const std::string l = axis_letters(g->direction);
      r += fmt::format("; voxels run to {} {} {}", l[0], l[1], l[2]);
    }
    for (const auto& [key, value] : d.notes())
      if (key == stored_space_note) r += "; in the file: " + printable(value);
  }
  for (const auto& [key, value] : d.notes())
    if (key == cameras_note || key == lights_note)
      r += fmt::format("\n  {:<7} {} (--{} file)", key, printable(value), key == cameras_note ? "camera" : "light");
  if (d.time()) r += "\n  time    " + short_number(*d.time());
  r += "\n";
  if (d.fields().empty()) return r + "  no fields\n";
  size_t width = 5;
  for (const Field& f : d.fields()) width = std::max(width, std::min<size_t>(f.name.size(), 32));
  r += fmt::format("  {:<{}}  {:<5}  {:<8}{}\n", "field", width, "on", "type", quick ? "" : "  range");
  for (const Field& f : d.fields()) r += field_line(d, f, width, quick);
  return r;
}

}  // namespace

std::string info_json(const Data& data, bool quick, const std::vector<double>& times) {
  return "{" + data_json(data, quick, &times) + "}\n";
}

namespace {

std::string table_cell(const Table& t, size_t column, size_t row) {
  const Array& a = t.columns[column].array;
  const double v = a.get(row);
  if (const auto* labels = t.words(column)) return v >= 0 && size_t(v) < labels->size() ? printable((*labels)[size_t(v)]) : "-";
  return std::isnan(v) ? "-" : is_float(a.type()) ? short_number(v) : exact_number(v);
}

// A table that fits a screen is shown; of a longer one, what each column holds.
std::string table_text(const Table& t, const std::string& name) {
  const size_t rows = t.columns.empty() ? 0 : t.columns[0].array.count();
  std::string r = fmt::format("{}\n  table of {} rows, {} columns\n", printable(name), rows, t.columns.size());
  if (rows <= 32 && t.columns.size() <= 24) {
    std::vector<size_t> width;
    for (size_t c = 0; c < t.columns.size(); ++c) {
      width.push_back(printable(t.columns[c].name).size());
      for (size_t i = 0; i < rows; ++i) width[c] = std::max(width[c], table_cell(t, c, i).size());
    }
    auto line = [&](auto&& cell) {
      for (size_t c = 0; c < t.columns.size(); ++c)
        r += t.words(c) ? fmt::format("  {:<{}}", cell(c), width[c]) : fmt::format("  {:>{}}", cell(c), width[c]);
      r += "\n";
    };
    line([&](size_t c) { return printable(t.columns[c].name); });
    for (size_t i = 0; i < rows; ++i) line([&](size_t c) { return table_cell(t, c, i); });
    return r;
  }
  size_t width = 6;
  for (const Field& f : t.columns) width = std::max(width, std::min<size_t>(f.name.size(), 32));
  for (size_t i = 0; i < t.columns.size(); ++i) {
    const Field& f = t.columns[i];
    const auto* labels = t.words(i);
    const std::string what = labels ? fmt::format("{} words", labels->size()) : range_text(field_stats(f.array).range[0]);
    r += fmt::format("  {:<{}}  {:<5}  {}\n", printable(f.name), width, labels ? "words" : element_name(f.array.type()), what);
  }
  return r;
}

std::string times_text(const std::vector<double>& times) {
  if (times.empty()) return "";
  return fmt::format("  times   {} .. {}, {} steps\n", short_number(times.front()), short_number(times.back()), times.size());
}

// Datasets and tables of a tree, each with the path of its names.
void add_parts(const Data& data, const std::string& name, const std::string& path, bool quick, std::string& out) {
  const std::string title = path.empty() ? name : name + ": " + path;
  if (auto* d = std::get_if<DatasetPtr>(&data)) {
    if (*d) out += dataset_text(**d, title, quick);
  } else if (auto* t = std::get_if<TablePtr>(&data)) {
    if (*t) out += table_text(**t, title);
  } else if (const auto& c = std::get<CollectionPtr>(data)) {
    for (const Collection::Part& part : c->parts) add_parts(part.data, name, path.empty() ? part.name : path + "/" + part.name, quick, out);
  }
}

}  // namespace

std::string info_text(const Data& data, const std::string& name, bool quick, const std::vector<double>& times) {
  std::string r;
  add_parts(data, name, "", quick, r);
  return (r.empty() ? printable(name) + "\n  empty\n" : r) + times_text(times);
}

std::string series_json(const SeriesRange& range, const std::vector<double>& times) {
  std::string r = "{\"times\":" + times_json(times) + ",\"bounds\":" + bounds_json(range.bounds) + ",\"fields\":[";
  for (size_t i = 0; i < range.fields.size(); ++i) {
    const SeriesField& f = range.fields[i];
    r += fmt::format("{}{{\"name\":{},\"association\":\"{}\",\"steps\":{},\"range\":{},\"nan\":{}}}", i ? "," : "", json_string(f.name),
                     association_name(f.association), f.steps, range_json(f.stats), f.stats.nan);
  }
  return r + "]}\n";
}

std::string series_text(const SeriesRange& range, const std::string& name, const std::vector<double>& times) {
  std::string r = printable(name) + ", over all steps\n" + times_text(times);
  size_t width = 5;
  for (const SeriesField& f : range.fields) width = std::max(width, std::min<size_t>(f.name.size(), 32));
  for (const SeriesField& f : range.fields) {
    r += fmt::format("  {:<{}}  {:<5}  ", printable(f.name), width, association_name(f.association));
    for (size_t c = 0; c < std::min<size_t>(f.stats.range.size(), 4); ++c) r += (c ? ", " : "") + range_text(f.stats.range[c]);
    if (f.steps != times.size()) r += fmt::format("; in {} steps", f.steps);
    if (f.stats.nan) r += fmt::format("; {} NaN", f.stats.nan);
    r += "\n";
  }
  return r;
}

}  // namespace sg
