// SPDX-License-Identifier: Apache-2.0
// Volumes larger than the memory allowed (an eighth of their numbers), as a user draws them: seconds to the first picture and to the
// final one, from a warm file, and peak memory.
#include <fmt/core.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "bench.h"

namespace sg::bench {

namespace {

std::string volume_path(const std::string& folder, int size) { return fmt::format("{}/tangle_{}.ome.zarr", folder, size); }

// 16 GiB within 2 GiB.
std::string memory_for(int size) {
  const double bytes = 4.0 * size * size * size;
  return fmt::format("{:.0f}M", std::max(48.0, bytes / 8 / 1048576));
}

}  // namespace

void make_large_volume(const std::string& folder, const std::string& program, int size) {
  if (size < 65 || size > 4096)
    fail_usage(fmt::format("{} samples along each axis", size), "--large", "from 65 to 4096; 1625 makes 16 GiB");
  const std::string path = volume_path(folder, size);
  if (file_exists(path)) return;
  const std::string command = fmt::format("tangle size={}", size), memory = memory_for(size);
  const char* argv[] = {program.c_str(), "convert", "-q", "-s", command.c_str(), "-o", path.c_str(), "--memory", memory.c_str(), nullptr};
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(argv[0], const_cast<char**>(argv));
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail_data("could not be made", path);
}

std::vector<ProcessTask> volume_large_tasks(const std::string& folder, const std::string& program, int size) {
  const std::string png = folder + "/large.png", text = fmt::format("float32 {}^3, 1024x1024", size);
  const auto command = [&](const char* look, std::vector<std::string> more) {
    std::vector<std::string> c = {
        program, "render", volume_path(folder, size), "--memory", memory_for(size), "--show", look, "--size", "1024x1024", "-q", "-o", png};
    c.insert(c.end(), more.begin(), more.end());
    return c;
  };
  return {{"volume_large_first", text, "sightglass --progressive, fog", command("volume", {"--progressive"}), png, true},
          {"volume_large_first", text, "sightglass --progressive, surfaces",
           command("volume opacity=@-6:0,@-4:0.6,@-2:0", {"--progressive"}), png, true},
          {"volume_large_within", text, "sightglass --within 2s, fog", command("volume", {"--within", "2s"}), png},
          {"volume_large_final", text, "sightglass, fog", command("volume", {}), png},
          {"volume_large_final", text, "sightglass, surfaces", command("volume opacity=@-6:0,@-4:0.6,@-2:0", {}), png}};
}

}  // namespace sg::bench
