// SPDX-License-Identifier: Apache-2.0
// A recipe out of a stranger's picture: it writes nothing but the picture, and reads only what the user allows.
#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>

#include "base/file/file.h"
#include "base/text/utf8.h"
#include "cli/program.h"
#include "image/codec.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::sightglass;

namespace {

namespace fs = std::filesystem;

// A folder tree: where the user works, and what is none of the recipe's business beside it.
struct Place {
  std::string top, work, secret;
  explicit Place(const std::string& name) : top(test::temp_folder() + name + "/"), work(top + "work/"), secret(top + "secret/") {
    fs::create_directories(work + "pictures"), fs::create_directories(secret);
    for (const std::string& at : {work + "in.vti", secret + "in.vti"})
      REQUIRE(sightglass({"convert", "--source", "hydrogen size=6", "-o", at}).status == 0);
  }
};

void put_recipe(const std::string& path, const std::string& recipe, const std::string& inputs = {}) {
  Image image(4, 4, 3);
  image.text.emplace_back("sightglass", "sightglass: 1\n" + recipe);
  if (!inputs.empty()) image.text.emplace_back("sightglass-inputs", inputs);
  write_image(path, image);
}

test::Ran open(const Place& p, std::vector<std::string> more = {}) {
  std::vector<std::string> args{"open", "pictures/a.png", "-o", "out.png", "--size", "40x30"};
  args.insert(args.end(), more.begin(), more.end());
  return sightglass(args, p.work);
}

}  // namespace

TEST_CASE("recipes: one that would write a file is refused, whichever way it says so, and nothing is written") {
  const Place p("recipe_writes");
  const std::string read = "steps: {a: {read: ../in.vti}}\n";
  for (const std::string show : {
           "show: [{volume: {save: pwned.txt}}]",
           "show: [{volume: {save: ../pwned.txt}}]",
           "show: [{volume: {\" save\": pwned.txt}}]",
           "show: [{volume: {\"save \": pwned.txt}}]",
           "show: [{volume: {save: [pwned.txt]}}]",
           "show: [{volume: {transfer: auto, save: /tmp/sightglass-pwned.txt}}]",
       }) {
    INFO(show);
    put_recipe(p.work + "pictures/a.png", read + show);
    const auto before = test::files_in(p.work), beside = test::files_in(p.work + "pictures");
    const auto r = open(p);
    CHECK(r.status == 2);
    CHECK(contains(r.err, "would write a file"));
    CHECK(contains(r.err, "pwned.txt"));
    CHECK(test::files_in(p.work) == before);
    CHECK(test::files_in(p.work + "pictures") == beside);
    CHECK_FALSE(file_exists("/tmp/sightglass-pwned.txt"));
  }
  // The output that a recipe names is not the user's.
  put_recipe(p.work + "pictures/a.png", read + "picture: {output: ../pwned.png, size: 40x30}");
  CHECK(sightglass({"open", "pictures/a.png"}, p.work).status == 0);
  CHECK_FALSE(file_exists(p.work + "pwned.png"));
  CHECK(file_exists(p.work + "pictures/a-again.png"));
}

TEST_CASE("recipes: they read below the folder of the picture and the working folder, and elsewhere only when the user says so") {
  const Place p("recipe_reads");
  for (const std::string& path :
       {std::string("../../secret/in.vti"), p.secret + "in.vti", p.work + "../secret/in.vti", std::string("../../*/in.vti"),
        std::string("in.vti,../../secret/in.vti"), std::string("../in.vti/../../secret/in.vti")}) {
    INFO(path);
    put_recipe(p.work + "pictures/a.png", "steps: {a: {read: \"" + path + "\"}}");
    const auto r = open(p);
    CHECK(r.status == 2);
    CHECK(contains(r.err, "--read-anywhere"));
    CHECK(contains(r.err, "in.vti"));
    CHECK_FALSE(file_exists(p.work + "out.png"));
  }
  put_recipe(p.work + "pictures/a.png", "steps: {a: {read: ../../secret/in.vti}}");
  CHECK(open(p, {"--read-anywhere"}).status == 0);
  fs::remove(p.work + "out.png");
  for (const std::string& path : {std::string("../in.vti"), p.work + "in.vti"}) {
    put_recipe(p.work + "pictures/a.png", "steps: {a: {read: \"" + path + "\"}}");
    CHECK(open(p).status == 0);
    fs::remove(p.work + "out.png");
  }
  // A link leads out as well.
  fs::create_symlink(p.secret, p.work + "pictures/here");
  put_recipe(p.work + "pictures/a.png", "steps: {a: {read: here/in.vti}}");
  const auto r = open(p);
  CHECK(r.status == 2);
  CHECK(contains(r.err, "here/in.vti"));
}

