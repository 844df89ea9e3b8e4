// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "scene/show/volume.h"

#include "color/parse_color.h"
#include "color/transfer_text.h"
#include "data/cells/point_positions.h"
#include "data/field_ops.h"
#include "filter/field/sampling/point_cell.h"
#include "scene/choose/volume/volume_support.h"
#include "scene/show/show.h"
#include "scene/show/volume_presets.h"
#include "support/test.h"

using namespace sg;
using test::contains;

namespace {

struct Made {
  VolumeItem item;
  Legend legend;
  std::string notes;
};

Made show(const DatasetPtr& d, const std::vector<std::string>& words) {
  Made m;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { m.notes += std::string(text) + "\n"; };
  Scene scene;
  const auto legend = add_show(scene, "volume", d, words, context);
  REQUIRE(legend);
  REQUIRE(scene.items.size() == 1);
  m.legend = *legend;
  m.item = std::get<VolumeItem>(scene.items[0]);
  return m;
}

std::string show_error(const DatasetPtr& d, const std::vector<std::string>& words) {
  Scene scene;
  Context context;
  return test::error_of([&] { add_show(scene, "volume", d, words, context); });
}

std::string check_error(const std::vector<std::string>& words) {
  return test::error_of([&] { show_params(find_show("volume"), words); });
}

// A field "r" (radius) and one "T" (x).
DatasetPtr two_fields() {
  const DatasetPtr a = test::cube_of(9, "r", [](Vec3 p) { return length(p); }),
                   b = test::cube_of(9, "T", [](Vec3 p) { return 300 + 100 * p.x; });
  DatasetParts parts = a->parts();
  Field t = b->fields()[0];
  t.role = Role::none;
  parts.fields.add(t);
  return make_dataset(parts);
}

DatasetPtr ct() {
  // Air, a box of soft tissue, a core of bone, in Hounsfield units.
  const DatasetPtr d = test::cube_of(24, "hu", [](Vec3 p) {
    const double m = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return m > 0.8 ? -1000 : m > 0.3 ? 40 : 1900;
  });
  DatasetParts parts = d->parts();
  std::vector<int16_t> v;
  for (size_t i = 0; i < d->point_count(); ++i) v.push_back(int16_t(d->fields()[0].array.get(i)));
  Field f = d->fields()[0];
  f.array = Array::from_vector(std::move(v));
  parts.fields = {};
  parts.fields.add(f);
  return make_dataset(parts);
}

}  // namespace

TEST_CASE("volume words: everything about sampling, light and method reaches the item") {
  const DatasetPtr d = two_fields();
  const Made m = show(d, {"field=r",         "opacity=0:0,@0.5:0.4,1:0.2",
                          "unit=2",          "method=splat",
                          "mode=isosurface", "levels=0.3,0.9",
                          "shaded=false",    "tolerance=0.01",
                          "step=0.05",       "classify=integrated",
                          "jitter",          "kernel=bspline",
                          "gradient=sobel",  "ambient=0.3",
                          "diffuse=0.5",     "specular=0.1",
                          "power=8",         "shadows=0.5",
                          "occlusion=0.25",  "depth_cue=0.75",
                          "style=tone",      "clip=1,0,0,0.5; box 0,1,0,2,0,3"});
  const VolumeItem& v = m.item;
  CHECK(v.field == "r");
  CHECK(v.unit_distance == 2);
  CHECK(v.method == VolumeMethod::splat);
  CHECK(v.mode == RayFunction::isosurface);
  CHECK(v.levels == std::vector<double>{0.3, 0.9});
  CHECK_FALSE(v.shaded);
  CHECK(v.sampling.tolerance == 0.01);
  CHECK(v.sampling.step == 0.05);
  CHECK(v.sampling.classify == VolumeClassify::integrated);
  CHECK(v.sampling.jitter);
  CHECK(v.sampling.kernel == Kernel::bspline);
  CHECK(v.sampling.gradient == GradientKind::sobel);
  CHECK(v.light.ambient == 0.3);
  CHECK(v.light.diffuse == 0.5);
  CHECK(v.light.specular == 0.1);
  CHECK(v.light.power == 8);
  CHECK(v.light.shadows == 0.5);
  CHECK(v.light.occlusion == 0.25);
  CHECK(v.light.depth_cue == 0.75);
  CHECK(v.light.style == LightStyle::tone);
  REQUIRE(v.clip.size() == 7);
  CHECK(v.clip[0].normal == Vec3{1, 0, 0});
  CHECK(v.clip[0].offset == 0.5);
  const Vec3 inside{0.5, 1, 1.5}, outside{0.5, 2.5, 1.5};
  const auto drawn = [&](Vec3 p) {
    return std::all_of(v.clip.begin() + 1, v.clip.end(), [&](const ClipPlane& c) { return dot(c.normal, p) <= c.offset; });
  };
  CHECK(drawn(inside));
  CHECK_FALSE(drawn(outside));
  CHECK(v.opacity.at(0.5) == 0.4);
  CHECK(v.detail.plain());
  REQUIRE(m.legend.volume);
  CHECK(m.legend.volume->opacity.at(0.5) == 0.4);
  for (const auto& [word, mode] : enum_words(RayFunction()))
    CHECK(show(d, {"field=r", "map=gray", fmt::format("mode={}", word)}).item.mode == mode);
  for (const auto& [word, method] : enum_words(VolumeMethod()))
    CHECK(show(d, {"field=r", fmt::format("method={}", word)}).item.method == method);
}

