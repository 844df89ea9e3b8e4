// SPDX-License-Identifier: Apache-2.0
#include "base/file/file_fence.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "base/file/file.h"
#include "base/file/partial_file.h"
#include "support/test.h"

using namespace sg;
using test::contains;
using test::fresh_folder;
namespace fs = std::filesystem;

namespace {

size_t entries(const std::string& folder) { return size_t(std::distance(fs::directory_iterator(folder), {})); }

struct NoFence {
  ~NoFence() { remove_file_fence(); }
};

}  // namespace

TEST_CASE("fence: a file names files below its folder, a trusted folder or the working folder, and no others") {
  const std::string top = fresh_folder("named"), here = top + "a/b/";
  fs::create_directories(here);
  const std::string header = here + "h.mhd";
  for (const char* inside : {"x.raw", "sub/x.raw", "./x.raw", "sub/../x.raw", "..x", "a..b", ".../x"})
    CHECK(named_file(header, inside) == here + inside);
  for (const std::string& outside : {std::string("../x.raw"), std::string("sub/../../x.raw"), std::string(".."), top + "x.raw",
                                     here + "x.raw", std::string("/etc/passwd"), std::string("x/../../../../../../../../../etc/passwd")}) {
    INFO(outside);
    const std::string said = test::error_of([&] { named_file(header, outside); });
    CHECK(contains(said, "'" + outside + "'"));
    CHECK(contains(said, "h.mhd"));
    CHECK(contains(said, "--read-anywhere"));
  }
  CHECK_THROWS_AS(named_file(header, std::string("a\0b", 3)), Error);
  trust_folder_of(top + "a/all.vtm");  // what the user named leads here
  CHECK(named_file(header, "../x.raw") == here + "../x.raw");
  CHECK_THROWS_AS(named_file(header, "../../x.raw"), Error);
  CHECK(named_file("h.mhd", "x/y.raw") == "x/y.raw");  // the working folder
  CHECK_THROWS_AS(named_file("h.mhd", "../y.raw"), Error);
  ::setenv("SIGHTGLASS_READ_ANYWHERE", "1", 1);
  CHECK(named_file(header, "/etc/passwd") == "/etc/passwd");
  ::unsetenv("SIGHTGLASS_READ_ANYWHERE");
}

TEST_CASE("fence: inside it nothing else is read, listed or written, through links neither") {
  const NoFence after;
  const std::string top = fresh_folder("fenced"), in = fresh_folder("fenced/in"), out = fresh_folder("fenced/out");
  write_file(in + "a", "a"), write_file(out + "b", "b");
  fs::create_symlink(out + "b", in + "link");
  fs::create_symlink(out, in + "folder");
  set_file_fence({{in}, {top + "result"}, "the recipe"});
  CHECK(MappedFile(in + "a").text() == "a");
  for (const std::string& path : {out + "b", in + "link", in + "folder/b", in + "../out/b", std::string("/etc/passwd"), out + "missing"}) {
    INFO(path);
    CHECK(contains(test::error_of([&] { MappedFile{path}; }), "the recipe may not read it"));
  }
  CHECK_THROWS_AS(folder_entries(out), Error);
  CHECK_NOTHROW(folder_entries(in));
  CHECK(contains(test::error_of([&] { write_file(in + "c", "c"); }), "the recipe may not write it"));
  CHECK_THROWS_AS(PartialFile{in + "c"}, Error);
  write_file(top + "result", "r");
  set_file_fence({{"/"}, {}, "the recipe"});  // the root is no fence
  CHECK_THROWS_AS(MappedFile{in + "a"}, Error);
  remove_file_fence();
  CHECK(entries(in) == 3);
}

TEST_CASE("file: a pipe or a device is refused at once, for reading and for writing") {
  const std::string folder = fresh_folder("pipes"), pipe = folder + "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK(contains(test::error_of([&] { MappedFile{pipe}; }), "is a pipe, not a file"));
  CHECK(contains(test::error_of([] { MappedFile{"/dev/zero"}; }), "is a device, not a file"));
  CHECK(contains(test::error_of([&] { write_file(pipe, "x"); }), "not a file"));
  CHECK(contains(test::error_of([&] { PartialFile{pipe}; }), "not a file"));
  CHECK_FALSE(is_plain_file(pipe));
  CHECK(entries(folder) == 1);
}

TEST_CASE("file: temporary names cannot be foreseen, are new, and are never too long") {
  const std::string folder = fresh_folder("partials"), path = folder + "out.vdb";
  CHECK(partial_name(path) != partial_name(path));
  std::string a, b;
  const int fa = create_partial(path, a), fb = create_partial(path, b);
  CHECK(a != b);
  struct stat st {};
  REQUIRE(::stat(a.c_str(), &st) == 0);
  const mode_t mask = ::umask(0);
  ::umask(mask);
  CHECK((st.st_mode & 0777) == (0666 & ~mask));
  ::close(fa), ::close(fb);
  remove_partials_at_exit();  // as a second Ctrl-C does
  CHECK(entries(folder) == 0);
  forget_partial(a), forget_partial(b);
  write_file(folder + std::string(255, 'n'), "long");
  CHECK(entries(folder) == 1);
}

TEST_CASE("file: a place for writers that open by name is the user's alone, and becomes the file or goes") {
  const std::string folder = fresh_folder("partial_file"), path = folder + "out.mp4";
  {
    PartialFile f(path);
    struct stat st {};
    REQUIRE(::stat(f.folder().c_str(), &st) == 0);
    CHECK((st.st_mode & 0777) == 0700);
    CHECK(extension_of(f.name()) == "mp4");
    write_file(f.name(), "half"), write_file(f.folder() + "log", "said");
  }
  CHECK(entries(folder) == 0);
  {
    PartialFile f(path), g(path);
    CHECK_THROWS_AS(g.commit(), Error);  // nothing was written
    write_file(f.name(), "whole");
    f.commit();
  }
  CHECK(entries(folder) == 1);
  CHECK(MappedFile(path).text() == "whole");
}
