// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/volume/visible_box.h"

#include <cmath>

#include "support/test.h"

using namespace sg;

namespace {

constexpr size_t n = 41;
const OpacityCurve rising{{{0, 0}, {0.1, 0}, {1, 0.7}}};

// A ball of radius 1 at `middle` in a box from 0 to 10: 1 in its middle, 0 at its surface, `haze` outside.
DatasetPtr ball(Vec3 middle, double haze, bool cells = false) {
  UniformGrid g;
  g.dims = {n, n, n};
  g.spacing = Vec3{1, 1, 1} * (10.0 / (n - 1));
  std::vector<float> v;
  const size_t m = cells ? n - 1 : n;
  for (size_t k = 0; k < m; ++k)
    for (size_t j = 0; j < m; ++j)
      for (size_t i = 0; i < m; ++i) {
        const double half = cells ? 0.5 : 0;
        const Vec3 p = Vec3{double(i) + half, double(j) + half, double(k) + half} * g.spacing.x;
        v.push_back(float(std::max(haze, 1 - length(p - middle))));
      }
  FieldSet fields;
  fields.add({"v", cells ? Association::cell : Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  return make_dataset(g, fields);
}

}  // namespace

TEST_CASE("visible box: around what is seen, with little room, for samples at points and in cells") {
  const Vec3 middle{3, 5, 8};
  for (const bool cells : {false, true}) {
    const DatasetPtr d = ball(middle, 0, cells);
    const auto box = visible_box(*d, d->fields()[0], -1, rising);
    REQUIRE(box);
    CAPTURE(cells);
    for (int a = 0; a < 3; ++a) {
      CHECK(box->lo[a] < middle[a] - 0.7);  // the rim of the ball is nearly clear
      CHECK(box->lo[a] > middle[a] - 1.4);
      CHECK(box->hi[a] > middle[a] + 0.7);
      CHECK(box->hi[a] < middle[a] + 1.4);
    }
  }
}

TEST_CASE("visible box: none where haze fills the volume, where nothing is seen, and where most of it is") {
  const DatasetPtr hazy = ball({3, 5, 8}, 0.15), clear = ball({3, 5, 8}, 0);
  CHECK_FALSE(visible_box(*hazy, hazy->fields()[0], -1, rising));
  CHECK_FALSE(visible_box(*clear, clear->fields()[0], -1, OpacityCurve{{{0, 0}, {1, 0}}}));
  CHECK_FALSE(visible_box(*clear, clear->fields()[0], -1, OpacityCurve{{{0, 0.5}, {1, 0.5}}}));
}
