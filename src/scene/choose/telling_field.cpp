// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/telling_field.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <span>

#include "base/text/text.h"
#include "data/lattice.h"

namespace sg {

namespace {

using std::string_view_literals::operator""sv;

constexpr double rounding = 1e-12;

double size_of(const Range& r) { return r.empty() ? 0 : std::max(std::abs(r.lo), std::abs(r.hi)); }

// The words of a name: "vtkGhostType" is vtk ghost type, "Block_Number" block number.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words;
  bool begin = true, was_lower = false;
  for (const char c : name) {
    const bool upper = c >= 'A' && c <= 'Z', letter = upper || (c >= 'a' && c <= 'z');
    if (!letter) {
      begin = true, was_lower = false;
      continue;
    }
    if (begin || (upper && was_lower)) words.emplace_back();
    words.back() += upper ? char(c - 'A' + 'a') : c;
    begin = false, was_lower = !upper;
  }
  return words;
}

bool any_of(const std::vector<std::string>& words, std::span<const std::string_view> among) {
  return std::any_of(words.begin(), words.end(),
                     [&](const std::string& w) { return std::find(among.begin(), among.end(), w) != among.end(); });
}

constexpr std::string_view numberings[] = {"id"sv,     "ids"sv,   "gid"sv,    "nodenums"sv, "elemnums"sv, "mask"sv,
                                           "iblank"sv, "ghost"sv, "ghosts"sv, "valid"sv,    "procid"sv,   "pid"sv};
// Of integers only: there is a Mach number and an index of refraction.
constexpr std::string_view whole_numberings[] = {"number"sv,    "index"sv, "rank"sv,  "proc"sv,
                                                 "processor"sv, "owner"sv, "blank"sv, "blanking"sv};
constexpr std::string_view divisions[] = {"block"sv, "part"sv,  "partition"sv, "domain"sv, "material"sv,   "mat"sv,
                                          "zone"sv,  "group"sv, "region"sv,    "level"sv,  "refinement"sv, "subdomain"sv};
constexpr std::string_view coordinates[] = {"x"sv,   "y"sv,   "z"sv,         "coords"sv,   "coordinates"sv, "xyz"sv,      "points"sv,
                                            "lon"sv, "lat"sv, "longitude"sv, "latitude"sv, "position"sv,    "positions"sv};

// 5, 6, 7, ... in the order of the points or cells.
bool counts_up(const Field& f) {
  const size_t n = std::min<size_t>(f.array.count(), 1000);
  if (n < 16) return false;
  for (size_t i = 1; i < n; ++i)
    if (f.array.get(i) != f.array.get(i - 1) + 1) return false;
  return true;
}

constexpr size_t few_numbers = 64;  // a legend of names has room for them

// Numbers that reach so far that most things can have their own.
bool one_for_each(const Field& f, const Range& r) {
  return f.array.count() > few_numbers && r.hi - r.lo + 1 >= 0.5 * double(f.array.count());
}

// Whole numbers, however they are stored; looked at in some places.
bool holds_whole_values(const Field& f) {
  if (!is_float(f.array.type())) return true;
  const size_t n = f.array.count(), step = std::max<size_t>(1, n / 4096);
  for (size_t i = 0; i < n; i += step)
    if (const double v = f.array.get(i); std::isfinite(v) && v != std::round(v)) return false;
  return true;
}

bool is_id(const Field& f, const std::vector<std::string>& words) {
  const std::string name = to_lower(f.name);
  const bool ends = name.ends_with("id") || name.ends_with("ids");
  return ends && (!is_float(f.array.type()) || words.back() == "id" || words.back() == "ids");  // no "solid" of real numbers
}

// More different values than a legend can name.
bool has_many_values(const Field& f) {
  std::set<double> values;
  for (size_t i = 0; i < f.array.count() && values.size() <= few_numbers; ++i) values.insert(f.array.get(i));
  return values.size() > few_numbers;
}

// Numbers under which a program keeps its groups (the objects of an OBJ file), or of more things than a legend can name: a bar of colours
// over them would be read as a quantity.
bool ids_of_groups(const Field& f, const std::vector<std::string>& words) {
  if (words.empty() || (words.back() != "id" && words.back() != "ids") || f.role == Role::labels || !holds_whole_values(f)) return false;
  const bool of_groups = std::any_of(words.begin(), words.end(), [](const std::string& w) { return w == "group" || w == "groups"; });
  return of_groups || has_many_values(f);
}

// Of any point; nothing for AMR grids.
std::function<Vec3(size_t)> positions_of(const Mesh& mesh) {
  if (is_lattice(mesh))
    return [lattice = std::make_shared<Lattice>(mesh)](size_t i) {
      const LatticeView& v = lattice->view();
      return v.position(i % v.dims[0], i / v.dims[0] % v.dims[1], i / v.dims[0] / v.dims[1]);
    };
  return std::visit(
      [](const auto& m) -> std::function<Vec3(size_t)> {
        if constexpr (requires { m.points.at(size_t()); }) return [&m](size_t i) { return m.points.at(i); };
        else return nullptr;
      },
      mesh);
}

// The positions of the points themselves, or one of their coordinates: looked at in some places.
bool is_position(const Dataset& d, const Field& f) {
  const std::string name = to_lower(f.name);
  if (f.association != Association::point || (f.components() != 3 && f.components() != 1)) return false;
  if (f.components() == 1 && std::find(std::begin(coordinates), std::end(coordinates), name) == std::end(coordinates)) return false;
  const auto at = positions_of(d.mesh());
  if (!at) return false;
  const size_t n = f.array.count(), step = std::max<size_t>(1, n / 64);
  const double near = 1e-5 * d.bounds().diagonal();
  bool along[3] = {true, true, true};
  for (size_t i = 0; i < n; i += step) {
    const Vec3 p = at(i);
    for (int c = 0; c < 3; ++c) {
      if (f.components() == 3 && !(std::abs(f.array.get(i, c) - p[c]) <= near)) return false;
      if (f.components() == 1) along[c] = along[c] && std::abs(f.array.get(i) - p[c]) <= near;
    }
  }
  return n > 0 && (f.components() == 3 || along[0] || along[1] || along[2]);
}

// Everything else in the file is larger by twelve orders of magnitude.
bool is_rounding(const Dataset& d, const Field& f, double size) {
  if (size >= 1e-3 || !is_float(f.array.type())) return false;  // ranges cost a pass over each field
  return std::any_of(d.fields().begin(), d.fields().end(), [&](const Field& o) {
    const bool alike = o.association == f.association || size < rounding;  // a fraction at points may be small beside energies of cells
    return &o != &f && alike && is_float(o.array.type()) && o.role != Role::normals && o.role != Role::tcoords &&
           o.association != Association::whole && size < rounding * size_of(d.range(o));
  });
}

}  // namespace

