// SPDX-License-Identifier: Apache-2.0
// First pictures of grids: which are seen through, which are bodies, slices or curves.
#include <cmath>

#include "filter/probe/probe.h"
#include "scene/choose/chosen_scale.h"
#include "scene/choose/shown_range.h"
#include "scene/look/look.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr grid(std::array<size_t, 3> dims, const std::function<double(size_t, size_t, size_t)>& f, bool patient = false) {
  DatasetParts parts;
  UniformGrid g;
  g.dims = dims;
  std::vector<float> v;
  for (size_t k = 0; k < dims[2]; ++k)
    for (size_t j = 0; j < dims[1]; ++j)
      for (size_t i = 0; i < dims[0]; ++i) v.push_back(float(f(i, j, k)));
  parts.mesh = g;
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(v)), "K", Role::scalars});
  if (patient) parts.notes = {{"space", "left-posterior-superior"}, {"Modality", "MR"}};
  return make_dataset(std::move(parts));
}

// 0 outside of a ball of radius 8 in the middle of 32^3 samples, or noise there; 300 to 400 inside.
double head(size_t i, size_t j, size_t k, bool noise) {
  const double x = double(i) - 15.5, y = double(j) - 15.5, z = double(k) - 15.5;
  if (x * x + y * y + z * z < 64) return 300 + double(i * 7 + j * 3) / 3;
  return noise ? double((i * 7 + j * 5 + k * 3) % 20) : 0;
}

}  // namespace

TEST_CASE("first look: a scan that is no CT is three slices in grey, what was cut out of its surroundings a body") {
  const auto scan = grid(
      {32, 32, 32}, [](size_t i, size_t j, size_t k) { return head(i, j, k, true); }, true);
  const Look slices = choose_look(*scan, "", "nii");
  CHECK(slices.filter == std::vector<std::string>{"slice", "planes=xyz"});
  CHECK(slices.picture == std::vector<std::string>{"views=front,left,bottom,iso"});
  REQUIRE(slices.shows.size() == 1);
  CHECK(slices.shows[0].kind->is<SurfaceShow>());
  CHECK_FALSE(slices.shows[0].of_input);
  CHECK(test::chosen_scale(scan).map.name == "gray");
  const auto cut_out = grid(
      {32, 32, 32}, [](size_t i, size_t j, size_t k) { return head(i, j, k, false); }, true);
  CHECK(choose_look(*cut_out, "", "nii").shows.at(0).kind->is<VolumeShow>());
  const auto no_patient = grid({32, 32, 32}, [](size_t i, size_t j, size_t k) { return head(i, j, k, true); });
  CHECK(choose_look(*no_patient, "", "nii").shows.at(0).kind->is<VolumeShow>());
}

TEST_CASE("first look: a thin layer is a body, as rays would meet little of it") {
  const auto spot = [](size_t i, size_t j, size_t k) { return std::exp(-0.05 * std::pow(double(i) - 20, 2) - 0.1 * double(j + k)); };
  const Look layer = choose_look(*grid({60, 40, 3}, spot), "", "vtk");
  REQUIRE(layer.shows.size() == 1);
  CHECK(layer.shows[0].kind->is<SurfaceShow>());
  CHECK(layer.reason.find("thin layer") != std::string::npos);
  CHECK(choose_look(*grid({60, 40, 12}, spot), "", "vtk").shows.at(0).kind->is<VolumeShow>());
}

TEST_CASE("first look: a few bright places of a scan do not darken the rest") {
  const auto scan = grid(
      {32, 32, 1}, [](size_t i, size_t j, size_t) { return i == 3 && j == 8 ? 5000.0 : head(i, j, 15, true); }, true);
  const ColorScale s = test::chosen_scale(scan);
  CHECK(s.lo == 0);
  CHECK(s.hi > 350);
  CHECK(s.hi < 1000);
  CHECK(s.above);
}

