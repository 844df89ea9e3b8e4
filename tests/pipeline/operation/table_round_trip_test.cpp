// SPDX-License-Identifier: Apache-2.0
// A mesh written as a table, and its rows as points again.
#include "base/file/file.h"
#include "filter/stats/table_to_points.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

TEST_CASE("tables of points: coordinates and vectors come back, and the table of them is the same text") {
  for (const bool clash : {false, true}) {
    CAPTURE(clash);
    PointCloud cloud;
    cloud.points.xyz = Array::from_vector(std::vector<double>{0, 1, 2, 3, 4, 5.5}, 3);
    FieldSet fields;
    fields.add({"wind", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4, 5, 6}, 3), "", Role::vectors});
    fields.add({"flat", Association::point, Array::from_vector(std::vector<double>{1, 2, 3, 4}, 2), "", Role::none});
    if (clash) fields.add({"x", Association::point, Array::from_vector(std::vector<double>{7, 8}), "", Role::scalars});
    const DatasetPtr in = make_dataset(std::move(cloud), std::move(fields));
    Context context;
    const std::string path = test::temp_folder() + "round.csv", again = test::temp_folder() + "round_2.csv";
    write_data(path, in, {}, context);
    const DatasetPtr out = table_to_points(read_data(path, {}, context), {}, context);
    CHECK(out->bounds().lo == in->bounds().lo);
    CHECK(out->bounds().hi == in->bounds().hi);
    const Field& wind = out->fields().require("wind", Association::point);
    CHECK(wind.role == Role::vectors);
    for (int c = 0; c < 3; ++c) CHECK(wind.array.get(1, c) == 4 + c);
    CHECK(out->fields().require("flat", Association::point).components() == 2);
    if (clash) CHECK(out->fields().require("x", Association::point).array.get(1) == 8);
    write_data(again, out, {}, context);
    CHECK(MappedFile(again).text() == MappedFile(path).text());
  }
}
