// SPDX-License-Identifier: Apache-2.0
#include "base/parallel.h"
#include "bricked_support.h"
#include "render/volume/sources/bricks/brick_tree.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double bumpy(double x, double y, double z) { return std::sin(0.31 * x) * std::cos(0.23 * y) + 0.02 * z + 0.5 * std::sin(0.17 * (x + z)); }

/// Looks at the middle of the box from `distance` box diagonals away.
Projection look(const Box3& box, double distance, int pixels, bool parallel = false, Vec3 towards = {0.5, 0.4, 1}) {
  Camera c;
  c.target = box.center(), c.position = box.center() + normalize(towards) * (distance * box.diagonal());
  c.parallel = parallel, c.parallel_height = box.diagonal();
  c.near_plane = 1e-3 * box.diagonal(), c.far_plane = 100 * box.diagonal();
  return make_projection(c, pixels, pixels);
}

Box3 box_of(const MadeVolume& m) {
  Box3 b;
  const auto& l = m.volume->levels[0];
  for (int c = 0; c < 8; ++c)
    b.add(l.origin + m.volume->direction * (l.spacing * Vec3(c & 1 ? double(l.dims[0] - 1) : 0, c & 2 ? double(l.dims[1] - 1) : 0,
                                                             c & 4 ? double(l.dims[2] - 1) : 0)));
  return b;
}

}  // namespace

TEST_CASE("bricked: with fine pixels the field is that of the whole grid, without gaps") {
  const MadeVolume m = make_volume({150, 101, 77}, 3, bumpy, {}, {-3, 2, 7}, {0.5, 0.75, 1.25});
  const auto source = source_of(m, look(box_of(m), 1, 20000));
  CHECK(volume::bricked_use(*source).bricks[0] == 3 * 2 * 2);
  CHECK(volume::bricked_use(*source).bricks[1] == 0);
  const auto ray = source->walker();
  for (const Vec3 aim :
       {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{0.3, 0.5, -0.7}, Vec3{-0.8, 0.1, 0.2}, Vec3{0.577, 0.577, 0.577}}) {
    const Vec3 d = normalize(aim), origin = box_of(m).center() + Vec3{1.3, -2.1, 0.7} - d * 300.0;
    const auto all = stretches(*ray, origin, d);
    REQUIRE(all.size() > 20);
    double worst = 0;
    for (size_t i = 0; i < all.size(); ++i) {
      if (i > 0) CHECK(all[i].from == all[i - 1].to);
      for (const double f : {0.0, 0.25, 0.7, 1.0}) {
        const double t = all[i].from + f * (all[i].to - all[i].from);
        const Vec3 moved = origin + d * t - m.volume->levels[0].origin, size = m.volume->levels[0].spacing;
        const Vec3 u{moved.x / size.x, moved.y / size.y, moved.z / size.z};
        worst = std::max(worst, std::abs(double(all[i].value(t)) - m.at(0, u)));
      }
    }
    CHECK(worst < 3e-6);
  }
}

TEST_CASE("bricked: a far camera takes the coarsest level, and it is the mean field") {
  const MadeVolume m = make_volume({200, 150, 130}, 3, bumpy);
  const auto source = source_of(m, look(box_of(m), 20, 64));
  const volume::BrickedUse use = volume::bricked_use(*source);
  CHECK(use.bricks[0] + use.bricks[1] == 0);
  CHECK(use.bricks[2] == 1);
  CHECK(use.voxel_pixels == 1);
  const auto ray = source->walker();
  const Vec3 origin{-50, 60, 70}, d = normalize(Vec3{1, 0.1, -0.2});
  double worst = 0;
  for (const auto& s : stretches(*ray, origin, d))
    for (const double t : {s.from, 0.5 * (s.from + s.to), s.to})
      worst = std::max(worst, std::abs(double(s.value(t)) - m.at(2, origin + d * t)));
  CHECK(worst < 3e-6);
}

