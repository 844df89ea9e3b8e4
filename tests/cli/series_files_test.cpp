// SPDX-License-Identifier: Apache-2.0
// Several files as a series, further inputs of a chain, and films from the command line.
#include <filesystem>

#include "base/file/file.h"
#include "image/codec.h"
#include "io/io.h"
#include "program.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

// Folder with flow_1.vti ... flow_12.vti: a box of 8 x 8 x 8 points that flows along x with the speed of its number.
const std::string& files() {
  static const std::string folder = [] {
    const std::string f = temp_folder() + "steps/";
    std::filesystem::create_directory(f);
    for (int n = 1; n <= 12; ++n) {
      UniformGrid g;
      g.dims = {8, 8, 8};
      std::vector<float> v;
      for (size_t i = 0; i < 512; ++i) v.insert(v.end(), {0.1f * float(n), 0, 0});
      DatasetParts parts;
      parts.mesh = g;
      parts.fields.add({"velocity", Association::point, Array::from_vector(v, 3), "", Role::vectors});
      Context context;
      write_data(f + "flow_" + std::to_string(n) + ".vti", make_dataset(std::move(parts)), {}, context);
    }
    return f;
  }();
  return folder;
}

}  // namespace

TEST_CASE("series: a pattern, {n} and --series are one flow in time") {
  std::vector<std::string> all{"info", "--series"};
  for (int n : {1, 10, 11, 12, 2, 3, 4, 5, 6, 7, 8, 9}) all.push_back("flow_" + std::to_string(n) + ".vti");  // as a shell sorts them
  all.insert(all.end(), {"-f", "pathlines points=1,1,1 attributes=none"});
  const Ran listed = sightglass(all, files()),
            pattern = sightglass({"info", "flow_*.vti", "-f", "pathlines points=1,1,1 attributes=none"}, files()),
            numbered = sightglass({"info", "flow_{n}.vti", "-f", "pathlines points=1,1,1 attributes=none"}, files());
  INFO(listed.err);
  REQUIRE(listed.status == 0);
  const auto without_name = [](const std::string& s) { return s.substr(s.find('\n')); };
  CHECK(without_name(listed.out) == without_name(pattern.out));
  CHECK(without_name(listed.out) == without_name(numbered.out));
  // The mean of 0.1 ... 1.2 with the ends halved, over 11 steps: 7.15.
  const size_t at = listed.out.find("x 1 .. ");  // it leaves the box
  REQUIRE(at != std::string::npos);
  CHECK(std::stod(listed.out.substr(at + 7)) == doctest::Approx(7).epsilon(2e-3));
  const Ran half = sightglass({"info", "flow_{n}.vti", "--series-times", "0:0.5", "-f", "pathlines points=1,1,1 attributes=none"}, files());
  CHECK(half.out.find("x 1 .. 4.575,") != std::string::npos);
  const Ran none = sightglass({"render", "flaw_*.vti", "-o", "x.png"}, files());
  CHECK(none.status == 3);
  CHECK(none.err.find("no file matches 'flaw_*.vti'; the nearest name is 'flow_1.vti'") != std::string::npos);
}

TEST_CASE("series: pipeline files read a pattern or a list, relative to themselves, and their pictures can be made again") {
  const std::string f = files() + "sub/";
  std::filesystem::create_directory(f);
  for (const char* read :
       {"\"../flow_{n}.vti\"", "[../flow_1.vti, ../flow_2.vti, ../flow_3.vti]", "{path: ../flow_*.vti, times: \"0:2\"}"}) {
    write_file(f + "a.yaml", std::string("sightglass: 1\nsteps:\n  in: {read: ") + read + "}\n  p: {pathlines: {points: [1, 1, 1]}}\n");
    const Ran r = sightglass({"run", "sub/a.yaml", "--size", "80x60", "-o", "sub/a.png"}, files());
    INFO(r.err);
    REQUIRE(r.status == 0);
    const Ran again = sightglass({"open", "sub/a.png"}, files());  // the working folder is around the data
    INFO(again.err);
    CHECK(again.status == 0);
    CHECK(read_png(f + "a.png").pixels == read_png(f + "a-again.png").pixels);
  }
}

