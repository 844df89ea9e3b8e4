// SPDX-License-Identifier: Apache-2.0
// Very dense media: what opacity says is what is drawn, however thin.
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// One cell with values 0 to 1 along z; alpha of a ray along it.
double alpha_through(OpacityCurve opacity, double unit, bool single, bool tets = false) {
  DatasetPtr data = grid(cube(2, 0, 1), [](Vec3 p) { return p.z; });
  if (tets) {
    const UniformGrid g = cube(2, 0, 1);
    UnstructuredMesh m;
    std::vector<double> xyz;
    for (int c = 0; c < 8; ++c)
      for (int a = 0; a < 3; ++a) xyz.push_back(c >> a & 1);
    m.points.xyz = Array::from_vector(xyz, 3), m.single_type = CellType::tetra;
    m.cells.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2, 4, 3, 1, 7, 2, 5, 1, 4, 7, 6, 2, 7, 4, 1, 2, 4, 7});
    m.cells.fixed = 4;
    data = make_dataset(m, data->fields());
  }
  VolumeItem v = item(data, one_color({1, 1, 1}), std::move(opacity));
  v.unit_distance = unit;
  const Projection view = parallel_view(1, 1, 1, {0, 0, -1}, {0, 1, 0}, {0.513, 0.417, 0});
  return double(draw(scene_of({v}), view, {}, single ? by_single_rays(view) : FragmentLists{}).rgba[3]);
}

}  // namespace

TEST_CASE("volume: a thin layer of opacity 1 is opaque") {
  for (const double width : {0.1, 0.01, 0.001, 0.0001})
    for (const bool single : {false, true})
      for (const bool tets : {false, true}) {
        INFO(width, std::string(single ? ", single rays" : ""), std::string(tets ? ", tetrahedra" : ""));
        CHECK(alpha_through({{{0.4, 0}, {0.4, 1}, {0.4 + width, 1}, {0.4 + width, 0}}}, 0.01, single, tets) > 0.998);
      }
}

TEST_CASE("volume: opacities below 1 have their own extinction, however large") {
  // 0.75 per 1e-6 of the edge, over 1e-6 of it: 0.75 of the light.
  for (const double thin : {1e-4, 1e-5})
    for (const bool single : {false, true}) {
      INFO(thin, std::string(single ? ", single rays" : ""));
      CHECK(alpha_through({{{0.5, 0}, {0.5, 0.75}, {0.5 + thin, 0.75}, {0.5 + thin, 0}}}, thin, single) ==
            doctest::Approx(0.75).epsilon(0.02));
    }
}
