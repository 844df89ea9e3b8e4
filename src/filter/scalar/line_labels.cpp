// SPDX-License-Identifier: Apache-2.0
#include "filter/scalar/line_labels.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "data/field_ops.h"
#include "filter/scalar/isolines.h"
#include "filter/surface/polygons.h"

namespace sg {

namespace {

// A polyline by its arc length; a closed one goes round.
class Course {
 public:
  Course(std::vector<Vec3> at, std::vector<double> value, bool closed) : at_(std::move(at)), value_(std::move(value)), closed_(closed) {
    s_.push_back(0);
    for (size_t k = 0; k + 1 < at_.size(); ++k) s_.push_back(s_.back() + length(at_[k + 1] - at_[k]));
  }
  double size() const { return s_.back(); }
  bool closed() const { return closed_; }
  Vec3 place(double s) const {
    const auto [k, t] = find(s);
    return lerp(at_[k], at_[k + 1], t);
  }
  double value(double s) const {
    const auto [k, t] = find(s);
    return value_[k] == value_[k + 1] ? value_[k] : value_[k] + (value_[k + 1] - value_[k]) * t;
  }

 private:
  std::pair<size_t, double> find(double s) const {
    if (closed_) s -= std::floor(s / size()) * size();
    s = std::clamp(s, 0.0, size());
    size_t k = size_t(std::upper_bound(s_.begin(), s_.end(), s) - s_.begin());
    k = std::clamp<size_t>(k, 1, s_.size() - 1) - 1;
    const double d = s_[k + 1] - s_[k];
    return {k, d > 0 ? (s - s_[k]) / d : 0.0};
  }
  std::vector<Vec3> at_;
  std::vector<double> value_, s_;
  bool closed_;
};

struct Labels {
  std::vector<Vec3> at;
  std::vector<double> value, angle;
  std::vector<int32_t> line;
};

void label(const Course& line, int32_t number, double spacing, double width, Vec3 right, Vec3 up, Labels& out) {
  if (line.size() < 2 * width || !(line.size() > 0)) return;
  const auto stretches = size_t(std::max(1.0, std::floor(line.size() / spacing)));
  const double each = line.size() / double(stretches);
  constexpr int candidates = 33;
  for (size_t k = 0; k < stretches; ++k) {
    double best = -1, best_s = 0;
    for (int i = 0; i < candidates; ++i) {
      // From the middle outwards, so that ties stay near it.
      const double offset = (i % 2 ? 0.5 : -0.5) * ((i + 1) / 2) * 2 / double(candidates + 1);
      const double s = each * (double(k) + 0.5 + offset * 0.9);
      if (!line.closed() && (s < width * 0.6 || s > line.size() - width * 0.6)) continue;
      const Vec3 here = line.place(s);
      const bool crowded = std::any_of(out.at.begin(), out.at.end(), [&](Vec3 p) { return length(p - here) < 1.2 * width; });
      if (crowded) continue;
      const double straight = length(line.place(s + width / 2) - line.place(s - width / 2)) / width;
      if (straight > best + 1e-6) best = straight, best_s = s;
    }
    if (best < 0) continue;
    const Vec3 along = line.place(best_s + width / 2) - line.place(best_s - width / 2);
    double angle = std::atan2(dot(along, up), dot(along, right)) * 180 / 3.14159265358979323846;
    if (angle > 90 + 1e-9) angle -= 180;
    else if (angle <= -90 + 1e-9) angle += 180;
    out.at.push_back(line.place(best_s)), out.value.push_back(line.value(best_s)), out.angle.push_back(angle), out.line.push_back(number);
  }
}

}  // namespace

std::pair<Vec3, Vec3> label_page(Vec3 n) {
  n = normalize(n);
  const Vec3 vertical = std::abs(n.z) > 0.9 ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
  const Vec3 up = normalize(vertical - n * dot(n, vertical));
  return {cross(up, n), up};
}

DatasetPtr line_labels(const DatasetPtr& in, const LineLabelsParams& p, Context& ctx) {
  if (!(length(p.normal) > 0) || !std::isfinite(length(p.normal)))
    fail_usage("the normal has no length", "line_labels normal", "write e.g. normal=0,0,1");
  const Field* field = nullptr;
  if (!p.field.empty()) field = with_context("line_labels", [&] { return &in->fields().require(p.field.name); });
  else field = in->fields().find("contour value", Association::cell);
  if (!field) field = in->fields().active(1);
  if (!field) fail_usage("the mesh has no scalar field", "line_labels", "name one: field=NAME");
  if (field->association == Association::whole || field->components() != 1)
    fail_usage(fmt::format("field '{}' does not have one number per point or cell", field->name), "line_labels");
  PolylinesParams by;
  if (field->association == Association::cell) by.fields = {field->name};
  const std::string name = field->name;
  const Association where = field->association;
  const DatasetPtr lines = polylines(in, by, ctx);
  const Field& f = lines->fields().require(name, where);
  const auto& mesh = *lines->as<SurfaceMesh>();
  const CellsView cells = cells_view(mesh.lines);
  const std::vector<Vec3> at = surface::positions(mesh.points);
  const Field& closed = lines->fields().require("closed", Association::cell);
  const double diagonal = in->bounds().diagonal();
  const double spacing = p.spacing > 0 ? p.spacing : diagonal / 3, width = p.width > 0 ? p.width : diagonal * 0.05;
  const auto [right, up] = label_page(p.normal);
  Labels labels;
  for (size_t l = 0; l < cells.count; ++l) {
    if (l % 1024 == 0) ctx.check();
    std::vector<Vec3> points;
    std::vector<double> values;
    for (size_t k = cells.begin(l); k < cells.end(l); ++k) {
      const auto id = size_t(cells.connectivity[k]);
      points.push_back(at[id]);
      values.push_back(f.array.get(where == Association::cell ? l : id));
    }
    if (points.size() > 1) label(Course(points, values, closed.array.get(l) != 0), int32_t(l), spacing, width, right, up, labels);
  }
  if (labels.at.empty()) ctx.info("line_labels: no line is long enough for a label");
  PointCloud cloud;
  std::vector<double> xyz;
  for (Vec3 q : labels.at) xyz.insert(xyz.end(), {q.x, q.y, q.z});
  cloud.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts out;
  out.fields.add({"value", Association::point, Array::from_vector(std::move(labels.value)), f.unit, Role::scalars});
  out.fields.add({"angle", Association::point, Array::from_vector(std::move(labels.angle)), "deg", Role::none});
  out.fields.add({"line", Association::point, Array::from_vector(std::move(labels.line)), "", Role::labels});
  carry_whole(out.fields, in->fields());
  out.fields.add(
      {"normal", Association::whole, Array::from_vector(std::vector<double>{p.normal.x, p.normal.y, p.normal.z}, 3), "", Role::none});
  out.mesh = std::move(cloud);
  out.notes = in->notes();
  out.time = in->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
