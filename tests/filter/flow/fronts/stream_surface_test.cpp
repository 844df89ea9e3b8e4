// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/fronts/stream_surface.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <map>
#include <numbers>
#include <set>

#include "base/parallel.h"
#include "filter/flow/flow_support.h"
#include "filter/flow/trace.h"
#include "support/test.h"

using namespace sg;

namespace {

using std::numbers::pi;

// In [-1,1]^3, n points a side.
template <class F>
DatasetPtr flow_on_grid(size_t n, F&& velocity) {
  return test::cube_flow(n, -1, 1, velocity);
}

struct Surface {
  DatasetPtr data;
  std::vector<std::array<int64_t, 3>> triangles;
  explicit Surface(const Data& d) : data(std::get<DatasetPtr>(d)) {
    const CellsView v = cells_view(data->as<SurfaceMesh>()->polygons);
    for (size_t c = 0; c < v.count; ++c) triangles.push_back({v.point(c, 0), v.point(c, 1), v.point(c, 2)});
  }
  Vec3 at(int64_t id) const { return data->as<SurfaceMesh>()->points.at(size_t(id)); }
  double area() const {
    double sum = 0;
    for (const auto& t : triangles) sum += length(cross(at(t[1]) - at(t[0]), at(t[2]) - at(t[0]))) / 2;
    return sum;
  }
  // Each directed edge at most once: two triangles at most, which run alike. Returns the Euler number of what triangles use.
  int euler() const {
    std::set<std::pair<int64_t, int64_t>> directed;
    std::set<std::pair<int64_t, int64_t>> edges;
    std::set<int64_t> used;
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const int64_t a = t[size_t(k)], b = t[size_t((k + 1) % 3)];
        CHECK(directed.insert({a, b}).second);
        edges.insert({std::min(a, b), std::max(a, b)});
        used.insert(a);
      }
    return int(used.size()) - int(edges.size()) + int(triangles.size());
  }
  double longest_edge() const {
    double most = 0;
    for (const auto& t : triangles)
      for (int k = 0; k < 3; ++k) most = std::max(most, length(at(t[size_t(k)]) - at(t[size_t((k + 1) % 3)])));
    return most;
  }
};

StreamSurfaceParams line(Vec3 from, Vec3 to, double spacing) {
  StreamSurfaceParams p;
  p.curve.from = from, p.curve.to = to;
  p.spacing = spacing;
  return p;
}

}  // namespace

TEST_CASE("stream surface: uniform wind sweeps a rectangle of exact area, forward, backward and both") {
  Context context;
  const DatasetPtr wind = flow_on_grid(5, [](Vec3) { return Vec3(2, 0, 0); });
  StreamSurfaceParams p = line({0, -0.5, 0}, {0, 0.5, 0}, 0.1);
  p.max_length = 0.75;
  for (const char* direction : {"forward", "backward", "both"}) {
    p.direction = *value_of_word<TraceDirection>(direction);
    const Surface s(stream_surface({wind}, p, context));
    CHECK(s.area() == doctest::Approx(std::string_view(direction) == "both" ? 1.5 : 0.75).epsilon(1e-5));
    CHECK(s.euler() == 1);
    const Range time = s.data->range(s.data->fields().require("time"));
    CHECK(std::max(-time.lo, time.hi) == doctest::Approx(0.375).epsilon(1e-5));
  }
}

TEST_CASE("stream surface: a radius that turns about an axis sweeps a ring, whose area has order 2 in the spacing") {
  Context context;
  const DatasetPtr turning = flow_on_grid(5, [](Vec3 x) { return Vec3(-x.y, x.x, 0); });
  double error[3], h[3];
  for (int k = 0; k < 3; ++k) {
    StreamSurfaceParams p = line({0.3, 0, 0.1}, {0.8, 0, 0.1}, 0.1 / (1 << k));
    p.front = FrontClock::time, p.max_time = pi, p.tolerance = 1e-7;
    h[k] = 0.1 / (1 << k);
    error[k] = std::abs(Surface(stream_surface({turning}, p, context)).area() - pi / 2 * (0.64 - 0.09));
  }
  CHECK(test::observed_order(h, error, 3) == doctest::Approx(2).epsilon(0.15));
}

