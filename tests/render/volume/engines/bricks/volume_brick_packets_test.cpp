// SPDX-License-Identifier: Apache-2.0
// Packets of rays through bricks: against the same volume in memory, and against single rays.
#include "render/volume/sources/bricks/bricked_support.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double bumpy(double x, double y, double z) { return std::sin(0.31 * x) * std::cos(0.23 * y) + 0.02 * z + 0.5 * std::sin(0.17 * (x + z)); }

VolumeItem look_of(DatasetPtr data, bool shaded) {
  VolumeItem v = item(std::move(data), grey(-2, 3), {});
  v.opacity.points = {{-1.5, 0.5}, {-0.9, 0}, {0.2, 0}, {0.5, 0.3}, {0.8, 0}, {2, 0.1}};
  v.unit_distance = 6, v.shaded = shaded;
  return v;
}

DatasetPtr in_memory(const MadeVolume& m) {
  const auto& l = m.volume->levels[0];
  UniformGrid g;
  g.dims = l.dims, g.origin = l.origin, g.spacing = l.spacing, g.direction = m.volume->direction;
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(m.values->front()), "", Role::scalars});
  return make_dataset(g, fields);
}

Vec3 middle_of(const MadeVolume& m) {
  const auto& l = m.volume->levels[0];
  return l.origin +
         m.volume->direction * (l.spacing * Vec3(0.5 * double(l.dims[0] - 1), 0.5 * double(l.dims[1] - 1), 0.5 * double(l.dims[2] - 1)));
}

/// From outside near a corner, so that voxels of level 0 are larger than pixels everywhere.
Projection near_view(const MadeVolume& m, int pixels, double scale) {
  return perspective_view(pixels, pixels, scale, middle_of(m) + Vec3{110, 70, 130}, middle_of(m));
}

volume::Knobs single_rays() {
  volume::Knobs k;
  k.bricks_in_packets = false;
  return k;
}

size_t levels_drawn(const MadeVolume& m, const Projection& p) {
  size_t n = 0;
  for (const size_t b : volume::bricked_use(*source_of(m, p)).bricks) n += b > 0;
  return n;
}

}  // namespace

TEST_CASE("brick packets: the picture is that of the volume in memory, shaded or not, of a turned grid too") {
  Mat3 turned;
  turned.m[0][0] = turned.m[1][1] = 0.8, turned.m[0][1] = -0.6, turned.m[1][0] = 0.6;
  for (const bool shaded : {false, true}) {
    const MadeVolume m = make_volume({150, 101, 77}, 3, bumpy, shaded ? turned : Mat3{}, {-3, 2, 7}, {0.9, 1, 1.1});
    const Projection p = near_view(m, 96, 400);
    CHECK(levels_drawn(m, p) == 1);
    const Frame whole = draw(scene_of({look_of(in_memory(m), shaded)}), p), bricks = draw(scene_of({look_of(m.dataset, shaded)}), p);
    CHECK(largest_difference(whole, bricks) < 1.0f / 255);
    float most = 0;
    for (size_t i = 3; i < whole.rgba.size(); i += 4) most = std::max(most, whole.rgba[i]);
    CHECK(most > 0.9f);
    // What can be picked lies at the same depth, but where half of the light is gone near an empty stretch. How far apart they may lie in
    // thin parts is the tolerance over what is taken there, so it is made small.
    VolumeItem near = look_of(in_memory(m), shaded), near_bricks = look_of(m.dataset, shaded);
    near.sampling.tolerance = near_bricks.sampling.tolerance = 1.0 / 8192;
    const Frame exact = draw(scene_of({near}), p), exact_bricks = draw(scene_of({near_bricks}), p);
    size_t picked = 0, off = 0;
    for (size_t i = 0; i < exact.depth.size(); ++i) {
      if (!(exact.depth[i] < HUGE_VALF) || !(exact_bricks.depth[i] < HUGE_VALF)) continue;
      CHECK(exact_bricks.ids[i] == 1);
      off += std::abs(exact.depth[i] - exact_bricks.depth[i]) > 0.1f;
      ++picked;
    }
    CHECK(picked > 500);
    CHECK(off <= picked / 500);
  }
}

