// SPDX-License-Identifier: Apache-2.0
// Every kind of grid, element type, hole and view: what the picture must not depend on.
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

double bumpy(Vec3 p) { return 0.5 + 0.3 * std::sin(3 * p.x + 1) * std::cos(2 * p.y) + 0.2 * std::sin(4 * p.z + p.x); }

VolumeItem bumpy_item(DatasetPtr d) {
  OpacityCurve curve;
  curve.points = {{0.4, 0}, {0.6, 0.5}, {0.8, 0.95}};
  VolumeItem v = item(std::move(d), grey(0, 1), curve, 0.01);
  v.shaded = true;
  return v;
}

Frame bumpy_picture(DatasetPtr d, const volume::Knobs& knobs = {}) {
  return draw(scene_of({bumpy_item(std::move(d))}), perspective_view(40, 40, 70, {1.5, 1.1, 3}, {0, 0, 0}), knobs);
}

/// The bumpy field on a grid of 21 x 17 x 13 points over [-1,1]^3 whose axes come in another order, sign or kind.
UniformGrid base_grid() {
  UniformGrid g;
  g.dims = {21, 17, 13}, g.origin = {-1, -1, -1}, g.spacing = {0.1, 0.125, 2.0 / 12};
  return g;
}

}  // namespace

TEST_CASE("volume: negative spacing, swapped axes and rectilinear coordinates show the same field the same") {
  const Frame want = bumpy_picture(grid(base_grid(), bumpy));
  float alpha = 0;
  for (size_t i = 3; i < want.rgba.size(); i += 4) alpha = std::max(alpha, want.rgba[i]);
  REQUIRE(alpha > 0.5f);

  UniformGrid g = base_grid();
  g.origin.x = 1, g.spacing.x = -0.1;
  CHECK(largest_difference(want, bumpy_picture(grid(g, bumpy))) < 2e-3f);

  g = base_grid();  // axes (y, z, x) by the direction matrix
  g.dims = {17, 13, 21}, g.spacing = {0.125, 2.0 / 12, 0.1};
  g.direction = Mat3{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};
  CHECK(largest_difference(want, bumpy_picture(grid(g, bumpy))) < 2e-3f);

  // The same numbers as a rectilinear grid, x descending.
  g = base_grid();
  g.origin.x = 1, g.spacing.x = -0.1;
  const DatasetPtr uniform = grid(g, bumpy);
  RectilinearGrid r;
  std::vector<double> c[3];
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < g.dims[size_t(a)]; ++i) c[a].push_back(g.origin[a] + g.spacing[a] * double(i));
  r.x = Array::from_vector(c[0]), r.y = Array::from_vector(c[1]), r.z = Array::from_vector(c[2]);
  CHECK(largest_difference(want, bumpy_picture(make_dataset(r, uniform->fields()))) < 2e-3f);
}

TEST_CASE("volume: a rotated grid under a rotated camera and lights gives the picture of the straight one") {
  const double a = 0.7;
  const Mat3 turn{{{std::cos(a), -std::sin(a), 0}, {std::sin(a), std::cos(a), 0}, {0, 0, 1}}};
  UniformGrid g = base_grid();
  g.direction = turn, g.origin = turn * g.origin;
  const DatasetPtr turned = grid(g, [&](Vec3 p) { return bumpy(transpose(turn) * p); });
  const Frame f =
      draw(scene_of({bumpy_item(turned)}), perspective_view(40, 40, 70, turn * Vec3{1.5, 1.1, 3}, {0, 0, 0}, turn * Vec3{0, 1, 0}));
  CHECK(largest_difference(bumpy_picture(grid(base_grid(), bumpy)), f) < 2e-3f);
}