TEST_CASE("stream surface: from a circle it is a closed band, and its orientation is one") {
  Context context;
  const DatasetPtr swirl = flow_on_grid(17, [](Vec3 x) { return Vec3(-x.y + 0.3 * x.x, x.x - 0.2 * x.y, 1); });
  StreamSurfaceParams p;
  p.curve.center = Vec3(0.1, 0, -0.9), p.curve.radius = 0.3, p.spacing = 0.05, p.max_length = 1.5;
  const Surface s(stream_surface({swirl}, p, context));
  CHECK(s.euler() == 0);
  CHECK(s.longest_edge() < 2 * 0.05);
}

TEST_CASE("stream surface: where the flow pulls apart, places are put in; all of the surface lies on streamlines of the curve") {
  Context context;
  // x = x0 e^t, z = z0 + t: neighbours part by a factor of e^1.5.
  const DatasetPtr apart = flow_on_grid(33, [](Vec3 x) { return Vec3(x.x, -x.y, 1); });
  StreamSurfaceParams p = line({-0.15, 0.3, -0.8}, {0.15, 0.3, -0.8}, 0.03);
  p.front = FrontClock::time, p.max_time = 1.5, p.tolerance = 1e-6;
  const Surface s(stream_surface({apart}, p, context));
  CHECK(s.euler() == 1);
  CHECK(s.longest_edge() < 0.08);
  const Field &time = s.data->fields().require("time"), &seed = s.data->fields().require("seed parameter");
  for (size_t i = 0; i < s.data->point_count(); ++i) {
    const double t = time.array.get(i), x0 = -0.15 + 0.3 * seed.array.get(i);
    CHECK(length(s.at(int64_t(i)) - Vec3(x0 * std::exp(t), 0.3 * std::exp(-t), -0.8 + t)) < 1e-5);
  }
}

TEST_CASE("stream surface: an obstacle tears it, and no triangle bridges the hole") {
  Context context;
  // No value within 0.3 of the axis y.
  const DatasetPtr holed = flow_on_grid(41, [](Vec3 x) {
    if (x.x * x.x + x.z * x.z < 0.09) return Vec3(NAN, NAN, NAN);
    return Vec3(1, 0, 0);
  });
  StreamSurfaceParams p = line({-0.9, 0, -0.8}, {-0.9, 0, 0.8}, 0.05);
  p.max_length = 1.7;
  const Surface s(stream_surface({holed}, p, context));
  s.euler();
  CHECK(s.longest_edge() < 0.15);
  for (const auto& t : s.triangles) {
    const Vec3 middle = (s.at(t[0]) + s.at(t[1]) + s.at(t[2])) / 3.0;
    if (middle.x > -0.2) CHECK(std::abs(middle.z) > 0.25);
  }
  // Above and below the hole it goes on.
  CHECK(s.data->bounds().hi.x > 0.75);
}

