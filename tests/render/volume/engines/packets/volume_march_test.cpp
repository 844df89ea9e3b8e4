// SPDX-License-Identifier: Apache-2.0
// Skipping, termination, threads, maxima, gradients, transfer tables and picking.
#include <tuple>

#include "render/volume/volume_support.h"

#include "render/volume/methods/stage.h"
#include "render/volume/sources/lattice/runs.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;

namespace {

/// A few blobs in empty space.
double blobs(Vec3 p) {
  double sum = 0;
  for (int i = 0; i < 5; ++i) {
    const Vec3 c{0.7 * std::sin(2.0 * i), 0.7 * std::cos(3.0 * i), 0.6 * std::sin(5.0 * i)};
    sum += std::exp(-40 * dot(p - c, p - c));
  }
  return sum;
}

Scene blob_scene(bool shaded, double opacity = 0.9, size_t n = 65) {
  OpacityCurve curve;
  curve.points = {{0.1, 0}, {0.3, opacity}, {0.5, 0.2 * opacity}, {0.9, opacity}};
  VolumeItem v = item(grid(cube(n, -1, 1), blobs), grey(0, 1), curve);
  v.unit_distance = 0.1, v.shaded = shaded;
  return scene_of({v});
}
const Projection blob_view = perspective_view(48, 48, 90, {1.5, 1.1, 3}, {0, 0, 0});

}  // namespace

TEST_CASE("volume: skipping empty bricks is not seen") {
  volume::Knobs plain;
  plain.skip_empty = false;
  for (const bool shaded : {false, true}) {
    volume::Knobs with, without;
    // Strides begin elsewhere when bricks are skipped.
    with.stop_below = without.stop_below = 0;
    without.skip_empty = false;
    const Frame a = draw(blob_scene(shaded), blob_view, with), b = draw(blob_scene(shaded), blob_view, without);
    CHECK(largest_difference(a, b) < 1.0f / 512);
    float most = 0;
    for (const float x : a.rgba) most = std::max(most, x);
    CHECK(most > 0.5f);
    CHECK(largest_difference(draw(blob_scene(shaded), blob_view), draw(blob_scene(shaded), blob_view, plain)) < 1.0f / 512);
  }
}

TEST_CASE("volume: highlights of every whole power are those of single rays, in steps and within the tolerance") {
  for (const double power : {0.0, 1.0, 5.0, 20.0, 32.0, 129.0})
    for (const double step : {0.0, 0.004}) {
      Scene scene = blob_scene(true);
      auto& v = std::get<VolumeItem>(scene.items[0]);
      v.light.power = power, v.light.specular = 0.6, v.sampling.step = step;
      const Frame packets = draw(scene, blob_view);
      volume::Knobs one_lane;
      one_lane.simd = false;
      CHECK(same_bytes(packets, draw(scene, blob_view, one_lane)));
      v.clip = {{{1, 0, 0}, 1e6}};  // packets do not know planes
      const Frame single = draw(scene, blob_view);
      INFO("power " << power << " step " << step);
      CHECK(largest_difference(packets, single) < 2.0f / 512);
      v.light.specular = 0;
      CHECK(largest_difference(single, draw(scene, blob_view)) > 0.02f);
    }
}

TEST_CASE("volume: skipping works for rectilinear grids, tiny steps and axis-parallel rays") {
  RectilinearGrid r;
  std::vector<double> c;
  for (int i = 0; i <= 50; ++i) c.push_back(-1 + 2 * std::pow(i / 50.0, 1.7));
  r.x = r.y = r.z = Array::from_vector(c);
  std::vector<float> v;
  for (int k = 0; k <= 50; ++k)
    for (int j = 0; j <= 50; ++j)
      for (int i = 0; i <= 50; ++i) v.push_back(float(blobs({c[size_t(i)], c[size_t(j)], c[size_t(k)]})));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  Scene scene = blob_scene(true);
  std::get<VolumeItem>(scene.items[0]).data = make_dataset(r, fields);
  volume::Knobs with, without;
  with.stop_below = without.stop_below = 0, without.skip_empty = false;
  for (const double step : {0.013, 0.0007}) {
    std::get<VolumeItem>(scene.items[0]).sampling.step = step;
    for (const Projection& p :
         {perspective_view(12, 12, 20, {1.5, 1.1, 3}, {0, 0, 0}), parallel_view(9, 9, 4.5), parallel_view(9, 9, 4.5, {-1, 0, 0})})
      CHECK(same_bytes(draw(scene, p, with), draw(scene, p, without)));
  }
}

