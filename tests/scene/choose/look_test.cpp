// SPDX-License-Identifier: Apache-2.0
// What is chosen when nobody says: colours, ranges, representations.
#include "scene/look/look.h"
#include "scene/choose/shared_scale.h"
#include "scene/show/labels.h"
#include "scene/show/points.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

#include "color/parse_color.h"
#include "filter/scalar/bands.h"
#include "scene/choose/chosen_scale.h"
#include "scene/choose/histogram.h"
#include "scene/choose/volume/look.h"
#include "support/test.h"

using namespace sg;

namespace {

template <class T>
DatasetPtr image(size_t n, const std::function<T(size_t, size_t, size_t)>& f) {
  UniformGrid g;
  g.dims = {n, n, n};
  std::vector<T> v;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) v.push_back(f(i, j, k));
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "K", Role::scalars});
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("choose_scale: signed data gets a diverging map with zero in the middle, other data a sequential one") {
  const auto is_signed = image<float>(4, [](size_t i, size_t, size_t) { return float(i) - 1.f; });  // -1 .. 2
  const ColorScale s = test::chosen_scale(is_signed);
  CHECK(s.map.kind == MapKind::diverging);
  CHECK(s.lo == -2);
  CHECK(s.hi == 2);
  CHECK(s.position(0) == doctest::Approx(0.5));
  CHECK(s.title == "v");
  CHECK(s.unit == "K");
  const auto positive = image<float>(4, [](size_t i, size_t, size_t) { return float(i); });
  CHECK(test::chosen_scale(positive).map.kind == MapKind::sequential);
  CHECK(test::chosen_scale(positive).hi == 3);
}

TEST_CASE("choose_scale: of a diverging map only as much is taken on each side as the values reach, zero keeps its colour") {
  const auto uneven = image<float>(4, [](size_t i, size_t, size_t) { return i == 0 ? -0.5f : float(i); });  // -0.5 .. 3
  const ColorScale s = test::chosen_scale(uneven);
  const Colormap whole = find_colormap("coolwarm");
  CHECK(s.lo == -0.5);
  CHECK(s.hi == 3);
  CHECK(s.map.kind == MapKind::diverging);
  const auto same = [](Vec3f a, Vec3f b) { return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)}) < 0.01; };
  for (const double v : {-0.5, -0.25, 0.0, 1.0, 3.0}) CHECK(same(s.map.at(s.position(v)), whole.at(0.5 + v / 6)));
}

TEST_CASE("choose_scale: a ramp of whole numbers along y is no map of labels, though neighbours along x are equal") {
  const auto ramp = image<uint8_t>(16, [](size_t, size_t j, size_t) { return uint8_t(j); });
  CHECK_FALSE(looks_like_labels(*ramp, ramp->fields()[0]));
}

TEST_CASE("choose_scale: labels in pieces get one colour each, noisy integers do not") {
  const auto pieces = image<uint8_t>(16, [](size_t i, size_t j, size_t) { return uint8_t(i < 4 ? 0 : i < 9 ? 3 : j < 8 ? 7 : 12); });
  CHECK(looks_like_labels(*pieces, pieces->fields()[0]));
  const ColorScale s = test::chosen_scale(pieces);
  CHECK(s.map.categorical());
  CHECK(s.labels == std::vector<double>{0, 3, 7, 12});
  const auto selected = image<uint8_t>(16, [](size_t i, size_t j, size_t) { return uint8_t(i < 9 ? 3 : j < 8 ? 1 : 12); });
  const ColorScale of_some = test::chosen_scale(selected);
  const std::vector<Vec3f> palette = find_colormap("labels").colors;
  for (const double label : {3.0, 12.0}) CHECK(of_some.color(label) == s.color(label));
  CHECK(of_some.map.colors[0] == palette[0]);
  const auto noise = image<uint8_t>(16, [](size_t i, size_t j, size_t k) { return uint8_t((i * 37 + j * 101 + k * 53) % 60); });
  CHECK_FALSE(looks_like_labels(*noise, noise->fields()[0]));
  const auto real = image<float>(8, [](size_t i, size_t, size_t) { return float(i < 4); });
  CHECK_FALSE(looks_like_labels(*real, real->fields()[0]));
}

