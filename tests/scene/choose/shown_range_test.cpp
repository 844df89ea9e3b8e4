// SPDX-License-Identifier: Apache-2.0
// Looks of the fields that flow operations make, and of fields with few extreme values.
#include "scene/choose/shown_range.h"

#include <cmath>

#include "data/fields/known_looks.h"
#include "scene/choose/chosen_scale.h"
#include "scene/choose/histogram.h"
#include "scene/choose/volume/look.h"
#include "scene/look/look.h"
#include "scene/show/glyphs.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"
#include "support/test.h"

using namespace sg;

namespace {

constexpr size_t n = 24;

// A cube of n points a side.
template <class F>
DatasetPtr cube(const std::string& name, F&& f) {
  UniformGrid g;
  g.dims = {n, n, n};
  std::vector<float> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) v.push_back(float(f(double(i), double(j), double(k))));
  FieldSet fields;
  fields.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return with_known_looks(make_dataset(g, std::move(fields)));
}

// Within +-1 but for one value in 500, which reaches far down.
DatasetPtr spiked(const std::string& name) {
  int at = 0;
  return cube(name, [&](double i, double j, double k) { return ++at % 500 == 0 ? -100 : std::sin(0.7 * i) * std::cos(0.5 * j + 0.3 * k); });
}

OpacityCurve opacity_of(const DatasetPtr& d) {
  Context context;
  Scene scene;
  add_show(scene, "volume", d, {}, context);
  return std::get<VolumeItem>(scene.items.back()).opacity;
}

std::string log_of_lines(const DatasetPtr& d) {
  Context context;
  std::string log;
  context.on_log = [&](LogLevel level, std::string_view text) { log += (level == LogLevel::warning ? "!" : "") + std::string(text); };
  Scene scene;
  add_show(scene, "lines", d, {}, context);
  return log;
}

DatasetPtr wind(double x0, size_t nx, double speed) {
  UniformGrid g;
  g.dims = {nx, 20, 1}, g.origin = {x0, 0, 0};
  std::vector<float> v;
  for (size_t i = 0; i < nx * 20; ++i) v.insert(v.end(), {float(speed), 0, 0});
  FieldSet f;
  f.add({"wind", Association::point, Array::from_vector(std::move(v), 3), "m/s", Role::vectors});
  return make_dataset(Mesh(g), std::move(f));
}

}  // namespace

TEST_CASE("choose_scale: ftle gets a sequential map though some values are negative, other signed fields a diverging one") {
  const auto f = [](double i, double, double) { return i / 10 - 0.5; };
  CHECK(test::chosen_scale(cube("ftle", f)).map.kind == MapKind::sequential);
  CHECK(test::chosen_scale(cube("ftle", f)).lo == doctest::Approx(-0.5));
  CHECK(test::chosen_scale(cube("temperature", f)).map.kind == MapKind::diverging);
  const auto lopsided = [](double i, double, double) { return i == 0 ? -100 : i / 24; };
  CHECK(test::chosen_scale(cube("Q", lopsided)).map.kind == MapKind::diverging);
  CHECK(test::chosen_scale(cube("temperature", lopsided)).map.kind == MapKind::sequential);
}

TEST_CASE("choose_scale: a few extreme values of a signed field are cut off, with triangles and a note; a stated range is kept") {
  std::string log;
  const ColorScale s = test::chosen_scale(spiked("Q"), {}, &log);
  CHECK(s.hi == doctest::Approx(1).epsilon(0.02));
  CHECK(s.lo == -s.hi);
  CHECK(s.below.has_value());
  CHECK(log.find("range=-100,") != std::string::npos);
  ColoringParams stated;
  stated.range = {-100, 100};
  CHECK(test::chosen_scale(spiked("Q"), stated).lo == -100);
  // Unknown fields of one sign keep their peaks: they may be what matters.
  int at = 0;
  const auto stress = cube("stress", [&](double i, double, double) { return ++at % 500 == 0 ? 100 : 0.1 * i; });
  CHECK(test::chosen_scale(stress).hi == 100);
  // So do signed ones whose ends are not far.
  CHECK(test::chosen_scale(cube("t", [](double i, double j, double) { return std::sin(i) * j; })).above.has_value() == false);
}