TEST_CASE("volume: early termination is not seen, even after encoding") {
  volume::Knobs all;
  all.stop_below = 0;
  for (const bool shaded : {false, true}) {
    const Frame a = draw(blob_scene(shaded, 0.999), blob_view), b = draw(blob_scene(shaded, 0.999), blob_view, all);
    float most = 0;
    for (size_t i = 0; i < a.rgba.size(); ++i)
      most = std::max(most, std::abs(srgb_encode(std::clamp(a.rgba[i], 0.0f, 1.0f)) - srgb_encode(std::clamp(b.rgba[i], 0.0f, 1.0f))));
    CHECK(most < 1.0f / 255);
    CHECK_FALSE(same_bytes(a, b));  // it did happen
  }
}

TEST_CASE("volume: 1 and 8 threads give the same bytes") {
  Scene scene = blob_scene(true);
  VolumeItem other = std::get<VolumeItem>(blob_scene(false, 0.4, 33).items[0]), most = other;
  most.mode = VolumeItem::Mode::maximum, most.opacity.points = {{0.4, 0}, {0.41, 1}};
  scene.items.push_back(other), scene.items.push_back(most);
  set_thread_count(1);
  const Frame one = draw(scene, blob_view);
  set_thread_count(8);
  const Frame eight = draw(scene, blob_view);
  set_thread_count(0);
  CHECK(same_bytes(one, eight));
}

TEST_CASE("volume: the maximum along axis-parallel rays through the samples is the largest sample") {
  UniformGrid g;
  g.dims = {9, 21, 18}, g.origin = {0, 0, 0}, g.spacing = {1, 1, 1};
  std::vector<int16_t> v(9 * 21 * 18);
  for (size_t i = 0; i < v.size(); ++i) v[i] = int16_t(random_bits(4, i) % 4001);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  VolumeItem item = test::item(make_dataset(g, fields), grey(0, 4000), {});
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 along{0, 0, 0};
    along[axis] = 1;
    const volume::Volume volume = volume::prepare(item, 1, {});
    for (const bool skip : {true, false}) {
      volume::Knobs knobs;
      knobs.skip_empty = skip;
      const int b = (axis + 1) % 3, c = (axis + 2) % 3;
      for (size_t i = 0; i < g.dims[size_t(b)]; ++i)
        for (size_t j = 0; j < g.dims[size_t(c)]; ++j) {
          Vec3 from{0, 0, 0};
          from[axis] = -5, from[b] = double(i), from[c] = double(j);
          int want = 0;
          for (size_t k = 0; k < g.dims[size_t(axis)]; ++k) {
            size_t at[3];
            at[axis] = k, at[b] = i, at[c] = j;
            want = std::max(want, int(v[at[0] + 9 * (at[1] + 21 * at[2])]));
          }
          const volume::Found m = largest_along(volume, from, along);
          REQUIRE(m.found);
          REQUIRE(m.value == double(want));
        }
    }
  }
}

TEST_CASE("volume: the maximum along any ray is never below samples of the field, and is attained where it says") {
  const DatasetPtr d = grid(cube(20, -1, 1), [](Vec3 p) {
    return random_unit(9, uint64_t(1e4 * (p.x + 1)) * 7919 + uint64_t(1e4 * (p.y + 1)) * 104729 + uint64_t(1e4 * (p.z + 1)));
  });
  UniformGrid g = cube(20, -1, 1);
  FieldSet cells;
  cells.add({"f", Association::cell, d->fields()[0].array.slice(0, 19 * 19 * 19), "", Role::none});
  const DatasetPtr by_cell = make_dataset(g, cells);
  for (const bool cell : {false, true}) {
    VolumeItem item = test::item(cell ? by_cell : d, grey(0, 1), {});
    item.association = cell ? Association::cell : Association::point;
    const volume::Volume v = volume::prepare(item, 1, {});
    for (uint64_t trial = 0; trial < 60; ++trial) {
      const auto coordinate = [&](uint64_t i) { return 2 * random_unit(trial, i) - 1; };
      const Vec3 to{coordinate(0), coordinate(1), coordinate(2)}, from = normalize(Vec3{coordinate(3), coordinate(4), coordinate(5)}) * 4.0;
      const volume::Course c = volume::course(v, from, normalize(to - from), 0, 1e9);
      const volume::Found m = largest_along(v, from, normalize(to - from));
      REQUIRE(m.found);
      float sampled = 0;
      const auto value_at = [&](double t) {
        volume::Run run;
        for (int n = 0; n < volume::run_length; ++n)
          run.ux[n] = float(c.start.x + t * c.along.x), run.uy[n] = float(c.start.y + t * c.along.y),
          run.uz[n] = float(c.start.z + t * c.along.z);
        volume::finish_values(v, run);
        return run.value[0];
      };
      for (int s = 0; s <= 3000; ++s) sampled = std::max(sampled, value_at(c.enter + (c.leave - c.enter) * s / 3000));
      REQUIRE(m.value >= double(sampled) - 1e-5);
      REQUIRE(m.value <= double(sampled) + 1e-2);
      REQUIRE(std::abs(double(value_at(m.t)) - m.value) < 1e-4);
    }
  }
}