TEST_CASE("choose_scale: floats are labels where the file says so and all are whole, and no value is none") {
  DatasetParts parts = image<float>(8, [](size_t i, size_t, size_t) { return i < 2 ? NAN : i < 5 ? 1.f : 6.f; })->parts();
  const auto with_role = [&](Role role) {
    Field f = parts.fields[0];
    f.role = role;
    parts.fields.add(f);
    return make_dataset(parts);
  };
  const DatasetPtr said = with_role(Role::labels);
  CHECK(looks_like_labels(*said, said->fields()[0]));
  const ColorScale s = test::chosen_scale(said);
  CHECK(s.map.categorical());
  CHECK(s.labels == std::vector<double>{1, 6});
  const DatasetPtr silent = with_role(Role::scalars);
  CHECK_FALSE(looks_like_labels(*silent, silent->fields()[0]));
  DatasetParts halves = image<float>(8, [](size_t i, size_t, size_t) { return i < 4 ? 1.5f : 2.f; })->parts();
  Field f = halves.fields[0];
  f.role = Role::labels;
  halves.fields.add(f);
  const DatasetPtr half = make_dataset(halves);
  CHECK_FALSE(looks_like_labels(*half, half->fields()[0]));
}

TEST_CASE("choose_scale: few cells with named numbers are labels, unnamed ones are not") {
  SurfaceMesh mesh;
  mesh.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  mesh.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 0, 2, 3, 0, 1, 3}), {}, 3};
  DatasetParts parts;
  parts.mesh = mesh;
  parts.fields.add({"kind", Association::cell, Array::from_vector(std::vector<int32_t>{0, 1, 2}), "", Role::labels});
  const DatasetPtr unnamed = make_dataset(parts);
  CHECK_FALSE(looks_like_labels(*unnamed, unnamed->fields()[0]));
  parts.notes.emplace_back("labels of kind", "0=field\n1=lake\n2=wood");
  const DatasetPtr named = make_dataset(parts);
  CHECK(looks_like_labels(*named, named->fields()[0]));
  CHECK(test::chosen_scale(named).label_names == std::vector<std::string>{"field", "lake", "wood"});
}

TEST_CASE("choose_scale: labels have the names that the dataset notes, when it names all of them") {
  DatasetParts parts = image<int32_t>(8, [](size_t i, size_t, size_t) { return i < 3 ? 1 : 4; })->parts();
  parts.notes.emplace_back("labels of v", "1=saddle\n3=node\n4=focus");
  CHECK(test::chosen_scale(make_dataset(parts)).label_names == std::vector<std::string>{"saddle", "focus"});
  parts.notes.back().second = "1=saddle\nx=node";
  CHECK(test::chosen_scale(make_dataset(parts)).label_names.empty());
  parts.notes.back().first = "labels of w";
  CHECK(test::chosen_scale(make_dataset(parts)).label_names.empty());
}

TEST_CASE("share_scale: labels of several datasets are one list, with the names that any of them knows") {
  const auto block = [](int number, const char* names) {
    DatasetParts parts = image<int32_t>(4, [=](size_t, size_t, size_t) { return number; })->parts();
    parts.notes.emplace_back("labels of v", names);
    return make_dataset(parts);
  };
  const auto shared = [](const std::vector<DatasetPtr>& parts, ColoringParams p = {}) {
    std::vector<FieldOf> fields;
    for (const DatasetPtr& d : parts) fields.push_back({d.get(), &d->fields()[0]});
    share_scale(fields, p);
    return p;
  };
  const std::vector<DatasetPtr> blocks = {block(7, "7=wheel"), block(2, "2=axle"), block(7, "7=wheel")};
  for (const DatasetPtr& d : blocks) {
    const ColorScale s = test::chosen_scale(d, shared(blocks));
    CHECK(s.map.categorical());
    CHECK(s.labels == std::vector<double>{2, 7});
    CHECK(s.label_names == std::vector<std::string>{"axle", "wheel"});
  }
  CHECK(shared({block(7, "7=wheel"), block(2, "")}).labels.names.empty());
  // The same number everywhere, and integers that count: values.
  CHECK(shared({block(7, "7=wheel"), block(7, "7=wheel")}).labels.values.empty());
  const auto counts = image<int32_t>(16, [](size_t i, size_t j, size_t k) { return int((i * 37 + j * 101 + k * 53) % 60); });
  CHECK(shared({counts, block(7, "")}).labels.values.empty());
  CHECK(shared({counts, block(7, "")}).range == std::vector<double>{0, 59});
  // A map of categories makes labels of anything.
  ColoringParams categories;
  categories.map = "labels";
  CHECK(shared({counts, block(70, "")}, categories).labels.values.size() == 61);
}

