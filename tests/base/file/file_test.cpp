// SPDX-License-Identifier: Apache-2.0
#include "base/file/file.h"

#include <dirent.h>
#include <sys/resource.h>

#include <csignal>

#include "support/test.h"

using namespace sg;
using test::fresh_folder;

namespace {
int files_in(const std::string& folder) {
  int n = 0;
  DIR* d = ::opendir(folder.c_str());
  REQUIRE(d);
  while (const dirent* e = ::readdir(d)) n += e->d_name[0] != '.';
  ::closedir(d);
  return n;
}
}  // namespace

TEST_CASE("file: what is written is read back, and the mapping outlives its file object") {
  const std::string path = test::temp_folder() + "a.bin";
  write_file(path, std::string("a\0b", 3));
  std::shared_ptr<const void> owner;
  std::string_view text;
  {
    const MappedFile f(path);
    CHECK(f.size() == 3);
    CHECK(f.path() == path);
    text = f.text();
    owner = f.owner();
  }
  CHECK(text == std::string_view("a\0b", 3));
  write_file(path, "");
  CHECK(MappedFile(path).size() == 0);
  CHECK(file_exists(path));
}

TEST_CASE("file: errors of reading name the path") {
  CHECK(test::error_of([] { MappedFile("/nowhere/at/all"); }) == "/nowhere/at/all: no such file");
  CHECK(test::error_of([] { MappedFile{test::temp_folder()}; }).find("is a folder, not a file") != std::string::npos);
}

TEST_CASE("file: without commit nothing is left, and the old file stays") {
  const std::string folder = fresh_folder("atomic"), path = folder + "out.txt";
  write_file(path, "old");
  {
    AtomicFile f(path);
    f.write("new, but");
    CHECK(f.position() == 8);
    CHECK(files_in(folder) == 2);
  }
  CHECK(files_in(folder) == 1);
  CHECK(MappedFile(path).text() == "old");
  {
    AtomicFile a(path), b(path);  // two writers of one path do not mix
    a.write("aaaa");
    b.write("bb");
    a.commit();
    b.commit();
  }
  CHECK(MappedFile(path).text() == "bb");
  CHECK(files_in(folder) == 1);
}

TEST_CASE("file: errors of writing say what to do, and leave nothing") {
  CHECK(test::error_of([] { write_file("/nowhere/at/all.txt", "x"); }) ==
        "/nowhere/at/all.txt: cannot be written: the folder does not exist; create the folder first");
  const std::string folder = fresh_folder("write_errors");
  CHECK(test::error_of([&] { write_file(test::temp_folder() + "write_errors", "x"); }).find("it is a folder") != std::string::npos);
  CHECK(files_in(folder) == 0);
  CHECK(files_in(test::temp_folder()) >= 1);
}

TEST_CASE("file: a disk that takes no more is an error, and leaves the old file") {
  const std::string folder = fresh_folder("full"), path = folder + "out";
  write_file(path, "old");
  struct rlimit before {};
  REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG
  struct rlimit small = before;
  small.rlim_cur = 4096;
  REQUIRE(::setrlimit(RLIMIT_FSIZE, &small) == 0);
  std::string error;
  try {
    write_file(path, std::string(1 << 20, 'x'));
  } catch (const Error& e) {
    error = e.what();
  }
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  CHECK(error.find(path + ": write failed: ") == 0);
  CHECK(files_in(folder) == 1);
  CHECK(MappedFile(path).text() == "old");
}

TEST_CASE("file: parts of paths") {
  CHECK(folder_of("/a/b/c.vti") == "/a/b/");
  CHECK(folder_of("c.vti").empty());
  CHECK(file_name_of("/a/b/c.vti") == "c.vti");
  CHECK(file_name_of("/a/b/").empty());
  CHECK(extension_of("/a.b/c.VTI") == "vti");
  CHECK(extension_of("/a.b/c").empty());
  CHECK(extension_of(".hidden").empty());
  CHECK(extension_of("x.tar.gz") == "gz");
  CHECK(path_beside("/a/p.yaml", "in.vti") == "/a/in.vti");
  CHECK(path_beside("/a/p.yaml", "/b/in.vti") == "/b/in.vti");
  CHECK(path_beside("p.yaml", "in.vti") == "in.vti");
  CHECK(path_beside("", "in.vti") == "in.vti");
}
