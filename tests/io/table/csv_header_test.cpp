// SPDX-License-Identifier: Apache-2.0
// Headers of delimited text: what we write reads back as it was, also where names of columns are numbers.
#include "io/io_files.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

namespace {

TablePtr read_table(const std::string& path, const ReadOptions& options = {}) {
  Context ctx;
  return std::get<TablePtr>(read_data(path, options, ctx));
}
TablePtr table_of_text(std::string_view text, const ReadOptions& options = {}) { return read_table(temp_file("h.csv", text), options); }

std::vector<std::string> names_of(const Table& t) {
  std::vector<std::string> r;
  for (const Field& f : t.columns) r.push_back(f.name);
  return r;
}
using Names = std::vector<std::string>;

}  // namespace

TEST_CASE("csv: a first line of numbers is a header when it is quoted, and data when it is not") {
  CHECK(names_of(*table_of_text("\"1990\",\"1991\"\n1,2\n3,4\n")) == Names{"1990", "1991"});
  CHECK(table_of_text("\"1990\",\"1991\"\n1,2\n3,4\n")->columns[0].array.count() == 2);
  CHECK(table_of_text("1990,1991\n1,2\n3,4\n")->columns[0].array.count() == 3);
  // Where all is quoted, quotes say nothing.
  CHECK(table_of_text("\"1\",\"2\"\n\"3\",\"4\"\n")->columns[0].array.count() == 2);
  // A word above a number is a name.
  CHECK(names_of(*table_of_text("country,1990,1991\nFR,1,2\nDE,3,4\n")) == Names{"column1", "column2", "column3"});  // as well data
  CHECK(names_of(*table_of_text("time,1,2\n0,5,6\n1,7,8\n")) == Names{"time", "1", "2"});
  CHECK(table_of_text("a,1,2\nb,3,4\n")->columns[1].array.count() == 2);  // all words of the first column alike: data
  CHECK(table_of_text("1,2,inf\n3,4,5\n")->columns[0].array.count() == 2);
  CHECK(table_of_text("1,NA\n3,5\n")->columns[0].array.count() == 2);
}

TEST_CASE("csv: the option header says what the first line is") {
  ReadOptions o;
  o.csv_header = HeaderLine::yes;
  CHECK(names_of(*table_of_text("1990,1991\n1,2\n3,4\n", o)) == Names{"1990", "1991"});
  o.csv_header = HeaderLine::no;
  const TablePtr t = table_of_text("a,b\nc,d\n", o);
  CHECK(t->columns[0].array.count() == 2);
  CHECK(t->columns[0].name == "column1");
}

TEST_CASE("property: tables read back as they were written, whatever their columns are called") {
  static const char* const names[] = {"1990", "-3",      "1e5",   "nan",  "inf",   "NA",  "T",   "wind speed",
                                      "a,b",  "quote\"", "größe", "0x10", " pad ", "x;y", "null"};
  for (uint64_t seed : property_seeds(200)) {
    CAPTURE(seed);
    Random random(seed);
    auto table = std::make_shared<Table>();
    const size_t rows = size_t(random.whole(1, 6));
    const int columns = random.whole(1, 5);
    for (int c = 0; c < columns; ++c) {
      std::string name = names[random.whole(0, 14)];
      for (const Field& f : table->columns)
        if (f.name == name) name += "_" + std::to_string(c);
      const int kind = random.whole(0, 3);
      std::vector<double> v;
      std::vector<int64_t> ids;
      std::vector<int32_t> places;
      std::vector<std::string> labels;
      for (size_t r = 0; r < rows; ++r) {
        v.push_back(random.chance(0.2) ? NAN : random.chance(0.1) ? HUGE_VAL : random.in(-5, 5));
        ids.push_back(int64_t(random.in(-9e18, 9e18)));
        places.push_back(int32_t(r));
        labels.push_back("word " + std::to_string(r));
      }
      table->labels.resize(table->columns.size() + 1);
      if (kind == 3) table->labels.back() = labels;
      table->columns.push_back({name, Association::whole,
                                kind == 3   ? Array::from_vector(places)
                                : kind == 2 ? Array::from_vector(ids)
                                            : Array::from_vector(v),
                                "", Role::none});
    }
    for (const char* extension : {"csv", "tsv"}) {
      Context ctx;
      const std::string path = temp_folder() + "t." + extension;
      write_data(path, TablePtr(table), {}, ctx);
      const TablePtr back = read_table(path);
      REQUIRE(back->columns.size() == table->columns.size());
      for (size_t c = 0; c < table->columns.size(); ++c) {
        const Field &f = table->columns[c], &g = back->columns[c];
        CAPTURE(f.name);
        CHECK(g.name == f.name);
        REQUIRE(g.array.count() == rows);
        for (size_t r = 0; r < rows; ++r) {
          if (table->words(c)) {
            REQUIRE(back->words(c));
            CHECK((*back->words(c))[size_t(g.array.get(r))] == (*table->words(c))[size_t(f.array.get(r))]);
          } else if (f.array.type() == ElementType::i64 && g.array.type() == ElementType::i64) {
            CHECK(f.array.view<int64_t>()[r] == g.array.view<int64_t>()[r]);
          } else {
            const double x = f.array.get(r), y = g.array.get(r);
            CHECK((x == y || (std::isnan(x) && std::isnan(y))));
          }
        }
      }
    }
  }
}
