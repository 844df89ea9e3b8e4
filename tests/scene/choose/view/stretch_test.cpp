// SPDX-License-Identifier: Apache-2.0
#include "scene/choose/view/stretch.h"

#include <cmath>

#include "data/fields/axis_notes.h"
#include "support/test.h"

using namespace sg;

namespace {

DatasetPtr sea(Vec3 lo, Vec3 hi, const AxisNote& z) {
  UniformGrid g;
  g.dims = {3, 3, 3}, g.origin = lo, g.spacing = (hi - lo) * 0.5;
  if (hi.z == lo.z) g.dims[2] = 1, g.spacing.z = 1;
  std::vector<float> v(9 * g.dims[2]);
  for (size_t i = 0; i < v.size(); ++i) v[i] = float(i);
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"T", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  note_axis(parts.notes, 0, {"lon", "degrees_east", ""}), note_axis(parts.notes, 1, {"lat", "degrees_north", ""});
  note_axis(parts.notes, 2, z);
  return make_dataset(std::move(parts));
}

Vec3 chosen(const DatasetPtr& d) { return chosen_stretch({&d, 1}, d->bounds()); }

}  // namespace

TEST_CASE("stretch: degrees of longitude are as long as at the middle latitude, depths grow downwards") {
  const Vec3 f = chosen(sea({0, 50, 0}, {20, 70, 5000}, {"depth", "m", "down"}));
  CHECK(f.x == doctest::Approx(0.5));
  CHECK(f.y == 1);
  CHECK(f.z == doctest::Approx(-0.3 * 20 / 5000));
  CHECK(chosen(sea({0, 50, 0}, {20, 70, 5000}, {"height", "m", "up"})).z == doctest::Approx(0.3 * 20 / 5000));
  CHECK(chosen(sea({-180, -90, 1000}, {180, 90, 10}, {"level", "hPa", ""})).x == 1);
  CHECK(chosen(sea({-180, -90, 0}, {180, 90, 0}, {"level", "hPa", ""})) == Vec3{1, 1, 1});  // one level
  // Without notes as it is.
  UniformGrid g;
  g.dims = {3, 3, 3};
  CHECK(chosen(make_dataset(g)) == Vec3{1, 1, 1});
}

TEST_CASE("stretch: the mesh is scaled and mirrored with its values, which stay what they are") {
  const DatasetPtr d = sea({0, 0, 0}, {2, 2, 2}, {"depth", "m", "down"});
  const DatasetPtr s = stretched(d, {0.5, 1, -2}, Context());
  const Box3 b = s->bounds();
  CHECK(b.lo == Vec3{0, 0, -4});
  CHECK(b.hi == Vec3{1, 2, 0});
  CHECK(s->range(s->fields()[0]).hi == 26);
  CHECK(stretched(d, {1, 1, 1}, Context()) == d);
}

TEST_CASE("stretch: metres along which values become fewer are a depth, though it is not said; heights and full grids are not") {
  const auto with_floor = [](const AxisNote& z, int sign) {
    const DatasetPtr d = sea({0, 50, 0}, {20, 70, 5000}, z);
    DatasetParts parts;
    parts.mesh = d->mesh(), parts.notes = d->notes();
    std::vector<float> v(27, 1);
    for (size_t k = 0; k < 3; ++k)
      for (size_t i = 0; i < 3 * (sign > 0 ? k : 2 - k) && sign != 0; ++i) v[9 * k + i] = NAN;
    parts.fields.add({"T", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
    return make_dataset(std::move(parts));
  };
  const auto depth = [](const DatasetPtr& d) { return is_unstated_depth(*d, d->fields()[0]); };
  CHECK(depth(with_floor({"Z", "m", ""}, 1)));
  CHECK_FALSE(depth(with_floor({"Z", "m", ""}, -1)));  // mountains
  CHECK_FALSE(depth(with_floor({"Z", "m", ""}, 0)));
  CHECK_FALSE(depth(with_floor({"Z", "m", "up"}, 1)));
  CHECK_FALSE(depth(with_floor({"Z", "m", "down"}, 1)));  // known already
}
