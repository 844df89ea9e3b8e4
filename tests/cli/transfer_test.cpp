// SPDX-License-Identifier: Apache-2.0
// Transfer functions from the command line: repeated by the recipe, saved and loaded, explained.
#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::bytes_of;
using test::contains;
using test::must;
using test::sightglass;

namespace {

std::string path_of(const std::string& name) { return test::temp_folder() + name; }

std::vector<std::string> render(const std::string& show, const std::string& out) {
  return {"render", "transfer.vti", "--show", show, "--size", "240x180", "-o", out};
}

}  // namespace

TEST_CASE("transfer functions: a recipe with a preset, a second axis, widgets or stops repeats the picture byte for byte") {
  must({"convert", "--source", "hydrogen size=24", "-o", "transfer.vti"});
  for (const std::string show : {
           "volume preset=mr",
           "volume preset=ct_bone specular=0.5",
           "volume second=gradient 'second_opacity=0:0,0.3:1' 'opacity=0:0,@0.00002:0.3,1:0.8'",
           "volume 'widgets=triangle 0.1 0.4 0 1 0.7 tomato; rectangle @0.00001 @0.00009 0 0.5 0.3'",
           "volume 'widgets=ellipse 0.1 0.4 0 1 0.7 tomato; paint 0.05:0.1 @0.00001,0.5 0.3,0.2 0.6,0.8 0.3'",
           "volume 'colors=0:#000000,0.4:#aa3311,1:white' transfer=boundaries",
           "volume 'clip=1,0,0,0; box -5,5,-5,5,-5,5'",
       }) {
    INFO(show);
    must(render(show, "a.png"));
    must({"open", "a.png", "-o", "b.png"});
    CHECK(bytes_of("a.png") == bytes_of("b.png"));
    const auto recipe = must({"open", "a.png", "--recipe"}).out;
    write_file(path_of("recipe.yaml"), recipe);
    must({"run", "recipe.yaml", "-o", "c.png"});
    CHECK(bytes_of("a.png") == bytes_of("c.png"));
  }
}

TEST_CASE("transfer functions: saved to a file and loaded, they make the same pixels; the recipe needs no file") {
  must({"convert", "--source", "hydrogen size=24", "-o", "transfer.vti"});
  must(render(
      "volume 'opacity=0:0,0.3:0.2,1:0.6' 'colors=0:#000000,0.5:#804020,1:#ffffff' second=gradient shaded=false unit=0.5 save=look.yaml",
      "a.png"));
  const std::string text = bytes_of("look.yaml");
  CHECK(text.starts_with("sightglass-transfer: 1\n"));
  CHECK(contains(text, "second: gradient"));
  CHECK(contains(text, "unit: 0.5"));
  CHECK_FALSE(contains(must({"open", "a.png", "--recipe"}).out, "save"));  // to look again writes nothing
  must(render("volume transfer=look.yaml save=again.yaml", "b.png"));
  CHECK(bytes_of("again.yaml") == text);
  const auto recipe = must({"open", "b.png", "--recipe"}).out;
  CHECK(contains(recipe, "second: gradient"));
  CHECK_FALSE(contains(recipe, "look.yaml"));
  write_file(path_of("look.yaml"), "gone");
  must({"open", "b.png", "-o", "c.png"});
  CHECK(bytes_of("b.png") == bytes_of("c.png"));
  // Stated words win over the file's.
  must(render("volume transfer=again.yaml shaded=true save=third.yaml", "d.png"));
  CHECK(contains(bytes_of("third.yaml"), "shaded: true") + contains(bytes_of("third.yaml"), "shaded: \"true\"") == 1);
}

TEST_CASE("transfer functions: files that are none are refused with the line") {
  must({"convert", "--source", "hydrogen size=8", "-o", "transfer.vti"});
  const auto refused = [&](const std::string& text) {
    write_file(path_of("bad.yaml"), text);
    const auto r = sightglass(render("volume transfer=bad.yaml", "a.png"));
    CHECK(r.status == 2);
    return r.err;
  };
  CHECK(contains(refused("opacity: '0:0,1:1'\n"), "sightglass-transfer: 1"));
  CHECK(contains(refused("sightglass-transfer: 2\n"), "version '2'"));
  CHECK(contains(refused("sightglass-transfer: 1\nopacitty: 0.5\n"), "did you mean 'opacity'"));
  CHECK(contains(refused("sightglass-transfer: 1\nopacitty: 0.5\n"), "line 2"));
  CHECK(contains(refused("sightglass-transfer: 1\nopacity: '0:0,1:3'\n"), "not between 0 and 1"));
  CHECK(contains(refused("sightglass-transfer: 1\nopacity: {0: 1}\n"), "holds a map"));
  CHECK(contains(refused("sightglass-transfer: 1\ntransfer: other.yaml\n"), "names another file"));
  CHECK(contains(refused("- 1\n"), "is not a transfer function"));
  CHECK(contains(refused("{"), "bad.yaml"));
  const std::string list = "sightglass-transfer: 1\nopacity: ['0:0', '@0.00002:0.25', '1:0.5']\nlevels: [0.00001, 0.00002]\n";
  write_file(path_of("list.yaml"), list);
  must(render("volume transfer=list.yaml", "a.png"));
  // Cut anywhere it is read or refused, never a crash.
  for (size_t n = 0; n < list.size(); ++n) {
    write_file(path_of("cut.yaml"), list.substr(0, n));
    if (n % 8) continue;
    const int status = sightglass(render("volume transfer=cut.yaml", "a.png")).status;
    CHECK((status == 0 || status == 2));
  }
  const auto missing = sightglass(render("volume transfer=nowhere.yaml", "a.png"));
  CHECK(missing.status == 3);
  CHECK(contains(missing.err, "nowhere.yaml"));
}

TEST_CASE("transfer functions: what was chosen and why reaches the screen, once") {
  must({"convert", "--source", "hydrogen size=24", "-o", "transfer.vti"});
  CHECK(contains(must(render("volume", "a.png")).err, "values above"));
  CHECK(contains(must(render("volume transfer=boundaries", "a.png")).err, "material bound"));
  CHECK(contains(must(render("volume preset=density", "a.png")).err, "preset density"));
  const auto plain = must({"render", "transfer.vti", "--size", "240x180", "-o", "a.png"});
  const std::string all = plain.out + plain.err;
  const size_t first = all.find("values above");
  CHECK(first != all.npos);
  CHECK(all.find("values above", first + 1) == all.npos);
  const auto bad = sightglass(render("volume preset=mri opacity=0:2 tolerance=0", "a.png"));
  CHECK(bad.status == 2);
  CHECK(contains(bad.err, "tolerance"));
  CHECK(contains(bad.err, "mri"));
}
