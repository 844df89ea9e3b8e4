// SPDX-License-Identifier: Apache-2.0
#include "data/fields/known_looks.h"

#include "data/field_ops.h"
#include "support/test.h"

using namespace sg;

namespace {

Field numbers(const char* name, std::vector<float> v, Association a = Association::point) {
  return {name, a, Array::from_vector(std::move(v)), "", Role::none};
}

DatasetPtr pair(std::vector<Field> fields) {
  UniformGrid g;
  g.dims = {2, 1, 1};
  FieldSet set;
  for (Field& f : fields) set.add(std::move(f));
  return make_dataset(g, std::move(set));
}

}  // namespace

TEST_CASE("looks: a newer result takes the place of the older, fields that are carried keep theirs") {
  DatasetPtr d = with_result(pair({numbers("a", {0, 1})}), numbers("b", {2, 3}));
  REQUIRE(d->fields().result());
  CHECK(d->fields().result()->name == "b");
  d = with_result(d, numbers("c", {4, 5}));
  CHECK(d->fields().result()->name == "c");
  CHECK_FALSE(d->fields().find("b")->look.result);
  FieldSet carried;
  const int64_t ids[] = {1, 0, 1};
  carry_gathered(carried, d->fields(), Association::point, ids, Association::cell);
  REQUIRE(carried.result());
  CHECK(carried.result()->name == "c");
  CHECK(carried.result()->association == Association::cell);
  mark_result(carried, "a", Association::cell);
  CHECK(carried.result()->name == "a");
  mark_result(carried, "nothing", Association::cell);
  CHECK(carried.result()->name == "a");
}

TEST_CASE("looks: data from outside get them by the names of fields; stated ones stay") {
  const DatasetPtr plain = pair({numbers("temperature", {0, 1})});
  CHECK(with_known_looks(plain) == plain);
  Field q = numbers("Q", {0, 1});
  q.look.tailed = true;
  const DatasetPtr d = with_known_looks(pair({numbers("lambda2", {0, 1}), numbers("lic", {0, 1}), q}));
  CHECK(d->fields().find("lambda2")->look.shows == FieldLook::Shows::low);
  CHECK(d->fields().find("lic")->look.texture);
  CHECK(d->fields().find("Q")->look == FieldLook{.tailed = true});
  CHECK_FALSE(d->fields().result());
}

TEST_CASE("looks: numbers of bands count as bands where the limits stand beside them") {
  Field band{"band", Association::cell, Array::from_vector(std::vector<int32_t>{3}), "", Role::labels};
  CHECK_FALSE(with_known_looks(pair({band}))->fields().find("band")->look.bands);
  const DatasetPtr d =
      with_known_looks(pair({band, numbers("band low", {1}, Association::cell), numbers("band high", {2}, Association::cell)}));
  CHECK(d->fields().find("band")->look.bands);
}
