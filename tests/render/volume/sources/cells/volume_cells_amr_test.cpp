// SPDX-License-Identifier: Apache-2.0
// Rays through AMR grids: each leaf once, continuous across levels.
#include "index/locator_meshes.h"
#include "support/test.h"
#include "volume_amr_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double wavy(Vec3 p) { return std::sin(2 * p.x) * std::cos(p.y) + p.z * p.z; }

/// Chord of [-1,1]^3.
std::pair<double, double> box_chord(Vec3 o, Vec3 d) {
  const auto [a, b] = chord((o + Vec3(1, 1, 1)) * 0.5, d * 0.5);
  return {a, b};
}

}  // namespace

TEST_CASE("volume cells: AMR leaves fill their box once, linear fields are exact and nothing jumps between levels") {
  for (Association a : {Association::point, Association::cell}) {
    CAPTURE(int(a));
    for (const DatasetPtr& grid : {amr(), amr_small()})
      for (bool straight_field : {true, false}) {
        const VolumeItem item = item_of(with_amr_field(grid, straight_field ? Function(linear) : Function(wavy), a), a);
        Context context;
        const auto source = volume::cell_source(item, context);
        const auto walker = source->walker();
        std::vector<TestRay> rays = some_rays(40);
        for (TestRay& r : rays) r.o = r.o * 2.0 - Vec3(1, 1, 1);
        for (double u : {0.0, 0.25, 0.375, 1.0 / 3}) rays.push_back({{-3, u, u}, {1, 0, 0}}), rays.push_back({{u, -u, -3}, {0, 0, 1}});
        for (const TestRay& ray : rays) {
          const auto [from, to] = box_chord(ray.o, ray.d);
          walker->start(ray.o, ray.d, -100, 100);
          volume::Stretch s[7];
          double at = from, sum = 0, length = 0, jump = 0;
          float last = 0;
          bool first = true;
          while (const size_t n = walker->next(s))
            for (size_t i = 0; i < n; ++i) {
              CHECK(s[i].from == doctest::Approx(at).epsilon(1e-9));
              if (!first) jump = std::max(jump, double(std::abs(s[i].b[0] - last)));
              at = s[i].to, last = s[i].b[3], first = false;
              length += s[i].to - s[i].from;
              sum += (s[i].to - s[i].from) * double(s[i].b[0] + s[i].b[1] + s[i].b[2] + s[i].b[3]) / 4;
            }
          CHECK(length == doctest::Approx(to - from).epsilon(1e-9));
          CHECK(jump < 1e-5);
          if (straight_field) CHECK(sum == doctest::Approx((to - from) * linear(ray.o + ray.d * (0.5 * (from + to)))).epsilon(2e-4));
        }
      }
  }
}

TEST_CASE("volume cells: a second field of AMR cells is interpolated as the first is") {
  for (const DatasetPtr& grid : {amr(), amr_small()}) {
    DatasetParts parts = with_amr_field(grid, linear, Association::cell)->parts();
    parts.fields.add({"g", Association::cell, parts.fields.require("f").array, "", Role::none});
    VolumeItem item = item_of(make_dataset(std::move(parts)), Association::cell);
    item.detail.second = SecondAxis::field, item.detail.second_field = "g";
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    size_t seen = 0;
    for (const TestRay& ray : some_rays(10)) {
      walker->start(ray.o, ray.d, -100, 100);
      volume::Stretch s[64];
      while (const size_t n = walker->next(s))
        for (size_t i = 0; i < n; ++i, ++seen)
          for (const double share : {0.2, 0.7}) {
            const double t = s[i].from + share * (s[i].to - s[i].from);
            CHECK(double(walker->second(s[i], t)) == doctest::Approx(linear(ray.o + ray.d * t)).epsilon(2e-4));
          }
    }
    CHECK(seen > 20);
  }
}

TEST_CASE("volume cells: a flat AMR grid has no volume") {
  const VolumeItem item = item_of(with_amr_field(amr(2), linear, Association::cell), Association::cell);
  CHECK(error_of([&] { gather(item, {}, {0, 0, 1}); }).find("two dimensions") != std::string::npos);
}
