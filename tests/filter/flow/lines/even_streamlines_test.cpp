// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/lines/even_streamlines.h"

#include <numbers>

#include "filter/every_mesh.h"

using namespace sg;

namespace {

using std::numbers::pi;

template <class F>
DatasetPtr flow_on(std::array<size_t, 3> n, F&& velocity) {
  return test::velocity_on<float>(test::even_grid(n, {}, 1.0 / double(n[0] - 1)), velocity);
}

struct Lines {
  std::vector<std::vector<Vec3>> lines;
  explicit Lines(const Data& data) {
    const DatasetPtr d = std::get<DatasetPtr>(data);
    const SurfaceMesh& mesh = *d->as<SurfaceMesh>();
    const CellsView v = cells_view(mesh.lines);
    for (size_t c = 0; c < v.count; ++c) {
      lines.emplace_back();
      for (size_t k = v.begin(c); k < v.end(c); ++k) lines.back().push_back(mesh.points.at(size_t(v.connectivity[k])));
    }
  }
  double nearest_pair() const {
    double least = HUGE_VAL;
    for (size_t a = 0; a < lines.size(); ++a)
      for (size_t b = a + 1; b < lines.size(); ++b)
        for (const Vec3& x : lines[a])
          for (const Vec3& y : lines[b]) least = std::min(least, length(x - y));
    return least;
  }
  double distance(Vec3 x) const {
    double least = HUGE_VAL;
    for (const auto& line : lines)
      for (const Vec3& y : line) least = std::min(least, length(x - y));
    return least;
  }
};

}  // namespace

TEST_CASE("even streamlines: no two come nearer than the test distance, and none of the plane is far from a line") {
  Context context;
  const auto gyre = [](Vec3 x) { return Vec3(-std::sin(pi * x.x) * std::cos(pi * x.y), std::cos(pi * x.x) * std::sin(pi * x.y), 0); };
  EvenStreamlinesParams p;
  p.spacing = 0.05, p.min_length = 0;
  const Lines found(even_streamlines(flow_on({33, 33, 1}, gyre), p, context));
  CHECK(found.lines.size() > 8);
  CHECK(found.nearest_pair() > 0.05 * 0.5 - 1e-6);
  for (int i = 1; i < 20; ++i)
    for (int j = 1; j < 20; ++j) CHECK(found.distance({i / 20.0, j / 20.0, 0}) < 0.075);
}

TEST_CASE("even streamlines: in uniform wind through a box they stand as a grid of straight lines") {
  Context context;
  EvenStreamlinesParams p;
  p.spacing = 0.2;
  const Lines found(even_streamlines(flow_on({9, 9, 9}, [](Vec3) { return Vec3(0, 0, 2); }), p, context));
  CHECK(found.nearest_pair() > 0.2 * 0.999);
  // Hexagonal packing of a square of 1 with distance 0.2 has about 29 places.
  CHECK(found.lines.size() >= 20);
  CHECK(found.lines.size() <= 36);
  for (const auto& line : found.lines) {
    CHECK(std::abs(line.front().x - line.back().x) < 1e-6);
    CHECK(line.back().z - line.front().z > 0.98);
  }
}

TEST_CASE("even streamlines: straight and even in uniform wind on every kind of flat mesh") {
  for (const test::MeshKind& kind : test::flat_meshes()) {
    CAPTURE(kind.name);
    Context context;
    EvenStreamlinesParams p;
    p.spacing = 0.25;
    const Lines found(even_streamlines(test::flow::with_velocity(kind.make(8, 1), [](Vec3) { return Vec3(0, 3, 0); }), p, context));
    CHECK(found.nearest_pair() > 0.25 * 0.999);
    CHECK(found.lines.size() >= 7);
    for (const auto& line : found.lines) {
      CHECK(std::abs(line.front().x - line.back().x) < 1e-6);
      CHECK(line.back().y - line.front().y > 1.9);
    }
  }
}

TEST_CASE("even streamlines: spacings that ask for too much and flows that stand still are refused") {
  Context context;
  EvenStreamlinesParams p;
  p.spacing = 1e-7;
  const DatasetPtr wind = flow_on({4, 4, 4}, [](Vec3) { return Vec3(1, 0, 0); });
  CHECK(test::error_of([&] { even_streamlines(wind, p, context); }).find("spacing") != std::string::npos);
  CHECK(test::error_of([&] {
          even_streamlines(flow_on({4, 4, 1}, [](Vec3) { return Vec3(); }), {}, context);
        }).find("no line") != std::string::npos);
}
