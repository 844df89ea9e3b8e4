// SPDX-License-Identifier: Apache-2.0
#include "io/table/table_parts.h"

#include "base/file/file.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

TablePtr table(std::vector<int32_t> fields, std::vector<std::string> words, std::vector<double> means) {
  auto t = std::make_shared<Table>();
  t->columns.push_back({"field", Association::whole, Array::from_vector(std::move(fields)), "", Role::none});
  t->columns.push_back({"mean", Association::whole, Array::from_vector(std::move(means)), "", Role::none});
  t->labels = {std::move(words), {}};
  return t;
}

CollectionPtr collection(std::vector<Collection::Part> parts) {
  auto c = std::make_shared<Collection>();
  c->parts = std::move(parts);
  return c;
}

}  // namespace

TEST_CASE("tables of parts: written under each other, with the part of each row and the words of all") {
  const CollectionPtr inner = collection({{"one", table({0, 1}, {"T", "p"}, {1.5, 2})}});
  const Data all = collection({{"Blocks", Data(inner)}, {"two", table({0, 1}, {"p", "T"}, {3, 4})}});
  REQUIRE(all_tables(all));
  const std::string f = test::fresh_folder("table_parts");
  Context context;
  write_data(f + "a.csv", all, {}, context);
  CHECK(MappedFile(f + "a.csv").text() == "part,field,mean\nBlocks/one,T,1.5\nBlocks/one,p,2\ntwo,p,3\ntwo,T,4\n");
}

TEST_CASE("tables of parts: those of different columns are refused, meshes among them are no tables") {
  auto other = std::make_shared<Table>(*table({0}, {"T"}, {1}));
  other->columns[1].name = "sum";
  const Data all = collection({{"a", table({0}, {"T"}, {1})}, {"b", TablePtr(other)}});
  CHECK(test::contains(test::error_of([&] { joined_tables(*std::get<CollectionPtr>(all)); }), "'a' and 'b' have different columns"));
  CHECK_FALSE(all_tables(collection({{"a", table({0}, {"T"}, {1})}, {"m", make_dataset(Mesh(PointCloud{}))}})));
  CHECK_FALSE(all_tables(collection({})));
}
