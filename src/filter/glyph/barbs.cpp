// SPDX-License-Identifier: Apache-2.0
#include "filter/glyph/barbs.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/cells/point_positions.h"
#include "filter/glyph/instances.h"
#include "filter/glyph/shapes.h"

namespace sg {

namespace {

constexpr int steps = most_barb_knots / barb_step;
// On a staff of length 1.
constexpr double stroke = 0.42, lean = 0.16, gap = 0.125, pennant = 0.17, after_pennants = 0.07, calm_radius = 0.11;

void stroke_of(ShapeBuilder& b, Vec3 from, Vec3 to) {
  const int32_t first = b.point(from);
  b.line(first, b.point(to));
}

DatasetPtr barb(int knots, double side) {
  ShapeBuilder b;
  if (knots == 0) {
    constexpr int n = 24;
    for (int k = 0; k < n; ++k) {
      const double t = 2 * 3.14159265358979323846 * k / n;
      b.point({calm_radius * std::cos(t), calm_radius * std::sin(t), 0});
    }
    for (int k = 0; k < n; ++k) b.line(k, (k + 1) % n);
    return std::move(b).made();
  }
  const BarbStrokes s = barb_strokes(knots);
  const double needed = pennant * s.pennants + (s.pennants ? after_pennants : 0) + gap * (s.barbs + s.half);
  const double tight = std::min(1.0, 0.95 / needed);  // more strokes than fit on a staff are drawn closer together
  b.point({0, 0, 0}), b.point({-1, 0, 0}), b.line(0, 1);
  double x = -1;
  for (int k = 0; k < s.pennants; ++k, x += pennant * tight) {
    const int32_t from = b.point({x, 0, 0}), to = b.point({x + pennant * tight, 0, 0}), tip = b.point({x - 0.3 * lean, side * stroke, 0});
    for (const double z : {-0.012, 0.012}) {  // before a map in its own plane from both sides
      int32_t corner[3];
      for (int c = 0; c < 3; ++c) {
        const size_t at = 3 * size_t(c == 0 ? from : c == 1 ? to : tip);
        corner[c] = b.point({double(b.xyz[at]), double(b.xyz[at + 1]), z});
      }
      if ((side > 0) == (z > 0)) b.triangle(corner[0], corner[1], corner[2]);
      else b.triangle(corner[0], corner[2], corner[1]);
    }
    b.line(from, tip), b.line(tip, to);
  }
  if (s.pennants) x += after_pennants * tight;
  for (int k = 0; k < s.barbs; ++k, x += gap * tight) stroke_of(b, {x, 0, 0}, {x - lean, side * stroke, 0});
  if (s.half) {
    if (knots == barb_step) x += gap;  // on its own it must not look like the end of a full one
    stroke_of(b, {x, 0, 0}, {x - 0.5 * lean, side * 0.5 * stroke, 0});
  }
  return std::move(b).made();
}

// Unit of the speeds as knots.
double factor_of(const Field& v, const BarbParams& p, Context& context) {
  if (p.unit) return knots_per(*p.unit);
  if (!v.unit.empty()) {
    try {
      return knots_per(v.unit);
    } catch (const Error&) {
      context.warn(fmt::format("barbs do not know the unit '{}' of '{}'; it is taken as m/s (set unit=)", v.unit, v.name));
      return knots_per("m/s");
    }
  }
  context.info(fmt::format("'{}' has no unit; barbs take it as m/s (set unit=kn, km/h, mph)", v.name));
  return knots_per("m/s");
}

bool looks_like_degrees(const Box3& box) {
  return !box.empty() && box.lo.y >= -90.5 && box.hi.y <= 90.5 && box.lo.x >= -360.5 && box.hi.x <= 360.5 && box.hi.x - box.lo.x >= 10;
}

}  // namespace

void describe(Schema& s, BarbParams& p) {
  s("unit", p.unit, "barbs: unit of the vectors: m/s, km/h, mph, ft/s or kn; auto: that of the field, else m/s.");
  s("hemisphere", p.hemisphere, "barbs: side of the strokes; latitude: by the sign of the latitude at each point.");
  s("latitude", p.latitude, "barbs: point field of latitudes in degrees; default: y, if it looks like degrees.").takes(fields::scalars);
}

BarbStrokes barb_strokes(int knots) {
  const int k = knots / barb_step;
  return {k / 10, k % 10 / 2, k % 2};
}

std::vector<DatasetPtr> barb_shapes() {
  static const std::vector<DatasetPtr> shapes = [] {
    std::vector<DatasetPtr> all;
    for (int k = 0; k <= steps; ++k) all.push_back(barb(k * barb_step, 1));
    for (int k = 1; k <= steps; ++k) all.push_back(barb(k * barb_step, -1));
    return all;
  }();
  return shapes;
}

int barb_shape(double knots, bool southern) {
  const int k = int(std::min(std::floor(knots / barb_step + 0.5), double(steps)));
  return southern && k > 0 ? steps + k : k;
}

double knots_per(const std::string& unit) {
  static const std::pair<std::string_view, double> known[] = {{"m/s", 3600.0 / 1852},
                                                              {"m s-1", 3600.0 / 1852},
                                                              {"m s^-1", 3600.0 / 1852},
                                                              {"m s**-1", 3600.0 / 1852},
                                                              {"m*s^-1", 3600.0 / 1852},
                                                              {"meter/second", 3600.0 / 1852},
                                                              {"meters/second", 3600.0 / 1852},
                                                              {"meter second-1", 3600.0 / 1852},
                                                              {"mps", 3600.0 / 1852},
                                                              {"cm/s", 36.0 / 1852},
                                                              {"cm s-1", 36.0 / 1852},
                                                              {"km/h", 1000.0 / 1852},
                                                              {"km h-1", 1000.0 / 1852},
                                                              {"km/hr", 1000.0 / 1852},
                                                              {"kph", 1000.0 / 1852},
                                                              {"kmh", 1000.0 / 1852},
                                                              {"mph", 1609.344 / 1852},
                                                              {"mi/h", 1609.344 / 1852},
                                                              {"ft/s", 0.3048 * 3600 / 1852},
                                                              {"kn", 1},
                                                              {"kt", 1},
                                                              {"kts", 1},
                                                              {"knot", 1},
                                                              {"knots", 1}};
  const std::string word = to_lower(std::string(trim(unit)));
  std::vector<std::string> names;
  for (const auto& [name, factor] : known) {
    if (name == word) return factor;
    names.emplace_back(name);
  }
  fail_usage(fmt::format("'{}' is not a unit of speed known to barbs", unit), "glyphs: unit", "give m/s, km/h, mph, ft/s or kn");
}

DatasetPtr barb_places(const DatasetPtr& data, const std::string& vectors, const BarbParams& p, Context& context) {
  const Field& v = data->fields().require(vectors, Association::point);
  if (v.components() != 2 && v.components() != 3)
    fail_usage(fmt::format("field '{}' has {} components", v.name, v.components()), "glyphs: barbs", "a wind needs 2 or 3");
  const double factor = factor_of(v, p, context);
  Array latitude;
  if (p.hemisphere == BarbHemisphere::latitude) {
    if (!p.latitude.empty()) {
      const Field& f = data->fields().require(p.latitude.name, Association::point);
      if (f.components() != 1) fail_usage(fmt::format("field '{}' has {} components", f.name, f.components()), "glyphs: latitude");
      latitude = f.array.converted(ElementType::f64).made_packed();
    } else if (looks_like_degrees(data->bounds())) {
      latitude = point_positions(data->mesh()).component(1).made_packed();
      if (data->bounds().lo.y < 0)
        context.info("barbs: y is taken as latitude, so strokes change sides south of 0 (hemisphere=north prevents this)");
    }
  }
  const size_t n = data->point_count();
  int32_t* choice = nullptr;
  double* frame = nullptr;
  Field shape{"barb", Association::point, Array::make<int32_t>(n, 1, &choice), "", Role::labels};
  Field turn{"barb frame", Association::point, Array::make<double>(n, 9, &frame), "", Role::tensors};
  dispatch(v.array, [&](auto in) {
    parallel_for(n, 1 << 13, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const Vec3 w{double(in(i, 0)), double(in(i, 1)), 0};
        const double speed = length(w);
        Mat3 m;
        if (speed > 0) m = turn_to(w, Vec3{0, 0, 1});
        const bool southern = p.hemisphere == BarbHemisphere::south || (!latitude.empty() && latitude.view<double>()[i] < 0);
        choice[i] = std::isfinite(speed) ? barb_shape(speed * factor, southern) : -1;
        for (size_t k = 0; k < 9; ++k) frame[9 * i + k] = m.m[k / 3][k % 3];
      }
    });
  });
  DatasetParts parts = data->parts();
  parts.fields.add(std::move(shape));
  parts.fields.add(std::move(turn));
  return make_dataset(std::move(parts));
}

}  // namespace sg