TEST_CASE("volume: uneven rectilinear coordinates show a linear field exactly where it is") {
  RectilinearGrid r;
  r.x = Array::from_vector<double>({-1, -0.9, 0.3, 1}), r.y = Array::from_vector<double>({1, 0.2, 0.1, -1});
  r.z = Array::from_vector<float>({-1, -0.99f, -0.5f, 0.75f, 1});
  std::vector<float> v;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) v.push_back(float(2 + r.x.get(size_t(i)) + 0.5 * r.y.get(size_t(j)) + 0.25 * r.z.get(size_t(k))));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  const DatasetPtr d = make_dataset(r, fields);
  for (const auto& [x, y] : {std::pair{-0.95, 0.5}, std::pair{0.0, 0.15}, std::pair{0.77, -0.8}}) {
    const Frame f = look(scene_of({item(d, one_color({1, 1, 1}), density_is_value(0, 4, 40000), 0.01)}), x, y);
    CHECK(-std::log(1 - double(f.rgba[3])) == Approx(2 * (2 + x + 0.5 * y)).epsilon(1e-3));
  }
}

TEST_CASE("volume: every element type shows the same numbers the same, scalar and vector code give the same bytes") {
  UniformGrid g = cube(14, -1, 1);
  const auto field = [](Vec3 p) { return std::floor(60 + 50 * std::sin(3 * p.x) * std::cos(2 * p.y + p.z)); };
  OpacityCurve curve;
  curve.points = {{40, 0}, {90, 0.9}};
  const Projection view = perspective_view(33, 33, 50, {1.5, 1.1, 3}, {0, 0, 0});
  Frame want;
  for (const ElementType t : {ElementType::f32, ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16, ElementType::u32,
                              ElementType::i32, ElementType::u64, ElementType::i64, ElementType::f64}) {
    VolumeItem v = item(grid(g, field, t), grey(0, 120), curve);
    v.shaded = true;
    const Frame f = draw(scene_of({v}), view);
    volume::Knobs scalar;
    scalar.simd = false;
    INFO(std::string(element_name(t)));
    CHECK(same_bytes(f, draw(scene_of({v}), view, scalar)));
    if (t == ElementType::f32) want = f;
    CHECK(largest_difference(want, f) < (is_float(t) || element_size(t) <= 2 ? 1e-6f : 1e-3f) + (t == ElementType::f64 ? 1e-3f : 0));
  }
}

TEST_CASE("volume: the last voxels of tiny arrays of small integers are read right") {
  for (const ElementType t : {ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16}) {
    const Array a = Array::from_vector<double>({1, 2, 3, 4, 5, 6, 7, 8}).converted(t);
    const volume::Voxels voxels{a, {2, 2, 2}};
    alignas(64) float x[16], y[16], z[16], fast[16], slow[16];
    for (int i = 0; i < 16; ++i) x[i] = float(i & 1), y[i] = float(i >> 1 & 1), z[i] = float(i >> 2 & 1);
    x[8] = 0.5f, y[9] = 0.25f, x[10] = -3, x[11] = 9;
    volume::best_kernels(voxels).sample(voxels, x, y, z, fast);
    volume::scalar_kernels(voxels).sample(voxels, x, y, z, slow);
    CHECK(std::memcmp(fast, slow, sizeof fast) == 0);
    for (int i = 0; i < 8; ++i) CHECK(fast[i] == float(i + 1));
    CHECK(fast[8] == 1.5f);
    CHECK(fast[10] == 3);
    CHECK(fast[11] == 4);
  }
}

TEST_CASE("volume: large values with small differences keep them") {
  UniformGrid g = cube(5, -1, 1);
  const double far = 1e9;
  const DatasetPtr d = grid(
      g, [&](Vec3 p) { return far + p.x; }, ElementType::f64);
  OpacityCurve curve;
  curve.points = {{far - 1, 0}, {far + 1, 0.8}};
  ColorScale scale = grey(far - 1, far + 1);
  for (const double x : {-0.5, 0.25, 0.8}) {
    const Frame f = look(scene_of({item(d, scale, curve)}), x, 0);
    CHECK(f.rgba[3] == Approx(1 - std::pow(1 - 0.4 * (x + 1), 2)).epsilon(1e-3));
  }
}

