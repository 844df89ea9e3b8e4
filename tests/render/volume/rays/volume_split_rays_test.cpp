// SPDX-License-Identifier: Apache-2.0
// antialias=split: rays that divide against the picture of many rays a pixel.
#include "base/error.h"
#include "data/bricked.h"
#include "render/volume/rays/split_rays.h"
#include "render/volume/sources/cells/volume_cells_support.h"
#include "render/volume/volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

// Narrow bands in all directions: as colours and opacity follow them, no mean of values stands for what is seen.
double bands(Vec3 p) { return 0.5 + 0.5 * std::sin(37 * p.x + 23 * p.y) * std::sin(31 * p.y - 29 * p.z + 1); }
OpacityCurve spikes() {
  OpacityCurve c;
  c.points = {{0, 0}, {0.2, 0}, {0.25, 0.97}, {0.3, 0}, {0.7, 0}, {0.8, 0.9}, {1, 0.5}};
  return c;
}

/// The picture with n x n rays a pixel.
std::vector<double> many_rays(const Scene& scene, const Projection& p, int n) {
  const Frame fine = draw(scene, window_of(p, 0, 0, p.width, p.height, n));
  std::vector<double> out(size_t(4 * p.width * p.height));
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x)
      for (size_t k = 0; k < 4; ++k)
        out[4 * size_t((y / n) * p.width + x / n) + k] += double(fine.rgba[4 * size_t(y * fine.width + x) + k]) / (n * n);
  return out;
}
double rms(const Frame& a, const std::vector<double>& truth) {
  REQUIRE(a.rgba.size() == truth.size());
  double sum = 0;
  for (size_t i = 0; i < truth.size(); ++i) sum += (double(a.rgba[i]) - truth[i]) * (double(a.rgba[i]) - truth[i]);
  return std::sqrt(sum / double(truth.size()));
}
Frame with(const VolumeItem& v, VolumeAntialias antialias, const Projection& p) {
  VolumeItem other = v;
  other.sampling.antialias = antialias;
  return draw(scene_of({other}), p);
}

DatasetPtr rectilinear(size_t n, const std::function<double(Vec3)>& f) {
  std::vector<double> at;
  for (size_t i = 0; i < n; ++i) {
    const double s = 2 * double(i) / double(n - 1) - 1;
    at.push_back(s + 0.1 * std::sin(3 * s) * (1 - s * s));
  }
  std::vector<float> values;
  for (double z : at)
    for (double y : at)
      for (double x : at) values.push_back(float(f({x, y, z})));
  RectilinearGrid r;
  r.x = r.y = r.z = Array::from_vector(at);
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(r, fields);
}

}  // namespace

TEST_CASE("volume split rays: nearer to many rays a pixel than one ray and than means, whatever the colours and the mesh") {
  const auto lattice = grid(cube(65, -1, 1), bands), uneven = rectilinear(65, bands);
  const auto cells = with_field(test::cube(CellType::tetra, 16, [](Vec3 p) { return p * 2.0 - Vec3{1, 1, 1}; }), bands);
  struct Case {
    DatasetPtr data;
    bool shaded;
    double step;
  };
  for (const Case& c : {Case{lattice, false, 0}, {lattice, true, 0}, {lattice, false, 0.01}, {uneven, false, 0}, {cells, false, 0}})
    for (const Vec3 eye : {Vec3{0.03, 0.02, 5}, Vec3{1, 1.2, 2.2}}) {
      VolumeItem v = item(c.data, grey(0, 1), spikes(), c.step);
      v.shaded = c.shaded, v.unit_distance = 0.1;
      const Projection p = perspective_view(12, 10, c.data == cells ? 9 : 16, eye, {0, 0, 0});
      const std::vector<double> truth = many_rays(scene_of({v}), p, 20);
      const double one = rms(with(v, VolumeAntialias::none, p), truth), split = rms(with(v, VolumeAntialias::split, p), truth);
      CAPTURE(c.data->kind());
      CAPTURE(c.shaded);
      CAPTURE(eye.z);
      CAPTURE(one);
      CAPTURE(split);
      CHECK(split < 0.1 * one);
      if (c.data == lattice && c.step == 0) {
        const double means = rms(with(v, VolumeAntialias::mip, p), truth);
        CAPTURE(means);
        CHECK(split < 0.1 * means);
      }
    }
}