bool names_numbers(const Field& f) {
  const std::vector<std::string> words = words_of(f.name);
  return f.components() == 1 && (is_id(f, words) || any_of(words, divisions)) && holds_whole_values(f);
}

Telling telling(const Dataset& d, const Field& f) {
  if (f.look.texture) return Telling::numbering;
  const Range r = d.range(f);
  if (r.empty()) return Telling::values;  // NaN alone: that is told elsewhere
  const double size = size_of(r);
  if (!(r.hi - r.lo > rounding * size) || is_rounding(d, f, size)) return Telling::nothing;
  const bool whole = holds_whole_values(f), integers = !is_float(f.array.type());
  const std::vector<std::string> words = words_of(f.name);
  if (f.components() == 1) {
    const bool named_id = any_of(words, numberings) || (whole && is_id(f, words)) || (integers && any_of(words, whole_numberings));
    const bool counts = counts_up(f);
    if (counts && is_lattice(d.mesh()) && !named_id) return Telling::numbering;  // the ramp of an image
    if (counts || (named_id && (one_for_each(f, r) || ids_of_groups(f, words)))) return Telling::ids;
    if (named_id) return Telling::numbering;
    if (integers && r.lo == 0 && r.hi == 1 && element_size(f.array.type()) == 1) return Telling::numbering;  // a mask
    if (whole && any_of(words, divisions)) return Telling::divisions;
    if (f.role == Role::labels) return Telling::divisions;
  }
  if (is_position(d, f)) return Telling::numbering;
  return Telling::values;
}

}  // namespace sg
