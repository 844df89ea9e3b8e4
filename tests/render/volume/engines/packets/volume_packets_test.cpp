// SPDX-License-Identifier: Apache-2.0
// Packets of rays against one ray at a time, empty space and what is kept between frames.
#include "render/volume/volume_support.h"

#include "data/memory/memo.h"
#include "render/volume/engines/packets/packets.h"

using namespace sg;
using namespace sg::test;

namespace {

double waves(Vec3 p) { return 60 + 25 * std::sin(5 * p.x + 1) * std::cos(4 * p.y) + 20 * std::sin(6 * p.z + p.x); }

VolumeItem wave_item(ElementType type, bool shaded, size_t n = 37) {
  OpacityCurve curve;
  curve.points = {{60, 0}, {70, 0.4}, {75, 0}, {85, 0}, {95, 0.9}};
  VolumeItem v = item(grid(cube(n, -1, 1), waves, type), grey(0, 120), curve);
  v.unit_distance = 0.05, v.shaded = shaded;
  return v;
}
const Projection oblique = perspective_view(45, 37, 55, {1.5, 1.1, 3}, {0, 0, 0});

volume::Knobs one_by_one() {
  volume::Knobs k;
  k.simd = false;
  return k;
}

}  // namespace

TEST_CASE("volume packets: sixteen rays at once give the bytes of one at a time, lit or not, skipping or not") {
  for (const ElementType t : {ElementType::f32, ElementType::u8, ElementType::i8, ElementType::u16, ElementType::i16})
    for (const bool shaded : {false, true})
      for (const bool skip : {true, false}) {
        volume::Knobs packets, single = one_by_one();
        packets.skip_empty = single.skip_empty = skip;
        const Scene scene = scene_of({wave_item(t, shaded)});
        const Frame a = draw(scene, oblique, packets), b = draw(scene, oblique, single);
        INFO(std::string(element_name(t)) << " shaded " << shaded << " skip " << skip);
        CHECK(same_bytes(a, b));
        CHECK(*std::max_element(a.rgba.begin(), a.rgba.end()) > 0.2f);
      }
}

TEST_CASE("volume packets: a ray does not depend on its neighbours: tiles of any size give the same bytes") {
  for (const auto mode : {VolumeItem::Mode::composite, VolumeItem::Mode::maximum}) {
    VolumeItem v = wave_item(ElementType::f32, true);
    v.mode = mode;
    const volume::Volume prepared = volume::prepare(v, 1, {});
    REQUIRE(volume::in_packets(prepared));
    const volume::MarchingPlan steps{{prepared, oblique}, {{{normalize(Vec3{1, 1, 1}), 1}}, {}}};
    const volume::MaximumPlan maximum{{prepared, oblique}};
    const auto draw_tile = [&](int x0, int y0, int x1, int y1, Frame& frame) {
      if (mode == VolumeItem::Mode::maximum) volume::draw_tile(maximum, x0, y0, x1, y1, frame);
      else volume::draw_tile(steps, x0, y0, x1, y1, frame);
    };
    Frame whole(45, 37), parts(45, 37);
    draw_tile(0, 0, 45, 37, whole);
    for (int y = 0; y < 37; y += 3)
      for (int x = 0; x < 45; x += 7) draw_tile(x, y, std::min(x + 7, 45), std::min(y + 3, 37), parts);
    CHECK(same_bytes(whole, parts));
    CHECK(whole.rgba[4 * (18 * 45 + 22) + 3] > 0);
  }
}

TEST_CASE("volume packets: a linear field on an axis too long for exact 32-bit places gives the picture of two samples") {
  const auto slope = [](Vec3 p) { return 60 + 40 * p.x + 15 * p.y; };
  const auto box = [&](size_t n) {
    UniformGrid g;
    g.dims = {n, 2, 2}, g.origin = {-1, -1, -1}, g.spacing = {2 / double(n - 1), 2, 2};
    VolumeItem v = item(grid(g, slope), grey(0, 120), OpacityCurve{});
    v.opacity.points = {{20, 0.1}, {60, 0.6}, {100, 0.1}};
    return v;
  };
  const VolumeItem few = box(2), many = box((size_t(1) << 20) + 2);
  CHECK(volume::prepare(few, 1, {}).within_samples());
  CHECK_FALSE(volume::prepare(many, 1, {}).within_samples());
  const Projection view = parallel_view(8, 8, 3, {0.2, -1, 0.1}, {0, 0, 1});
  const Frame a = draw(scene_of({few}), view), b = draw(scene_of({many}), view);
  for (size_t i = 0; i < a.rgba.size(); ++i) CHECK(std::abs(a.rgba[i] - b.rgba[i]) < 2.0f / 512);
  CHECK(a.rgba[4 * (4 * 8 + 4) + 3] > 0.5f);
}