TEST_CASE("volume: a maximum is drawn in the full colour of its value, and not where opacity is zero or a surface hides it") {
  const DatasetPtr d = grid(cube(17, -1, 1), [](Vec3 p) { return std::max(0.0, 1 - length(p - Vec3{0, 0, -0.5})); });
  VolumeItem v = item(d, grey(0, 1), {});
  v.mode = VolumeItem::Mode::maximum;
  const Frame f = look(scene_of({v}), 0, 0);
  CHECK(f.rgba[0] == Approx(1.0).epsilon(1e-3));
  CHECK(f.rgba[3] == 1);
  CHECK(f.depth[0] == Approx(100.5));
  CHECK(f.ids[0] == 1);
  Projection p = parallel_view(1, 1, 1);
  p.far_plane = 100;  // the near half: the largest value there is at z = 0
  CHECK(draw(scene_of({v}), p).rgba[0] == Approx(0.5).epsilon(1e-3));
  v.opacity.points = {{0.97, 0}, {1, 1}};
  CHECK(look(scene_of({v}), 0.3, 0).rgba[3] == 0);
}

TEST_CASE("volume: gradients by central differences converge with order 2 in uniform and rectilinear grids") {
  const auto field = [](Vec3 p) { return std::sin(2 * p.x) * std::cos(p.y) + p.z * p.z * p.z; };
  const auto exact = [](Vec3 p) { return Vec3{2 * std::cos(2 * p.x) * std::cos(p.y), -std::sin(2 * p.x) * std::sin(p.y), 3 * p.z * p.z}; };
  for (const bool rectilinear : {false, true}) {
    double h[3], error[3];
    for (int level = 0; level < 3; ++level) {
      const size_t n = size_t(12) << level;
      DatasetPtr d = grid(cube(n + 1, -1, 1), field);
      if (rectilinear) {
        RectilinearGrid r;
        std::vector<double> c;
        for (size_t i = 0; i <= n; ++i) c.push_back(1 - 2.0 * double(i) / double(n));
        r.x = Array::from_vector(c);
        for (double& x : c) x = -x;
        r.y = r.z = Array::from_vector(c);
        std::vector<float> values;
        for (size_t k = 0; k <= n; ++k)
          for (size_t j = 0; j <= n; ++j)
            for (size_t i = 0; i <= n; ++i) values.push_back(float(field({r.x.get(i), c[j], c[k]})));
        FieldSet fields;
        fields.add({"f", Association::point, Array::from_vector(values), "", Role::scalars});
        d = make_dataset(r, fields);
      }
      const volume::Volume v = volume::prepare(item(d, grey(0, 1), {}), 1, {});
      double worst = 0;
      for (uint64_t i = 0; i < 300; ++i) {
        // On uneven axes samples at even steps are lit by what there is of a cell in the outermost ones.
        const double reach = rectilinear ? 0.7 : 1;
        const Vec3 p = Vec3{2 * random_unit(1, 3 * i) - 1, 2 * random_unit(1, 3 * i + 1) - 1, 2 * random_unit(1, 3 * i + 2) - 1} * reach;
        const Vec3 q = v.q(p);
        volume::Run run;
        for (int s = 0; s < volume::run_length; ++s) run.ux[s] = v.u(0, q.x), run.uy[s] = v.u(1, q.y), run.uz[s] = v.u(2, q.z);
        volume::finish_values(v, run);
        const int which[1] = {0};
        volume::Gradients g;
        volume::gradients(
            v, run, which, 1, [&](int axis, int) { return q[axis]; }, g);
        const Vec3 world = transpose(v.to_q) * Vec3{double(g.x[0]), double(g.y[0]), double(g.z[0])};
        worst = std::max(worst, length(world - exact(p)));
      }
      h[level] = 1.0 / double(n), error[level] = worst;
    }
    INFO("errors " << error[0] << " " << error[1] << " " << error[2]);
    CHECK(observed_order(h, error, 3) == Approx(2).epsilon(0.1));
  }
}

