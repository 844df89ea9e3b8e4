// SPDX-License-Identifier: Apache-2.0
// Splatting against closed forms and against the ray caster.
#include "render/volume/methods/footprint.h"
#include "volume_classic_support.h"

using namespace sg;
using namespace sg::test;
using doctest::Approx;
using Order = volume::SplatOptions::Order;
using Classify = volume::SplatOptions::Classify;

namespace {

struct Variant {
  Order order;
  Classify classify;
};
const Variant variants[] = {{Order::sheets, Classify::after}, {Order::sheets, Classify::before}, {Order::whole, Classify::before}};

double optical_depth(const volume::Layer& l, size_t pixel) { return -std::log(1 - double(l.rgba[4 * pixel + 3])); }

}  // namespace

TEST_CASE("splat: the kernel's tables have the integral 1 across and along the ray") {
  const volume::KernelTable table;
  double sum = 0;
  const double h = 0.02;
  for (double y = -4 + h / 2; y < 4; y += h)
    for (double x = -4 + h / 2; x < 4; x += h)
      if (const double e = x * x + y * y; e < volume::kernel_reach * volume::kernel_reach) sum += h * h * double(table.across(float(e)));
  CHECK(sum == Approx(1).epsilon(1e-4));
  CHECK(table.before(-9) == 0);
  CHECK(table.before(9) == 1);
  CHECK(table.before(0) == Approx(0.5).epsilon(1e-5));
  for (const float z : {0.5f, 1.0f, 2.0f}) CHECK(table.before(z) == Approx(0.5 * std::erfc(-double(z) / std::sqrt(2))).epsilon(4e-3));
}

TEST_CASE("splat: a flat field stays flat to 1e-3, from any side, near and far, on anisotropic rotated grids too") {
  UniformGrid skew = cube(33, -1, 1);
  skew.spacing = {0.09, 0.06, 0.045};
  const double c = std::cos(0.4), s = std::sin(0.4);
  skew.direction.m[0][0] = c, skew.direction.m[0][2] = s, skew.direction.m[2][0] = -s, skew.direction.m[2][2] = c;
  skew.origin = skew.direction * (skew.spacing * -16.0);
  for (const UniformGrid& g : {cube(33, -1, 1), skew})
    for (const Variant& variant : variants) {
      const VolumeItem v = item(grid(g, [](Vec3) { return 1.0; }), one_color({1, 0.5f, 0.25f}), constant_opacity(1));
      // Pixels of a tenth of a voxel, of about one voxel, and of two; the rays pass through the middle of the box.
      for (const double scale : {160.0, 16.0, 8.0})
        for (const Vec3 forward : {Vec3{0, 0, -1}, Vec3{0.15, -0.2, -1}, Vec3{1, 0.1, 0.2}}) {
          const int size = scale > 100 ? 24 : scale > 10 ? 3 : 1;
          const Projection p = parallel_view(size, size, scale, forward, {0, 1, 0.1});
          const auto layer = draw_layer(v, p, splats(variant.order, variant.classify));
          const Frame want = ray_cast(v, p, 0.05);
          double most = 0;
          for (size_t i = 0; i < size_t(size) * size_t(size); ++i) {
            const double chord = -std::log(1 - double(want.rgba[4 * i + 3]));
            most = std::max(most, std::abs(optical_depth(layer, i) / chord - 1));
          }
          INFO("scale " << scale << " order " << int(variant.order) << " classify " << int(variant.classify) << " error " << most);
          CHECK(most < 1e-3);
          CHECK(layer.rgba[1] == Approx(0.5 * double(layer.rgba[0])).epsilon(1e-3));
        }
      // Perspective: footprints are those of the middle's ray.
      const Projection p = perspective_view(16, 16, 300, {0.4, 0.5, 6}, {0, 0, 0});
      CHECK(distance(draw_layer(v, p, splats(variant.order, variant.classify)).rgba, ray_cast(v, p, 0.05).rgba).most < 2e-3);
    }
}

TEST_CASE("splat: a flat field reaches to the border of the box and not beyond, on points and cells") {
  const DatasetPtr points = grid(cube(9, -1, 1), [](Vec3) { return 0.5; });
  DatasetParts parts = points->parts();
  parts.fields = {};
  parts.fields.add({"f", Association::cell, Array::from_vector(std::vector<float>(512, 0.5f)), "", Role::scalars});
  const DatasetPtr cells = make_dataset(parts);
  using volume::SplatOptions;
  for (const DatasetPtr& data : {points, cells})
    for (const auto classify : {SplatOptions::Classify::before, SplatOptions::Classify::after})
      for (const Projection& p : {parallel_view(48, 40, 17), parallel_view(48, 40, 15, {0.5, -0.4, -1}),
                                  perspective_view(48, 40, 60, {2.0, 1.5, 3.4}, {0, 0, 0})})
        for (const RayFunction mode : {RayFunction::composite, RayFunction::sum, RayFunction::average}) {
          VolumeItem v = item(data, mode == RayFunction::composite ? one_color({1, 0.5f, 0.25f}) : grey(0, 2), constant_opacity(0.5));
          v.association = data->fields()[0].association, v.mode = mode;
          const auto layer = draw_layer(v, p, splats(SplatOptions::Order::sheets, classify));
          const Frame want = ray_cast(v, p, 0.01);
          CAPTURE(int(mode));
          CAPTURE(int(classify));
          CHECK(distance(layer.rgba, want.rgba).most < 0.015);
        }
}

