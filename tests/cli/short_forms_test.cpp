// SPDX-License-Identifier: Apache-2.0
// What people type first: the file alone, another program's word, a pipe.
#include "base/file/file.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/test.h"

using namespace sg;
using test::bytes_of;
using test::must;
using test::sightglass;

TEST_CASE("command line: a file alone is rendered, under its own name or one made from it") {
  must({"convert", "--source", "sphere size=12", "-o", "ball.vti"});
  must({"ball.vti", "--size", "64x48", "--quiet"});
  must({"render", "ball.vti", "--size", "64x48", "--quiet", "-o", "of_{name}.png"});
  CHECK(bytes_of("ball.png") == bytes_of("of_ball.png"));
  const auto missing = sightglass({"nothing.vti"});
  CHECK(missing.status == 3);
  CHECK(missing.err.find("nothing.vti") != std::string::npos);
  CHECK(missing.err.find("unknown command") == std::string::npos);
  CHECK(sightglass({"rendr"}).err.find("did you mean 'render'") != std::string::npos);
}

TEST_CASE("command line: -o - writes the picture to standard output and nothing else") {
  must({"render", "--source", "gyroid size=12", "--size", "64x48", "-o", "g.png"});
  const auto streamed = must({"render", "--source", "gyroid size=12", "--size", "64x48", "-o", "-"});
  const auto read = [](std::string_view bytes) { return decode_png(std::as_bytes(std::span(bytes.data(), bytes.size())), "stdout"); };
  const Image a = read(streamed.out), b = read(bytes_of("g.png"));
  CHECK(a.width == 64);
  CHECK(compare(a, b).pixels == 0);
  CHECK(sightglass({"render", "--source", "gyroid size=12", "--progressive", "-o", "-"}).status == 2);
}

TEST_CASE("command line: words of the legend, and none") {
  const std::vector<std::string> head = {"render", "--source", "gyroid size=12", "-f", "slice axis=z", "--size", "320x240"};
  const auto drawn = [&](const std::vector<std::string>& more) {
    std::vector<std::string> args = head;
    args.insert(args.end(), more.begin(), more.end());
    args.insert(args.end(), {"-o", "l.png"});
    must(args);
    const std::string png = bytes_of("l.png");
    return decode_png(std::as_bytes(std::span(png)), "l.png").pixels;
  };
  const auto usual = drawn({}), none = drawn({"--legend", "false"}),
             named = drawn({"--legend", "title='Wall heat' unit=K ticks=0,1 format=.2f"});
  CHECK(usual != none);
  CHECK(named != usual);
  CHECK(named == drawn({"--show", "surface lit=false legend_title='Wall heat' legend_unit=K legend_ticks=0,1 legend_format=.2f"}));
  CHECK(none == drawn({"--show", "surface lit=false legend=false"}));
  const auto below = drawn({"--legend", "place=bottom bar=0.4"});
  CHECK(below != usual);
  CHECK(below == drawn({"--show", "surface lit=false legend_place=bottom legend_bar=0.4"}));
  CHECK(usual == drawn({"--legend", "place=right"}));
  std::vector<std::string> wrong = head;
  wrong.insert(wrong.end(), {"--legend", "format=2f", "-o", "l.png"});
  CHECK(sightglass(wrong).err.find("'2f' is not a format of numbers") != std::string::npos);
  wrong[wrong.size() - 3] = "place=below";
  CHECK(sightglass(wrong).err.find("'below' is not one of the choices") != std::string::npos);
  wrong[wrong.size() - 3] = "bar=1.5";
  CHECK(sightglass(wrong).err.find("from 0.05 to 1") != std::string::npos);
  // Texts in the picture, one flag each or all in one word.
  CHECK(drawn({"--note", "Inlet @ 0.3,0.5", "--note", "Outlet @ top-left"}) ==
        drawn({"--picture", "note='Inlet @ 0.3,0.5; Outlet @ top-left'"}));
}

TEST_CASE("command line: what other programs call a thing leads to what it is called here") {
  const auto told = [](const std::vector<std::string>& args) { return sightglass(args).err; };
  const std::vector<std::string> source = {"render", "--source", "gyroid size=8"};
  const auto with = [&](const char* flag, const char* word) {
    auto args = source;
    args.insert(args.end(), {flag, word});
    return told(args);
  };
  CHECK(with("-f", "isosurface").find("-f 'contour values=...'") != std::string::npos);
  CHECK(with("-f", "Stream_Tracer").find("-f streamlines") != std::string::npos);
  CHECK(with("--show", "wireframe").find("--show 'surface style=wireframe'") != std::string::npos);
  CHECK(with("--show", "contour").find("-f 'contour values=...'") != std::string::npos);
  CHECK(with("-f", "contuor").find("did you mean 'contour'") != std::string::npos);
  // Missing quotes.
  CHECK(told({"render", "--source", "gyroid size=8", "-f", "contour", "values=0.2"}).find("-f 'contour values=0.2'") != std::string::npos);
  CHECK(told({"ops", "mip"}).find("mode=maximum") != std::string::npos);
  CHECK(told({"render", "x.vtu", "--opacity", "0.5"}).find("--show 'surface opacity=") != std::string::npos);
  CHECK(sightglass({"ops", "--other-names"}).out.find("-f 'contour values=...'") != std::string::npos);
}

TEST_CASE("command line: of=OPERATION is the step without a name, where one with a name is of the same operation") {
  const auto drawn = [](const std::vector<std::string>& more) {
    std::vector<std::string> args{
        "render", "--source", "sphere size=12", "-f", "contour values=0", "-f", "big: contour on=input values=0.3"};
    args.insert(args.end(), more.begin(), more.end());
    args.insert(args.end(), {"--size", "80x60", "--camera", "position=0,-6,0 target=0,0,0", "-o", "step.png"});
    must(args);
    const std::string png = bytes_of("step.png");
    return decode_png(std::as_bytes(std::span(png)), "step.png").pixels;
  };
  const auto small = drawn({"--show", "surface of=contour"}), big = drawn({"--show", "surface of=big"});
  CHECK(small != big);
  CHECK(big == drawn({"--show", "surface"}));
  // name=NAME says the same as NAME: before an operation that has no such parameter.
  must({"render", "--source", "sphere size=12", "-f", "contour values=0", "-f", "contour on=input values=0.3 name=large", "--show",
        "surface of=large", "--size", "80x60", "--camera", "position=0,-6,0 target=0,0,0", "-o", "named.png"});
  const std::string named = bytes_of("named.png");
  CHECK(big == decode_png(std::as_bytes(std::span(named)), "named.png").pixels);
}
