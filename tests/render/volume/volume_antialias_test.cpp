// SPDX-License-Identifier: Apache-2.0
// Rays that would undersample: means of cells against the picture of many rays a pixel.
#include "base/error.h"
#include "render/volume/sources/bricks/mip_source.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double checker(Vec3 p) { return (int(std::floor(p.x * 24 + 100.25)) + int(std::floor(p.y * 24 + 100.25))) % 2; }

/// Pixels as means of n x n rays.
std::vector<double> reduced(const Frame& fine, int n) {
  const int w = fine.width / n, h = fine.height / n;
  std::vector<double> out(size_t(4 * w * h));
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      for (int k = 0; k < 4; ++k)
        out[size_t(4 * ((y / n) * w + x / n) + k)] += double(fine.rgba[4 * size_t(y * fine.width + x) + size_t(k)]) / (n * n);
  return out;
}
double rms(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / double(a.size()));
}

}  // namespace

TEST_CASE("volume antialias: a far checkerboard in perspective is nearer to many rays a pixel with means of cells") {
  VolumeItem v = item(grid(cube(97, -1, 1), checker), grey(0, 1), constant_opacity(0.8));
  for (const Vec3 eye : {Vec3{0.03, 0.02, 9}, Vec3{3, 2, 8}}) {
    const Projection p = perspective_view(20, 20, 80, eye, {0, 0, 0}), fine = perspective_view(160, 160, 640, eye, {0, 0, 0});
    const std::vector<double> truth = reduced(draw(scene_of({v}), fine), 8);
    const double plain = rms(reduced(draw(scene_of({v}), p), 1), truth);
    VolumeItem means = v;
    means.sampling.antialias = VolumeAntialias::mip;
    const double averaged = rms(reduced(draw(scene_of({means}), p), 1), truth);
    CAPTURE(plain);
    CAPTURE(averaged);
    CHECK(averaged < 0.5 * plain);
    CHECK(averaged < 0.03);
    // Ray functions and another run too.
    means.mode = RayFunction::average;
    const Frame a = draw(scene_of({means}), p), b = draw(scene_of({means}), p);
    CHECK(same_bytes(a, b));
  }
}

TEST_CASE("volume antialias: near by, nothing changes; integers with a base and turned axes keep their place") {
  VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3 p) { return p.x + 2 * p.y; }), grey(-3, 3), {{{-3, 0}, {3, 0.9}}});
  const Projection near_by = perspective_view(32, 32, 120, {1, 2, 4}, {0, 0, 0});
  const Frame plain = draw(scene_of({v}), near_by);
  v.sampling.antialias = VolumeAntialias::mip;
  CHECK(same_bytes(plain, draw(scene_of({v}), near_by)));
  // A smooth field is the same from afar, whatever its numbers are stored as.
  UniformGrid g = cube(65, -1, 1);
  g.origin.x = 1, g.spacing.x = -g.spacing.x;
  VolumeItem w = item(grid(
                          g, [](Vec3 p) { return 30000 + 90 * p.x + 40 * p.y; }, ElementType::i32),
                      grey(29870, 30130), {{{29870, 0}, {30130, 0.9}}});
  const Projection far_off = perspective_view(16, 16, 60, {1, 2, 8}, {0, 0, 0});
  const Frame exact = draw(scene_of({w}), far_off);
  w.sampling.antialias = VolumeAntialias::mip;
  const Frame averaged = draw(scene_of({w}), far_off);
  CHECK_FALSE(same_bytes(exact, averaged));
  CHECK(largest_difference(exact, averaged) < 0.02f);
}

TEST_CASE("volume antialias: what has no means of cells is refused in words") {
  const Projection far_off = perspective_view(8, 8, 10, {0, 0, 9}, {0, 0, 0});
  const auto refused = [&](VolumeItem v, const char* word) {
    v.sampling.antialias = VolumeAntialias::mip;
    try {
      draw(scene_of({v}), far_off);
      FAIL("not refused");
    } catch (const Error& e) {
      CHECK(std::string(e.what()).find(word) != std::string::npos);
    }
  };
  VolumeItem v = item(grid(cube(17, -1, 1), [](Vec3 p) { return p.x; }), grey(-1, 1), {{{-1, 0}, {1, 0.9}}});
  VolumeItem sharp = v;
  sharp.sampling.kernel = Kernel::bspline;
  refused(sharp, "kernel");
  RectilinearGrid r;
  r.x = r.y = r.z = Array::from_vector(std::vector<double>{0, 1, 3});
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<float>(27, 1.0f)), "", Role::scalars});
  VolumeItem uneven = v;
  uneven.data = make_dataset(r, fields);
  refused(uneven, "rectilinear");
}
