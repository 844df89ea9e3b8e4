// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/geographic.h"

#include <fmt/core.h>

#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "data/fields/axis_notes.h"
#include "data/trusted.h"
#include "filter/flow/line_mesh.h"

namespace sg {

namespace {

constexpr double metres_per_degree = 6371000 * M_PI / 180;
constexpr size_t points_per_chunk = 1 << 14;

// "m s-1", "m/s", "m.s^-1" and the like as one word.
std::string squeezed(std::string_view unit) {
  std::string r;
  for (const char c : to_lower(unit))
    if (c != ' ' && c != '.' && c != '^' && c != '*' && c != '(' && c != ')') r += c;
  return r;
}

// Metres a second in the unit; 0 when it is not a speed.
double metres_per_second(std::string_view unit) {
  struct Known {
    std::string_view text;
    double factor;
  };
  static constexpr Known known[] = {
      {"ms-1", 1},          {"m/s", 1},     {"s-1m", 1},        {"meters/second", 1}, {"metersecond-1", 1},     {"meterssecond-1", 1},
      {"cms-1", 0.01},      {"cm/s", 0.01}, {"kmh-1", 1 / 3.6}, {"km/h", 1 / 3.6},    {"knots", 1852 / 3600.0}, {"kt", 1852 / 3600.0},
      {"kn", 1852 / 3600.0}};
  const std::string word = squeezed(unit);
  for (const Known& k : known)
    if (k.text == word) return k.factor;
  return 0;
}

bool on_a_globe(const Box3& b) { return b.lo.y >= -90.01 && b.hi.y <= 90.01 && b.hi.x - b.lo.x <= 360.01 * 2; }

// f(latitude in degrees, velocity) for each point.
template <class F>
Array changed(const Array& positions, const Array& velocity, F&& f) {
  const Array at = positions.converted(ElementType::f64), v = velocity.converted(ElementType::f64).made_packed();
  const size_t n = v.count(), m = size_t(v.components());
  float* out = nullptr;
  Array r = Array::make<float>(n, v.components(), &out);
  const Array packed = at.made_packed();
  const double *x = packed.view<double>().data, *from = v.view<double>().data;
  parallel_for(n, points_per_chunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3 now = f(x[3 * i + 1], Vec3(from[i * m], from[i * m + 1], m > 2 ? from[i * m + 2] : 0.0));
      for (size_t a = 0; a < m; ++a) out[i * m + a] = float(now[int(a)]);
    }
  });
  return r;
}

double cosine(double latitude) {
  const double c = std::cos(latitude * M_PI / 180);
  return c > 1e-6 ? c : NAN;  // at the poles no longitude is any
}

}  // namespace

bool needs_geographic(const Dataset& d, const Field& velocity) {
  const auto x = axis_note(d, 0), y = axis_note(d, 1);
  return x && x->in_degrees() && y && y->in_degrees() && metres_per_second(velocity.unit) > 0 && on_a_globe(d.bounds());
}

void warn_of_degrees(const Dataset& d, const Field& velocity, std::string_view who, Context& context) {
  if (needs_geographic(d, velocity))
    context.warn(fmt::format("{}: positions are in degrees, but '{}' is in {}: it is traced as if in degrees; geographic=true converts it",
                             who, velocity.name, velocity.unit));
}

double seconds_of_time(const Dataset& d) {
  for (const auto& [key, text] : d.notes()) {
    if (key != "time") continue;
    const auto all = words(text);
    const std::string unit = all.empty() ? "" : to_lower(all[0]);
    if (unit.starts_with("day") || unit == "d") return 86400;
    if (unit.starts_with("hour") || unit.starts_with("hr") || unit == "h") return 3600;
    if (unit.starts_with("min")) return 60;
    if (unit.starts_with("msec") || unit.starts_with("millisec")) return 1e-3;
  }
  return 1;
}

Data geographic_flow(const Data& data, const std::string& field, double seconds, std::string_view who) {
  return map_datasets(data, [&](const DatasetPtr& d) {
    const Field* f = d->fields().find(field);
    if (!f) return d;
    if (f->association != Association::point)
      fail_usage(fmt::format("field '{}' is a cell field", field), std::string(who) + " geographic",
                 "cell_to_point converts it to a point field");
    if (!on_a_globe(d->bounds()))
      fail_usage(fmt::format("latitudes range from {:.6g} to {:.6g}", d->bounds().lo.y, d->bounds().hi.y), std::string(who) + " geographic",
                 "x must be longitude and y latitude, in degrees");
    const double unit = metres_per_second(f->unit), scale = (unit > 0 ? unit : 1) * seconds / metres_per_degree;
    DatasetParts parts = d->parts();
    Field now = *f;
    now.array = changed(point_positions(d->mesh()), f->array, [&](double latitude, Vec3 v) {
      return Vec3(v.x * scale / cosine(latitude), v.y * scale, v.z * (unit > 0 ? unit : 1) * seconds);
    });
    parts.fields.add(std::move(now));
    return make_trusted_dataset(std::move(parts));
  });
}

DatasetPtr in_metres(const DatasetPtr& traced, const std::string& field, double seconds) {
  const Field* f = traced->fields().find(field, Association::point);
  if (!f) return traced;
  const double unit = metres_per_second(f->unit), scale = metres_per_degree / seconds / (unit > 0 ? unit : 1);
  DatasetParts parts = traced->parts();
  Field now = *f;
  now.array = changed(point_positions(traced->mesh()), f->array, [&](double latitude, Vec3 v) {
    return Vec3(v.x * scale * cosine(latitude), v.y * scale, v.z / seconds / (unit > 0 ? unit : 1));
  });
  if (const Field* old = traced->fields().find(own_value("speed", field), Association::point)) {
    const View<float> v = now.array.view<float>();
    const size_t m = size_t(now.components());
    float* out = nullptr;
    Field speed = *old;
    speed.array = Array::make<float>(now.array.count(), 1, &out);
    for (size_t i = 0; i < now.array.count(); ++i)
      out[i] = float(length(Vec3(v.data[i * m], v.data[i * m + 1], m > 2 ? v.data[i * m + 2] : 0.f)));
    parts.fields.add(std::move(speed));
  }
  parts.fields.add(std::move(now));
  return make_trusted_dataset(std::move(parts));
}

}  // namespace sg
