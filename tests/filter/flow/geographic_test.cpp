// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/geographic.h"

#include "filter/flow/streamlines.h"
#include "filter/flow/unsteady/pathlines.h"
#include "filter/flow/unsteady/unsteady_lines.h"
#include "filter/flow/vortex/ftle.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test::unsteady;

namespace {

constexpr double metres = 6371000 * M_PI / 180;  // of a degree

// 0..40 degrees east, 20..60 north, with what a file says of its axes and its time.
DatasetPtr sea(Vec3 v, const std::string& unit = "m s-1", const std::string& axis = "lon, degrees_east (drawn flat)") {
  UniformGrid g;
  g.dims = {41, 41, 1};
  g.origin = {0, 20, 0};
  std::vector<double> values;
  for (size_t i = 0; i < 41 * 41; ++i) values.insert(values.end(), {v.x, v.y, v.z});
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"current", Association::point, Array::from_vector(values, 3), unit, Role::vectors});
  parts.notes = {{"x axis", axis}, {"y axis", "lat, degrees_north (drawn flat)"}, {"time", "days since 1900-1-1"}};
  return make_dataset(std::move(parts));
}

Series days(Vec3 v) {
  Series s;
  for (int i = 0; i <= 10; ++i) s.times.push_back(i);
  s.load = [v](size_t) -> Data { return sea(v); };
  return s;
}

}  // namespace

TEST_CASE("geographic: a day at a metre a second is 86.4 km, along the meridian and along a parallel") {
  Context context;
  auto p = seeded_at<PathlinesParams>({10, 40, 0});
  p.geographic = true;
  const Lines north{pathlines(days({0, 1, 0}), {}, p, context)};
  const size_t last = north.points() - 1;
  CHECK(north.value("time", last) == 10);
  CHECK(north.x(last).y == doctest::Approx(40 + 864000 / metres).epsilon(1e-6));
  CHECK(north.value("speed", last) == doctest::Approx(1).epsilon(1e-5));
  const Lines east{pathlines(days({1, 0, 0}), {}, p, context)};
  CHECK(east.x(east.points() - 1).x == doctest::Approx(10 + 864000 / metres / std::cos(40 * M_PI / 180)).epsilon(1e-5));
  CHECK(east.x(east.points() - 1).y == doctest::Approx(40));
  CHECK(east.value("speed", 0) == doctest::Approx(1).epsilon(1e-5));
}

TEST_CASE("geographic: lines at 45 degrees of the compass keep their heading") {
  // On a sphere such a line is a loxodrome: dlon = dy_mercator, y = ln tan(45 + lat / 2).
  Context context;
  StreamlinesParams p;
  p.geographic = true, p.direction = TraceDirection::forward;
  p.seeds.points = {5, 30, 0};
  const DatasetPtr d = std::get<DatasetPtr>(streamlines({sea({1, 1, 0})}, p, context));
  const Lines lines{d};
  const auto mercator = [](double lat) { return std::log(std::tan(M_PI / 4 + lat * M_PI / 360)) * 180 / M_PI; };
  for (size_t i = 0; i < lines.points(); ++i) {
    const Vec3 x = lines.x(i);
    CHECK(std::abs((x.x - 5) - (mercator(x.y) - mercator(30))) < 4e-3);  // the field is linear within a degree
    CHECK(lines.value("speed", i) == doctest::Approx(std::sqrt(2.0)).epsilon(1e-4));
  }
  CHECK(lines.points() > 10);
}