TEST_CASE("bricked: the field is continuous where levels meet") {
  // Noise: every level differs from the next by much.
  const MadeVolume m =
      make_volume({400, 300, 260}, 4, [](double x, double y, double z) { return std::sin(12.9898 * x + 78.233 * y + 37.719 * z); });
  const Box3 box = box_of(m);
  Camera c;
  c.position = {-20, 150, 130}, c.target = {400, 150, 130}, c.near_plane = 1, c.far_plane = 1000, c.view_angle = 60;
  const Projection p = make_projection(c, 64, 64);
  const auto source = source_of(m, p);
  const volume::BrickedUse use = volume::bricked_use(*source);
  int levels = 0;
  for (const size_t n : use.bricks) levels += n > 0;
  CHECK(levels >= 3);
  const auto ray = source->walker();
  double jump = 0, across = 0, within = 0;
  size_t changes = 0;
  for (int y = 2; y < 64; y += 7)
    for (int x = 1; x < 64; x += 5) {
      const auto r = p.ray(x + 0.5, y + 0.5);
      const auto all = stretches(*ray, r.origin, r.direction);
      for (size_t i = 1; i < all.size(); ++i) {
        REQUIRE(all[i].from == all[i - 1].to);
        const double gap = std::abs(double(all[i].b[0]) - double(all[i - 1].b[3]));
        jump = std::max(jump, gap);
        if (all[i].cell != all[i - 1].cell) across = std::max(across, gap), ++changes;
        within = std::max(within, std::abs(double(all[i].b[3]) - double(all[i].b[0])));
      }
    }
  CHECK(changes > 100);
  CHECK(within > 0.05);  // the field itself varies
  CHECK(across < 1e-4);
  CHECK(jump < 1e-4);
  CHECK(box.diagonal() > 0);
}

TEST_CASE("bricked: the field is continuous across the faces between levels, also beside the ray") {
  const MadeVolume m =
      make_volume({400, 300, 260}, 4, [](double x, double y, double z) { return std::sin(12.9898 * x + 78.233 * y + 37.719 * z); });
  Camera c;
  c.position = {-20, 150, 130}, c.target = {400, 150, 130}, c.near_plane = 1, c.far_plane = 1000, c.view_angle = 60;
  const auto source = source_of(m, make_projection(c, 64, 64));
  const auto ray = source->walker();
  // Rays along x on both sides of planes that separate bricks of all levels.
  for (const double plane : {64.0, 128.0, 192.0})
    for (const double z : {20.3, 77.7, 140.2}) {
      const auto below = stretches(*ray, {-10, plane - 1e-5, z}, {1, 0, 0}), above = stretches(*ray, {-10, plane + 1e-5, z}, {1, 0, 0});
      auto value = [](const std::vector<volume::Stretch>& s, double t) {
        for (const auto& i : s)
          if (i.from <= t && t <= i.to) return double(i.value(t));
        return std::nan("");
      };
      for (double t = 10.5; t < 409; t += 1.7) {
        CAPTURE(plane);
        CAPTURE(t);
        const double low = value(below, t), high = value(above, t);
        CHECK(std::isnan(low) == std::isnan(high));  // beside the picture
        if (std::isnan(low)) continue;
        CHECK(low == doctest::Approx(high).scale(1).epsilon(2e-3));
      }
    }
}

TEST_CASE("bricked: bricks in which nothing can be seen are never read") {
  // A ball in one corner; all else is 0.
  const MadeVolume m = make_volume({257, 257, 257}, 3, [](double x, double y, double z) {
    return std::max(0.0, 1 - length(Vec3{x - 30, y - 30, z - 30}) / 20);
  });
  const Projection p = look(box_of(m), 1, 20000);
  const auto source = source_of(m, p);
  source->invisible = {[](const void*, float lo, float hi) { return lo >= 0 && hi <= 0; }, nullptr};
  const volume::BrickedUse use = volume::bricked_use(*source);
  CHECK(use.bricks[0] == 1);
  const auto ray = source->walker();
  size_t seen = 0;
  for (int k = 0; k < 400; ++k) {
    const Vec3 aim{double(k % 20) * 13, double(k / 20) * 13, 0};
    for (const auto& s : stretches(*ray, aim - Vec3{0, 0, 50}, {0, 0, 1})) seen += s.highest() > 0;
  }
  CHECK(seen > 50);
  CHECK(*m.expected == 64 * 64 * 64);
  CHECK(*m.reads == 1);
  // Little empty cubes inside the brick are passed over too.
  for (const auto& s : stretches(*ray, {60.5, 60.5, -10}, {0, 0, 1})) CHECK(s.highest() > 0);
}