TEST_CASE("choose_scale: a log scale begins at the smallest positive value, and refuses data without one") {
  const auto d = image<float>(4, [](size_t i, size_t, size_t) { return i == 0 ? 0.f : float(i) * 10; });
  ColoringParams p;
  p.scale = ScaleKind::log;
  const ColorScale s = test::chosen_scale(d, p);
  CHECK(s.lo == 10);
  CHECK(s.hi == 30);
  const auto negative = image<float>(4, [](size_t i, size_t, size_t) { return -float(i); });
  CHECK(test::error_of([&] { test::chosen_scale(negative, p); }).find("symlog") != std::string::npos);
}

TEST_CASE("choose_scale: constant and NaN-only fields give a usable range") {
  const auto constant = image<float>(4, [](size_t, size_t, size_t) { return 5.f; });
  CHECK(test::chosen_scale(constant).lo < 5);
  CHECK(test::chosen_scale(constant).hi > 5);
  const auto nan = image<float>(4, [](size_t, size_t, size_t) { return NAN; });
  CHECK(test::chosen_scale(nan).lo < test::chosen_scale(nan).hi);
  ColoringParams p;
  p.range = {3, 1};
  CHECK(test::error_of([&] { test::chosen_scale(constant, p); }).find("lower one first") != std::string::npos);
}

TEST_CASE("choose_scale: jet is drawn with a warning") {
  const auto d = image<float>(4, [](size_t i, size_t, size_t) { return float(i); });
  ColoringParams p;
  p.map = "jet";
  std::string warned;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == LogLevel::warning) warned += text;
  };
  choose_scale(*d, d->fields()[0], p, context);
  CHECK(warned.find("jet") != std::string::npos);
  CHECK(warned.find("uniform") != std::string::npos);
}

TEST_CASE("choose_look: one thin layer of solid cells is seen straight on, a block is not") {
  const auto grid = [](size_t nx, size_t ny, size_t nz, Vec3 spacing) {
    RectilinearGrid g;
    const auto axis = [](size_t n, double step) {
      std::vector<double> v;
      for (size_t i = 0; i <= n; ++i) v.push_back(double(i) * step);
      return Array::from_vector(v);
    };
    g.x = axis(nx, spacing.x), g.y = axis(ny, spacing.y), g.z = axis(nz, spacing.z);
    return make_dataset(Mesh(g));
  };
  const Look layer = choose_look(*grid(20, 20, 1, {1, 1, 2}), "", "");
  CHECK(layer.camera.direction == Vec3(0, 0, 1));
  CHECK(layer.camera.parallel);
  CHECK(choose_look(*grid(20, 1, 20, {1, 2, 1}), "", "").camera.direction == Vec3(0, -1, 0));
  CHECK(!choose_look(*grid(20, 20, 2, {1, 1, 1}), "", "").camera.parallel);
  CHECK(!choose_look(*grid(20, 20, 1, {1, 1, 18}), "", "").camera.parallel);
  CHECK(!choose_look(*grid(2, 2, 1, {1, 1, 0.1}), "", "").camera.parallel);
}

