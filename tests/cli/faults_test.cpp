// SPDX-License-Identifier: Apache-2.0
// Full disks, planted links and signals: the old file stays, nothing else is touched, nothing is left.
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <thread>

#include "base/file/file.h"
#include "cli/program.h"
#include "support/test.h"

using namespace sg;
using test::fresh_folder;
using test::sightglass;

namespace {

namespace fs = std::filesystem;

// Every file of a folder with its bytes.
std::map<std::string, std::string> bytes_below(const std::string& folder) {
  std::map<std::string, std::string> r;
  for (const auto& e : fs::recursive_directory_iterator(folder))
    r[e.path().string()] = e.is_regular_file() ? std::string(MappedFile(e.path().string()).text()) : "";
  return r;
}

// What makes a file of each kind that is written, of more than 20 kB.
std::vector<std::vector<std::string>> writers() {
  std::vector<std::vector<std::string>> all;
  const auto add = [&](const std::vector<std::string>& extensions, std::vector<std::string> how) {
    for (const std::string& e : extensions) {
      std::vector<std::string> args = how;
      args.push_back("-o"), args.push_back("out." + e);
      all.push_back(args);
    }
  };
  const std::string source = "hydrogen size=24";
  add({"vti", "nrrd", "mhd", "mha", "nii", "nii.gz", "hdr", "mnc", "dcm", "npy", "vdb", "vtkhdf", "zarr", "pvti", "vtm"},
      {"convert", "--source", source});
  add({"vtu", "pvtu"}, {"convert", "--source", source, "-f", "threshold min=0"});
  add({"ply", "stl", "obj", "vtp", "pvtp", "glb", "gltf"}, {"convert", "--source", source, "-f", "faces"});
  add({"png", "jpg", "webp"}, {"render", "--source", source, "--size", "600x500"});
  return all;
}

// Runs the program in the background.
pid_t start(const std::vector<std::string>& args, const std::string& folder) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  const int nowhere = ::open("/dev/null", O_RDWR);
  if (::chdir(folder.c_str()) != 0 || ::dup2(nowhere, 1) < 0 || ::dup2(nowhere, 2) < 0) ::_exit(126);
  const std::string program = std::string(test::build_folder()) + "/sightglass";
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& a : args) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  ::execv(argv[0], argv.data());
  ::_exit(127);
}