TEST_CASE("chain: a further input is a file or a step by its name") {
  const std::string f = files();
  const Ran seeds = sightglass({"convert", "-s", "sphere size=4", "-o", "seeds.vti"}, f);
  REQUIRE(seeds.status == 0);
  const Ran probe = sightglass({"info", "seeds.vti", "-f", "probe with=flow_3.vti"}, f);
  INFO(probe.err);
  CHECK(probe.out.find("velocity") != std::string::npos);
  const Ran both =
      sightglass({"info", "flow_3.vti", "-f", "places: seeds points=2,2,2,3,3,3", "-f", "streamlines on=input with=places"}, f);
  INFO(both.err);
  CHECK(both.out.find("2 cells") != std::string::npos);
  const Ran by_operation = sightglass({"info", "flow_3.vti", "-f", "seeds points=2,2,2,3,3,3", "-f", "streamlines on=input with=seeds"}, f);
  CHECK(by_operation.out == both.out);
  const Ran joined = sightglass({"info", "flow_{n}.vti", "-f", "join_fields with=flow_2.vti", "-f", "pathlines points=1,1,1"}, f);
  INFO(joined.err);
  CHECK(joined.status == 0);
  const Ran unknown = sightglass({"info", "flow_3.vti", "-f", "probe with=imput"}, f);
  CHECK(unknown.status == 2);
  CHECK(unknown.err.find("'imput' is neither a file nor a step before it; did you mean 'input'") != std::string::npos);
  const Ran nobody = sightglass({"info", "flow_3.vti", "-f", "contour on=imput"}, f);
  CHECK(nobody.err.find("there is no step 'imput' before it") != std::string::npos);
}

TEST_CASE("film: a series becomes a .gif, with the step in its title unless one is stated") {
  const auto made = [&](const std::vector<std::string>& more) {
    std::vector<std::string> args = {"render", "flow_{n}.vti", "--times", "2:4", "--size", "160x120", "-o", "film.gif"};
    args.insert(args.end(), more.begin(), more.end());
    const Ran r = sightglass(args, files());
    INFO(r.err);
    REQUIRE(r.status == 0);
    return std::string(MappedFile(files() + "film.gif").text());
  };
  const std::string told = made({}), same = made({"--title", "step {n} of {count}, t = {t}"}), plain = made({"--picture", "title="});
  CHECK(told.substr(0, 6) == "GIF89a");
  CHECK(told == same);
  CHECK(told != plain);
}

TEST_CASE("film: a series becomes a .webm") {
  const Ran r = sightglass({"render", "flow_{n}.vti", "--times", "2:5", "--fps", "5", "--size", "161x121", "-o", "film.webm"}, files());
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("film.webm: 4 pictures, times 2 to 5") != std::string::npos);
  const MappedFile file(files() + "film.webm");
  CHECK(file.text().substr(0, 4) == "\x1A\x45\xDF\xA3");
  const Ran again = sightglass(
      {"render", "flow_{n}.vti", "--times", "2:5", "--fps", "5", "--size", "161x121", "-o", "film2.webm", "--threads", "1"}, files());
  CHECK(MappedFile(files() + "film2.webm").text() == file.text());
  CHECK(sightglass({"render", "flow_{n}.vti", "--times", "90:95", "-o", "film.webm"}, files()).err.find("it has 0 to 11") !=
        std::string::npos);
}

TEST_CASE("film: a camera goes around data that stand still, and each picture is made again from its recipe") {
  const std::string f = files() + "orbit/";
  std::filesystem::create_directory(f);
  const Ran r = sightglass({"render", "-s", "tangle size=9", "-f", "contour values=0", "--camera", "azimuth={t}", "--times", "0:90:3",
                            "--size", "80x60", "-o", "o_{n}.png"},
                           f);
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("3 pictures, times 0 to 90") != std::string::npos);
  CHECK(read_png(f + "o_000.png").pixels != read_png(f + "o_001.png").pixels);
  CHECK(sightglass({"open", "o_001.png"}, f).status == 0);
  CHECK(read_png(f + "o_001-again.png").pixels == read_png(f + "o_001.png").pixels);
  const Ran one = sightglass({"render", "-s", "tangle size=9", "--camera", "azimuth={t}", "-o", "one.png"}, f);
  CHECK(one.err.find("'{t}' is not a number") != std::string::npos);
}

