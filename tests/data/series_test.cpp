// SPDX-License-Identifier: Apache-2.0
#include "data/series.h"

#include <algorithm>

#include "support/test.h"

using namespace sg;

TEST_CASE("series: ranges over all steps, with one step in memory at a time") {
  static int alive = 0, most = 0;
  struct Counted {
    Counted() { most = std::max(most, ++alive); }
    ~Counted() { --alive; }
  };
  Series series{{0, 0.5, 2}, [](size_t step) -> Data {
                  UniformGrid g;
                  g.dims = {2, 1, 1};
                  g.origin = {double(step), 0, 0};
                  auto owner = std::make_shared<std::pair<Counted, std::vector<double>>>();
                  owner->second = {double(step), step == 2 ? NAN : 10.0 * double(step)};
                  FieldSet fields;
                  const Buffer b{owner, reinterpret_cast<const std::byte*>(owner->second.data()), 16};
                  fields.add({"T", Association::point, Array(b, ElementType::f64, 2), "", Role::scalars});
                  if (step == 1) fields.add({"extra", Association::cell, Array::from_vector(std::vector<float>{3}), "", Role::none});
                  return make_dataset(g, std::move(fields));
                }};
  Context context;
  const SeriesRange r = series_range(series, context);
  CHECK(alive == 0);
  CHECK(most == 1);
  const SeriesField* t = r.find("T", Association::point);
  REQUIRE(t);
  CHECK(t->stats.range[0] == Range{0, 10});
  CHECK(t->stats.nan == 1);
  CHECK(t->steps == 3);
  REQUIRE(r.find("extra", Association::cell));
  CHECK(r.find("extra", Association::cell)->steps == 1);
  CHECK(r.bounds.lo.x == 0);
  CHECK(r.bounds.hi.x == 3);
}