TEST_CASE("choose_look: a level set is shown as its surface of zero, where it has one") {
  const auto ball = [](float radius) {
    const auto d = image<float>(
        12, [&](size_t i, size_t j, size_t k) { return std::hypot(float(i) - 5.5f, float(j) - 5.5f, float(k) - 5.5f) - radius; });
    DatasetParts parts = d->parts();
    Field f = parts.fields[0];
    f.look.shows = FieldLook::Shows::zero;
    parts.fields = {};
    parts.fields.add(f);
    return make_dataset(parts);
  };
  const Look look = choose_look(*ball(4), "", "");
  CHECK(look.filter == std::vector<std::string>{"contour", "field=v", "values=0"});
  CHECK(look.shows[0].kind->is<SurfaceShow>());
  CHECK(choose_look(*ball(-1), "", "").filter.empty());
}

TEST_CASE("choose_look: CT, labels, flat images, surfaces and points are recognised") {
  // A body of water (0 HU) with bone (700 HU) in air (-1000 HU).
  const auto ct = image<int16_t>(32, [](size_t i, size_t j, size_t k) {
    const double x = double(i) - 15.5, y = double(j) - 15.5, z = double(k) - 15.5, r = std::sqrt(x * x + y * y + z * z);
    return int16_t(r < 4 ? 1600 : r < 12 ? 20 + int(i % 3) : -1000);
  });
  double offset = -1;
  CHECK(looks_like_ct(*ct, ct->fields()[0], &offset));
  CHECK(offset == 0);
  CHECK(choose_look(*ct, "", "mhd").reason.find("CT") != std::string::npos);
  CHECK(choose_look(*ct, "", "mhd").shows[0].kind->is<VolumeShow>());

  const auto labels = image<uint8_t>(16, [](size_t i, size_t j, size_t) { return uint8_t(i < 4 ? 0 : j < 8 ? 1 : 2); });
  const Look look = choose_look(*labels, "", "");
  REQUIRE(look.filter.size() == 3);
  CHECK(look.filter[0] == "label_surface");

  UniformGrid flat;
  flat.dims = {8, 4, 1};
  FieldSet f;
  f.add({"a", Association::point, Array::from_vector(std::vector<float>(32, 1.f)), "", Role::none});
  const Look map = choose_look(*make_dataset(flat, f), "", "");
  CHECK(map.camera.parallel);
  CHECK(map.camera.direction == Vec3(0, 0, 1));
  CHECK(map.shows[0].kind->is<SurfaceShow>());

  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 2, 3}, 3);
  CHECK(choose_look(*make_dataset(cloud), "", "").shows[0].kind->is<PointsShow>());
}

TEST_CASE("show: a constant field is no automatic colour, a named one is") {
  SurfaceMesh m;
  m.points.xyz = Array::from_vector<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  m.polygons.fixed = 3;
  m.polygons.connectivity = Array::from_vector<int32_t>({0, 1, 2});
  FieldSet f;
  f.add({"iso", Association::point, Array::from_vector<float>({2, 2, 2}), "", Role::scalars});
  f.add({"t", Association::point, Array::from_vector<float>({0, 1, 2}), "", Role::none});
  const DatasetPtr d = make_dataset(m, f);
  Context context;
  Scene scene;
  const auto automatic = add_show(scene, "surface", d, {}, context);
  REQUIRE(automatic);
  CHECK(automatic->title == "t");
  const auto named = add_show(scene, "surface", d, {"field=iso"}, context);
  REQUIRE(named);
  CHECK(named->title == "iso");
  CHECK_FALSE(add_show(scene, "surface", d, {"color=white"}, context));
  CHECK(test::error_of([&] { add_show(scene, "surface", d, {"field=tt"}, context); }).find("did you mean 't'") != std::string::npos);
  CHECK(test::error_of([] { find_show("volme"); }).find("did you mean 'volume'") != std::string::npos);
}

