// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/vortex/shear_lines.h"

#include "filter/flow/vortex/ftle.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("shear lines: of simple shear one family lies along the flow; all keep their length under the flow") {
  // x' = y: F = (1 T; 0 1). The directions that keep their length are x and its mirror in the eigenvectors.
  const double T = 1.5;
  UniformGrid g;
  g.dims = {21, 21, 1}, g.spacing = {0.1, 0.1, 0.1};
  const DatasetPtr d = ftle_of(g, T, {}, [&](std::span<const Vec3> from, std::vector<Vec3>& to, std::vector<uint8_t>& known) {
    to.assign(from.begin(), from.end()), known.assign(from.size(), 1);
    for (Vec3& x : to) x.x += T * x.y;
  });
  Context context;
  int along_x = 0, lines = 0;
  for (const char* family : {"plus", "minus"}) {
    ShearLinesParams p;
    p.family = *value_of_word<ShearChoice>(family), p.count = 9;
    const DatasetPtr found = shear_lines(d, p, context);
    const SurfaceMesh& m = *found->as<SurfaceMesh>();
    const CellsView v = cells_view(m.lines);
    for (size_t c = 0; c < v.count; ++c) {
      const Vec3 a = m.points.at(size_t(v.connectivity[v.begin(c)])), b = m.points.at(size_t(v.connectivity[v.end(c) - 1]));
      const Vec3 e = b - a, moved(e.x + T * e.y, e.y, 0);
      CHECK(length(moved) == doctest::Approx(length(e)).epsilon(1e-4));
      along_x += std::abs(e.y) < 1e-4 * std::abs(e.x);
      ++lines;
    }
  }
  CHECK(lines >= 18);
  CHECK(2 * along_x == lines);
}

TEST_CASE("shear lines: what is no result of ftle is refused by the name of what it lacks") {
  UniformGrid g;
  g.dims = {3, 3, 1};
  Context context;
  CHECK(test::error_of([&] { shear_lines(make_dataset(Mesh(g)), {}, context); }).find("stretch") != std::string::npos);
}