TEST_CASE("first look: few cells, and values that are all alike frequent, are a body") {
  const auto wave = [](size_t i, size_t j, size_t k) { return std::exp(-0.1 * double(i * i + j * j + k * k)); };
  const Look few = choose_look(*grid({7, 11, 3}, wave), "", "vtk");
  REQUIRE(few.shows.at(0).kind->is<SurfaceShow>());
  CHECK(few.shows[0].params.as<SurfaceShow>().edges);
  CHECK(choose_look(*grid({7, 12, 3}, wave), "", "vtk").shows.at(0).kind->is<VolumeShow>());
  const Look ramp = choose_look(*grid({20, 20, 20}, [](size_t i, size_t, size_t) { return double(i) / 19; }), "", "vtk");
  REQUIRE(ramp.shows.at(0).kind->is<SurfaceShow>());
  CHECK_FALSE(ramp.shows[0].params.as<SurfaceShow>().edges);
}

TEST_CASE("first look: values along one axis are a curve, as high as half of its length or so, with the field's name at its axis") {
  for (const size_t axis : {0, 1, 2}) {
    std::array<size_t, 3> dims{1, 1, 1};
    dims[axis] = 21;
    const Look look = choose_look(*grid(dims, [](size_t i, size_t j, size_t k) { return 1000.0 + 3 * double(i + j + k); }), "", "nrrd");
    REQUIRE(look.filter.size() == 4);
    CHECK(look.filter[0] == "warp");
    CHECK(look.filter[2] == (axis == 0 ? "direction=0,1,0" : "direction=1,0,0"));
    REQUIRE(look.picture.size() == 2);
    CHECK(look.picture[0] == (axis == 0 ? "stretch=1,0.2,1" : "stretch=0.2,1,1"));  // 0.6 * 20 / 60
    CHECK(look.picture[1] == (axis == 0 ? "y_title=v [K]" : "x_title=v [K]"));
    CHECK(look.camera.parallel);
  }
  CHECK(choose_look(*grid({21, 1, 1}, [](size_t, size_t, size_t) { return 5.0; }), "", "nrrd").filter.empty());
}

TEST_CASE("first look: what was probed along a line is a curve over the distance") {
  Context context;
  const DatasetPtr cube = grid({5, 5, 5}, [](size_t i, size_t, size_t) { return 10.0 * double(i); });
  const DatasetPtr line = probe_at(cube, {.points = {}, .from = Vec3{0, 2, 2}, .to = Vec3{4, 2, 2}, .count = 9}, context);
  const Look look = choose_look(*line, "", "vti");
  CHECK(look.filter == std::vector<std::string>{"profile", "field=v"});
  CHECK(look.picture == std::vector<std::string>{"stretch=1,0.06,1", "x_title=distance", "y_title=v [K]"});  // 0.6 * 4 / 40
  CHECK(look.camera.parallel);
  const DatasetPtr points = probe_at(cube, {.points = {0, 0, 0, 1, 1, 1}, .from = {}, .to = {}, .count = 9}, context);
  CHECK(choose_look(*points, "", "vti").filter.empty());
}

TEST_CASE("first look: a table is a curve over a column that increases, another one is none") {
  const auto column = [](const char* name, std::vector<double> v) {
    return Field{name, Association::whole, Array::from_vector(std::move(v)), "", Role::none};
  };
  Table t;
  t.columns = {column("x", {5, 5, 5, 5}), column("t", {0, 1, 2, 4}), column("same", {3, 3, 3, 3}), column("v", {7, NAN, 2, 12}),
               column("w", {1, 2, 1, 2})};
  const auto curve = look_at_table(t, "");
  REQUIRE(curve);
  CHECK(curve->filter == std::vector<std::string>{"table_to_points", "x=t", "y=v", "line=true"});
  CHECK(curve->picture[0] == "stretch=1,0.24,1");  // 0.6 * 4 / 10
  CHECK(look_at_table(t, "w")->filter[2] == "y=w");
  t.columns[1] = column("t", {0, 1, 1, 4});
  CHECK_FALSE(look_at_table(t, ""));
  t.columns[1] = column("distance", {0, 1, 2, 4}), t.columns[4] = column("v2", {0, 1, 2, 3});
  CHECK(look_at_table(t, "")->filter[1] == "x=distance");
  t.labels = {{}, {}, {"a", "b", "c", "d"}, {}, {}};
  CHECK_FALSE(look_at_table(t, ""));
}