TEST_CASE("volume split rays: every slab has rays less than a cell apart, and none twice as many as that takes") {
  VolumeItem v = item(grid(cube(33, -1, 1), bands), grey(0, 1), spikes());  // cells of 1/16
  v.sampling.antialias = VolumeAntialias::split;
  const Scene scene = scene_of({v});
  const Projection p = perspective_view(16, 16, 20, {0, 0, 5}, {0, 0, 0});
  const auto slabs = volume::ray_slabs(scene, p);
  REQUIRE(slabs.size() == 2);  // depths 4 to 6; pixels of 1/16 at 1.25, 2.5, 5, 10
  CHECK(slabs[0].from == p.near_plane);
  CHECK(slabs[0].to == doctest::Approx(5));
  CHECK(slabs[0].finer == 4);
  CHECK(slabs[1].from == slabs[0].to);
  CHECK(slabs[1].to == p.far_plane);
  CHECK(slabs[1].finer == 8);
  // Near by, one ray a pixel; the same bytes.
  const Projection near_by = perspective_view(24, 24, 200, {0, 0, 5}, {0, 0, 0});
  CHECK(volume::ray_slabs(scene, near_by).empty());
  CHECK(same_bytes(with(v, VolumeAntialias::none, near_by), with(v, VolumeAntialias::split, near_by)));
  // Parallel views and whole rays: as many everywhere.
  const auto parallel = volume::ray_slabs(scene, parallel_view(16, 16, 5));
  REQUIRE(parallel.size() == 1);
  CHECK(parallel[0].finer == 4);
  VolumeItem m = v;
  m.mode = RayFunction::maximum;
  const auto whole = volume::ray_slabs(scene_of({m}), p);
  REQUIRE(whole.size() == 1);
  CHECK(whole[0].finer == 8);
  VolumeItem plain = m;
  plain.sampling.antialias = VolumeAntialias::none;
  CHECK(rms(with(m, VolumeAntialias::split, p), many_rays(scene_of({plain}), p, 8)) < 1e-6);
}

TEST_CASE("volume split rays: surfaces, sheets and picks stay where they are") {
  // A homogenous slab that fills the view: dividing changes nothing but lengths within a pixel.
  VolumeItem v = item(grid(cube(65, -4, 4), [](Vec3) { return 0.5; }), one_color({0.8f, 0.5f, 0.2f}), constant_opacity(0.2));
  const Projection p = perspective_view(16, 16, 48, {0.2, 0.1, 12}, {0, 0, 0});
  REQUIRE(volume::ray_slabs(scene_of({[&] {
                              VolumeItem s = v;
                              s.sampling.antialias = VolumeAntialias::split;
                              return s;
                            }()}),
                            p)
              .size() >= 2);
  for (const float surface : {6.0f, 10.3f, 14.5f, 17.0f, HUGE_VALF})
    for (const float sheet : {5.0f, 8.1f, 11.9f, 16.5f}) {
      FragmentLists sheets;
      sheets.start.push_back(0);
      for (int i = 0; i < p.width * p.height; ++i) {
        if (sheet < surface) sheets.fragments.push_back({sheet, {0.1f, 0.2f, 0.3f, 0.4f}, 7});
        sheets.start.push_back(uint32_t(sheets.fragments.size()));
      }
      const auto picture = [&](VolumeAntialias antialias) {
        VolumeItem s = v;
        s.sampling.antialias = antialias;
        Frame frame(p.width, p.height);
        for (size_t i = 0; i < frame.pixels() && surface < HUGE_VALF; ++i) {
          frame.depth[i] = surface, frame.ids[i] = 5;
          const float c[4] = {0.9f, 0.1f, 0.4f, 1};
          std::copy_n(c, 4, &frame.rgba[4 * i]);
        }
        Context context;
        volume::composite_volumes(scene_of({s}), p, sheets, frame, context, {});
        return frame;
      };
      CAPTURE(surface);
      CAPTURE(sheet);
      const Frame one = picture(VolumeAntialias::none), split = picture(VolumeAntialias::split);
      CHECK(largest_difference(one, split) < 0.002f);
      for (size_t i = 0; i < one.pixels(); ++i) {
        REQUIRE(one.ids[i] == split.ids[i]);
        if (one.depth[i] < HUGE_VALF) REQUIRE(std::abs(one.depth[i] - split.depth[i]) < (surface < HUGE_VALF ? 1e-6f : 2.5f));
        else REQUIRE(split.depth[i] == HUGE_VALF);
      }
    }
}

TEST_CASE("volume split rays: the same bytes for any number of threads; a window is a part of the picture") {
  VolumeItem v = item(grid(cube(65, -1, 1), bands), grey(0, 1), spikes());
  v.sampling.antialias = VolumeAntialias::split, v.shaded = true;
  const Projection p = perspective_view(40, 30, 60, {1, 1.2, 2.2}, {0, 0, 0});
  const int threads = thread_count();
  set_thread_count(1);
  const Frame one = draw(scene_of({v}), p);
  set_thread_count(3);
  const Frame three = draw(scene_of({v}), p);
  set_thread_count(threads);
  CHECK(same_bytes(one, three));
  // A window of the picture is that part of it.
  const Frame part = draw(scene_of({v}), window_of(p, 10, 8, 20, 15));
  float most = 0;
  for (int y = 0; y < 15; ++y)
    for (int x = 0; x < 20; ++x)
      for (size_t k = 0; k < 4; ++k)
        most = std::max(most, std::abs(part.rgba[4 * size_t(y * 20 + x) + k] - one.rgba[4 * size_t((y + 8) * 40 + x + 10) + k]));
  CHECK(most < 0.002f);
}

TEST_CASE("volume split rays: refused for volumes that memory does not hold") {
  const auto volume = std::make_shared<BrickedVolume>();
  volume->levels.emplace_back();
  const DatasetPtr data = make_dataset(grid(cube(17, -1, 1), bands)->parts(), volume);
  VolumeItem v = item(data, grey(0, 1), spikes());
  v.sampling.antialias = VolumeAntialias::split;
  CHECK_THROWS_WITH_AS(volume::ray_slabs(scene_of({v}), perspective_view(8, 8, 10, {0, 0, 9}, {0, 0, 0})),
                       doctest::Contains("already averages of cells"), Error);
}