TEST_CASE("run: a pipeline file makes numbered pictures and films, of a file's steps or a source's times") {
  const std::string f = files() + "film/";
  std::filesystem::create_directory(f);
  const std::string head = "sightglass: 1\nsteps:\n  in: {read: \"../flow_{n}.vti\"}\n  v: {magnitude: {}}\n";
  write_file(f + "numbered.yaml", head + "picture: {size: 80x60, output: \"flow_{n}.png\", times: \"2:4\"}\n");
  const Ran r = sightglass({"run", "film/numbered.yaml"}, files());
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.out.find("3 pictures, times 2 to 4") != std::string::npos);
  const Image second = read_png(f + "flow_001.png");
  CHECK(second.width == 80);
  // One of them, made again alone.
  const Ran again = sightglass({"open", "flow_001.png", "--read-anywhere"}, f);
  INFO(again.err);
  CHECK(again.status == 0);
  CHECK(read_png(f + "flow_001-again.png").pixels == second.pixels);
  CHECK(sightglass({"open", "--recipe", "flow_001.png"}, f).out.find("times") == std::string::npos);
  // The same as the command line makes.
  const Ran command =
      sightglass({"render", "../flow_{n}.vti", "-f", "magnitude", "--times", "2:4", "--size", "80x60", "-o", "c_{n}.png"}, f);
  INFO(command.err);
  REQUIRE(command.status == 0);
  CHECK(read_png(f + "c_001.png").pixels == second.pixels);
  // A film of a source; what states its time stands still.
  write_file(f + "film.yaml",
             "sightglass: 1\nsteps:\n  a: {double_gyre: {dims: [21, 11, 1]}}\n  b: {double_gyre: {dims: [21, 11, 1], time: 3}}\n"
             "show: [{surface: {}, of: a}, {outline: {}, of: b}]\npicture: {size: 80x60, output: film.webm, times: \"0:2:3\", fps: 4}\n");
  const Ran film = sightglass({"run", "film.yaml"}, f);
  INFO(film.err);
  REQUIRE(film.status == 0);
  CHECK(film.out.find("film.webm: 3 pictures, times 0 to 2") != std::string::npos);
  CHECK(MappedFile(f + "film.webm").text().substr(0, 4) == "\x1A\x45\xDF\xA3");
  CHECK(sightglass({"run", "film.yaml", "-o", "still.png"}, f).status == 0);  // one picture of the same file
  CHECK(sightglass({"run", "film.yaml", "-o", "s_{n}.png", "--times", "0,1"}, f).out.find("2 pictures") != std::string::npos);
  // What cannot be.
  CHECK(sightglass({"run", "film.yaml", "-o", "still.png", "--times", "0,1"}, f).err.find("several pictures are asked for") !=
        std::string::npos);
  write_file(f + "no.yaml", "sightglass: 1\nsteps:\n  b: {double_gyre: {time: 3}}\npicture: {times: \"0:2:3\", output: no.webm, fps: x}\n");
  CHECK(sightglass({"run", "no.yaml"}, f).err.find("'x' is not a number") != std::string::npos);
  CHECK(sightglass({"run", "no.yaml", "--fps", "3"}, f).err.find("already set") != std::string::npos);
  write_file(f + "one.yaml", "sightglass: 1\nsteps:\n  in: {read: ../flow_3.vti}\n");
  const Ran one = sightglass({"run", "one.yaml", "-o", "o_{n}.png"}, f);
  CHECK(one.err.find("flow_3.vti: has no time steps") != std::string::npos);
  CHECK(one.err.find("leave {n} out of the picture's name") != std::string::npos);
  const Ran still = sightglass({"convert", "../flow_3.vti", "--all-times", "-o", "o.vtkhdf"}, f);
  CHECK(still.err.find("has no time steps") != std::string::npos);
  CHECK(still.err.find("leave --all-times (and --times) out") != std::string::npos);
  CHECK(still.err.find("picture") == std::string::npos);
}

TEST_CASE("series: real currents over degrees, day by day" * doctest::skip(no_data())) {
  // The program runs in a folder of its own.
  const std::string f = folder_of(
      std::filesystem::absolute(data_file("vectors/globcurrent-2002-01/20020101000000-GLOBCURRENT-L4-CUReul_hs-ALT_SUM-v02.0-fv01.0.nc"))
          .string());
  const std::vector<std::string> flow{
      "info", f + "*.nc", "-f", "calc expr=vec(eastward_eulerian_current_velocity,northward_eulerian_current_velocity,0) name=current",
      "-f"};
  auto args = flow;
  args.push_back("pathlines points=29,-33,0 geographic=true attributes=none");
  const Ran r = sightglass(args);
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(r.err.empty());
  // The Agulhas current goes south-west along the coast, 1 to 2 m/s: some hundred kilometres in a few days.
  CHECK(r.out.find("PolyLine 1") != std::string::npos);
  const size_t at = r.out.find("bounds  x ");
  REQUIRE(at != std::string::npos);
  CHECK(std::stod(r.out.substr(at + 10)) < 28);
  args = flow;
  args.push_back("pathlines points=29,-33,0");
  CHECK(sightglass(args).err.find("geographic=true converts it") != std::string::npos);
}