TEST_CASE("volume: cell fields fill their cells, vectors show components and magnitude") {
  UniformGrid g;
  g.dims = {3, 2, 2}, g.origin = {-1, -1, -1}, g.spacing = {1, 2, 2};
  FieldSet fields;
  fields.add({"f", Association::cell, Array::from_vector<float>({3, 4, 0, 2}, 2), "", Role::none});
  const DatasetPtr d = make_dataset(g, fields);
  VolumeItem v = item(d, one_color({1, 1, 1}), density_is_value(0, 6, 40000));
  v.association = Association::cell;
  const auto density = [&](double x) { return -std::log(1 - double(look(scene_of({v}), x, 0).rgba[3])) / 2; };
  v.component = 0;
  CHECK(density(-0.9) == Approx(3).epsilon(1e-3));  // outer half: the cell's own value
  CHECK(density(0) == Approx(1.5).epsilon(1e-3));   // between the middles of the two: linear
  CHECK(density(0.25) == Approx(0.75).epsilon(1e-3));
  v.component = 1;
  CHECK(density(0.9) == Approx(2).epsilon(1e-3));
  v.component = -1;
  CHECK(density(-0.9) == Approx(5).epsilon(1e-2));
}

TEST_CASE("volume: a grid one point thick is a slab one cell thick") {
  for (const int axis : {0, 1, 2}) {
    UniformGrid g = cube(5, -1, 1);
    g.dims[size_t(axis)] = 1, g.spacing[axis] = 0.25, g.origin[axis] = 0;
    Vec3 forward{0.0, 0.0, 0.0};
    forward[axis] = -1;
    const Vec3 up = axis == 1 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    const Frame f = draw(scene_of({item(grid(g, [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(2))}),
                         parallel_view(1, 1, 1, forward, up, {0.01, 0.02, 0.03}));
    CHECK(f.rgba[3] == Approx(1 - std::exp(-0.5)).epsilon(1e-4));
  }
  RectilinearGrid r;
  r.x = Array::from_vector<double>({-1, 0.5, 1}), r.y = Array::from_vector<double>({-1, 1}), r.z = Array::from_vector<double>({3});
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector<float>({1, 1, 1, 1, 1, 1}), "", Role::scalars});
  CHECK(look(scene_of({item(make_dataset(r, fields), one_color({1, 1, 1}), constant_opacity(2))})).rgba[3] ==
        Approx(1 - std::exp(-1.0)).epsilon(1e-4));
}

TEST_CASE("volume: NaN voxels draw nothing, their cells are clear and the rest is untouched") {
  UniformGrid g;
  g.dims = {3, 3, 5}, g.origin = {-1, -1, -2}, g.spacing = {1, 1, 1};
  const DatasetPtr d = grid(g, [](Vec3 p) { return p.z == 0 ? NAN : 1.0; });
  const Frame f = look(scene_of({item(d, one_color({1, 1, 1}), constant_opacity(0.5), 0.01)}));
  CHECK(1 - f.rgba[3] == Approx(std::exp(-0.5 * 2)).epsilon(1e-3));  // of 4 cells, the two that touch z = 0 are clear
  const DatasetPtr none = grid(g, [](Vec3) { return NAN; });
  CHECK(look(scene_of({item(none, one_color({1, 1, 1}), constant_opacity(0.5))})).rgba[3] == 0);
  VolumeItem m = item(none, one_color({1, 1, 1}), constant_opacity(0.5));
  m.mode = VolumeItem::Mode::maximum;
  CHECK(look(scene_of({m})).rgba[3] == 0);
}