TEST_CASE("recipes: no parameter and no file that is read leads out") {
  const Place p("recipe_other");
  write_file(p.secret + "map.cpt", "0 0 0 0 1 255 255 255\n");
  write_file(p.secret + "look.yaml", "sightglass-transfer: 1\nopacity: \"0:0,1:1\"\n");
  write_file(p.secret + "ball.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  write_file(p.secret + "b.bval", "0 1000\n");
  write_file(p.work + "out.vtm",
             "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><DataSet index=\"0\" file=\"" + p.secret +
                 "in.vti\"/></vtkMultiBlockDataSet></VTKFile>");
  const std::string read = "steps: {a: {read: ../in.vti}";
  for (const std::string& recipe : {
           read + "}\nshow: [{outline: }, {surface: {map: \"" + p.secret + "map.cpt\"}}]",
           read + "}\nshow: [{surface: {map: \"../secret/map.cpt\"}}]",
           read + "}\nshow: [{volume: {transfer: \"../../secret/look.yaml\"}}]",
           read + ", b: {glyphs: {shape: \"" + p.secret + "ball.obj\"}}}",
           read + ", b: {tensor_fit: {bvals: ../../secret/b.bval, bvecs: ../../secret/b.bval}}}",
           std::string("steps: {a: {gradient_images: {path: ../../secret/in.vti}}}"),
           std::string("steps: {a: {read: ../out.vtm}}"),
       }) {
    INFO(recipe);
    put_recipe(p.work + "pictures/a.png", recipe);
    const auto r = open(p);
    CHECK(r.status != 0);
    CHECK(contains(r.err, "--read-anywhere"));
    CHECK(contains(r.err, "secret"));
    CHECK_FALSE(file_exists(p.work + "out.png"));
  }
}

TEST_CASE("recipes: the list of inputs leads to no other file") {
  const Place p("recipe_inputs");
  REQUIRE(::mkfifo((p.work + "pictures/pipe").c_str(), 0600) == 0);
  put_recipe(p.work + "pictures/a.png", "steps: {a: {read: ../in.vti}}",
             "0 xxh3-4m ../../secret/in.vti\n0 xxh3-4m pipe\n0 xxh3-4m /etc/passwd\n0 xxh3-4m ../in.vti\n");
  const auto r = open(p);
  CHECK(r.status == 0);
  CHECK(contains(r.err, "in.vti' has changed since"));
  CHECK_FALSE(contains(r.err, "secret"));
  CHECK_FALSE(contains(r.err, "passwd"));
}

TEST_CASE("recipes: every word is bounded") {
  const Place p("recipe_bounds");
  std::string steps = "steps: {", deep = "steps: ", keys = "steps: {a: {read: ../in.vti}}\npicture: {",
              shows = "steps: {a: {read: ../in.vti}}\nshow: [";
  for (int i = 0; i < 1200; ++i) steps += fmt::format("s{}: {{hydrogen: }}, ", i), shows += "outline, ";
  for (int i = 0; i < 5000; ++i) keys += fmt::format("k{}: 1, ", i);
  for (const std::string& recipe :
       {steps + "}", shows + "]", keys + "}", deep + std::string(100, '[') + std::string(100, ']'),
        "steps: {a: {read: \"" + std::string(300 << 10, 'x') + "\"}}", "steps: {a: {read: " + std::string(2 << 20, 'x') + "}}",
        std::string("steps: &x {a: {read: in.vti}}\nshow: *x"), std::string("steps: {a: {read: !!binary aGk=}}")}) {
    INFO(recipe.substr(0, 80));
    put_recipe(p.work + "pictures/a.png", recipe);
    const auto r = open(p);
    CHECK(r.status == 2);
    CHECK(r.err.size() < 20000);
    CHECK_FALSE(file_exists(p.work + "out.png"));
  }
}

TEST_CASE("recipes: names of fields, files and titles add no structure: render and open make the same picture") {
  const Place p("recipe_names");
  for (const std::string& name : {std::string("a}}, show: [{volume: {save: pwned}}]"), std::string("x\n  - {volume: {save: pwned}}"),
                                  std::string("q\"', save: pwned, \\"), std::string("\x1b[31m\xe9 \xff\xc0\x80"),
                                  std::string(" blank, comma: and # more "), std::string("1,2,3"), std::string("- ? ! & * {t}")}) {
    INFO(printable(name));
    std::string file = "f" + name + ".vtk";
    std::replace(file.begin(), file.end(), '/', '_');
    std::string field = name;
    for (char& c : field)
      if (c == ' ' || c == '\n') c = '_';  // legacy VTK has names without blanks
    std::string text =
        "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 3\nORIGIN 0 0 0\nSPACING 1 1 1\nPOINT_DATA "
        "27\nSCALARS " +
        field + " float 1\nLOOKUP_TABLE default\n";
    for (int i = 0; i < 27; ++i) text += fmt::format("{} ", i * i % 7);
    write_file(p.work + file, text + "\n");
    const auto r = sightglass({"render", file, "--show", "surface", "--title", name, "--size", "80x60", "-o", "pictures/n.png"}, p.work);
    INFO(r.err);
    REQUIRE(r.status == 0);
    const auto again = sightglass({"open", "pictures/n.png", "-o", "m.png"}, p.work);
    INFO(again.err);
    REQUIRE(again.status == 0);
    CHECK(MappedFile(p.work + "pictures/n.png").text().size() > 0);
    CHECK(read_png(p.work + "pictures/n.png").pixels == read_png(p.work + "m.png").pixels);
    CHECK_FALSE(file_exists(p.work + "pwned"));
  }
}