TEST_CASE("volume words: one level set has the colour of surfaces and no legend, unless colours are stated or there are several") {
  const DatasetPtr d = two_fields();
  const auto shown = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"field=r", "mode=isosurface"});
    Context context;
    Scene scene;
    const bool legend = add_show(scene, "volume", d, words, context).has_value();
    return std::pair(legend, std::get<VolumeItem>(scene.items[0]));
  };
  const auto [legend, item] = shown({"levels=0.5"});
  CHECK_FALSE(legend);
  const Vec4f c = item.color.color(0.5), same = item.color.color(0.9);
  CHECK(Vec3f(c.x, c.y, c.z) == SurfaceItem().color);
  CHECK(c == same);
  CHECK(item.opacity.at(0.5) == 1);
  CHECK_FALSE(shown({"levels=0.5", "color=red"}).first);
  CHECK_FALSE(shown({"levels=0.5", "material=gold"}).first);
  for (const char* stated : {"map=viridis", "range=0,1", "colors=0:red,1:blue", "color_by=T"})
    CHECK_MESSAGE(shown({"levels=0.5", stated}).first, stated);
  CHECK(shown({"levels=0.5,0.8"}).first);
}

TEST_CASE("volume words: the isosurface of a field of cells is that of its mean at the points, and told, where cells have no middles") {
  const DatasetPtr even = test::cube_of(4, "r", [](Vec3 p) { return length(p); });
  CurvilinearGrid bent;
  bent.dims = {4, 4, 4}, bent.points.xyz = point_positions(even->mesh());
  DatasetParts parts;
  parts.mesh = std::move(bent);
  std::vector<float> v(even->cell_count());
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i);
  parts.fields.add({"c", Association::cell, Array::from_vector(v), "", Role::scalars});
  const Made m = show(make_dataset(parts), {"field=c", "mode=isosurface", "levels=9", "map=gray"});
  CHECK(m.item.association == Association::point);
  CHECK(contains(m.notes, "averaged to the points"));
}