TEST_CASE("stream surface: the same bytes for any number of threads, and curves outside or without flow are refused") {
  Context context;
  const DatasetPtr swirl = flow_on_grid(9, [](Vec3 x) { return Vec3(-x.y, x.x, 0.3); });
  const StreamSurfaceParams p = line({0.1, 0, -0.5}, {0.8, 0, -0.5}, 0.05);
  set_thread_count(1);
  const Surface one(stream_surface({swirl}, p, context));
  set_thread_count(8);
  const Surface many(stream_surface({swirl}, p, context));
  set_thread_count(0);
  const Array &a = one.data->as<SurfaceMesh>()->points.xyz, &b = many.data->as<SurfaceMesh>()->points.xyz;
  REQUIRE(a.bytes() == b.bytes());
  CHECK(std::memcmp(a.raw(), b.raw(), a.bytes()) == 0);
  CHECK(one.triangles == many.triangles);
  CHECK(test::error_of([&] {
          stream_surface({swirl}, line({5, 0, 0}, {6, 0, 0}, 0.1), context);
        }).find("outside the flow") != std::string::npos);
  const DatasetPtr still = flow_on_grid(4, [](Vec3) { return Vec3(); });
  CHECK(test::error_of([&] { stream_surface({still}, p, context); }).find("there is no flow") != std::string::npos);
  StreamSurfaceParams dense = p;
  dense.spacing = dense.max_length = 1e-200;
  CHECK(test::error_of([&] { stream_surface({swirl}, dense, context); }).find("max_points") != std::string::npos);
  StreamSurfaceParams two = p;
  two.curve.points = {0, 0, 0, 1, 0, 0};
  CHECK(test::error_of([&] { stream_surface({swirl}, two, context); }).find("seed curve") != std::string::npos);
}

TEST_CASE("stream surface: without a seed curve it begins at a line across the flow, also where the middle stands still") {
  Context context;
  std::string log;
  context.on_log = [&](LogLevel, std::string_view text) { log += text; };
  const Surface wide(stream_surface({flow_on_grid(9, [](Vec3) { return Vec3(1, 0.2, 0); })}, {}, context));
  CHECK(log.find("from=") != std::string::npos);
  const Box3 box = wide.data->bounds();
  CHECK(box.size().z > 0.5);  // along z, which is across
  CHECK(box.hi.x > 0.99);     // from the middle to the border
  CHECK(box.lo.x > -0.01);
  CHECK(wide.euler() == 1);
  // A jet beside the middle, still air elsewhere.
  const Surface jet(stream_surface({flow_on_grid(33,
                                                 [](Vec3 x) {
                                                   const double r = (x.y - 0.5) * (x.y - 0.5) + x.z * x.z;
                                                   return r < 0.04 ? Vec3(1 - r / 0.04, 0, 0) : Vec3();
                                                 })},
                                   {}, context));
  CHECK(jet.data->bounds().lo.y > 0.2);
  CHECK(jet.data->bounds().size().z < 0.5);
  CHECK(jet.data->bounds().hi.x > 0.9);
}

TEST_CASE("stream surface: in a chaotic flow no strips narrower than three spacings are left between tears") {
  Context context;
  const DatasetPtr chaos = flow_on_grid(41, [](Vec3 x) {  // periods of the ABC flow
    const Vec3 p = x * pi;
    return Vec3(std::sin(p.z) * 1.7 + std::cos(p.y), std::sin(p.x) * 1.4 + std::cos(p.z) * 1.7, std::sin(p.y) + std::cos(p.x) * 1.4);
  });
  StreamSurfaceParams p = line({-0.6, -0.2, 0.1}, {0.6, 0.3, -0.1}, 0.05);
  p.max_length = 5;
  const Surface s(stream_surface({chaos}, p, context));
  s.euler();
  CHECK(s.longest_edge() < 4.5 * 0.05);
  // Parts of the surface that hang together by edges: all are larger than a rag.
  std::map<int64_t, int64_t> parent;
  const std::function<int64_t(int64_t)> root = [&](int64_t i) {
    const auto at = parent.find(i);
    return at == parent.end() || at->second == i ? i : at->second = root(at->second);
  };
  for (const auto& t : s.triangles)
    for (const int64_t i : t) parent.try_emplace(i, i), parent[root(i)] = root(t[0]);
  std::map<int64_t, double> area;
  for (const auto& t : s.triangles) area[root(t[0])] += length(cross(s.at(t[1]) - s.at(t[0]), s.at(t[2]) - s.at(t[0]))) / 2;
  CHECK(area.size() < 10);
  CHECK(s.area() > 1);
}