TEST_CASE("colours as text: hex, numbers and names; anything else says what would be right") {
  CHECK(parse_color("#ff8000", "x") == Vec3f(1.f, 128 / 255.f, 0.f));
  CHECK(parse_color("#f80", "x") == Vec3f(1.f, 136 / 255.f, 0.f));
  CHECK(parse_color("0.25,0.5,1", "x") == Vec3f(0.25f, 0.5f, 1.f));
  CHECK(parse_color("White", "x") == Vec3f(1.f, 1.f, 1.f));
  CHECK(color_text(parse_color("#123456", "x")) == "#123456");
  for (const char* bad : {"#12345", "#ggg", "0.2,0.3", "2,0,0", "purpel", ""}) CHECK_THROWS_AS(parse_color(bad, "x"), Error);
  CHECK(test::error_of([] { parse_color("purpel", "background"); }).find("did you mean 'purple'") != std::string::npos);
}

TEST_CASE("outline: twelve edges of the grid's own box, turned with it") {
  UniformGrid g;
  g.dims = {3, 3, 3};
  g.direction.m[0][0] = 0, g.direction.m[0][1] = -1, g.direction.m[1][0] = 1, g.direction.m[1][1] = 0;
  Context context;
  Scene scene;
  add_show(scene, "outline", make_dataset(g), {}, context);
  const auto& item = std::get<LinesItem>(scene.items.at(0));
  CHECK(item.data->as<SurfaceMesh>()->lines.size() == 12);
  CHECK(item.data->bounds().lo == Vec3(-2, 0, 0));
  CHECK(item.data->bounds().hi == Vec3(0, 2, 2));
}

TEST_CASE("surface with edges: a curved cell shows its own four sides, a linear one those of its polygon") {
  UnstructuredMesh m;
  m.points.xyz =
      Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, .5f, -.2f, 0, 1.2f, .5f, 0, .5f, 1.2f, 0, -.2f, .5f, 0}, 3);
  m.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7}), {}, 8};
  m.single_type = CellType::quadratic_quad;
  Context context;
  Scene scene;
  add_show(scene, "surface", make_dataset(m), {"edges=true"}, context);
  const auto& curved = std::get<SurfaceItem>(scene.items.at(0));
  REQUIRE(curved.edge_lines);
  CHECK(curved.edge_lines->as<SurfaceMesh>()->lines.size() == 4);
  CHECK(curved.data->as<SurfaceMesh>()->polygons.size() > 100);
  m.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  m.single_type = CellType::quad;
  add_show(scene, "surface", make_dataset(m), {"edges=true"}, context);
  CHECK_FALSE(std::get<SurfaceItem>(scene.items.at(1)).edge_lines);
}

TEST_CASE("choose_look: filled contours are coloured by band, unlit on a plane, with the limits in the legend") {
  Context ctx;
  UniformGrid g;
  g.dims = {9, 9, 1};
  std::vector<float> v;
  for (int j = 0; j < 9; ++j)
    for (int i = 0; i < 9; ++i) v.push_back(float(i));
  FieldSet fields;
  fields.add({"t", Association::point, Array::from_vector(std::move(v)), "K", Role::scalars});
  const DatasetPtr d = bands(make_dataset(g, fields), {.values = {2, 4, 6}}, ctx);
  CHECK(automatic_field(*d)->name == "band");
  const Look look = choose_look(*d, "", "");
  REQUIRE(look.shows.size() == 1);
  CHECK(changed_words(look.shows[0].params).empty());
  Scene scene;
  look.shows[0].kind->add(scene, d, look.shows[0].params, ctx);
  CHECK_FALSE(std::get<SurfaceItem>(scene.items[0]).material.lit);
  const ColorScale s = choose_scale(*d, *automatic_field(*d), {}, ctx);
  CHECK(s.title == "t");
  CHECK(s.unit == "K");
  CHECK(s.labels == std::vector<double>{0, 1, 2, 3});
  CHECK(s.limits == std::vector<double>{0, 2, 4, 6, 8});
  CHECK(s.color(0) == Vec4f{find_colormap("sight").at(0).x, find_colormap("sight").at(0).y, find_colormap("sight").at(0).z, 1});
  CHECK_FALSE(s.color(1) == s.color(2));
  CHECK(changed_words(choose_look(*d, "t", "").shows[0].params).empty());
}