TEST_CASE("splat: one voxel is a projected Gaussian") {
  const double sigma = volume::kernel_sigma * 0.25;
  UniformGrid g = cube(17, -2, 2);  // farther from the border than kernels reach
  for (const Variant& variant : {variants[1], variants[2]}) {
    const double density = 0.01;
    OpacityCurve curve;
    curve.points = {{0.5 * density, 0}, {0.9 * density, 1 - std::exp(-density)}};
    const VolumeItem v = item(grid(g, [&](Vec3 p) { return length(p) < 0.1 ? density : 0.0; }), one_color({1, 1, 1}), curve);
    const auto layer = draw_layer(v, parallel_view(41, 41, 40, {0.2, 0.4, -1}), splats(variant.order, variant.classify));
    const double peak = density * 0.25 * 0.25 * 0.25 / (2 * M_PI * sigma * sigma);
    for (int x = 0; x < 41; ++x) {
      const double b = (x - 20) / 40.0, want = peak * std::exp(-b * b / (2 * sigma * sigma));
      INFO("pixel " << x << " got " << optical_depth(layer, size_t(41 * 20 + x)) / peak << " want " << want / peak);
      REQUIRE(std::abs(optical_depth(layer, size_t(41 * 20 + x)) - want) < 1e-3 * peak);
    }
  }
}

TEST_CASE("splat: a Gaussian ball is the projected Gaussian of both widths together") {
  const double s = 0.3, h = 3.6 / 64, wide = std::sqrt(s * s + 0.49 * h * h);
  const DatasetPtr d = grid(cube(65, -1.8, 1.8), [&](Vec3 p) { return std::exp(-dot(p, p) / (2 * s * s)); });
  for (const Variant& variant : variants)
    for (const double b : {0.0, 0.2, 0.5}) {
      const auto layer = draw_layer(item(d, one_color({1, 1, 1}), density_is_value(0, 1, 20000)),
                                    parallel_view(1, 1, 30, {0, 0, -1}, {0, 1, 0}, {b, 0, 0}), splats(variant.order, variant.classify));
      const double want = s * s * s / (wide * wide) * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * wide * wide));
      CHECK(optical_depth(layer, 0) == Approx(want).epsilon(3e-3));
      CHECK(want == Approx(s * std::sqrt(2 * M_PI) * std::exp(-b * b / (2 * s * s))).epsilon(0.04));
    }
}

TEST_CASE("splat: a sphere of constant density darkens by exp(-2 sigma sqrt(R^2-b^2)) away from the rim") {
  const double sigma = 1.2;
  const DatasetPtr d = grid(cube(65, -1.3, 1.3), [&](Vec3 p) { return length(p) - 1; });
  OpacityCurve curve;
  curve.points = {{-10, 1 - std::exp(-sigma)}, {0, 1 - std::exp(-sigma)}, {1e-9, 0}, {10, 0}};
  for (const Variant& variant : variants) {
    const auto layer = draw_layer(item(d, one_color({1, 1, 1}), curve), parallel_view(12, 12, 12 / 1.3, {0.3, -0.2, -1}),
                                  splats(variant.order, variant.classify));
    double most = 0;
    for (int y = 0; y < 12; ++y)
      for (int x = 0; x < 12; ++x)
        if (const double b = std::hypot(x - 5.5, y - 5.5) * 1.3 / 12; b < 0.7)
          most =
              std::max(most, std::abs(1 - double(layer.rgba[size_t(4 * (12 * y + x) + 3)]) - std::exp(-2 * sigma * std::sqrt(1 - b * b))));
    INFO("error " << most);
    CHECK(most < 0.012);  // voxels are in or out; kernels average many
  }
}

TEST_CASE("splat: a smooth scene is that of the ray caster within the blur of the kernel") {
  const double rms[] = {0.008, 0.008, 0.03}, most[] = {0.05, 0.08, 0.15};
  for (int i = 0; i < 3; ++i)
    for (const bool shaded : {false, true})
      for (const Projection& p : some_views()) {
        const Distance d = from_rays(smooth_item(49, shaded), p, splats(variants[i].order, variants[i].classify), 0.002);
        INFO("variant " << i << " shaded " << shaded << " rms " << d.rms << " most " << d.most);
        CHECK(d.rms < rms[i]);
        CHECK(d.most < most[i]);
      }
}