bool wait_until(const std::function<bool()>& there, double seconds) {
  for (double t = 0; t < seconds; t += 0.01) {
    if (there()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return there();
}

// Its status as sh says it; -1 when it still runs after so many seconds (it is killed then).
int status_of(pid_t child, double seconds) {
  int status = 0;
  if (!wait_until([&] { return ::waitpid(child, &status, WNOHANG) == child; }, seconds)) {
    ::kill(child, SIGKILL), ::waitpid(child, &status, 0);
    return -1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

TEST_CASE("full disk: every writer says so, keeps the old file and leaves nothing beside it") {
  for (const auto& args : writers()) {
    INFO(args.back());
    const std::string folder = fresh_folder("full_disk");
    const auto first = sightglass(args, folder);
    if (first.status == 3 && first.err.find("install") != std::string::npos) continue;  // no plug-in here
    INFO(first.err);
    REQUIRE(first.status == 0);
    const auto before = bytes_below(folder);
    const auto r = sightglass(args, folder, 4096);
    INFO(r.err);
    CHECK(r.status == 3);
    CHECK(r.err.find("out") != std::string::npos);
    CHECK(bytes_below(folder) == before);
  }
}

TEST_CASE("full disk: files that belong together are replaced together or not at all") {
  // The header is what does not fit any more, after the numbers.
  const std::vector<std::string> small = {"convert", "--source", "sphere size=4", "-o"}, other = {"convert", "--source", "sphere size=5"};
  const std::string name = std::string(6000, 'n');
  for (const std::string out : {"out.mhd", "out.pvti"}) {
    INFO(out);
    const std::string folder = fresh_folder("together");
    std::vector<std::string> before = small, after = other;
    before.push_back(out);
    after.insert(after.end(), {"-f", "calc expr=x name=" + name, "-f", "select keep=" + name, "-o", out});
    const auto first = sightglass(before, folder);
    INFO(first.err);
    REQUIRE(first.status == 0);
    const auto was = bytes_below(folder);
    const auto r = sightglass(after, folder, 5000);
    INFO(r.err);
    CHECK(r.status == 3);
    CHECK(bytes_below(folder) == was);
    CHECK(sightglass(after, folder).status == 0);  // with room enough it is written
    CHECK(bytes_below(folder) != was);
  }
}

TEST_CASE("temporary files: links planted under the names that were used are not followed, and writers do not share one") {
  const std::string folder = fresh_folder("planted"), victim = folder + "victim";
  write_file(victim, "precious");
  for (const std::string e : {"vdb", "vti", "vtkhdf", "mp4"})
    for (const std::string& tail : {std::string(".partial"), ".partial." + e, ".partial." + e + ".log", std::string(".partial-1-0")})
      fs::create_symlink(victim, folder + "out." + e + tail);
  for (const std::string e : {"vdb", "vti", "vtkhdf"}) {
    std::vector<pid_t> children;
    for (int i = 0; i < 3; ++i) children.push_back(start({"convert", "--source", "hydrogen size=40", "-o", "out." + e}, folder));
    std::vector<int> statuses;
    for (const pid_t c : children) statuses.push_back(status_of(c, 60));
    if (statuses == std::vector<int>{3, 3, 3}) continue;  // no plug-in here
    CHECK(statuses == std::vector<int>{0, 0, 0});
    CHECK(sightglass({"info", "out." + e}, folder).status == 0);
  }
  CHECK(MappedFile(victim).text() == "precious");
  size_t links = 0, files = 0;
  for (const auto& e : fs::directory_iterator(folder)) ++(e.is_symlink() ? links : files);
  CHECK(links == 16);
  CHECK(files <= 4);
}

TEST_CASE("films by ffmpeg: the name that it gets is neither an option nor a protocol, and its files lie in a folder of the user's alone") {
  const std::string folder = fresh_folder("films"), bin = folder + "bin/";
  fs::create_directories(bin);
  write_file(bin + "ffmpeg", "#!/bin/sh\nfor last; do :; done\necho \"$last\" > '" + folder +
                                 "asked'\nls -ld -- \"$(dirname -- \"${last#file:}\")\" >> '" + folder +
                                 "asked'\ncat > \"${last#file:}\"\n");
  fs::permissions(bin + "ffmpeg", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (bin + ":" + path).c_str(), 1);
  for (const std::string name : {"-y.mp4", "http:x.mp4", "pipe:1.mp4", "a b.mp4"}) {
    INFO(name);
    const auto r = sightglass({"render", "--source", "hydrogen size=6", "-f", "contour values={t}", "--times", "0.001,0.002", "--size",
                               "16x16", "--output=" + name},
                              folder);
    INFO(r.err);
    CHECK(r.status == 0);
    CHECK(file_exists(folder + name));
    const std::string asked(MappedFile(folder + "asked").text());
    CHECK(asked.starts_with("file:" + name + ".partial-"));
    CHECK(asked.find("drwx------") != std::string::npos);
    fs::remove(folder + name), fs::remove(folder + "asked");
  }
  ::setenv("PATH", path.c_str(), 1);
  CHECK(test::files_in(folder) == std::vector<std::string>{"bin"});
}

TEST_CASE("signals: work that does not ask is ended after a few seconds, and leaves nothing") {
  const std::string folder = fresh_folder("stuck"), bin = folder + "bin/";
  fs::create_directories(bin);
  write_file(bin + "ffmpeg", "#!/bin/sh\nexec sleep 20\n");  // takes no picture: the program waits for it
  fs::permissions(bin + "ffmpeg", fs::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (bin + ":" + path).c_str(), 1);
  const pid_t child =
      start({"render", "--source", "hydrogen size=6", "-f", "contour values={t}", "--times", "0:1:9", "--size", "600x600", "-o", "a.mp4"},
            folder);
  ::setenv("PATH", path.c_str(), 1);
  REQUIRE(wait_until([&] { return test::files_in(folder).size() > 1; }, 30));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ::kill(child, SIGTERM);
  CHECK(status_of(child, 15) == 128 + SIGTERM);
  CHECK(test::files_in(folder) == std::vector<std::string>{"bin"});
}

TEST_CASE("signals: hang-up and the polite end clean up as Ctrl-C does; a second one ends the program at once") {
  const auto inherited = ::signal(SIGHUP, SIG_DFL);  // whoever runs the tests may have it ignored
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    for (const bool twice : {false, true}) {
      if (twice && signal != SIGINT) continue;
      INFO(signal << (twice ? " twice" : " once"));
      const std::string folder = fresh_folder("signals");
      // Work of some seconds, so that the signal comes while it goes on, however busy the machine is.
      const pid_t child = start({"convert", "--source", "hydrogen size=160", "--compression", "lzma", "-o", "out.vti"}, folder);
      REQUIRE(wait_until([&] { return !fs::is_empty(folder); }, 60));  // it writes
      ::kill(child, signal);
      if (twice) ::kill(child, signal);
      CHECK(status_of(child, 30) == 128 + signal);
      CHECK(fs::is_empty(folder));
    }
  ::signal(SIGHUP, inherited);
  // nohup stays nohup
  const std::string folder = fresh_folder("signals");
  const auto before = ::signal(SIGHUP, SIG_IGN);
  const pid_t child = start({"convert", "--source", "hydrogen size=40", "--compression", "lzma", "-o", "out.vti"}, folder);
  ::signal(SIGHUP, before);
  REQUIRE(wait_until([&] { return !fs::is_empty(folder); }, 60));
  ::kill(child, SIGHUP);
  CHECK(status_of(child, 60) == 0);
  CHECK(file_exists(folder + "out.vti"));
}
