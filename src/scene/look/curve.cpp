// SPDX-License-Identifier: Apache-2.0
// Values along one axis, along a line or in the rows of a table: curves.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/text/text.h"
#include "data/lattice.h"
#include "data/patient/patient_frame.h"
#include "scene/look/look_parts.h"
#include "scene/show/surface.h"

namespace sg {

namespace {

constexpr double height = 0.6;  // of a curve, as a share of its length

std::string titled(const std::string& name, const std::string& unit) { return unit.empty() ? name : fmt::format("{} [{}]", name, unit); }

void show_curve(Look& look) {
  SurfaceShow curve;
  curve.coloring.color = "steelblue";
  add_show(look, curve, false);
}

// Distances or times to the right, values upwards.
void face_plot(Look& look, const Range& across, const Range& values, const std::string& x_title, const std::string& y_title) {
  face_axis(2, false, look.camera);
  const double width = across.hi - across.lo, rise = values.hi - values.lo;
  if (rise > 0 && width > 0) look.picture.push_back(fmt::format("stretch=1,{},1", height * width / rise));
  look.picture.push_back("x_title=" + x_title);
  look.picture.push_back("y_title=" + y_title);
}

bool increases(const Field& column) {
  double last = -HUGE_VAL;
  for (size_t i = 0; i < column.array.count(); ++i) {
    const double x = column.array.get(i);
    if (!(x > last)) return false;
    last = x;
  }
  return true;
}

Range range_of(const Field& column) {
  Range r;
  for (size_t i = 0; i < column.array.count(); ++i)
    if (const double x = column.array.get(i); std::isfinite(x)) r.add({x, x});
  return r;
}

// What says where a row or a point is, and no value there.
bool is_place(const std::string& name) {
  static constexpr std::string_view columns[] = {"distance", "valid", "x", "y", "z", "points", "position"};
  const std::string n = to_lower(name);
  return std::find(std::begin(columns), std::end(columns), n) != std::end(columns) || n.starts_with("points:") ||
         n.starts_with("points_") || n.starts_with("position_");
}

}  // namespace

bool look_at_profile(const Dataset& d, const Field& f, Look& look) {
  if (!is_lattice(d.mesh()) || in_patient_frame(d) || f.association != Association::point || f.components() != 1) return false;
  const auto dims = lattice_dims(d.mesh());
  const Vec3 size = d.bounds().size();
  const Range r = d.range(f);
  const int along = dims[0] > 1 ? 0 : dims[1] > 1 ? 1 : 2;
  if (dims[0] * dims[1] * dims[2] != dims[size_t(along)] || dims[size_t(along)] < 3 || !(r.lo < r.hi) || !(size[along] > 0)) return false;
  const int values = along == 0 ? 1 : 0;
  Vec3 direction, stretch{1, 1, 1};
  direction[values] = 1, stretch[values] = height * size[along] / (r.hi - r.lo);
  look.filter = {"warp", "field=" + f.name, fmt::format("direction={},{},0", direction.x, direction.y), "scale=1"};
  show_curve(look);
  look.picture = {fmt::format("stretch={},{},1", stretch.x, stretch.y), fmt::format("{}_title={}", "xyz"[values], titled(f.name, f.unit))};
  look.reason = fmt::format("'{}' along one axis: its curve", f.name);
  return true;
}

bool look_at_line_probe(const Dataset& d, const Field& automatic, Look& look) {
  const auto* mesh = d.as<SurfaceMesh>();
  const Field* distance = d.fields().find("distance", Association::point);
  if (!mesh || !distance || !d.fields().find("valid", Association::point)) return false;
  if (mesh->lines.size() != 1 || mesh->cell_count() != 1) return false;
  const auto tells = [&](const Field& f) { return f.association == Association::point && f.components() == 1 && !is_place(f.name); };
  const Field* f = &automatic;
  if (!tells(*f)) {
    const auto any = std::find_if(d.fields().begin(), d.fields().end(), tells);
    if (any == d.fields().end()) return false;
    f = &*any;
  }
  const Range values = d.range(*f, 0);
  if (values.empty()) return false;
  look.filter = {"profile", "field=" + f->name};
  show_curve(look);
  face_plot(look, d.range(*distance, 0), values, "distance", titled(f->name, f->unit));
  look.reason =
      fmt::format("values along a line: the curve of '{}' over the distance; --show surface shows the line where it lies", f->name);
  return true;
}

std::optional<Look> look_at_table(const Table& t, const std::string& field) {
  constexpr size_t least_rows = 3;
  const Field *across = nullptr, *upwards = nullptr;
  for (size_t i = 0; i < t.columns.size(); ++i) {
    const Field& c = t.columns[i];
    if (t.words(i)) return {};  // rows that are told apart by words are things: no step leads from one to the next
    if (c.components() != 1 || c.array.count() < least_rows) continue;
    if ((!across || c.name == "distance") && increases(c)) across = &c;
  }
  if (!across) return {};
  for (size_t i = 0; i < t.columns.size() && !upwards; ++i) {
    const Field& c = t.columns[i];
    if (c.components() != 1 || &c == across || (field.empty() ? is_place(c.name) : c.name != field)) continue;
    if (const Range r = range_of(c); !field.empty() || (!r.empty() && r.lo < r.hi)) upwards = &c;
  }
  if (!upwards) return {};
  Look look;
  look.filter = {"table_to_points", "x=" + across->name, "y=" + upwards->name, "line=true"};
  show_curve(look);
  face_plot(look, range_of(*across), range_of(*upwards), titled(across->name, across->unit), titled(upwards->name, upwards->unit));
  look.reason =
      fmt::format("a table: the curve of '{}' over '{}'; --field names another column, -f table_to_points makes points of the rows",
                  upwards->name, across->name);
  return look;
}

}  // namespace sg