TEST_CASE("volume: blanked cells are clear, of cell fields just themselves, of point fields too") {
  UniformGrid g;
  g.dims = {2, 2, 5}, g.origin = {-1, -1, -2}, g.spacing = {2, 2, 1};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"f", Association::cell, Array::from_vector<float>({1, 1, 1, 1}), "", Role::none});
  parts.fields.add({"f", Association::point, Array::from_vector(std::vector<float>(20, 1)), "", Role::none});
  parts.cell_ghost = Array::from_vector<uint8_t>({0, ghost_hidden_cell, 0, ghost_refined_cell});
  const DatasetPtr d = make_dataset(parts);
  for (const Association a : {Association::cell, Association::point}) {
    VolumeItem v = item(d, one_color({1, 1, 1}), constant_opacity(0.5), 0.01);
    v.association = a;
    CHECK(1 - look(scene_of({v})).rgba[3] == Approx(std::exp(-0.5 * 2)).epsilon(1e-2));
    v.mode = VolumeItem::Mode::maximum;
    CHECK(look(scene_of({v})).rgba[3] == 1);
  }
}

TEST_CASE("volume: the camera may stand inside, and rays may run along faces and edges") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  const Scene scene = scene_of({item(d, one_color({1, 1, 1}), constant_opacity(1))});
  const Frame inside = draw(scene, perspective_view(1, 1, 1, {0.1, 0.2, 0.5}, {0.1, 0.2, -3}));
  CHECK(inside.rgba[3] == Approx(1 - std::exp(-1.5)).epsilon(1e-4));
  const Frame away = draw(scene, perspective_view(1, 1, 1, {0, 0, 3}, {0, 0, 9}));
  CHECK(away.rgba[3] == 0);
  for (const auto& [x, y] : {std::pair{1.0, 0.3}, std::pair{-1.0, -1.0}, std::pair{0.25, 0.5}}) {
    const Frame f = look(scene, x, y);
    CHECK(f.rgba[3] == Approx(1 - std::exp(-2.0)).epsilon(1e-4));
  }
  CHECK(look(scene, 1.001, 0).rgba[3] == 0);
}

TEST_CASE("volume: near and far planes cut the volume") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  Projection p = parallel_view(1, 1, 1);
  p.near_plane = 99.25, p.far_plane = 100.5;
  CHECK(draw(scene_of({item(d, one_color({1, 1, 1}), constant_opacity(1))}), p).rgba[3] == Approx(1 - std::exp(-1.25)).epsilon(1e-4));
}

TEST_CASE("volume: what cannot be shown is said, with what would be right") {
  const DatasetPtr d = grid(cube(3, -1, 1), [](Vec3) { return 1.0; });
  const auto error = [](const VolumeItem& v) { return error_of([&] { look(scene_of({v})); }); };
  VolumeItem v = item(d, grey(0, 1), {});
  v.field = "g";
  CHECK(error(v).find("g") != std::string::npos);
  v = item(d, grey(0, 1), {});
  v.component = 2;
  CHECK(error(v).find("has 1 component;") != std::string::npos);
  v.component = -1, v.sampling.step = -1;
  CHECK(error(v).find("step") != std::string::npos);
  v.sampling.step = 1e-9;
  CHECK(error(v).find("longer step") != std::string::npos);
  v.sampling.step = 0, v.unit_distance = NAN;
  CHECK(error(v).find("unit distance") != std::string::npos);
  v.unit_distance = 1;
  for (const double tolerance : {0.0, -1.0, HUGE_VAL, double(NAN)}) {
    v.sampling.tolerance = tolerance;
    CHECK(error(v).find("tolerance") != std::string::npos);
  }
  v.sampling.tolerance = 1.0 / 512, v.data = nullptr;
  CHECK(error(v).find("no dataset") != std::string::npos);
  PointCloud cloud;
  cloud.points.xyz = Array::from_vector<float>({0, 0, 0}, 3);
  v.data = make_dataset(cloud);
  CHECK(error(v).find("show its surface instead: --show surface") != std::string::npos);
  v.data = make_dataset(cube(2, 0, 1)), v.field = "";
  CHECK(error(v).find("no scalar field") != std::string::npos);
  FieldSet whole;
  whole.add({"f", Association::whole, Array::from_vector<float>({1}), "", Role::none});
  v.data = make_dataset(cube(2, 0, 1), whole), v.field = "f", v.association = Association::whole;
  CHECK(error(v).find("whole") != std::string::npos);
}
