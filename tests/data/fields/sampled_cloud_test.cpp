// SPDX-License-Identifier: Apache-2.0
#include "data/fields/sampled_cloud.h"

#include "support/test.h"

using namespace sg;

namespace {

// 1000 samples: a ramp, vectors with one long one, and a mark on the cells.
DatasetPtr line(bool hide_last = false) {
  UniformGrid g;
  g.dims = {1000, 1, 1}, g.origin = {1, 2, 3};
  std::vector<int16_t> ramp;
  std::vector<float> vectors;
  for (int i = 0; i < 1000; ++i) {
    ramp.push_back(int16_t(i));
    vectors.insert(vectors.end(), {float(i % 7), i == 613 ? -90.0f : 1.0f, 0});
  }
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"ramp", Association::point, Array::from_vector(std::move(ramp)), "m", Role::scalars});
  parts.fields.add({"u", Association::point, Array::from_vector(std::move(vectors), 3), "", Role::vectors});
  parts.fields.add({"on cells", Association::cell, Array::from_vector(std::vector<double>(999, 4)), "", Role::none});
  if (hide_last) {
    std::vector<uint8_t> ghosts(1000, 0);
    ghosts[999] = ghost_hidden_point;
    parts.point_ghost = Array::from_vector(std::move(ghosts));
  }
  return make_dataset(std::move(parts));
}

}  // namespace

TEST_CASE("sampled cloud: bounds, ranges of components and magnitudes are those of all values") {
  const DatasetPtr all = line();
  for (const size_t most : {0, 1, 10, 5000}) {
    const DatasetPtr some = sampled_cloud(*all, most);
    CHECK(some->point_count() <= most + 10);
    CHECK(some->bounds() == all->bounds());
    for (const char* name : {"ramp", "u", "on cells"}) {
      const Field &a = all->fields().require(name), &b = some->fields().require(name, Association::point);
      CHECK(b.array.type() == a.array.type());
      CHECK(b.unit == a.unit);
      for (int c = a.components() > 1 ? -1 : 0; c < a.components(); ++c) CHECK(some->range(b, c) == all->range(a, c));
    }
  }
}

TEST_CASE("sampled cloud: what is hidden does not count, and a mesh of nothing gives nothing") {
  const DatasetPtr some = sampled_cloud(*line(true), 100);
  CHECK(some->range(some->fields().require("ramp")) == Range{0, 998});
  DatasetParts nothing;
  nothing.mesh = PointCloud();
  CHECK(sampled_cloud(*make_dataset(std::move(nothing)), 100)->point_count() == 0);
}

TEST_CASE("sampled cloud: samples are spread evenly over the values") {
  const DatasetPtr some = sampled_cloud(*line(), 100);
  const Array& ramp = some->fields().require("ramp").array;
  double sum = 0;
  for (size_t i = 2; i < ramp.count(); ++i) sum += ramp.get(i);  // behind the two extremes
  CHECK(sum / double(ramp.count() - 2) == doctest::Approx(499.5).epsilon(0.05));
}