TEST_CASE("volume words: what cannot be is refused before any data is read, all mistakes at once") {
  for (const char* t : {"tolerance=0", "tolerance=-1", "tolerance=inf", "tolerance=nan", "tolerance=1.5"})
    CHECK(contains(check_error({t}), "it must be above 0 and at most 1"));
  CHECK(contains(check_error({"opacity=0:0,1:1.5"}), "1.5 is not between 0 and 1"));
  CHECK(contains(check_error({"opacity=0:0,0.7:1,0.5:0"}), "ascending"));
  CHECK(contains(check_error({"opacity="}), "empty"));
  CHECK(contains(check_error({"step=inf"}), "finite"));
  CHECK(contains(check_error({"unit=inf"}), "finite"));
  CHECK(contains(check_error({"levels=1,nan"}), "not in range"));
  CHECK(contains(check_error({"preset=ct_bnoe"}), "did you mean 'ct_bone'"));
  CHECK(contains(check_error({"transfer=boundary"}), "did you mean 'boundaries'"));
  CHECK(contains(check_error({"mode=maximal"}), "did you mean 'maximum'"));
  CHECK(contains(check_error({"kernel=cubic"}), "choices"));
  CHECK(contains(check_error({"second_opacity=0:0,0.2:1"}), "second=gradient"));
  CHECK(contains(check_error({"opacity_by=a", "color_by=b"}), "give one of them"));
  CHECK(contains(check_error({"color_by=b", "second=gradient"}), "already is the second axis"));
  CHECK(contains(check_error({"widgets=triangle 0 1 0 1", "opacity=0:0,1:1"}), "leave out one"));
  CHECK(contains(check_error({"widgets=paint 0.1 0.5,0.5"}), "radii of a brush"));
  CHECK(contains(check_error({"clip=1,0,0"}), "has 3 numbers"));
  CHECK(contains(check_error({"clip=0,0,0,1"}), "no direction"));
  CHECK(contains(check_error({"clip=box 0,0,0,1,0,1"}), "empty"));
  CHECK(contains(check_error({"clip=1,0,x,1"}), "'x'"));
  CHECK(contains(check_error({"clip=;"}), "no planes"));
  CHECK(contains(check_error({"colors=0:black,1:nocolour"}), "not a colour"));
  const std::string both = check_error({"opacity=0:2", "clip=1,2"});
  CHECK(contains(both, "not between"));
  CHECK(contains(both, "has 2 numbers"));
  CHECK_NOTHROW(show_params(find_show("volume"), {"scale=log", "opacity=@5:0,@500:1"}));
  // Which of a position and a value comes first, only the data can tell.
  CHECK_NOTHROW(show_params(find_show("volume"), {"opacity=0:0,@-500:0.1,1:1", "colors=0:black,@-500:white", "widgets="}));
  CHECK_NOTHROW(show_params(find_show("volume"), {"widgets=triangle 0 @-500 0 1"}));
  CHECK_NOTHROW(show_params(find_show("volume"), {"widgets=paint 0.1:@1e-30 @1e-30,0.5 0.5,@7"}));
  const DatasetPtr d = two_fields();
  CHECK(contains(show_error(d, {"field=T", "opacity=0:0,@100:0.5,1:1"}), "'@100:0.5' lies below the previous point (100 after 200)"));
  CHECK(show(d, {"field=T", "opacity=0:0,@250:0.5,1:1"}).item.opacity.at(250) == 0.5);
}

TEST_CASE("volume words: opacity by one field, colour by another") {
  const DatasetPtr d = two_fields();
  for (const std::vector<std::string>& words : {std::vector<std::string>{"field=r", "color_by=T"}, {"field=T", "opacity_by=r"}}) {
    std::vector<std::string> all = words;
    all.insert(all.end(), {"opacity=0:0,1:0.5", "map=ember"});
    const Made m = show(d, all);
    CHECK(m.item.field == "r");
    CHECK(m.item.detail.second == SecondAxis::field);
    CHECK(m.item.detail.second_field == "T");
    CHECK(m.item.detail.color_by_second);
    CHECK(m.item.detail.second_color.lo == 200);
    CHECK(m.item.detail.second_color.map.name == "ember");
    CHECK(m.item.opacity.points.front().x == 0);
    CHECK(m.item.opacity.points.back().x == doctest::Approx(std::sqrt(3.0)));
    CHECK(m.legend.title == "T");
    REQUIRE(m.legend.volume);
    CHECK(m.legend.volume->value.title == "r");
  }
  CHECK(show(d, {"field=r", "opacity_by=r"}).item.detail.plain());
  CHECK(contains(show_error(d, {"field=r", "color_by=TT"}), "did you mean 'T'"));
  Context context;
  DatasetParts parts = d->parts();
  Field cells = point_to_cell(d, {}, context)->fields().require("T", Association::cell);
  cells.name = "C";
  parts.fields.add(cells);
  CHECK(contains(show_error(make_dataset(parts), {"field=r", "color_by=C"}), "cell_to_point"));
}