TEST_CASE("splat: maximum, sum and average of a smooth field as the ray caster's, and holes stay empty") {
  VolumeItem v = smooth_item(49);
  v.opacity = constant_opacity(1);
  const Projection p = some_views(32)[0];
  v.mode = RayFunction::maximum;
  const Frame rays = ray_cast(v, p, 0.01);
  const auto layer = draw_layer(v, p, splats());
  double sum = 0;
  size_t both = 0;
  for (size_t i = 0; i < layer.rgba.size(); i += 4)
    if (layer.rgba[i + 3] == 1 && rays.rgba[i + 3] == 1) sum += std::abs(double(layer.rgba[i] - rays.rgba[i])), ++both;
  CHECK(both > 300);
  CHECK(sum / double(both) < 0.025);
  // One constant value: sum = value times chord, average = value.
  v = item(grid(cube(17, -1, 1), [](Vec3) { return 3.0; }), grey(0, 12), constant_opacity(1));
  v.mode = RayFunction::sum;
  CHECK(double(draw_layer(v, parallel_view(3, 3, 10), splats()).rgba[16]) * 12 == Approx(6).epsilon(0.01));
  v.mode = RayFunction::average;
  CHECK(double(draw_layer(v, parallel_view(3, 3, 10), splats()).rgba[16]) * 12 == Approx(3).epsilon(0.01));
  v = item(grid(cube(33, -1, 1), [](Vec3 q) { return q.x > 0 ? NAN : 1.0; }), one_color({1, 1, 1}), constant_opacity(1));
  for (const Variant& variant : variants) {
    const auto half = draw_layer(v, parallel_view(32, 3, 20), splats(variant.order, variant.classify));
    CHECK(half.rgba[4 * (32 + 8) + 3] == Approx(1 - std::exp(-2.0)).epsilon(2e-3));
    CHECK(half.rgba[4 * (32 + 24) + 3] == 0);
  }
}

TEST_CASE("splat: nothing is drawn behind a surface") {
  const VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(1));
  Frame opaque(3, 3);
  for (const double z : {1.5, 0.4, -0.7, -3.0}) {
    std::fill(opaque.depth.begin(), opaque.depth.end(), float(100 - z));
    for (const Variant& variant : variants) {
      const float alpha = draw_layer(v, parallel_view(3, 3, 20), splats(variant.order, variant.classify), &opaque).rgba[19];
      CHECK(std::abs(double(alpha) - (1 - std::exp(-std::clamp(1 - z, 0.0, 2.0)))) < 0.03);  // half a voxel
    }
  }
}

TEST_CASE("splat: the eye inside the volume, splats far below a pixel, and a volume off the picture") {
  const VolumeItem v = item(grid(cube(33, -1, 1), [](Vec3) { return 1.0; }), one_color({1, 1, 1}), constant_opacity(1));
  const Projection inside = perspective_view(16, 16, 20, {0.1, 0.05, 0.2}, {0, 0, -5});
  CHECK(distance(draw_layer(v, inside, splats()).rgba, ray_cast(v, inside, 0.01).rgba).rms < 0.12);  // voxels at the eye are left out
  const Projection tiny = parallel_view(8, 8, 2);
  double all = 0;
  for (size_t i = 0; i < 64; ++i) {
    const VolumeItem thin = item(v.data, one_color({1, 1, 1}), constant_opacity(0.001));
    if (i == 0) {
      const auto layer = draw_layer(thin, tiny, splats());
      for (size_t p = 0; p < 64; ++p) all += optical_depth(layer, p) / 4;
    }
  }
  CHECK(all == Approx(0.001 * 8).epsilon(2e-3));  // what is there in all: density times volume
  const auto nothing = draw_layer(v, parallel_view(8, 8, 20, {0, 0, -1}, {0, 1, 0}, {50, 0, 0}), splats());
  CHECK(*std::max_element(nothing.rgba.begin(), nothing.rgba.end()) == 0);
}

TEST_CASE("splat: the same bytes from one thread and from eight") {
  for (const Variant& variant : variants) {
    set_thread_count(1);
    const auto one = draw_layer(smooth_item(33, true), some_views(70)[2], splats(variant.order, variant.classify));
    set_thread_count(8);
    const auto eight = draw_layer(smooth_item(33, true), some_views(70)[2], splats(variant.order, variant.classify));
    set_thread_count(0);
    CHECK(std::memcmp(one.rgba.data(), eight.rgba.data(), one.rgba.size() * 4) == 0);
  }
}

TEST_CASE("splat: rectilinear grids and other ray functions are refused in words") {
  VolumeItem v = smooth_item(9);
  const Projection p = parallel_view(4, 4, 1);
  v.mode = RayFunction::isosurface;
  CHECK(refused(v, p, splats(), "method=ray"));
  v = smooth_item(9), v.clip.push_back({{1, 0, 0}, 0});
  CHECK(refused(v, p, splats(), "clipped"));
  v = smooth_item(9), v.sampling.step = 1e-4;
  CHECK(refused(v, p, splats(), "too thin"));
  RectilinearGrid r;
  r.x = r.y = r.z = Array::from_vector(std::vector<double>{0, 1, 3});
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::vector<double>(27, 1.0)), "", Role::scalars});
  v = smooth_item(9), v.data = make_dataset(r, fields);
  CHECK(refused(v, p, splats(), "rectilinear"));
}