TEST_CASE("bricked: rays are the same for any number of threads, with a cold or warm cache, and when bricks do not fit") {
  auto make = [] { return make_volume({300, 200, 180}, 3, bumpy); };
  const MadeVolume m = make();
  const Projection p = look(box_of(m), 0.8, 300);
  auto draw = [&](const MadeVolume& v, size_t memory, int threads) {
    set_thread_count(threads);
    const auto source = source_of(v, p, memory);
    std::vector<float> picture(size_t(100) * 100);
    parallel_for(picture.size(), 64, [&](size_t begin, size_t end) {
      const auto ray = source->walker();
      for (size_t i = begin; i < end; ++i) {
        const auto r = p.ray(double(i % 100) * 3 + 0.5, double(i / 100) * 3 + 0.5);
        float sum = 0;
        for (const auto& s : stretches(*ray, r.origin, r.direction)) sum += (s.b[0] + s.b[1] + s.b[2] + s.b[3]) * float(s.to - s.from);
        picture[i] = sum;
      }
    });
    set_thread_count(0);
    return picture;
  };
  const auto one = draw(m, size_t(1) << 28, 1);
  const size_t cold = *m.reads;
  CHECK(draw(m, size_t(1) << 28, 8) == one);
  CHECK(*m.reads == cold);  // the bricks stayed with the dataset
  const MadeVolume again = make();
  CHECK(draw(again, size_t(1) << 28, 8) == one);
  CHECK(*again.reads == cold);  // each brick was read once
  // Less memory than the bricks need (but levels that are allowed): read again, the same picture.
  const MadeVolume small = make();
  const size_t need = volume::bricked_use(*source_of(m, p)).bytes;
  CHECK(draw(small, need / 2, 4) == one);
  CHECK(*small.reads > cold);
}

TEST_CASE("bricked: less memory takes coarser bricks, down to the coarsest") {
  const MadeVolume m = make_volume({300, 200, 180}, 3, bumpy);
  const Projection p = look(box_of(m), 1, 5000);
  const auto all = volume::bricked_use(*source_of(m, p));
  const auto less = volume::bricked_use(*source_of(m, p, size_t(all.bytes / 16)));
  CHECK(less.bytes < all.bytes / 2);
  CHECK(less.voxel_pixels > 1);
  const auto least = volume::bricked_use(*source_of(m, p, 1000));
  CHECK(least.bricks[0] + least.bricks[1] == 0);
}

TEST_CASE("bricked: a first picture takes coarser bricks than the final one") {
  const MadeVolume m = make_volume({300, 200, 180}, 3, bumpy);
  const Projection p = look(box_of(m), 1, 250);
  const auto first = volume::bricked_use(*source_of(m, p, size_t(1) << 28, 8)), final = volume::bricked_use(*source_of(m, p));
  CHECK(first.bricks[0] == 0);
  CHECK(final.bricks[0] > 0);
  CHECK(first.bytes * 20 < final.bytes);
}