TEST_CASE("brick packets: fixed steps lie where they lie in memory") {
  const MadeVolume m = make_volume({150, 101, 77}, 3, bumpy);
  const Projection p = near_view(m, 64, 260);
  VolumeItem whole = look_of(in_memory(m), false), bricks = look_of(m.dataset, false);
  whole.sampling.step = bricks.sampling.step = 0.7;
  CHECK(largest_difference(draw(scene_of({whole}), p), draw(scene_of({bricks}), p)) < 1.0f / 255);
  whole.shaded = bricks.shaded = true;
  CHECK(largest_difference(draw(scene_of({whole}), p), draw(scene_of({bricks}), p)) < 4.0f / 255);
}

TEST_CASE("brick packets: the same as single rays where levels meet, of numbers of any type") {
  const MadeVolume m = make_volume({400, 300, 260}, 4, [](double x, double y, double z) { return bumpy(0.2 * x, 0.2 * y, 0.2 * z); });
  const Projection p = perspective_view(96, 96, 110, {-40, 160, 140}, {400, 150, 130});
  CHECK(levels_drawn(m, p) >= 2);
  VolumeItem v = look_of(m.dataset, true);
  v.unit_distance = 30;
  const Frame packets = draw(scene_of({v}), p), single = draw(scene_of({v}), p, single_rays());
  CHECK(largest_difference(packets, single) < 2.0f / 255);
}

TEST_CASE("brick packets: a brick that begins right before the eye is drawn, wherever its corners lie in the picture") {
  const MadeVolume m = make_volume({150, 101, 77}, 3, bumpy);
  for (const double face : {64.0, 32.0}) {
    Projection p = perspective_view(64, 64, 60, {70, 50, face + 1e-8}, {70, 50, 0});
    p.near_plane = 1e-9;  // the corners of the bricks below lie 1e11 pixels away
    const VolumeItem v = look_of(m.dataset, false);
    const Frame packets = draw(scene_of({v}), p), single = draw(scene_of({v}), p, single_rays());
    CHECK(*std::max_element(single.rgba.begin(), single.rgba.end()) > 0.2f);
    CHECK(largest_difference(packets, single) < 2.0f / 255);
  }
}