TEST_CASE("volume: high values of ftle and Q are seen, low ones of lambda2; the other side of zero is clear") {
  const auto wave = [](double i, double j, double k) { return std::sin(0.5 * i) * std::sin(0.4 * j) * std::cos(0.3 * k); };
  const OpacityCurve q = opacity_of(cube("Q", wave)), l = opacity_of(cube("lambda2", wave));
  CHECK(q.at(0.9) > 0.5);
  CHECK(q.at(-0.9) == 0);
  CHECK(q.at(0) == 0);
  CHECK(l.at(-0.9) > 0.5);
  CHECK(l.at(0.9) == 0);
  const OpacityCurve ftle = opacity_of(cube("ftle", [](double i, double, double) { return 1 - i / 24; }));
  CHECK(ftle.at(1) > 0.5);
  CHECK(ftle.at(0.3) == 0);
  const OpacityCurve other = opacity_of(cube("v", wave));
  CHECK(other.at(0.9) == doctest::Approx(other.at(-0.9)));
}

TEST_CASE("volume: extreme values of Q do not make the rest invisible") {
  int at = 0;
  const OpacityCurve q = opacity_of(cube("Q", [&](double i, double, double) { return ++at % 500 == 0 ? 200 : std::sin(0.4 * i); }));
  CHECK(q.at(0.9) > 0.3);
}

TEST_CASE("volume: the side of Q that matters says how far its colours go, and any solid mesh shows it inside") {
  // Strong shear in a fifth of the cube, weak vortices elsewhere.
  const auto flow = [](double i, double j, double) { return i < 5 ? -1000 : std::sin(0.7 * i) * std::cos(0.5 * j); };
  std::string log;
  const ColorScale s = test::chosen_scale(cube("Q", flow), {}, &log);
  CHECK(s.hi == doctest::Approx(1).epsilon(0.02));
  CHECK(s.lo == -s.hi);
  CHECK(s.below.has_value());
  CHECK_FALSE(s.above.has_value());
  CHECK(log.find("range=-1000,") != std::string::npos);
  CHECK(opacity_of(cube("Q", flow)).at(0.9) > 0.5);
  CHECK(test::chosen_scale(cube("lambda2", [&](double i, double j, double k) { return -flow(i, j, k); })).hi ==
        doctest::Approx(1).epsilon(0.02));
  const auto bent = [](const std::string& name) {
    CurvilinearGrid g;
    g.dims = {3, 3, 3};
    std::vector<float> xyz, v;
    for (int i = 0; i < 27; ++i) {
      xyz.insert(xyz.end(), {float(i % 3), float(i / 3 % 3), float(i / 9) + 0.1f * float(i % 3)});
      v.push_back(float(i));
    }
    g.points.xyz = Array::from_vector(std::move(xyz), 3);
    FieldSet f;
    f.add({name, Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
    return with_known_looks(make_dataset(Mesh(g), std::move(f)));
  };
  CHECK(choose_look(*bent("Q"), "", "").shows[0].kind->is<VolumeShow>());
  CHECK(choose_look(*bent("temperature"), "", "").shows[0].kind->is<SurfaceShow>());
}

TEST_CASE("look: a solid texture of sparse noise is shown as opaque strands in the colours of the speed") {
  DatasetParts parts = cube("other", [](double i, double, double) { return i; })->parts();
  const auto strands = cube("lic", [](double i, double j, double) { return int(i) % 6 == 0 && int(j) % 6 == 0 ? 0.8 : 0.0; });
  Field lic = strands->fields()[0], speed = lic;
  lic.role = speed.role = Role::none, speed.name = "speed", speed.look = known_look("speed");
  parts.fields.add(lic), parts.fields.add(speed);
  const DatasetPtr d = make_dataset(std::move(parts));
  const Look look = choose_look(*d, "", "");
  REQUIRE(look.shows.size() == 1);
  CHECK(look.shows[0].kind->is<VolumeShow>());
  CHECK(changed_words(look.shows[0].params) == std::vector<std::string>{"field=lic", "color_by=speed", "tolerance=0.01"});
  Context context;
  Scene scene;
  show_kind<VolumeShow>().add(scene, d, look.shows[0].params, context);
  const auto& item = std::get<VolumeItem>(scene.items.back());
  CHECK(item.field == "lic");
  CHECK(item.opacity.at(0) == 0);
  CHECK(item.opacity.at(0.5) > 0.9);
  CHECK(item.unit_distance == doctest::Approx(3));
  CHECK(choose_look(*d, "other", "").shows[0].params.as<VolumeShow>().coloring.field.name == "other");
}

TEST_CASE("lines of data without lines draw nothing, and say what to do") {
  const std::string log = log_of_lines(cube("v", [](double i, double, double) { return i; }));
  CHECK(log.find("!lines:") == 0);
  CHECK(log.find("streamlines") != std::string::npos);
  SurfaceMesh m;
  m.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0}, 3);
  m.lines.connectivity = Array::from_vector(std::vector<int32_t>{0, 1}), m.lines.fixed = 2;
  CHECK(log_of_lines(make_dataset(std::move(m))).empty());
}