TEST_CASE("volume: gradients of parabolas are exact up to the border, by either kernels and at samples") {
  const auto bowl = [](Vec3 p) { return 3 * p.x * p.x - 2 * p.y * p.y + p.z * p.z + p.x * p.y; };
  for (const size_t samples : {size_t(3), size_t(12)}) {
    const volume::Volume v = volume::prepare(item(grid(cube(samples, -1, 1), bowl), grey(0, 1), {}), 1, {});
    const double cell = 2.0 / double(samples - 1), top = double(samples - 1);
    const auto slope = [&](Vec3 u) {  // in u
      const Vec3 p = u * cell - Vec3{1, 1, 1};
      return Vec3{6 * p.x + p.y, -4 * p.y + p.x, 2 * p.z} * cell;
    };
    volume::Run run;
    volume::Gradients by[2];
    for (uint64_t i = 0; i < 20; ++i) {
      float* const u[3] = {run.ux, run.uy, run.uz};
      for (uint64_t a = 0; a < 3; ++a)
        for (uint64_t s = 0; s < uint64_t(volume::run_length); ++s) u[a][s] = float(random_unit(a + 1, i * 100 + s) * top);
      v.kernels.sample(v.voxels, run.ux, run.uy, run.uz, run.value);
      volume::scalar_kernels(v.voxels).gradients(v.voxels, u, run.value, by[0]);
      volume::best_kernels(v.voxels).gradients(v.voxels, u, run.value, by[1]);
      for (int s = 0; s < volume::run_length; ++s) {
        const Vec3 exact = slope({run.ux[s], run.uy[s], run.uz[s]});
        CHECK(length(Vec3{by[0].x[s], by[0].y[s], by[0].z[s]} - exact) < 2e-5);
        CHECK(by[0].per_cell[s] == Approx(length(exact)).epsilon(1e-4));
        CHECK(std::tie(by[0].x[s], by[0].y[s], by[0].z[s], by[0].per_cell[s]) ==
              std::tie(by[1].x[s], by[1].y[s], by[1].z[s], by[1].per_cell[s]));
      }
    }
    for (size_t k = 0; k < samples; ++k)
      for (size_t i = 0; i < samples; ++i)
        CHECK(length(Vec3(volume::gradient_at_sample(v, i, samples - 1, k).q) - slope({double(i), top, double(k)})) < 2e-5);
  }
}

TEST_CASE("volume: a lit sphere is brightest where it faces the light, also with the gradient turned round") {
  for (const double sign : {1.0, -1.0}) {
    OpacityCurve curve;
    curve.points = sign > 0 ? std::vector<Vec2>{{0.5, 0}, {0.52, 0.999}} : std::vector<Vec2>{{-0.52, 0.999}, {-0.5, 0}};
    VolumeItem v = item(grid(cube(49, -1, 1), [&](Vec3 p) { return sign * (1.3 - length(p)); }), one_color({0.5f, 0.5f, 0.5f}), curve);
    v.shaded = true, v.unit_distance = 0.02;
    Scene scene = scene_of({v});
    scene.lights = {{{1, 0, 0.3}, false, 1}};
    const Frame f = draw(scene, parallel_view(21, 21, 10));
    const auto red = [&](int x) { return f.rgba[size_t(4 * (10 * 21 + x))]; };
    CHECK(red(16) > red(10));
    CHECK(red(10) > red(4) * 1.5f);
    // Lambert: normal (x, 0, z) at x = 0.5 of radius .8; ambient .12 + diffuse .88 n.l, and the specular term.
    CHECK(red(4) == Approx(0.5 * 0.12).epsilon(0.05));
  }
}