TEST_CASE("labels: a cloud of line labels becomes texts that lie along their lines") {
  Context ctx;
  FieldSet f;
  f.add({"value", Association::point, Array::from_vector(std::vector<double>{988, 992.25}), "hPa", Role::scalars});
  f.add({"angle", Association::point, Array::from_vector(std::vector<double>{30, -90}), "deg", Role::none});
  f.add({"line", Association::point, Array::from_vector(std::vector<int32_t>{0, 1}), "", Role::labels});
  const DatasetPtr d = make_dataset(Mesh(PointCloud{{Array::from_vector(std::vector<double>{1, 2, 0, 3, 4, 0}, 3), {}}}), f);
  CHECK(is_line_labels(*d));
  const Look look = choose_look(*d, "", "");
  REQUIRE(look.shows.size() == 1);
  CHECK(look.shows[0].kind->is<LabelsShow>());
  Scene scene;
  add_show(scene, "labels", d, {}, ctx);
  REQUIRE(scene.texts.size() == 2);
  CHECK(scene.texts[0].text == "988");
  CHECK(scene.texts[1].text == "992.25");
  CHECK(scene.texts[1].at == Vec3(3, 4, 0));
  CHECK(length(scene.texts[0].along - Vec3(std::sqrt(0.75), 0.5, 0)) < 1e-12);
  CHECK(length(scene.texts[1].along - Vec3(0, -1, 0)) < 1e-12);
  CHECK(test::error_of([&] { add_show(scene, "labels", d, {"field=none such"}, ctx); }).find("none such") != std::string::npos);
}

TEST_CASE("look: slices of a patient as radiologists see them, bodies from the front") {
  const auto slice = [](Vec3 a, Vec3 b, bool patient) {
    DatasetParts parts;
    UniformGrid g;
    g.dims = {4, 5, 1};
    const Vec3 n = cross(a, b);
    for (int r = 0; r < 3; ++r) g.direction.m[r][0] = a[r], g.direction.m[r][1] = b[r], g.direction.m[r][2] = n[r];
    parts.mesh = g;
    std::vector<float> v(20);
    for (size_t i = 0; i < v.size(); ++i) v[i] = float(i);
    parts.fields.add({"t", Association::point, Array::from_vector(v), "", Role::scalars});
    if (patient) parts.notes = {{"space", "left-posterior-superior"}};
    return choose_look(*make_dataset(parts), "", "").camera;
  };
  CameraDefaults c = slice({1, 0, 0}, {0, 1, 0}, true);  // axial
  CHECK(c.direction == Vec3(0, 0, -1));
  CHECK(c.up == Vec3(0, -1, 0));
  CHECK(c.parallel);
  c = slice({1, 0, 0}, {0, 1, 0}, false);
  CHECK(c.direction == Vec3(0, 0, 1));
  CHECK(c.up == Vec3(0, 1, 0));
  c = slice({1, 0, 0}, {0, 0, -1}, true);  // coronal
  CHECK(c.direction == Vec3(0, -1, 0));
  CHECK(c.up == Vec3(0, 0, 1));
  c = slice({0, 1, 0}, {0, 0, -1}, true);  // sagittal
  CHECK(c.direction == Vec3(1, 0, 0));
  CHECK(c.up == Vec3(0, 0, 1));
  // Leaning by a fifth: still axial, along its own normal.
  c = slice({1, 0, 0}, normalize(Vec3(0, 1, 0.2)), true);
  CHECK(length(c.direction - normalize(Vec3(0, 0.2, -1))) < 1e-12);
  CHECK(c.up == Vec3(0, -1, 0));
  CHECK(c.parallel);
  const CameraDefaults body = choose_view({{0, 0, 0}, {1, 1, 1}}, "nii", true);
  CHECK(-body.direction.y > 2 * std::abs(body.direction.x));
}

