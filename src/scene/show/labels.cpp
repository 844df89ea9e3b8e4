// SPDX-License-Identifier: Apache-2.0
#include "scene/show/labels.h"

#include <fmt/core.h>

#include "base/schema/color_params.h"
#include "base/text/text.h"
#include "color/parse_color.h"
#include "data/cells/point_positions.h"
#include "filter/scalar/line_labels.h"

namespace sg {

namespace {

const Field* numbers(const Dataset& d, std::string_view name) {
  const Field* f = d.fields().find(name, Association::point);
  return f && f->components() == 1 ? f : nullptr;
}

}  // namespace

void describe(Schema& s, LabelsShow& p) {
  s("field", p.field, "Point field whose values are written; default: 'value', else the active scalar.");
  s("size", p.size, "Text size; 1 is the size of the axis numbers.").range(0.1, 20);
  s("color", p.color, "Text colour; default: that of all text.").unit(color_unit);
}

bool is_line_labels(const Dataset& d) { return d.as<PointCloud>() && numbers(d, "value") && numbers(d, "angle") && numbers(d, "line"); }

std::optional<Legend> add(Scene& scene, const DatasetPtr& input, const LabelsShow& p, Context&) {
  const Dataset& d = *input;
  const Field* value = p.field.empty() ? numbers(d, "value") : &d.fields().require(p.field.name);
  if (!value) value = d.fields().active(1);
  if (!value || value->association != Association::point || value->components() != 1)
    fail_usage(value ? fmt::format("field '{}' does not have one number per point", value->name) : "there are no values to write", "labels",
               "use line_labels to label contour lines");
  const Field *angle = numbers(d, "angle"), *towards = d.fields().find("normal", Association::whole);
  Vec3 normal{0, 0, 1};
  if (towards && towards->components() == 3 && towards->array.count() == 1)
    normal = {towards->array.get(0, 0), towards->array.get(0, 1), towards->array.get(0, 2)};
  const auto [right, up] = label_page(normal);
  std::vector<double> written;
  std::vector<size_t> points;
  for (size_t i = 0; i < value->array.count(); ++i)
    if (const double v = value->array.get(i); std::isfinite(v)) written.push_back(v), points.push_back(i);
  const Array at = point_positions(d.mesh());
  const std::vector<std::string> texts = distinct_texts(written);
  const std::optional<Vec3f> color = p.color.empty() ? std::nullopt : std::optional(parse_color(p.color, "color"));
  for (size_t k = 0; k < points.size(); ++k) {
    TextItem t;
    t.at = {at.get(points[k], 0), at.get(points[k], 1), at.get(points[k], 2)};
    if (angle) {
      const double a = angle->array.get(points[k]) * 3.14159265358979323846 / 180;
      t.along = right * std::cos(a) + up * std::sin(a);
    }
    t.text = texts[k], t.size = p.size, t.color = color;
    scene.texts.push_back(std::move(t));
  }
  return {};
}

}  // namespace sg