TEST_CASE("volume words: second axes and their ranges") {
  const DatasetPtr d = test::cube_of(33, "f", [](Vec3 p) { return 5 * p.x - 2 * p.y; });
  const Made g = show(d, {"second=gradient"});
  CHECK(g.item.detail.second == SecondAxis::gradient);
  CHECK(g.item.detail.second_hi == doctest::Approx(std::sqrt(29.0)).epsilon(1e-4));
  CHECK(g.item.detail.second_factor.at(0) == 0);
  CHECK(g.item.detail.second_factor.at(std::sqrt(29.0)) == 1);
  CHECK(show(d, {"second=gradient", "second_opacity=0:0,@2:0.5"}).item.detail.second_factor.at(2) == 0.5);
  const DatasetPtr ball = test::cube_of(41, "f", [](Vec3 p) { return 3 - dot(p, p); });
  const Made s = show(ball, {"second=second_derivative"});
  CHECK(s.item.detail.second_lo == doctest::Approx(-2).epsilon(1e-3));
  CHECK(s.item.detail.second_hi == doctest::Approx(2).epsilon(1e-3));
  const Made c = show(ball, {"second=curvature"});
  CHECK(c.item.detail.second_lo == -c.item.detail.second_hi);
  CHECK(c.item.detail.second_hi > 1);  // 1/R, R from 0 to sqrt(3)
  CHECK(contains(show_error(ball, {"second=gradiant"}), "did you mean 'gradient'"));
  const Made f = show(two_fields(), {"field=r", "second=T"});
  CHECK(f.item.detail.second == SecondAxis::field);
  CHECK(f.item.detail.second_lo == 200);
  CHECK(f.item.detail.second_hi == 400);
  // Widgets bring the gradient, and the curve bounds them whatever it is.
  const Made w = show(ball, {"widgets=triangle 0.2 0.6 0 1 0.7 tomato; rectangle @2.5 @3 0 0.5 0.3"});
  CHECK(w.item.detail.second == SecondAxis::gradient);
  REQUIRE(w.item.detail.widgets.size() == 2);
  const TransferFunction t(w.item.color, w.item.opacity, w.item.detail);
  for (int i = 0; i <= 60; ++i)
    for (int k = 0; k <= 10; ++k) CHECK(double(t.opacity(float(i) * 0.05f, float(k) * 0.4f)) <= w.item.opacity.at(i * 0.05) + 1e-6);
  const Made soft = show(ball, {"widgets=ellipse 0.2 0.6 0 1 0.7 tomato; paint 0.1:@0.2 @2.5,0 @3,1 0.3"});
  REQUIRE(soft.item.detail.widgets.size() == 2);
  const TransferWidget& stroke = soft.item.detail.widgets[1];
  CHECK(stroke.line[1].y == soft.item.detail.second_hi);
  CHECK(stroke.radius == doctest::Approx(0.1 * (soft.item.color.hi - soft.item.color.lo)));
  const TransferFunction strokes(soft.item.color, soft.item.opacity, soft.item.detail);
  for (int i = 0; i <= 60; ++i)
    for (int k = 0; k <= 10; ++k)
      CHECK(double(strokes.opacity(float(i) * 0.05f, float(k) * 0.4f)) <= soft.item.opacity.at(i * 0.05) + 1e-6);
}

TEST_CASE("volume words: one colour, colour stops, and the range they span") {
  const DatasetPtr d = two_fields();
  const Made one = show(d, {"field=r", "color=tomato", "opacity=0.1"});
  CHECK(color_text({one.item.color.color(1).x, one.item.color.color(1).y, one.item.color.color(1).z}) == "#ff6347");
  const Made stops = show(d, {"field=T", "colors=@250:black,@350:white", "opacity=0:0,1:1"});
  CHECK(stops.item.color.lo == 250);
  CHECK(stops.item.opacity.points.front().x == 200);  // positions are on the range of the data
  CHECK(show(d, {"field=T", "colors=@250:black,@350:white", "range=200,400"}).item.color.hi == 400);
}