TEST_CASE("geographic: ftle measures metres, so the globe's own turning has none and a jet has that of its shear") {
  // East along parallels by f(latitude) m/s, for ten days.
  const auto days_of = [](auto&& f) {
    Series s;
    for (int i = 0; i <= 10; ++i) s.times.push_back(i);
    s.load = [f](size_t) -> Data {
      DatasetParts parts = sea({})->parts();
      std::vector<double> v;
      for (int j = 0; j <= 40; ++j)
        for (int i = 0; i <= 40; ++i) v.insert(v.end(), {f(20.0 + j), 0, 0});
      parts.fields.add({"current", Association::point, Array::from_vector(v, 3), "m s-1", Role::vectors});
      return make_dataset(parts);
    };
    return s;
  };
  Context context;
  FtleParams p;
  p.geographic = true, p.dims = {21, 21, 1}, p.bounds = {5, 20, 30, 50, 0, 0}, p.duration = 5;
  const auto values = [&](const Series& s) {
    const DatasetPtr d = ftle(s, p, context);
    std::vector<double> out;
    for (size_t j = 1; j < 20; ++j) out.push_back(d->fields().require("ftle").array.get(21 * j + 10, 0));
    return out;
  };
  // As a rigid body: all speeds in proportion to the cosine.
  for (const double v : values(days_of([](double lat) { return 2 * std::cos(lat * M_PI / 180); }))) CHECK(std::abs(v) < 2e-4);
  // A linear shear of k / s: the largest stretch in time T is (g + sqrt(g^2 + 4)) / 2, g = k T; to first order also on the sphere, where
  // the parallels' own turning adds tan(latitude) speed / R.
  const double shear = 0.1 / metres;  // 0.1 m/s a degree
  const auto jet = values(days_of([](double lat) { return 0.1 * (lat - 40); }));
  for (size_t j = 1; j < 20; ++j) {
    const double lat = 30 + double(j), turn = 0.1 * std::tan(lat * M_PI / 180) * (lat - 40) / 6371000;
    const double g = (shear + turn) * 5 * 86400, truth = std::log((std::abs(g) + std::sqrt(g * g + 4)) / 2) / 5;
    CHECK(jet[j - 1] == doctest::Approx(truth).epsilon(0.02));
  }
  // One step, a steady current: a duration is found, in days.
  std::string log;
  context.on_log = [&](LogLevel, std::string_view t) { log += t; };
  p.duration = {};
  Series one = days_of([](double) { return 1.0; });
  one.times.resize(1);
  ftle(one, p, context);
  CHECK(log.find("ftle: duration=") != std::string::npos);
  CHECK(log.find("geographic=true") == std::string::npos);
  p.geographic = false;
  ftle(one, p, context);
  CHECK(log.find("geographic=true converts it") != std::string::npos);
}

TEST_CASE("geographic: metres over degrees are warned of, other units and axes are not") {
  const auto warned = [](const DatasetPtr& d) {
    std::string text;
    Context context;
    context.on_log = [&](LogLevel level, std::string_view t) {
      if (level == LogLevel::warning) text = t;
    };
    StreamlinesParams p;
    p.seeds.points = {10, 40, 0};
    streamlines({d}, p, context);
    return text;
  };
  for (const char* unit : {"m s-1", "m/s", "m s^-1", "cm/s", "m.s-1"})
    CHECK(warned(sea({1, 0, 0}, unit)).find("geographic=true converts it") != std::string::npos);
  CHECK(warned(sea({1, 0, 0}, "degrees/day")).empty());
  CHECK(warned(sea({1, 0, 0}, "")).empty());
  CHECK(warned(sea({1, 0, 0}, "m/s", "x, m")).empty());
}

TEST_CASE("geographic: latitudes that are none, and fields on cells, are refused") {
  Context context;
  UniformGrid g;
  g.dims = {3, 300, 1};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"v", Association::point, Array::from_vector(std::vector<double>(2700, 1.0), 3), "m/s", Role::none});
  const auto message = [&](const DatasetPtr& d) { return test::error_of([&] { geographic_flow(d, "v", 1, "streamlines"); }); };
  CHECK(message(make_dataset(parts)).find("latitudes range from 0 to 299") != std::string::npos);
  parts.fields = {};
  parts.fields.add({"v", Association::cell, Array::from_vector(std::vector<double>(598 * 3, 1.0), 3), "m/s", Role::none});
  CHECK(message(make_dataset(parts)).find("cell_to_point") != std::string::npos);
}