TEST_CASE("bricked: gradients of a linear field are exact, on a turned grid too, for all levels") {
  const double s = std::sqrt(0.5);
  Mat3 turned;
  turned.m[0][0] = s, turned.m[0][1] = -s, turned.m[1][0] = s, turned.m[1][1] = s;
  const Vec3 spacing{0.5, 0.25, 2};
  const MadeVolume m = make_volume(
      {160, 140, 70}, 2, [](double x, double y, double z) { return 3 * x - 2 * y + 0.5 * z; }, turned, {10, 20, 30}, spacing);
  // In the world: turned * (slope per length along the grid's axes).
  const Vec3 expected = turned * Vec3{3 / 0.5, -2 / 0.25, 0.5 / 2};
  for (const double distance : {0.6, 30.0}) {
    const auto source = source_of(m, look(box_of(m), distance, 400));
    const auto ray = source->walker();
    const Vec3 middle = box_of(m).center(), d = normalize(Vec3{0.2, 0.9, 0.4});
    size_t checked = 0;
    for (const auto& i : stretches(*ray, middle - d * 200.0, d)) {
      const double t = 0.5 * (i.from + i.to);
      const Vec3f g = ray->gradient(i, t);
      CHECK(length(Vec3(g) - expected) < 2e-3 * length(expected));
      ++checked;
    }
    CHECK(checked > 20);
  }
}

TEST_CASE("bricked: gradients are central differences of the trilinear field, inside bricks and at their borders") {
  const MadeVolume m = make_volume({140, 70, 70}, 1, bumpy);
  const auto source = source_of(m, look(box_of(m), 1, 4000, true));
  const auto ray = source->walker();
  const Vec3 origin{-1, 20.3, 31.1}, d = normalize(Vec3{1, 0.11, 0.07});
  double worst = 0, most = 0;
  for (const auto& s : stretches(*ray, origin, d)) {
    const double t = 0.4 * s.from + 0.6 * s.to;
    const Vec3 u = origin + d * t, g = Vec3(ray->gradient(s, t));
    if (u.x < 1 || u.x > 138) continue;
    for (int a = 0; a < 3; ++a) {
      Vec3 h{0, 0, 0};
      h[a] = 1;
      worst = std::max(worst, std::abs(g[a] - 0.5 * (m.at(0, u + h) - m.at(0, u - h)))), most = std::max(most, std::abs(g[a]));
    }
  }
  CHECK(worst < 5e-6);
  CHECK(most > 0.1);
}

TEST_CASE("bricked: gradients of parabolas are exact up to the border") {
  const auto bowl = [](double x, double y, double z) { return 3e-3 * x * x - 2e-2 * y * y + 0.01 * z * z + 1e-3 * x * y; };
  const MadeVolume m = make_volume({140, 20, 9}, 1, bowl);
  const auto source = source_of(m, look(box_of(m), 1, 4000, true));
  const auto ray = source->walker();
  int outermost = 0;
  for (const Vec3 origin : {Vec3{-1, 0.3, 0.2}, Vec3{-1, 18.7, 7.9}, Vec3{-1, 7, 4}})
    for (const auto& s : stretches(*ray, origin, normalize(Vec3{1, 1e-3, 1e-3}))) {
      const double t = 0.4 * s.from + 0.6 * s.to;
      const Vec3 u = origin + normalize(Vec3{1, 1e-3, 1e-3}) * t, g = Vec3(ray->gradient(s, t));
      if (u.x < 0 || u.x > 139) continue;
      CHECK(length(g - Vec3{6e-3 * u.x + 1e-3 * u.y, -4e-2 * u.y + 1e-3 * u.x, 0.02 * u.z}) < 2e-5);
      outermost += u.x < 1 || u.x > 138;
    }
  CHECK(outermost >= 4);
}

TEST_CASE("bricked: a cell with a corner without a value is clear") {
  const MadeVolume m = make_volume({20, 20, 20}, 1, [](double x, double y, double z) { return x == 10 && y == 10 && z == 10 ? NAN : x; });
  const auto source = source_of(m, look(box_of(m), 1, 4000));
  const auto ray = source->walker();
  const auto all = stretches(*ray, {-5, 9.5, 9.5}, {1, 0, 0});
  double covered = 0;
  for (const auto& s : all) {
    covered += s.to - s.from;
    CHECK(!(s.from < 5 + 10.9 && s.to > 5 + 9.1));
    CHECK(s.highest() <= 19);
  }
  CHECK(covered == doctest::Approx(17));
}