TEST_CASE("volume: ray functions that collect something else have the range of that") {
  const DatasetPtr d = test::cube_of(21, "f", [](Vec3) { return 3.0; });
  const Made sum = show(d, {"mode=sum"});
  CHECK(sum.item.color.lo == 0);
  CHECK(sum.item.color.hi == doctest::Approx(6));  // 3 times 2 lengths
  CHECK(contains(sum.legend.title, "sum of f"));
  CHECK_FALSE(sum.legend.volume);
  const Made distance = show(d, {"mode=distance", "levels=2"});
  CHECK(distance.item.color.hi == doctest::Approx(std::sqrt(12.0)));
  CHECK(contains(distance.legend.title, "distance to f = 2"));
  CHECK(show(d, {"mode=sum", "range=1,2"}).item.color.hi == 2);
  const Made level = show(test::cube_of(33, "f", [](Vec3 p) { return std::erf(-6 * (length(p) - 0.6)); }), {"mode=first_hit"});
  REQUIRE(level.item.levels.size() == 1);
  CHECK(std::abs(level.item.levels[0]) < 0.15);
  CHECK(contains(level.notes, "level"));
}

TEST_CASE("volume presets: each is a whole look that passes its own checks; stated words win") {
  const DatasetPtr d = ct();
  CHECK(volume_presets().size() == 8);
  for (const VolumePreset& p : volume_presets()) {
    const Made m = show(d, {"preset=" + std::string(p.name)});
    INFO(p.name);
    CHECK(contains(m.notes, "preset " + std::string(p.name)));
    CHECK(m.item.opacity.points.size() >= (p.name == "xray" ? 1 : 2));
    CHECK(m.item.color.lo < m.item.color.hi);
  }
  const Made bone = show(d, {"preset=ct_bone"});
  CHECK(bone.item.opacity.at(40) == 0);  // soft tissue is gone
  CHECK(bone.item.opacity.at(1200) > 0.8);
  CHECK(bone.item.shaded);
  CHECK(bone.item.light.specular == 0.3);
  CHECK(contains(bone.notes, "Hounsfield units"));
  const Made skin = show(d, {"preset=ct_skin", "specular=0", "shaded=false"});
  CHECK(skin.item.opacity.at(40) > 0.5);
  CHECK(skin.item.light.specular == 0);
  CHECK_FALSE(skin.item.shaded);
  CHECK(show(d, {"preset=xray"}).item.mode == RayFunction::sum);
  CHECK(show(d, {"preset=mip_angiography"}).item.mode == RayFunction::maximum);
  CHECK(show(d, {"preset=mr"}).item.detail.second == SecondAxis::gradient);
  CHECK(show(d, {"preset=mr", "second=none"}).item.detail.second == SecondAxis::none);
  CHECK(show(d, {"preset=ct_bone", "map=ember"}).item.color.map.name == "ember");
  CHECK(show(d, {"preset=ct_bone", "opacity=0.5"}).item.opacity.at(40) == 0.5);
  CHECK(show(d, {"preset=xray"}).item.opacity.at(0) == 1);
  // Legends go no farther than the data.
  CHECK(bone.item.color.hi == 1800);
  CHECK(skin.item.color.lo == -700);
  // Values that are no Hounsfield units: it says how it took them.
  const Made other = show(test::cube_of(9, "f", [](Vec3 p) { return length(p); }), {"preset=ct_bone"});
  CHECK(contains(other.notes, "does not look like CT"));
  CHECK(other.item.color.hi <= std::sqrt(3.0) + 1e-6);
  CHECK(other.item.color.lo >= 0);
  // A constant field is no reason to fail.
  for (const VolumePreset& p : volume_presets())
    CHECK_NOTHROW(show(test::cube_of(5, "f", [](Vec3) { return 7.0; }), {"preset=" + std::string(p.name)}));
}

