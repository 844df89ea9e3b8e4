// SPDX-License-Identifier: Apache-2.0
#include "io/file_series.h"

#include <sys/stat.h>

#include "base/file/file.h"
#include "support/test.h"

using namespace sg;

namespace {

// A folder of its own for each test.
std::string folder() {
  static int count = 0;
  const std::string path = test::temp_folder() + "series" + std::to_string(count++) + "/";
  ::mkdir(path.c_str(), 0700);
  return path;
}

// A grid of two points whose field "T" is `value`.
void write_step(const std::string& path, double value, std::optional<double> time = {}) {
  UniformGrid g;
  g.dims = {2, 1, 1};
  DatasetParts parts;
  parts.mesh = g;
  parts.fields.add({"T", Association::point, Array::from_vector(std::vector<double>{value, value}), "", Role::none});
  parts.time = time;
  Context context;
  write_data(path, make_dataset(std::move(parts)), {}, context);
}

double value_of(const Data& d) { return std::get<DatasetPtr>(d)->fields().require("T").array.get(0); }

std::vector<double> times_of(const std::string& path, const std::string& stated = {}) {
  Context context;
  ReadOptions o;
  o.times = stated;
  return file_times(path, o, context);
}

}  // namespace

TEST_CASE("file series: a pattern's files come in the order of their numbers, counted where they have no time") {
  const std::string f = folder();
  for (const int n : {10, 2, 1, 33}) write_step(f + "flow_" + std::to_string(n) + ".vti", n);
  write_step(f + "flow_last.vti", -1), write_step(f + "other_1.vti", -2);
  for (const char* pattern : {"flow_{n}.vti", "flow_?.vti,flow_{n}0.vti,flow_3*.vti"}) {
    const std::string path = series_beside(f, pattern);
    REQUIRE(names_series(path));
    CHECK(series_files(path) == std::vector<std::string>{f + "flow_1.vti", f + "flow_2.vti", f + "flow_10.vti", f + "flow_33.vti"});
    CHECK(times_of(path) == std::vector<double>{0, 1, 2, 3});
  }
  CHECK(series_files(f + "flow_*.vti").size() == 5);
  Context context;
  ReadOptions o;
  o.time = 2.2;
  const Data step = read_data(f + "flow_{n}.vti", o, context);
  CHECK(value_of(step) == 10);
  CHECK(std::get<DatasetPtr>(step)->time() == 2);
  CHECK(std::get<DatasetPtr>(step)->notes().back() == std::pair<std::string, std::string>("file", "flow_10.vti"));
  o.time.reset(), o.step = 3;
  CHECK(value_of(read_data(f + "flow_{n}.vti", o, context)) == 33);
  o.step = 4;
  CHECK(test::error_of([&] { read_data(f + "flow_{n}.vti", o, context); }).find("there is no time step 4") != std::string::npos);
}

TEST_CASE("file series: times come from the files, or are stated") {
  const std::string f = folder();
  for (int n = 0; n < 3; ++n) write_step(f + "a" + std::to_string(n) + ".vti", n, 0.25 + n * n);
  CHECK(times_of(f + "a{n}.vti") == std::vector<double>{0.25, 1.25, 4.25});
  CHECK(times_of(f + "a{n}.vti", "5:0.5") == std::vector<double>{5, 5.5, 6});
  CHECK(times_of(f + "a{n}.vti", "1,2,7") == std::vector<double>{1, 2, 7});
  CHECK(test::error_of([&] { times_of(f + "a{n}.vti", "1,2"); }).find("2 times for 3 steps") != std::string::npos);
  for (const char* bad : {"0:0", "0:-1", "x:1", "1,y,2", "0:nan"})
    CHECK(test::error_of([&] { times_of(f + "a{n}.vti", bad); }).find("does not give the times of the files") != std::string::npos);
  // Files that all say the same time say none.
  for (int n = 0; n < 3; ++n) write_step(f + "same" + std::to_string(n) + ".vti", n, 7.0);
  CHECK(times_of(f + "same{n}.vti") == std::vector<double>{0, 1, 2});
}

TEST_CASE("file series: files that change are looked into again") {
  const std::string f = folder();
  write_step(f + "a1.vti", 1, 1.0), write_step(f + "a2.vti", 2, 2.0);
  CHECK(times_of(f + "a{n}.vti").size() == 2);
  write_step(f + "a3.vti", 3, 30.0);
  CHECK(times_of(f + "a{n}.vti") == std::vector<double>{1, 2, 30});
}

TEST_CASE("file series: a list keeps its order, also with commas in names; patterns in folders") {
  const std::string f = folder();
  write_step(f + "b.vti", 1), write_step(f + "a,1.vti", 2);
  const std::string list = series_path({f + "b.vti", f + "a,1.vti"}, false);
  CHECK(series_files(list) == std::vector<std::string>{f + "b.vti", f + "a,1.vti"});
  CHECK(series_files(series_path({f + "s10.vti", f + "s9.vti"}, true).substr(0, 0) + f + "b.vti") == std::vector<std::string>{f + "b.vti"});
  CHECK(series_path({"s10", "s9"}, true) == "s9,s10");
  CHECK_FALSE(names_series(f + "a,1.vti"));  // a file
  for (const char* name : {"run_2", "run_10"}) ::mkdir((f + name).c_str(), 0700), write_step(f + name + "/x.vti", 1);
  CHECK(series_files(f + "run_*/x.vti") == std::vector<std::string>{f + "run_2/x.vti", f + "run_10/x.vti"});
}

TEST_CASE("file series: what is not there is said, with what is near") {
  const std::string f = folder();
  write_step(f + "flow_1.vti", 1), write_step(f + "flow_2.vti", 1);
  const auto message = [&](const std::string& path) { return test::error_of([&] { series_files(path); }); };
  CHECK(message(f + "flaw_{n}.vti").find("no file matches 'flaw_{n}.vti'; the nearest name is 'flow_1.vti'") != std::string::npos);
  CHECK(message(f + "zzzzzzzzz*.nc").find("it contains: flow_1.vti, flow_2.vti") != std::string::npos);
  CHECK(message(f + "gone/flow_*.vti").find("no such folder; looked for 'flow_*.vti' there") != std::string::npos);
  CHECK(message(f + "flow_1.vti," + f + "flow_9.vti").find("flow_9.vti: no such file") != std::string::npos);
  write_step(f + "t_1.vti", 1, 5.0), write_step(f + "t_2.vti", 1, 4.0), write_step(f + "t_3.vti", 1, 6.0);
  const std::string order = test::error_of([&] { times_of(f + "t_{n}.vti"); });
  CHECK(order.find("t_2.vti: begins at the time 4, but the previous file, 't_1.vti', ends at 5; ") != std::string::npos);
  CHECK(times_of(f + "t_{n}.vti", "0:1").size() == 3);
}

TEST_CASE("file series: 31 daily files of currents are one month" * doctest::skip(test::no_data())) {
  const std::string path = test::data_file("vectors/globcurrent-2002-01/20020101000000-GLOBCURRENT-L4-CUReul_hs-ALT_SUM-v02.0-fv01.0.nc");
  const std::vector<double> times = times_of(folder_of(path) + "200201*.nc");
  REQUIRE(times.size() == 31);
  CHECK(times.front() == 37255);
  CHECK(times.back() == 37285);
}