TEST_CASE("bricked: a single layer is a slab one cell thick, rays along faces stay on one side") {
  const MadeVolume m = make_volume({130, 70, 1}, 1, [](double x, double, double) { return x; });
  const auto source = source_of(m, look(box_of(m), 1, 4000, true));
  const auto ray = source->walker();
  double through = 0;
  for (const auto& s : stretches(*ray, {64, 30, -5}, {0, 0, 1})) {
    through += s.to - s.from;
    CHECK(s.b[0] == 64);
  }
  CHECK(through == doctest::Approx(1));
  CHECK(stretches(*ray, {-5, 71, 0}, {1, 0, 0}).empty());
  const auto along = stretches(*ray, {-5, 64, 0.5}, {1, 0, 0});
  REQUIRE(!along.empty());
  CHECK(along.back().b[3] == 129);
}

TEST_CASE("bricked: integers, and other datasets and fields") {
  auto v = std::make_shared<BrickedVolume>();
  v->field = "f", v->type = ElementType::u16;
  v->levels.push_back({{70, 5, 6}, {}, {1, 1, 1}, {1, 1, 1}});
  v->read = [](size_t, std::array<size_t, 3> lo, std::array<size_t, 3> n, std::byte* out) {
    auto* to = reinterpret_cast<uint16_t*>(out);
    for (size_t k = 0; k < n[2]; ++k)
      for (size_t j = 0; j < n[1]; ++j)
        for (size_t i = 0; i < n[0]; ++i) *to++ = uint16_t(900 * (lo[0] + i));
  };
  DatasetParts parts;
  parts.mesh = UniformGrid{};
  VolumeItem item;
  item.data = make_dataset(parts);
  const Projection p = look({{0, 0, 0}, {69, 4, 5}}, 1, 4000, true);
  Context context;
  CHECK(!volume::bricked_source(item, p, 0, context));
  item.data = make_dataset(parts, v);
  const auto source = volume::bricked_source(item, p, 0, context);
  REQUIRE(source);
  const auto ray = source->walker();
  const auto all = stretches(*ray, {-1, 2, 2}, {1, 0, 0});
  CHECK(all.size() == 69);
  CHECK(all.back().b[3] == 900 * 69.0f);
  item.field = "g";
  CHECK(!volume::bricked_source(item, p, 0, context));
  item.field = "f";
  CHECK(error_of([&] { volume::bricked_source(item, p, 0, context, 0.5); }).find("1 or more") != std::string::npos);
}

TEST_CASE("bricked: what cannot be read says so from any walker") {
  MadeVolume m = make_volume({100, 100, 100}, 2, bumpy);
  auto broken = std::make_shared<BrickedVolume>(*m.volume);
  broken->read = [](size_t, std::array<size_t, 3>, std::array<size_t, 3>, std::byte*) { fail_data("is damaged", "chunk 3"); };
  CHECK(!make_dataset(m.dataset->parts())->bricks());  // a new dataset: no longer the volume
  m.dataset = make_dataset(m.dataset->parts(), broken);
  const auto source = source_of(m, look(box_of(m), 1, 4000));
  for (int i = 0; i < 2; ++i) {
    const auto ray = source->walker();
    CHECK(error_of([&] { stretches(*ray, {-5, 50, 50}, {1, 0, 0}); }).find("chunk 3") != std::string::npos);
  }
}

TEST_CASE("bricked: kernels and second fields that bricks do not have are refused, not ignored") {
  const MadeVolume m = make_volume({100, 100, 100}, 2, bumpy);
  VolumeItem item = test::item(m.dataset, test::grey(-2, 2), {});
  item.field = m.volume->field;
  const auto shot = [&] {
    return test::draw(test::scene_of({item}), test::parallel_view(4, 4, 0.01, {0, 0, -1}, {0, 1, 0}, {50, 50, 50}));
  };
  const auto error = [&] { return error_of(shot); };
  CHECK(shot().rgba.size() == 64);
  item.sampling.kernel = Kernel::bspline;
  CHECK(error().find("linear kernel") != std::string::npos);
  item.sampling.kernel = Kernel::linear, item.detail.second = SecondAxis::field, item.detail.second_field = "g";
  CHECK(error().find("not support a second field") != std::string::npos);
}