TEST_CASE("volume packets: the way of several volumes agrees with the packets'") {
  for (const auto mode : {VolumeItem::Mode::composite, VolumeItem::Mode::maximum})
    for (const bool shaded : {false, true}) {
      VolumeItem v = wave_item(ElementType::f32, shaded);
      v.mode = mode;
      // Whether a maximum is drawn at all jumps where its opacity vanishes: one way reads the curve, the other a table.
      if (mode == VolumeItem::Mode::maximum) v.opacity.points = {{0, 1}};
      const Scene scene = scene_of({v});
      volume::Knobs all;
      all.stop_below = 0;
      const Frame a = draw(scene, oblique, all), b = draw(scene, oblique, all, by_single_rays(oblique));
      CHECK(largest_difference(a, b) < 2e-3f);
    }
}

TEST_CASE("volume packets: maxima along more bricks than a ray looks at together are found") {
  UniformGrid g;
  g.dims = {3000, 3, 3}, g.origin = {-50, -1, -1}, g.spacing = {100.0 / 2999, 1, 1};
  const auto peaks = [](Vec3 p) { return 10 * random_unit(4, uint64_t(p.x * 30 + 2000)) + 80 * std::exp(-std::pow(p.x - 41, 2)) - p.y; };
  VolumeItem v = item(grid(g, peaks), grey(0, 100), {});
  v.mode = VolumeItem::Mode::maximum, v.opacity.points = {{0, 1}};
  for (const double turn : {0.0, 0.005, -0.01})
    for (const double sign : {1.0, -1.0}) {
      const Projection along = parallel_view(12, 12, 6, {sign, turn, 0.3 * turn});
      const Frame a = draw(scene_of({v}), along), b = draw(scene_of({v}), along, {}, by_single_rays(along));
      CHECK(largest_difference(a, b) < 2e-3f);
      CHECK(a.rgba[4 * (6 * 12 + 6)] > 0.5f);
    }
}

TEST_CASE("volume packets: clip planes cut as they cut single rays, in steps, within the tolerance and for maxima") {
  for (const auto& planes : {std::vector<ClipPlane>{{{1, 0, 0}, 0.3}}, std::vector<ClipPlane>{{{0.3, -0.5, 0.8}, 0.1}, {{-1, 0, 0}, 0.6}},
                             std::vector<ClipPlane>{{{0, 0, 1}, -2}}})
    for (const double step : {0.0, 0.01, -1.0}) {  // tolerance, steps that are lit one by one, maximum
      INFO(planes.size() << " planes, step " << step);
      VolumeItem v = wave_item(ElementType::f32, true);
      if (step < 0) v.mode = VolumeItem::Mode::maximum, v.opacity.points = {{0, 1}};
      else v.sampling.step = step;
      const Frame whole = draw(scene_of({v}), oblique);
      v.clip = planes;
      volume::Knobs all;
      all.stop_below = 0;
      const Frame cut = draw(scene_of({v}), oblique, all);
      CHECK(largest_difference(cut, draw(scene_of({v}), oblique, all, by_single_rays(oblique))) <
            (step > 0 ? 1e-2f : 2.0f / 512));  // a step may see another side of its surface by rounding
      CHECK(same_bytes(cut, draw(scene_of({v}), oblique, [&] {
                         volume::Knobs one = one_by_one();
                         one.stop_below = 0;
                         return one;
                       }())));
      CHECK(largest_difference(cut, whole) > 0.1f);
    }
}

TEST_CASE("volume packets: maxima along axes through the samples are those samples") {
  UniformGrid g;
  g.dims = {19, 21, 18}, g.origin = {0, 0, 0}, g.spacing = {1, 1, 1};
  for (const ElementType type : {ElementType::i16, ElementType::f32}) {
    const DatasetPtr d = grid(
        g, [](Vec3 p) { return double(random_bits(4, uint64_t(p.x + 19 * (p.y + 21 * p.z))) % 4001); }, type);
    VolumeItem v = item(d, grey(0, 4000), {});
    v.mode = VolumeItem::Mode::maximum, v.opacity.points = {{0, 1}};
    // A pixel per sample, looking along -z: the colour is the value.
    Projection p = parallel_view(19, 21, 1, {0, 0, -1}, {0, 1, 0}, {9, 10, 0});
    const Frame f = draw(scene_of({v}), p);
    const volume::Volume prepared = volume::prepare(v, 1, {});
    const volume::Transfer& transfer = prepared.transfer[0];
    for (int y = 0; y < 21; ++y)
      for (int x = 0; x < 19; ++x) {
        float want = 0;
        for (int z = 0; z < 18; ++z) want = std::max(want, float(d->fields()[0].array.get(size_t(x + 19 * ((20 - y) + 21 * z)))));
        REQUIRE(f.rgba[size_t(4 * (19 * y + x))] == transfer.medium(transfer.index(want)).r);
      }
  }
}