TEST_CASE("volume looks: a scan that is no CT is grey, in its own window; CT is said where the file or the values say so") {
  // A head of 400 in a background of 0 to 20, as MR gives it.
  const auto mr = [](std::vector<std::pair<std::string, std::string>> notes) {
    DatasetParts parts = image<int16_t>(24, [](size_t i, size_t j, size_t k) {
                           const double x = double(i) - 11.5, y = double(j) - 11.5, z = double(k) - 11.5;
                           return int16_t(x * x + y * y + z * z < 64 ? 400 + int(i * 7 + j * 3) : int(i + 2 * j + k) % 20);
                         })->parts();
    parts.notes = std::move(notes);
    FieldSet fields;
    for (Field f : parts.fields) f.role = Role::scalars, fields.add(std::move(f));
    parts.fields = std::move(fields);
    return make_dataset(std::move(parts));
  };
  const auto look_of = [](const DatasetPtr& d, VolumeItem& item) {
    Context quiet;
    item.color = choose_scale(*d, d->fields()[0], {}, quiet);
    return choose_volume_look(*d, d->fields()[0], {}, item);
  };
  VolumeItem item;
  const auto scan = mr({{"space", "left-posterior-superior"}, {"Modality", "MR"}});
  CHECK(look_of(scan, item).find("in grey") != std::string::npos);
  CHECK(item.color.map.name == "soft grey");
  for (const Vec3f& c : item.color.map.colors) CHECK(std::abs(c.x - c.z) < 0.1f);
  CHECK(item.shaded);
  CHECK(item.opacity.points[1].x > 15);
  CHECK(item.opacity.points[1].x < 200);
  const auto windowed = mr({{"space", "left-posterior-superior"}, {"WindowCenter", "300\\150"}, {"WindowWidth", "200\\100"}});
  VolumeItem own;
  look_of(windowed, own);
  CHECK(own.color.lo == 200);
  CHECK(own.color.hi == 400);
  // No patient: the usual colours.
  VolumeItem other;
  CHECK(look_of(mr({}), other).find("grey") == std::string::npos);
  CHECK(other.color.map.name == "sight");
  // What the file calls MR is no CT, whatever its values; what it calls CT is.
  const auto body = [](const char* modality) {
    DatasetParts parts = image<int16_t>(32, [](size_t i, size_t j, size_t k) {
                           const double x = double(i) - 15.5, y = double(j) - 15.5, z = double(k) - 15.5,
                                        r = std::sqrt(x * x + y * y + z * z);
                           return int16_t(r < 4 ? 1600 : r < 12 ? 20 + int(i % 3) : -1000);
                         })->parts();
    parts.notes = {{"Modality", modality}};
    return make_dataset(std::move(parts));
  };
  double offset = 0;
  CHECK(!looks_like_ct(*body("MR"), body("MR")->fields()[0], &offset));
  CHECK(looks_like_ct(*body("CT"), body("CT")->fields()[0], &offset));
}

TEST_CASE("choose_look: distances to a surface are known by their slope") {
  const auto filter_of = [](double factor, const std::function<double(Vec3)>& f) {
    return choose_look(
               *image<float>(16, [&](size_t i, size_t j, size_t k) { return float(factor * f(Vec3(i, j, k) - Vec3(7.5, 7.5, 7.5))); }), "",
               "")
        .filter;
  };
  const auto ball = [](Vec3 x) { return length(x) - 5; };
  const std::vector<std::string> zero{"contour", "field=v", "values=0"};
  CHECK(filter_of(1, ball) == zero);
  CHECK(filter_of(-1, ball) == zero);
  CHECK(filter_of(2, ball).empty());                                    // no distance
  CHECK(filter_of(1, [](Vec3 x) { return x.x; }).empty());              // a coordinate
  CHECK(filter_of(1, [](Vec3 x) { return length(x) + 0.1; }).empty());  // no zero
  // A narrow band: held at three cells on both sides.
  CHECK(filter_of(1, [&](Vec3 x) { return std::clamp(ball(x), -3.0, 3.0); }) == zero);
}