TEST_CASE("first look: of a volume that is clear but for one place, a frame around that") {
  const auto spot = [](size_t i, size_t j, size_t k) {
    const double x = double(i) - 10, y = double(j) - 10, z = double(k) - 10;
    return std::exp(-0.1 * (x * x + y * y + z * z));
  };
  const Look look = choose_look(*grid({40, 40, 40}, spot), "", "vti");
  REQUIRE(look.frame);
  CHECK(look.frame->hi.x < 25);
  CHECK(look.frame->lo.x >= 0);
  CHECK_FALSE(
      choose_look(*grid({40, 40, 40}, [](size_t i, size_t j, size_t k) { return std::sin(0.5 * double(i + j + k)); }), "", "vti").frame);
}

TEST_CASE("shown range: a logarithmic scale where values crowd at the low end of a linear one over decades") {
  const auto decades = [](const std::function<double(size_t)>& f) {
    const auto d = grid({1000, 1, 1}, [&](size_t i, size_t, size_t) { return f(i); });
    const FieldOf of{d.get(), &d->fields()[0]};
    return spans_decades({&of, 1});
  };
  CHECK(decades([](size_t i) { return std::pow(10.0, double(i) / 60); }));
  CHECK(decades([](size_t i) { return i % 3 == 0 ? 0 : std::pow(10.0, double(i) / 60); }));     // with zeros
  CHECK_FALSE(decades([](size_t i) { return double(i); }));                                     // evenly spread
  CHECK_FALSE(decades([](size_t i) { return i == 7 ? 1e6 : 1 + 0.001 * double(i % 10); }));     // one outlier
  CHECK_FALSE(decades([](size_t i) { return i == 7 ? -1 : std::pow(10.0, double(i) / 60); }));  // signed
  CHECK_FALSE(decades([](size_t i) { return i % 10 ? 0 : std::pow(10.0, double(i) / 60); }));   // nothing but in a few places
  // Nor where zero is a value like any other (temperatures) or the middle (heights of waves).
  const auto d = grid({1000, 1, 1}, [&](size_t i, size_t, size_t) { return std::pow(10.0, double(i) / 60); });
  for (const FieldLook look : {FieldLook{.one_sided = true}, FieldLook{.two_sided = true}}) {
    Field f = d->fields()[0];
    f.look = look;
    const FieldOf of{d.get(), &f};
    CHECK_FALSE(spans_decades({&of, 1}));
  }
}

TEST_CASE("choose_scale: labels that have the names of colours have these colours") {
  const auto with_names = [](const std::string& names) {
    DatasetParts parts = grid({12, 12, 12}, [](size_t i, size_t, size_t) { return double(i / 4); })->parts();
    FieldSet fields;
    std::vector<int32_t> v;
    for (size_t i = 0; i < 1728; ++i) v.push_back(int32_t(i % 12 / 4));
    fields.add({"m", Association::point, Array::from_vector(std::move(v)), "", Role::labels});
    parts.fields = fields;
    parts.notes = {{"labels of m", names}};
    return test::chosen_scale(make_dataset(std::move(parts)));
  };
  const ColorScale s = with_names("0=Red\n1=lamp\n2=white");
  REQUIRE(s.labels.size() == 3);
  CHECK(s.color(0) == Vec4f(1, 0, 0, 1));
  CHECK(s.color(2) == Vec4f(1, 1, 1, 1));
  CHECK_FALSE(with_names("0=red\n1=lamp\n2=wall").color(0) == Vec4f(1, 0, 0, 1));
}
