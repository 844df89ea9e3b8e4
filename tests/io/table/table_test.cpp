// SPDX-License-Identifier: Apache-2.0
// Tables: delimited text and JSON in, delimited text out, rows as points.
#include "base/file/file.h"
#include "io/io.h"
#include "support/test.h"

using namespace sg;

namespace {

TablePtr table_in(const std::string& name, const std::string& text) {
  const std::string path = test::temp_folder() + name;
  write_file(path, text);
  Context context;
  return std::get<TablePtr>(read_data(path, {}, context));
}
TablePtr csv(const std::string& text) { return table_in("t.csv", text); }
std::string error(const std::string& name, const std::string& text) {
  return test::error_of([&] { table_in(name, text); });
}

std::string utf16(const std::string& s, bool big, bool mark) {
  std::string out = mark ? (big ? "\xfe\xff" : "\xff\xfe") : "";
  for (const char c : s) out += big ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

}  // namespace

TEST_CASE("csv: numbers, words, missing cells and quotes") {
  const TablePtr t = csv("id,name,size,big\n1,\"a, \"\"b\"\"\",1.5,1\n2,c,,5000000000\n3,\"two\nlines\",NA,3\n");
  REQUIRE(t->columns.size() == 4);
  CHECK(t->columns[0].array.type() == ElementType::i32);
  CHECK(t->columns[0].array.count() == 3);
  REQUIRE(t->words(1));
  CHECK((*t->words(1))[0] == "a, \"b\"");
  CHECK((*t->words(1))[2] == "two\nlines");
  CHECK(t->columns[2].array.type() == ElementType::f64);
  CHECK(t->columns[2].array.get(0) == 1.5);
  CHECK(std::isnan(t->columns[2].array.get(1)));
  CHECK(std::isnan(t->columns[2].array.get(2)));
  CHECK(t->columns[3].array.type() == ElementType::i64);
  CHECK(t->columns[3].array.view<int64_t>()[1] == 5000000000);
}

TEST_CASE("csv: the delimiter is found, also blanks; a first line of numbers is no header") {
  for (const char* text : {"a;b\n1;2\n3;4\n", "a\tb\n1\t2\n3\t4\n", "a|b\n1|2\n3|4\n", "a b\n1   2\n3 4\n", "a:b\n1:2\n3:4\n"}) {
    const TablePtr t = csv(text);
    CAPTURE(text);
    REQUIRE(t->columns.size() == 2);
    CHECK(t->columns[1].name == "b");
    CHECK(t->columns[1].array.get(1) == 4);
  }
  const TablePtr t = csv("1,2\n3,4\n");
  CHECK(t->columns[0].name == "column1");
  CHECK(t->columns[0].array.count() == 2);
}

TEST_CASE("csv: byte order marks, UTF-16 with and without one, carriage returns, blank lines") {
  for (const std::string& text : {std::string("\xef\xbb\xbf"
                                              "alpha,beta\r\n1,2\r\n\r\n3,4"),
                                  utf16("alpha,beta\n1,2\n3,4\n", true, true), utf16("alpha,beta\n1,2\n3,4\n", false, true),
                                  utf16("alpha,beta\n1,2\n3,4\n", true, false), utf16("alpha,beta\n1,2\n3,4\n", false, false)}) {
    const TablePtr t = csv(text);
    REQUIRE(t->columns.size() == 2);
    CHECK(t->columns[0].name == "alpha");
    CHECK(t->columns[1].array.count() == 2);
    CHECK(t->columns[1].array.get(1) == 4);
  }
}

TEST_CASE("csv: rows of other lengths lose nothing; equal names are told apart") {
  const TablePtr t = csv("a,a\n1\n2,3,4\n");
  REQUIRE(t->columns.size() == 3);
  CHECK(t->columns[1].name == "a_2");
  CHECK(t->columns[2].name == "column3");
  CHECK(std::isnan(t->columns[2].array.get(0)));
  CHECK(t->columns[2].array.get(1) == 4);
}

TEST_CASE("csv: what is no table is refused with the place") {
  CHECK(error("t.csv", "a,b\n\"1,2\n").find("not closed") != std::string::npos);
  CHECK(error("t.csv", "a,b\n\"1,2\n").find("byte 4") != std::string::npos);
  CHECK(error("t.csv", "\n\n  \n").find("only empty lines") != std::string::npos);
  CHECK(error("t.csv", std::string("a\0b\0\0c", 6)).find("not text") != std::string::npos);
}

TEST_CASE("csv: what is written reads back equal") {
  const TablePtr t = csv("x,word,y\n0.1,\"a,b\",1\n1e-300,\"q\"\"q\",2\n,last,3\n");
  Context context;
  const std::string path = test::temp_folder() + "again.csv";
  write_data(path, t, {}, context);
  const TablePtr r = std::get<TablePtr>(read_data(path, {}, context));
  REQUIRE(r->columns.size() == 3);
  CHECK(r->columns[0].array.get(0) == 0.1);
  CHECK(r->columns[0].array.get(1) == 1e-300);
  CHECK(std::isnan(r->columns[0].array.get(2)));
  CHECK(*r->words(1) == *t->words(1));
  const std::string tsv = test::temp_folder() + "again.tsv";
  write_data(tsv, t, {}, context);
  CHECK(MappedFile(tsv).text().substr(0, 8) == "x\tword\ty");
}

TEST_CASE("csv: the points of a mesh with their fields are a table") {
  UniformGrid g;
  g.dims = {2, 1, 1};
  FieldSet f;
  f.add({"T", Association::point, Array::from_vector(std::vector<float>{0.1f, 2}), "", Role::scalars});
  Context context;
  const std::string path = test::temp_folder() + "mesh.csv";
  write_data(path, make_dataset(g, std::move(f)), {}, context);
  CHECK(MappedFile(path).text() == "x,y,z,T\n0,0,0,0.1\n1,0,0,2\n");
}

TEST_CASE("csv: components of vectors are named after the axes, coordinates otherwise where a field has their names") {
  UniformGrid g;
  g.dims = {2, 1, 1};
  const auto header = [&](std::vector<Field> fields) {
    FieldSet set;
    for (Field& f : fields) set.add(std::move(f));
    Context context;
    const std::string path = test::temp_folder() + "mesh.csv";
    write_data(path, make_dataset(g, std::move(set)), {}, context);
    const MappedFile file(path);
    return std::string(file.text().substr(0, file.text().find('\n')));
  };
  const auto numbers = [](int components, std::vector<double> v) {
    v.resize(size_t(2 * components));
    return Array::from_vector(std::move(v), components);
  };
  CHECK(header({{"v", Association::point, numbers(3, {}), "", Role::vectors}, {"w", Association::point, numbers(2, {}), "", Role::none}}) ==
        "x,y,z,v_x,v_y,v_z,w_x,w_y");
  CHECK(header({{"rgb", Association::point, numbers(3, {}), "", Role::colors},
                {"s", Association::point, numbers(6, {}), "", Role::tensors}}) == "x,y,z,rgb_0,rgb_1,rgb_2,s_0,s_1,s_2,s_3,s_4,s_5");
  // A field x that is no coordinate keeps its name; one that repeats the coordinate is written once.
  CHECK(header({{"X", Association::point, numbers(1, {5, 5}), "", Role::scalars}}) == "position_x,position_y,position_z,X");
  CHECK(header({{"x", Association::point, numbers(1, {0, 1}), "", Role::scalars}}) == "x,y,z");
}

TEST_CASE("json: lists of objects, objects of lists, grids, and named tables") {
  const TablePtr rows = table_in("t.json", R"([{"a":1,"b":"x"},{"a":2.5,"b":null},{"b":"x","c":true}])");
  REQUIRE(rows->columns.size() == 3);
  CHECK(rows->columns[0].array.get(1) == 2.5);
  CHECK(std::isnan(rows->columns[0].array.get(2)));
  CHECK(rows->columns[1].array.get(1) == -1);
  CHECK(rows->columns[1].array.get(2) == 0);
  const TablePtr columns = table_in("t.json", R"({"a":[1,2],"b":["p","q"]})");
  CHECK(columns->columns[0].array.type() == ElementType::i32);
  CHECK((*columns->words(1))[1] == "q");
  Context context;
  const std::string path = test::temp_folder() + "g.json";
  write_file(path, R"({"width":3,"height":2,"values":[1,2,3,4,5,null]})");
  const DatasetPtr grid = std::get<DatasetPtr>(read_data(path, {}, context));
  CHECK(grid->as<UniformGrid>()->dims == std::array<size_t, 3>{3, 2, 1});
  CHECK(grid->fields().require("values").array.get(3) == 4);
  write_file(path, R"({"nodes":[{"n":1}],"links":[{"s":0},{"s":1}]})");
  const auto parts = std::get<CollectionPtr>(read_data(path, {}, context));
  REQUIRE(parts->parts.size() == 2);
  CHECK(parts->parts[1].name == "links");
}

TEST_CASE("json: what is no table, cut off or too deep is refused") {
  CHECK(error("t.json", R"({"a":1})").find("not a table") != std::string::npos);
  CHECK(error("t.json", R"([{"a":1})").find("not valid JSON") != std::string::npos);
  CHECK(error("t.json", std::string(100000, '[')).find("deep") != std::string::npos);
  CHECK(error("t.json", R"({"width":9999999999999999999,"height":2,"values":[1]})").size() > 0);
  CHECK(error("t.json", R"({"width":3,"height":2,"values":[1]})").find("1 values for 3 x 2") != std::string::npos);
}

TEST_CASE("tables of the data folder have the rows, columns and ranges of the manifest" * doctest::skip(test::no_data())) {
  Context context;
  const TablePtr cars = std::get<TablePtr>(read_data(test::data_file("tables/cars.csv"), {}, context));
  CHECK(cars->columns.size() == 8);
  CHECK(cars->columns[0].array.count() == 398);
  CHECK(cars->words(0)->size() == 299);
  const FieldStats power = field_stats(cars->columns[4].array);
  CHECK(power.range[0] == Range{46, 230});
  CHECK(power.nan == 6);
  const TablePtr penguins = std::get<TablePtr>(read_data(test::data_file("tables/penguins.json"), {}, context));
  CHECK(penguins->columns[0].array.count() == 344);
  CHECK(field_stats(penguins->columns[2].array).range[0] == Range{32.1, 59.6});
  for (const char* name : {"delimited.txt", "delimitedUTF16.txt", "delimitedUTF16LE.txt", "delimitedUTF16BE.txt"}) {
    const TablePtr t = std::get<TablePtr>(read_data(test::data_file(std::string("edge-cases/text/") + name), {}, context));
    CAPTURE(name);
    CHECK(t->columns[0].name == "My Field Name 1");
    CHECK(t->columns[0].array.count() == 5);
  }
}

TEST_CASE("csv: a table written, read and written again has the same bytes") {
  auto t = std::make_shared<Table>();
  t->columns.push_back(
      {"f32", Association::whole, Array::from_vector(std::vector<float>{-0.0002f, 4e5f, 0.1f, 1e-30f, -0.0f}), "", Role::none});
  t->columns.push_back({"zeros", Association::whole, Array::from_vector(std::vector<float>{0, -0.0f, 0, 0, 0}), "", Role::none});
  t->columns.push_back({"f64", Association::whole, Array::from_vector(std::vector<double>{-2e-4, 4e5, 0.1, NAN, 1.0 / 3}), "", Role::none});
  t->columns.push_back({"large", Association::whole, Array::from_vector(std::vector<float>{1, INFINITY, -INFINITY, 2, 3}), "", Role::none});
  Context context;
  const std::string a = test::temp_folder() + "first.csv", b = test::temp_folder() + "second.csv";
  write_data(a, TablePtr(t), {}, context);
  const Data back = read_data(a, {}, context);
  write_data(b, back, {}, context);
  CHECK(MappedFile(a).text() == MappedFile(b).text());
  const Array& f = std::get<TablePtr>(back)->columns[0].array;
  for (size_t i = 0; i < 5; ++i) CHECK(float(f.get(i)) == float(t->columns[0].array.get(i)));
  CHECK(std::signbit(std::get<TablePtr>(back)->columns[1].array.get(1)));
}