TEST_CASE("volume: the words of a look make the same look again") {
  const DatasetPtr d = two_fields(), ball = test::cube_of(17, "r", [](Vec3 p) { return length(p); });
  for (const std::vector<std::string>& words : {
           std::vector<std::string>{"field=r"},
           {"field=r", "preset=mr"},
           {"field=r", "second=gradient", "second_opacity=0:0,0.3:1", "unit=0.125", "kernel=sinc", "shadows=0.5"},
           {"field=r", "widgets=triangle 0.2 0.6 0 1 0.7 tomato; rectangle 0.5 0.9 0 0.5 0.3"},
           {"field=r", "widgets=ellipse 0.2 0.6 0 1 0.7 tomato; paint 0.05:0.1 0.5,0 0.9,0.5 @1,@0.2 0.3"},
           {"field=r", "scale=log", "range=0.1,2", "opacity=0:0,1:0.6", "below=tomato", "clamp=false"},
           {"field=r", "mode=isosurface", "levels=0.25,1"},
           {"field=r", "color_by=T", "opacity=0:0,1:0.5"},
           {"field=r", "second=T"},
       }) {
    const VolumeItem first = show(d, words).item;
    std::vector<std::string> again = transfer_words(first);
    INFO(words.back());
    again.push_back("field=r");
    const VolumeItem second = show(d, again).item;
    const auto but_colors = [](std::vector<std::string> w) {
      std::erase_if(w, [](const std::string& s) { return s.starts_with("colors="); });  // to 8 bits, checked below
      return w;
    };
    CHECK(but_colors(transfer_words(second)) == but_colors(transfer_words(first)));
    CHECK(second.opacity.points == first.opacity.points);
    CHECK(second.detail.second == first.detail.second);
    CHECK(second.detail.second_factor.points == first.detail.second_factor.points);
    CHECK(second.mode == first.mode);
    CHECK(second.color.lo == first.color.lo);
    CHECK(second.color.hi == first.color.hi);
    for (int i = 0; i <= 20; ++i)
      for (int k = 0; k < 3; ++k) CHECK(std::abs(second.color.color(i * 0.1)[k] - first.color.color(i * 0.1)[k]) < 1.6 / 255);
    // On data with another range the values stay where they were.
    if (words.back() == "field=r") CHECK(show(ball, again).item.opacity.points == first.opacity.points);
  }
}

TEST_CASE("volume: automatic looks say in one line what was chosen and why") {
  CHECK(contains(show(two_fields(), {"field=r"}).notes, "values"));
  CHECK(contains(show(ct(), {}).notes, "CT"));
  CHECK_FALSE(contains(show(ct(), {"transfer=histogram"}).notes, "CT"));
  const Made b = show(test::cube_of(49, "f", test::nested_balls), {"transfer=boundaries"});
  CHECK(contains(b.notes, "material boundaries"));
  CHECK(b.item.detail.second == SecondAxis::gradient);
  CHECK(std::count(b.notes.begin(), b.notes.end(), '\n') == 1);
  // White noise has no borders: the histogram decides, and it says so.
  uint64_t state = 1;
  const Made none =
      show(test::cube_of(17, "f", [&](Vec3) { return double((state = state * 6364136223846793005u + 1442695040888963407u) >> 40); }),
           {"transfer=boundaries"});
  CHECK(contains(none.notes, "no material boundaries"));
}

TEST_CASE("volume: a spike of one value, like letters burnt in, is not the background") {
  // A wide dark background, a bright ball in it, and a tenth of all samples at the largest value.
  const auto head = [](double spike) {
    return test::cube_of(41, "f", [spike](Vec3 x) {
      if (x.x > 1 - 2 * spike) return 255.0;
      const double wave = std::sin(37 * x.x) + std::sin(53 * x.y) + std::sin(71 * x.z);
      return length(x) < 0.7 ? 120 + 20 * wave : 12 + 3 * wave;
    });
  };
  const Made letters = show(head(0.1), {"transfer=histogram"});
  CHECK(contains(letters.notes, "background below is left out"));
  CHECK(letters.item.opacity.at(15) == 0);
  CHECK(letters.item.opacity.at(200) > 0.05);
  const Made bright = show(head(0.8), {"transfer=histogram"});
  CHECK(contains(bright.notes, "the background is bright"));
}

TEST_CASE("volume show: a constant field is drawn evenly, not left out") {
  UniformGrid g;
  g.dims = {3, 3, 3};
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<float>(27, 1.0f)), "", Role::scalars});
  Scene scene;
  Context context;
  add(scene, make_dataset(g, fields), VolumeShow(), context);
  const auto& item = std::get<VolumeItem>(scene.items.at(0));
  CHECK(item.opacity.at(1) > 0.1);
}
