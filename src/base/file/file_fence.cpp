// SPDX-License-Identifier: Apache-2.0
#include "base/file/file_fence.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/file/file.h"

namespace sg {

namespace {

namespace fs = std::filesystem;

constexpr const char* variable = "SIGHTGLASS_READ_ANYWHERE";
constexpr const char* way_out = "if that is intended, use --read-anywhere";

std::optional<FileFence> fence;
std::mutex trusted_mutex;
std::set<std::string> trusted;

bool anywhere() {
  const char* set = std::getenv(variable);
  return set && std::string_view(set) == "1";
}

// Absolute, without "." and "..", and with a '/' at the end; "" when it is unknown or the root: all lies below that.
std::string folder_text(const fs::path& path) {
  std::string text = path.lexically_normal().string();
  if (text.empty() || text[0] != '/') return "";
  if (text.back() != '/') text += '/';
  return text == "/" ? "" : text;
}

std::string absolute_folder(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::absolute(folder.empty() ? "." : folder, error);
  return error ? "" : folder_text(path);
}

std::string real_folder(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(folder.empty() ? "." : folder, error);
  return error ? "" : folder_text(path);
}

bool below(const std::string& path, const std::string& folder) { return !folder.empty() && path.starts_with(folder); }

}  // namespace

void allow_reading_anywhere() { ::setenv(variable, "1", 1); }

void trust_folder_of(const std::string& path) {
  std::string folder = absolute_folder(folder_of(path));
  if (folder.empty()) return;
  const std::lock_guard lock(trusted_mutex);
  trusted.insert(std::move(folder));
}

namespace {

enum class By { file, recipe };

std::string checked_file(std::string_view beside, std::string_view name, By by) {
  std::string path = path_beside(beside, name);
  const bool plain = !name.empty() && name[0] != '/' && name.find("..") == name.npos && name.find('\0') == name.npos;
  if (plain || anywhere()) return path;  // the quick way: a header may name a million files
  if (name.find('\0') != name.npos) fail_data("names a file with a zero byte in its name", std::string(beside));
  if (!name.empty() && name[0] == '/' && by == By::file)
    fail_data(fmt::format("names the file '{}' by an absolute path, which is not allowed", name), std::string(beside), way_out);
  const std::string at = folder_text(fs::path(absolute_folder(folder_of(beside))) / name);
  if (below(at, absolute_folder(folder_of(beside))) || below(at, absolute_folder(""))) return path;
  const std::lock_guard lock(trusted_mutex);
  for (const std::string& folder : trusted)
    if (by == By::file && below(at, folder)) return path;
  fail_data(fmt::format("names the file '{}', which lies neither below its own folder nor below the working folder", name),
            std::string(beside), way_out);
}

}  // namespace

std::string named_file(std::string_view beside, std::string_view name) { return checked_file(beside, name, By::file); }
std::string file_of_recipe(std::string_view picture, std::string_view name) { return checked_file(picture, name, By::recipe); }

void set_file_fence(FileFence f) {
  for (std::string& folder : f.read_below) folder = real_folder(folder);
  fence = std::move(f);
}
void remove_file_fence() { fence.reset(); }

void check_may_read(const std::string& path) {
  if (!fence || anywhere()) return;
  const std::string at = real_folder(path);
  for (const std::string& folder : fence->read_below)
    if (below(at, folder)) return;
  fail_data(fmt::format("{} may not read it: it lies neither below the picture's folder nor below the working folder", fence->who), path,
            way_out);
}

void check_may_write(const std::string& path) {
  if (!fence || std::find(fence->write.begin(), fence->write.end(), path) != fence->write.end()) return;
  fail_data(fmt::format("{} may not write it: a recipe may write only its picture", fence->who), path, "give the output with -o");
}

int open_plain_file(const std::string& path) {
  check_may_read(path);
  // Not to wait: a pipe would block the program until someone writes to it. Looked at twice, so that no device is opened and none can slip
  // in.
  struct stat st {};
  int fd = -1;
  const bool there = ::stat(path.c_str(), &st) == 0;
  if (!there || S_ISREG(st.st_mode) || S_ISDIR(st.st_mode)) fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0 && (!there || S_ISREG(st.st_mode) || S_ISDIR(st.st_mode)))
    fail_data(errno == ENOENT ? "no such file" : std::string("cannot open the file: ") + std::strerror(errno), path);
  if (fd >= 0 && ::fstat(fd, &st) == 0 && S_ISREG(st.st_mode)) return fd;
  if (fd >= 0) ::close(fd);
  if (S_ISDIR(st.st_mode)) fail_data("is a folder, not a file", path, "name a file inside it");
  fail_data(S_ISFIFO(st.st_mode) ? "is a pipe, not a file" : "is a device, not a file", path, "save its data to a file first");
}

bool is_plain_file(const std::string& path) {
  struct stat st {};
  return ::stat(path.c_str(), &st) == 0 && S_ISREG(st.st_mode);
}

}  // namespace sg
