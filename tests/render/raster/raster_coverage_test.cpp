// SPDX-License-Identifier: Apache-2.0
// Which pixels a triangle owns: exactly one owner everywhere inside a mesh.
#include "raster_support.h"
#include "render/raster/triangles/kernels.h"

using namespace sg;
using namespace sg::raster;

namespace {

constexpr int width = 200, height = 150;

/// A jittered grid of triangles that covers the picture and more; `coarse` puts vertices onto pixel centres and corners.
struct Grid {
  std::vector<float> xyz;
  std::vector<uint32_t> triangles;
};
Grid jittered(uint64_t seed, int n, bool coarse) {
  Grid g;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const uint64_t k = uint64_t(j) * 1000 + uint64_t(i);
      const bool rim = i == 0 || j == 0 || i == n || j == n;
      double x = -40 + 280.0 * (i + (rim ? 0.0 : 0.4 * (random_unit(seed, 2 * k) - 0.5))) / n,
             y = -40 + 230.0 * (j + (rim ? 0.0 : 0.4 * (random_unit(seed, 2 * k + 1) - 0.5))) / n;
      if (coarse) x = std::round(2 * x) / 2, y = std::round(2 * y) / 2;
      for (double q : {x - 0.5 * width, 0.5 * height - y, random_unit(seed + 1, k) * 4 - 10}) g.xyz.push_back(float(q));
      if (i == n || j == n) continue;
      const uint32_t a = uint32_t(j * (n + 1) + i), b = a + 1, c = a + uint32_t(n) + 1, d = c + 1;
      if (random_bits(seed + 2, k) & 1)
        for (uint32_t q : {a, b, d, a, d, c}) g.triangles.push_back(q);
      else
        for (uint32_t q : {a, b, c, d, c, b}) g.triangles.push_back(q);  // either diagonal, either orientation
    }
  return g;
}

TriangleJob job_of(const Grid& g, int small, uint64_t* keys) {
  Camera c = test::front_parallel(height, 10);
  return {eye_view(make_projection(c, width, height), {}), g.xyz.data(), g.triangles.data(), 0, small, keys};
}

}  // namespace

TEST_CASE("raster coverage: every pixel of a random mesh belongs to exactly one triangle") {
  for (const bool coarse : {false, true})
    for (uint64_t seed = 1; seed < 30; ++seed) {
      const Grid g = jittered(seed, 4 + int(seed * (coarse ? 1 : 5)), coarse);  // jitter small enough for no triangle to turn over
      std::vector<TriangleRecord> records;
      std::vector<uint64_t> keys(size_t(width) * height);
      draw_triangles(job_of(g, 0, keys.data()), 0, g.triangles.size() / 3, records);
      std::vector<int> count(size_t(width) * height);
      for (const TriangleRecord& t : records)
        for_each_span(t, pixel_box(t, width, height), [&](int y, int x0, int x1) {
          for (int x = x0; x <= x1; ++x) ++count[size_t(y) * width + size_t(x)];
        });
      size_t wrong = 0;
      for (int c : count) wrong += c != 1;
      CHECK(wrong == 0);
    }
}

TEST_CASE("raster coverage: spans are the pixels whose centres pass the edge test") {
  for (uint64_t i = 0; i < 2000; ++i) {
    TriangleRecord t{};
    const double size = i % 3 == 0 ? 20 : i % 3 == 1 ? 400 : 4e5;  // tiny, common, far beyond the picture
    for (uint64_t k = 0; k < 3; ++k) {
      t.x[k] = int32_t((50 + size * (random_unit(11, 3 * i + k) - 0.5)) * subpixels),
      t.y[k] = int32_t((40 + size * (random_unit(12, 3 * i + k) - 0.5)) * subpixels);
      t.w[k] = 1;
    }
    if (!finish_record(t, 100, 80)) continue;
    std::vector<uint8_t> spans(8000), wanted(8000);
    for_each_span(t, pixel_box(t, 100, 80), [&](int y, int x0, int x1) {
      for (int x = x0; x <= x1; ++x) ++spans[size_t(y) * 100 + size_t(x)];
    });
    for (int y = 0; y < 80; ++y)
      for (int x = 0; x < 100; ++x) {
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          const int n = (k + 1) % 3;
          const __int128 dx = t.x[n] - t.x[k], dy = t.y[n] - t.y[k], e = dx * (y * 256 + 128 - t.y[k]) - dy * (x * 256 + 128 - t.x[k]);
          inside = inside && (e > 0 || (e == 0 && (dy < 0 || (dy == 0 && dx > 0))));
        }
        wanted[size_t(y) * 100 + size_t(x)] = inside;
      }
    CHECK(spans == wanted);
  }
}

TEST_CASE("raster coverage: the vector code draws the keys of the plain one") {
  for (uint64_t seed = 1; seed < 12; ++seed) {
    const Grid g = jittered(seed, int(seed * seed), seed % 2 == 0);
    const size_t n = g.triangles.size() / 3;
    std::vector<uint64_t> a(size_t(width) * height, empty_key(100)), b = a;
    std::vector<TriangleRecord> la, lb;
    draw_triangles(job_of(g, 8, a.data()), 0, n, la), draw_triangles_reference(job_of(g, 8, b.data()), 0, n, lb);
    CHECK(a == b);
    REQUIRE(la.size() == lb.size());
    auto order = [](const TriangleRecord& x, const TriangleRecord& y) { return x.primitive < y.primitive; };
    std::stable_sort(la.begin(), la.end(), order), std::stable_sort(lb.begin(), lb.end(), order);
    CHECK(test::same_bytes(la, lb));
  }
}

TEST_CASE("raster: known points land within 1/256 of a pixel") {
  // A small right triangle around each point; its snapped corners against the exact projection.
  for (const bool parallel : {false, true})
    for (uint64_t i = 0; i < 500; ++i) {
      Camera c;
      c.position = {5, -7, 3}, c.target = {0.1, 0.2, 0.3}, c.up = {0, 0, 1}, c.parallel = parallel, c.parallel_height = 3;
      const Projection p = make_projection(c, 1920, 1080);
      std::vector<float> xyz;
      for (uint64_t k = 0; k < 9; ++k) xyz.push_back(float(random_unit(21, 9 * i + k) * 2 - 1));
      const uint32_t t[3] = {0, 1, 2};
      std::vector<TriangleRecord> r;
      std::vector<uint64_t> keys(size_t(1920) * 1080);
      draw_triangles({eye_view(p, {}), xyz.data(), t, 0, 0, nullptr}, 0, 1, r);
      for (const TriangleRecord& q : r)
        for (size_t k = 0; k < 3; ++k) {
          double best = 1e9;
          for (size_t j = 0; j < 3; ++j) {
            const Vec3 e = p.to_pixel({xyz[3 * k], xyz[3 * k + 1], xyz[3 * k + 2]});
            best = std::min(best, std::max(std::abs(q.x[j] / 256.0 - e.x), std::abs(q.y[j] / 256.0 - e.y)));
          }
          CHECK(best < 1.0 / 256);
        }
    }
}
