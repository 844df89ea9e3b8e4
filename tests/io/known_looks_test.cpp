// SPDX-License-Identifier: Apache-2.0
// What fields of files are to be seen as, which only their names tell.
#include "data/fields/known_looks.h"
#include "io/formats.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("looks: a field keeps its look through a file by its name, a result does not") {
  UniformGrid g;
  g.dims = {2, 1, 1};
  FieldSet fields;
  fields.add({"lambda2", Association::point, Array::from_vector(std::vector<float>{-1, 1}), "", Role::scalars, known_look("lambda2")});
  const Field other{"other", Association::point, Array::from_vector(std::vector<float>{0, 1}), "", Role::none};
  const DatasetPtr d = with_result(make_dataset(g, fields), other);
  const std::string path = test::temp_folder() + "/looks.vti";
  Context context;
  write_data(path, d, {}, context);
  const DatasetPtr back = single_dataset(read_data(path, {}, context), "test");
  CHECK(back->fields().require("lambda2").look == d->fields().require("lambda2").look);
  CHECK_FALSE(back->fields().result());
}
