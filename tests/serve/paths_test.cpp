// SPDX-License-Identifier: Apache-2.0
// Names below the served folder, and the ways out of it.
#include <sys/stat.h>
#include <unistd.h>

#include "base/file/file.h"
#include "base/text/json.h"
#include "serve/files/series_groups.h"
#include "serve/files/served_folder.h"
#include "serve/guard/confined_path.h"
#include "support/test.h"

namespace sg {

using namespace serve;
using test::contains;
using test::error_of;

namespace {

const char* small_grid = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 1 1\n";

// served/ with what may be seen, and secret/ beside it with what may not.
std::string make_served(const std::string& name) {
  const std::string top = test::fresh_folder(name), served = top + "served/";
  for (const std::string& folder : {served, served + "sub", served + ".hidden", served + "run1", top + "secret"})
    ::mkdir(folder.c_str(), 0755);
  for (const std::string& file :
       {served + "a.vtk", served + "sub/b c.vtk", served + ".hidden/c.vtk", served + ".d.vtk", top + "secret/s.vtk",
        served + "named_by_content", served + "run1/t1.vtk", served + "run1/t2.vtk", served + "run1/t10.vtk"})
    write_file(file, small_grid);
  write_file(served + "notes", "words");
  CHECK(::symlink("../secret/s.vtk", (served + "link.vtk").c_str()) == 0);
  CHECK(::symlink("../secret", (served + "way").c_str()) == 0);
  CHECK(::symlink("a.vtk", (served + "inner.vtk").c_str()) == 0);
  CHECK(::mkfifo((served + "pipe.vtk").c_str(), 0600) == 0);
  return served;
}

}  // namespace

TEST_CASE("confined names: parts of plain names, and no other spelling") {
  CHECK(confined_parts("a/b c/d.vti") == std::vector<std::string>{"a", "b c", "d.vti"});
  CHECK(confined_parts("Gr\xc3\xbc\xc3\x9f"
                       "e%2e..vti")
            .size() == 1);
  const std::string spellings[] = {"",
                                   "/",
                                   "/etc/passwd",
                                   "..",
                                   "../a",
                                   "a/..",
                                   "a/../b",
                                   ".",
                                   "./a",
                                   "a/./b",
                                   "a//b",
                                   "a/",
                                   "//a",
                                   "..\\a",
                                   "a\\..\\b",
                                   std::string("a\0b", 3),
                                   "a\nb",
                                   "\xc0\xae.",
                                   "\xc0\xaf",
                                   "\xe0\x80\xaf",
                                   "\xff",
                                   ".hidden/a",
                                   "a/.hidden",
                                   "...",
                                   "a\x7f",
                                   "\xe2\x80\xae"
                                   "a"};
  for (const std::string& name : spellings) CHECK_MESSAGE(!error_of([&] { confined_parts(name); }).empty(), name);
  CHECK(contains(error_of([] { confined_parts(std::string(5000, 'a')); }), "too long"));
  std::string deep = "a";
  for (int i = 0; i < 64; ++i) deep += "/a";
  CHECK(contains(error_of([&] { confined_parts(deep); }), "too many folders"));
}

TEST_CASE("the served folder: files are found, links and pipes are not, wherever they stand") {
  const std::string served = make_served("confined");
  const ConfinedFolder folder(served);
  CHECK(folder.find("a.vtk").path == folder.path() + "/a.vtk");
  CHECK(folder.find("a.vtk").bytes == std::string(small_grid).size());
  CHECK(folder.find("sub/b c.vtk").kind == Inside::file);
  CHECK(folder.find("sub").kind == Inside::folder);
  CHECK(folder.find("").path == folder.path());
  CHECK(contains(error_of([&] { folder.find("link.vtk"); }), "'link.vtk' is a symbolic link"));
  CHECK(contains(error_of([&] { folder.find("inner.vtk"); }), "symbolic link"));
  CHECK(contains(error_of([&] { folder.find("way"); }), "symbolic link"));
  CHECK(contains(error_of([&] { folder.find("way/s.vtk"); }), "symbolic link"));
  CHECK(contains(error_of([&] { folder.find("pipe.vtk"); }), "neither a file nor a folder"));
  CHECK(contains(error_of([&] { folder.find("a.vtk/b"); }), "is not there"));
  CHECK(contains(error_of([&] { folder.find("none"); }), "is not there"));
  // Where the folder lies is nobody's business.
  CHECK_FALSE(contains(error_of([&] { folder.find("none"); }), folder.path()));
  CHECK(contains(error_of([&] { ConfinedFolder("/"); }), "is not served"));
  CHECK(contains(error_of([&] { ConfinedFolder(served + "none"); }), "no such folder"));
}

TEST_CASE("the served folder: may itself be reached by a link") {
  const std::string served = make_served("confined_link");
  const std::string link = test::fresh_folder("confined_by") + "link";
  REQUIRE(::symlink(served.c_str(), link.c_str()) == 0);
  CHECK(ConfinedFolder(link).find("a.vtk").path == ConfinedFolder(served).path() + "/a.vtk");
}

TEST_CASE("the list of files: what readers take, numbered files as a series, nothing hidden, no links") {
  const ServedFolder folder(make_served("listed"));
  CHECK(
      folder.list_json("") ==
      R"({"folders":["run1","sub"],"files":[{"name":"a.vtk","bytes":105,"series":1},{"name":"named_by_content","bytes":105,"series":1}],"more":false})");
  CHECK(folder.list_json("run1") == R"({"folders":[],"files":[{"name":"t{n}.vtk","bytes":315,"series":3}],"more":false})");
  CHECK(folder.list_json("sub") == R"({"folders":[],"files":[{"name":"b c.vtk","bytes":105,"series":1}],"more":false})");
  for (const char* name : {"..", "way", ".hidden", "a.vtk", "none"})
    CHECK_MESSAGE(!error_of([&] { folder.list_json(name); }).empty(), name);
  CHECK(folder.to_open("run1/t{n}.vtk") == folder.path() + "/run1/t{n}.vtk");
  CHECK(folder.to_open("sub") == folder.path() + "/sub");
  for (const char* name : {"", "../secret/s.vtk", "link.vtk", "t{n}.vtk", "run1/../a.vtk", "*.vtk", "run?/t1.vtk", "run{n}/t{n}.vtk",
                           "a.vtk,../secret/s.vtk", "run1/{n}{n}.vtk", "/etc/passwd"})
    CHECK_MESSAGE(!error_of([&] { folder.to_open(name); }).empty(), name);
}

TEST_CASE("the list of files: a series with a link among its files is not opened as one") {
  const std::string served = make_served("linked_series");
  const ServedFolder folder(served);
  CHECK(folder.to_open("run1/t{n}.vtk") == folder.path() + "/run1/t{n}.vtk");
  REQUIRE(::symlink("../../secret/s.vtk", (served + "run1/t11.vtk").c_str()) == 0);
  CHECK(contains(error_of([&] { folder.to_open("run1/t{n}.vtk"); }), "symbolic link"));
}

TEST_CASE("the list of files: folders that mean something in names of series open no series") {
  const std::string top = test::fresh_folder("pattern_folder") + "a*b/";
  ::mkdir(top.c_str(), 0755);
  for (const char* name : {"t1.vtk", "t2.vtk", "t3.vtk"}) write_file(top + name, small_grid);
  const ServedFolder folder(top);
  CHECK(contains(error_of([&] { folder.to_open("t{n}.vtk"); }), "cannot be opened as a series"));
  CHECK(folder.to_open("t1.vtk") == folder.path() + "/t1.vtk");
}

TEST_CASE("series: by the last whole number of a name, not of its extension, from three files on") {
  const auto grouped = [](std::vector<std::string> names) {
    std::vector<ConfinedFolder::Entry> files;
    for (auto& name : names) files.push_back({std::move(name), Inside::file, 10});
    std::string out;
    for (const ListedFile& f : grouped_as_series(files))
      out += f.name + ":" + std::to_string(f.series) + ":" + std::to_string(f.bytes) + " ";
    return out;
  };
  CHECK(grouped({"a.vtk", "f1.vtk", "f2.vtk", "f10.vtk", "g1.vtk", "g2.vtk"}) == "a.vtk:1:10 f{n}.vtk:3:30 g1.vtk:1:10 g2.vtk:1:10 ");
  CHECK(grouped({"r1_t001.vtu", "r1_t002.vtu", "r1_t003.vtu", "r2_t001.vtu"}) == "r1_t{n}.vtu:3:30 r2_t001.vtu:1:10 ");
  CHECK(grouped({"a.h5", "b.h5", "c.h5"}) == "a.h5:1:10 b.h5:1:10 c.h5:1:10 ");
  CHECK(grouped({"case.001", "case.002", "case.003"}) == "case.{n}:3:30 ");
  CHECK(grouped({"a,1.vtk", "a,2.vtk", "a,3.vtk"}) == "a,1.vtk:1:10 a,2.vtk:1:10 a,3.vtk:1:10 ");
  CHECK(grouped({}).empty());
}

}  // namespace sg