TEST_CASE("choose_scale: Hounsfield units of a scan are grey from air on, though they are of both signs") {
  DatasetParts parts = image<int16_t>(12, [](size_t i, size_t j, size_t) {
                         return int16_t(i == 0 ? -3000 : i < 4 ? -1000 : 40 * int(j));
                       })->parts();
  parts.notes = {{"space", "left-posterior-superior"}};
  Field f = parts.fields[0];
  f.unit = "HU";
  parts.fields = {};
  parts.fields.add(f);
  const DatasetPtr d = make_dataset(parts);
  Context quiet;
  const ColorScale s = choose_scale(*d, d->fields()[0], {}, quiet);
  CHECK(s.map.name == "gray");
  CHECK(s.lo == -1024);
  CHECK(s.below);
  // Diffusion images are of magnetic resonance, whatever their values look like.
  parts.fields.add({"bval", Association::whole, Array::from_vector(std::vector<double>{0, 1000}), "", Role::none});
  f.unit = "";
  parts.fields.remove(f.name, f.association), parts.fields.add(f);
  double offset = 0;
  const DatasetPtr diffusion = make_dataset(parts);
  CHECK_FALSE(looks_like_ct(*diffusion, diffusion->fields().require("v"), &offset));
}

TEST_CASE("choose_scale: stated numbers of the legend that are not on it are left out with a word") {
  const auto d = image<float>(4, [](size_t i, size_t, size_t) { return float(i); });
  std::string warned;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { warned = text; };
  ColoringParams p;
  p.legend_ticks = {-1, 0, 3, 4};
  CHECK(choose_scale(*d, d->fields()[0], p, context).ticks == std::vector<double>{0, 3});
  CHECK(warned.find("-1, 4 are beyond the legend") != warned.npos);
  p.legend_ticks = {5};  // meant as how many
  CHECK(choose_scale(*d, d->fields()[0], p, context).ticks.empty());
  CHECK(warned.find("legend_count=5") != warned.npos);
  warned = "";
  p.legend_ticks = {0, 3}, p.legend_count = 7;
  CHECK(choose_scale(*d, d->fields()[0], p, context).tick_count == 7);
  CHECK(warned.empty());
}

TEST_CASE("choose_scale: with colours for what lies beyond a range it is said how much does") {
  const auto d = image<float>(10, [](size_t i, size_t, size_t) { return float(i); });  // 0 to 9
  std::string said;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) { said = text; };
  ColoringParams p;
  p.range = {2, 20}, p.above = "red";
  choose_scale(*d, d->fields()[0], p, context);
  CHECK(said.find("20 % lie below the range and none above") != said.npos);
  said = "", p.above = "";
  choose_scale(*d, d->fields()[0], p, context);
  CHECK(said.empty());
}

TEST_CASE("choose_view: what lies flat is seen from higher up, what is long from its side") {
  const auto seen_from = [](Vec3 size) { return choose_view({{0, 0, 0}, size}, "vtu", false).direction; };
  const Vec3 usual = CameraDefaults().direction;
  CHECK(seen_from({1, 1, 1}) == usual);
  CHECK(seen_from({1, 1, 0.1}).z > 2 * usual.z);
  CHECK(std::abs(seen_from({4, 1, 1}).x) < usual.x);
  CHECK(std::abs(seen_from({1, 4, 1}).y) < std::abs(usual.y));
  CHECK(choose_view({{0, 0, 0}, {4, 1, 0.1}}, "nii", true).direction == choose_view({{0, 0, 0}, {1, 1, 1}}, "nii", true).direction);
}

TEST_CASE("choose_scale: a stated range ends in triangles where values lie beyond it") {
  const auto d = image<float>(4, [](size_t i, size_t, size_t) { return float(i); });
  Context quiet;
  ColoringParams p;
  p.range = {0, 3};
  CHECK_FALSE(choose_scale(*d, d->fields()[0], p, quiet).below);
  CHECK_FALSE(choose_scale(*d, d->fields()[0], p, quiet).above);
  p.range = {1, 2};
  const ColorScale s = choose_scale(*d, d->fields()[0], p, quiet);
  CHECK(s.color(0) == s.color(1));
  CHECK(s.below);
  CHECK(s.above);
  p.above = "red";
  CHECK(choose_scale(*d, d->fields()[0], p, quiet).color(3) == Vec4f{1, 0, 0, 1});
  p.clamp = false;
  CHECK_FALSE(choose_scale(*d, d->fields()[0], p, quiet).below);
}