TEST_CASE("brick packets: a ray in a face between bricks meets its samples once") {
  // Homogeneous: how much passes is known.
  const MadeVolume m = make_volume({129, 129, 129}, 2, [](double, double, double) { return 1.0; });
  VolumeItem v = item(m.dataset, one_color({1, 1, 1}), constant_opacity(0.01));
  for (const Vec3 forward : {Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
    const Vec3 up = forward.y != 0 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
    // 3 x 3 pixels of 1/8: the one in the middle lies in the faces at 64.
    const Frame f = draw(scene_of({v}), parallel_view(3, 3, 8, forward, up, {64, 64, 64}));
    for (size_t i = 0; i < 9; ++i) CHECK(1 - f.rgba[4 * i + 3] == doctest::Approx(std::exp(-1.28)).epsilon(2e-3));
  }
}

TEST_CASE("brick packets: what is opaque in the frame ends rays, also inside a brick") {
  const MadeVolume m = make_volume({129, 100, 90}, 2, [](double, double, double) { return 1.0; });
  VolumeItem v = item(m.dataset, one_color({1, 0, 0}), constant_opacity(0.02));
  const Projection p = parallel_view(4, 4, 1, {0, 0, -1}, {0, 1, 0}, {60, 50, 45});
  Frame frame(4, 4);
  for (size_t i = 0; i < 16; ++i) {
    frame.depth[i] = 100 + 45 - 89 + 30.0f;  // 30 behind where rays enter
    frame.rgba[4 * i + 2] = frame.rgba[4 * i + 3] = 1;
  }
  Context context;
  volume::composite_volumes(scene_of({v}), p, {}, frame, context, {});
  CHECK(frame.rgba[0] == doctest::Approx(1 - std::exp(-0.6)).epsilon(3e-3));
  CHECK(frame.rgba[2] == doctest::Approx(std::exp(-0.6)).epsilon(3e-3));
  CHECK(frame.rgba[3] == doctest::Approx(1));
}

TEST_CASE("brick packets: what is translucent lies before, in and behind the bricks as among single rays") {
  const MadeVolume m = make_volume({129, 100, 90}, 2, [](double, double, double) { return 1.0; });
  const VolumeItem v = item(m.dataset, one_color({1, 0, 0}), constant_opacity(0.02));
  const Projection p = parallel_view(6, 1, 1, {0, 0, -1}, {0, 1, 0}, {60, 50, 45});
  // Before, in the middle, at the far face, behind, two of them, none.
  FragmentLists lists;
  lists.start = {0, 1, 2, 3, 4, 6, 6};
  const float face = 145, depth[6] = {50, 100, face, 150, 60, 160};
  for (const float d : depth) lists.fragments.push_back({d, {0, 0.5f, 0, 0.5f}, 2});
  const Frame packets = draw(scene_of({v}), p, {}, lists), single = draw(scene_of({v}), p, single_rays(), lists);
  CHECK(largest_difference(packets, single) < 1.0f / 255);
  CHECK(packets.rgba[4 * 0 + 1] == doctest::Approx(0.5));
  CHECK(packets.rgba[4 * 2 + 1] == doctest::Approx(0.5 * std::exp(-1.78)).epsilon(5e-3));
  CHECK(packets.rgba[4 * 3 + 1] == doctest::Approx(0.5 * std::exp(-1.78)).epsilon(5e-3));
}

TEST_CASE("brick packets: the same bytes for any number of threads, with bricks in memory or not, and in any tiles") {
  const auto make = [] { return make_volume({300, 200, 180}, 3, bumpy); };
  const MadeVolume m = make();
  const Projection p = perspective_view(150, 130, 150, {-60, 130, 300}, {150, 100, 90});
  const auto shot = [&](const MadeVolume& v, int threads, size_t memory, const volume::Knobs& knobs) {
    set_thread_count(threads);
    Frame frame(p.width, p.height);
    Context context;
    context.memory_limit = memory;
    volume::composite_volumes(scene_of({look_of(v.dataset, true)}), p, {}, frame, context, knobs);
    set_thread_count(0);
    return frame;
  };
  const Frame one = shot(m, 1, size_t(1) << 30, {});
  CHECK(same_bytes(one, shot(m, 8, size_t(1) << 30, {})));
  const MadeVolume again = make();
  CHECK(same_bytes(one, shot(again, 8, size_t(32) << 20, {})));  // bricks are read again and again
  const std::vector<uint8_t> all(size_t(10) * 9, 1);
  volume::Knobs tiles;
  tiles.wanted = &all;
  CHECK(same_bytes(one, shot(m, 2, size_t(1) << 30, tiles)));
}

TEST_CASE("brick packets: bricks behind what is opaque, and those in which nothing can be seen, are not read") {
  const MadeVolume m = make_volume({129, 129, 513}, 2, [](double, double, double z) { return z > 450 ? 1.0 : z < 300 ? 0.5 : 0.0; });
  VolumeItem v = item(m.dataset, grey(0, 1), {});
  v.opacity.points = {{0, 0}, {0.25, 0}, {0.5, 0.9}, {1, 0.9}};
  const Frame f = draw(scene_of({v}), parallel_view(40, 40, 0.4, {0, 0, -1}, {0, 1, 0}, {64, 64, 256}));
  CHECK(f.rgba[4 * 820 + 3] > 0.99f);
  const size_t bricks = *m.reads;
  CHECK(bricks >= 1);
  CHECK(bricks <= 2 * 2 * 2 * 2);  // of the front only: levels 0 or 1, mixed ones twice
}

TEST_CASE("brick packets: holes are clear, single layers are slabs") {
  const MadeVolume holes =
      make_volume({80, 80, 80}, 1, [](double x, double y, double z) { return std::abs(x - 40) + std::abs(y - 40) < 9 ? double(NAN) : z; });
  VolumeItem v = item(holes.dataset, grey(0, 80), constant_opacity(0.05));
  const Projection p = parallel_view(32, 32, 0.5, {0, 0, -1}, {0, 1, 0}, {40, 40, 40});
  const Frame a = draw(scene_of({v}), p);
  CHECK(largest_difference(a, draw(scene_of({v}), p, single_rays())) < 1.0f / 255);
  CHECK(a.rgba[4 * (16 * 32 + 16) + 3] == 0);
  const MadeVolume thin = make_volume({130, 70, 1}, 1, [](double x, double, double) { return x; });
  v = item(thin.dataset, grey(0, 130), constant_opacity(0.5));
  const Projection above = parallel_view(32, 16, 0.25, {0, 0, -1}, {0, 1, 0}, {65, 35, 0});
  const Frame b = draw(scene_of({v}), above);
  CHECK(b.rgba[4 * (8 * 32 + 16) + 3] == doctest::Approx(1 - std::exp(-0.5)).epsilon(1e-3));
  CHECK(largest_difference(b, draw(scene_of({v}), above, single_rays())) < 1.0f / 255);
}

TEST_CASE("brick packets: a first picture comes from the level in memory and fills the box of the volume") {
  const MadeVolume m = make_volume({129, 129, 129}, 4, [](double, double, double) { return 1.0; });
  VolumeItem v = item(m.dataset, one_color({1, 1, 1}), constant_opacity(0.01));
  volume::Knobs first;
  first.coarser = 0;
  // Rays through the middle, and just inside the edge of the box.
  const Frame f = draw(scene_of({v}), parallel_view(33, 33, 33 / 128.1, {0, 0, -1}, {0, 1, 0}, {64, 64, 64}), first);
  CHECK(*m.reads == 0);
  CHECK(1 - f.rgba[4 * (16 * 33 + 16) + 3] == doctest::Approx(std::exp(-1.28)).epsilon(3e-3));
  CHECK(1 - f.rgba[3] == doctest::Approx(std::exp(-1.28)).epsilon(3e-3));
}

TEST_CASE("brick packets: what cannot be read, and work that is to stop, end with their error") {
  const MadeVolume m = make_volume({200, 100, 100}, 2, bumpy);
  auto broken = std::make_shared<BrickedVolume>(*m.volume);
  broken->read = [](size_t, std::array<size_t, 3>, std::array<size_t, 3>, std::byte*) { fail_data("is damaged", "chunk 3"); };
  const DatasetPtr data = make_dataset(m.dataset->parts(), broken);
  const Projection p = near_view(m, 64, 200);
  CHECK(error_of([&] { draw(scene_of({look_of(data, true)}), p); }).find("chunk 3") != std::string::npos);

  Context context;
  auto stops = std::make_shared<BrickedVolume>(*m.volume);
  stops->read = [&](size_t level, std::array<size_t, 3> lo, std::array<size_t, 3> n, std::byte* out) {
    context.cancel();
    m.volume->read(level, lo, n, out);
  };
  const DatasetPtr other = make_dataset(m.dataset->parts(), stops);
  Frame frame(p.width, p.height);
  CHECK_THROWS_AS(volume::composite_volumes(scene_of({look_of(other, true)}), p, {}, frame, context, {}), Error);
  CHECK(*m.reads <= 8);  // one brick for each thread, and what it mixes in
}