TEST_CASE("volume: in a homogeneous region shading leaves the colour alone") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  VolumeItem v = item(d, one_color({0.8f, 0.4f, 0.2f}), constant_opacity(2));
  const Frame plain = look(scene_of({v}));
  v.shaded = true;
  CHECK(largest_difference(plain, look(scene_of({v}))) < 1e-5f);
}

TEST_CASE("volume: the depth at which half of the light is gone is kept for picking, unless something opaque is there") {
  const DatasetPtr d = grid(cube(9, -1, 1), [](Vec3) { return 1.0; });
  Scene scene = scene_of({SurfaceItem{}, item(d, one_color({1, 1, 1}), constant_opacity(2), 0.01)});
  const Frame f = look(scene);
  CHECK(f.ids[0] == 2);
  CHECK(f.depth[0] == Approx(99 + std::log(2.0) / 2).epsilon(1e-4));
  std::get<VolumeItem>(scene.items[1]).opacity = constant_opacity(0.1);
  CHECK(look(scene).ids[0] == 0);
}

TEST_CASE("transfer: linear, log and symlog scales give the colour of the value") {
  OpacityCurve curve;
  curve.points = {{0, 0.5}};
  for (const ScaleKind kind : {ScaleKind::linear, ScaleKind::log, ScaleKind::symlog}) {
    ColorScale scale = grey(kind == ScaleKind::log ? 1e-4 : -1000, 1000);
    scale.kind = kind, scale.linear_threshold = 0.1;
    scale.below = Vec3f{1, 0, 0}, scale.above = Vec3f{0, 1, 0};
    const volume::Transfer t(scale, curve, 1, 1, -5000, 5000, 0);
    for (const double v : {1e-4, 0.02, 0.7, 1.0, 31.0, 999.0, -0.3, -40.0, -900.0}) {
      if (v < 0 && kind == ScaleKind::log) continue;
      const auto& m = t.medium(t.index(float(v)));
      CHECK(m.r == Approx(scale.position(v)).epsilon(2e-3));
      CHECK(m.density == Approx(std::log(2.0)));
    }
    CHECK(t.medium(t.index(2000)).g == 1);
    CHECK(t.medium(t.index(2000)).r == 0);
    if (kind != ScaleKind::log) CHECK(t.medium(t.index(-2000)).r == 1);
    CHECK(t.medium(t.index(NAN)).density == 0);
  }
}

TEST_CASE("transfer: clear() is true just for ranges that draw nothing, at jumps of the curve too") {
  OpacityCurve curve;
  curve.points = {{0, 0}, {10, 0}, {10, 1}, {20, 1}, {20, 0}};
  const volume::Transfer t(grey(0, 100), curve, 1, 1, 0, 100, 0);
  CHECK(t.clear(0, 9.9f));
  CHECK_FALSE(t.clear(0, 10.1f));
  CHECK_FALSE(t.clear(12, 13));
  CHECK(t.clear(20.1f, 100));
  CHECK_FALSE(t.clear(0, 100));
  CHECK(t.clear(HUGE_VALF, -HUGE_VALF));
  ColorScale hollow = grey(30, 40);
  hollow.clamp = false;  // values out of range are not drawn
  curve.points = {{0, 0.5}};
  const volume::Transfer h(hollow, curve, 1, 1, 0, 100, 0);
  CHECK(h.clear(0, 29.9f));
  CHECK(h.clear(40.1f, 90));
  CHECK_FALSE(h.clear(35, 36));
}

TEST_CASE("transfer: labels are drawn in their own colours, without values between them") {
  UniformGrid g;
  g.dims = {2, 2, 2}, g.origin = {-1, -1, -1}, g.spacing = {2, 2, 2};
  const DatasetPtr d = grid(
      g, [](Vec3 p) { return p.z > 0 ? 7.0 : 3.0; }, ElementType::u8);
  ColorScale scale;
  scale.map.kind = MapKind::categorical;
  scale.map.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  scale.labels = {3, 5, 7};
  const Frame f = look(scene_of({item(d, scale, constant_opacity(1))}));
  CHECK(f.rgba[2] == Approx(1 - std::exp(-1.0)).epsilon(1e-4));
  CHECK(f.rgba[1] == 0);
  CHECK(f.rgba[0] == Approx(std::exp(-1.0) * (1 - std::exp(-1.0))).epsilon(1e-4));
}