TEST_CASE("glyphs of several parts: one length for one value, and shares of one number of glyphs") {
  const std::vector<DatasetPtr> parts{wind(0, 60, 2), wind(60, 20, 6)};
  const auto shared = [&](const GlyphsShow& stated) {
    std::vector<GlyphsShow> all(2, stated);
    share(parts, std::vector<GlyphsShow*>{&all[0], &all[1]});
    return all;
  };
  const std::vector<GlyphsShow> both = shared({});
  double scale[2];
  size_t count[2];
  for (size_t i = 0; i < 2; ++i) {
    Context context;
    Scene scene;
    const auto legend = add(scene, parts[i], both[i], context);
    const auto& item = std::get<GlyphsItem>(scene.items.back());
    scale[i] = item.rule.scale, count[i] = item.data->point_count();
    REQUIRE(legend);
    REQUIRE(legend->glyph);
    CHECK(legend->glyph->length == doctest::Approx(item.rule.scale));
    CHECK(legend->glyph->unit == "m/s");
  }
  CHECK(scale[0] == scale[1]);
  CHECK(count[0] > 2 * count[1]);
  CHECK(count[0] + count[1] < 1100);
  GlyphsShow stated;
  stated.glyphs.factor = 0.25, stated.glyphs.count = 50;
  CHECK(changed_words(param_set_of(shared(stated)[0])) == std::vector<std::string>{"factor=0.25", "count=50"});
  GlyphsShow sized;
  sized.glyphs.size = 3;  // of the largest of all
  CHECK(shared(sized)[0].glyphs.factor == 0.5);
}

TEST_CASE("shown range: specks of noise do not take the scale of a curvature, and zero is the middle of its map") {
  std::vector<float> v(2000);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(0.2 * std::sin(0.1 * double(i)) + 0.1);
  v[7] = 900, v[100] = -400;
  UniformGrid g;
  g.dims = {2000, 1, 1};
  FieldSet fields;
  fields.add({"mean curvature", Association::point, Array::from_vector(v), "", Role::none, known_look("mean curvature")});
  const ColorScale s = test::chosen_scale(make_dataset(g, fields));
  CHECK(s.hi < 1);
  CHECK(s.lo > -1);
  CHECK(s.map.kind == MapKind::diverging);
  CHECK(s.above);
}

TEST_CASE("shown range: a curvature with long tails is cut where nine of ten values lie, a criterion of vortices is not") {
  const auto shown = [](const char* name) {
    std::vector<float> v(20000);  // the quantiles of Cauchy's distribution
    for (size_t i = 0; i < v.size(); ++i) v[i] = float(0.1 * std::tan(M_PI * ((double(i) + 0.5) / double(v.size()) - 0.5)));
    UniformGrid g;
    g.dims = {v.size(), 1, 1};
    FieldSet fields;
    fields.add({name, Association::point, Array::from_vector(v), "", Role::none, known_look(name)});
    return test::chosen_scale(make_dataset(g, fields)).hi;
  };
  CHECK(shown("mean curvature") == doctest::Approx(0.1 * std::tan(0.45 * M_PI)).epsilon(0.02));
  CHECK(shown("Q") > 5 * shown("mean curvature"));
}