TEST_CASE("volume packets: maxima agree with the search one ray at a time") {
  for (const Association where : {Association::point, Association::cell}) {
    const DatasetPtr points = grid(
        cube(23, -1, 1), [](Vec3 p) { return double(random_bits(7, uint64_t(1e6 * (p.x + 11 * p.y + 101 * p.z + 200))) % 200); },
        ElementType::u8);
    FieldSet cells;
    cells.add({"f", Association::cell, points->fields()[0].array.slice(0, 22 * 22 * 22), "", Role::none});
    VolumeItem v = item(where == Association::point ? points : make_dataset(cube(23, -1, 1), cells), grey(0, 200), {});
    v.mode = VolumeItem::Mode::maximum, v.association = where, v.opacity.points = {{0, 1}};
    const volume::Volume prepared = volume::prepare(v, 1, {});
    const Frame f = draw(scene_of({v}), oblique);
    CHECK(same_bytes(f, draw(scene_of({v}), oblique, one_by_one())));
    const auto& transfer = prepared.transfer[0];
    int hits = 0;
    for (int y = 0; y < oblique.height; ++y)
      for (int x = 0; x < oblique.width; ++x) {
        const auto ray = oblique.ray(x + 0.5, y + 0.5);
        const volume::Found m = largest_along(prepared, ray.origin, ray.direction);
        const float got = f.rgba[size_t(4 * (oblique.width * y + x))];
        hits += m.found;
        INFO(int(where) << " " << x << " " << y << " want " << m.value << " at " << m.t << " got " << got * 200);
        if (m.found) REQUIRE(std::abs(got - transfer.medium(transfer.index(float(m.value))).r) < 2e-3f);
        else REQUIRE(got == 0);
      }
    CHECK(hits > 100);
  }
}

TEST_CASE("empty space: ranges enclose their cells, distances say what is empty") {
  const std::array<size_t, 3> dims{71, 9, 22};
  std::vector<float> values(dims[0] * dims[1] * dims[2]);
  for (size_t i = 0; i < values.size(); ++i) values[i] = random_bits(3, i) % 400 == 0 ? 1.0f : float(random_unit(5, i)) * 0.2f;
  values[5] = NAN;
  const Array a = Array::from_vector(values);
  const volume::FineBricks fine = volume::fine_bricks(a, dims);
  const MinMaxBricks coarse = volume::coarse_bricks(fine), want = minmax_bricks(a, dims);
  REQUIRE(coarse.dims == want.dims);
  for (size_t i = 0; i < want.size(); ++i) {
    REQUIRE(coarse.ranges[i].lo == want.ranges[i].lo);
    REQUIRE(coarse.ranges[i].hi == want.ranges[i].hi);
  }
  OpacityCurve curve;
  curve.points = {{0.5, 0}, {0.6, 1}};
  const volume::Transfer transfer(grey(0, 1), curve, 1, 1, 0, 1, 0);
  bool any_empty = false;
  const volume::Distances distance = volume::distance_to_drawn(fine, transfer, any_empty);
  CHECK(any_empty);
  std::vector<uint8_t> empty(fine.size());
  for (size_t i = 0; i < fine.size(); ++i) empty[i] = !(fine.ranges[i].hi >= 0.5f);
  const std::vector<uint8_t> exact = empty_distance(empty, fine.dims);
  size_t zeros = 0;
  for (size_t i = 0; i < fine.size(); ++i) {
    REQUIRE(distance[i] == std::min<uint8_t>(exact[i], 15));
    zeros += distance[i] == 0;
  }
  CHECK(zeros > 3);
  CHECK(zeros < fine.size());
  const volume::Distances none = volume::distance_to_drawn(fine, volume::Transfer(grey(0, 1), {{{0, 0}}}, 1, 1, 0, 1, 0), any_empty);
  CHECK(none[0] == 15);
}

TEST_CASE("volume: samples are taken once for all frames of a field") {
  const VolumeItem v = wave_item(ElementType::f64, false);
  const volume::Volume first = volume::prepare(v, 1, {});
  VolumeItem other = v;
  other.opacity.points = {{0, 0.5}};
  CHECK(volume::prepare(other, 1, {}).samples == first.samples);
  CHECK(v.data->memo().bytes() > first.voxels.array.bytes());
  other.color.kind = ScaleKind::log, other.color.lo = 1;  // wide numbers are not kept relative to their middle then
  CHECK(volume::prepare(other, 1, {}).samples != first.samples);
}
