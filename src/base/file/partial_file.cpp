// SPDX-License-Identifier: Apache-2.0
#include "base/file/partial_file.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/file/mapped_watch.h"

namespace sg {

namespace {

constexpr int attempts = 100;
constexpr size_t longest_name = 255, added = 25;  // ".partial-" and 16 digits

[[noreturn]] void fail_to_make(int error, const std::string& path) {
  if (error == ENOENT) fail_data("cannot be written: the folder does not exist", path, "create the folder first");
  fail_data(std::string("cannot be written: ") + std::strerror(error ? error : EIO), path);
}

// What a signal handler may touch: names copied into fixed places, taken and given back one by one.
struct Slot {
  std::atomic<int> state{0};  // 0 free, 1 being changed, 2 holds a name
  pid_t owner = 0;
  char name[4096];
};
std::array<Slot, 64> slots;
std::atomic<int> cleaning{0};

}  // namespace

std::string partial_name(const std::string& path) {
  uint64_t bits = 0;
  if (::getrandom(&bits, sizeof bits, 0) != ssize_t(sizeof bits)) fail_data("no random numbers are available for a temporary name", path);
  const std::string name = file_name_of(path);
  return fmt::format("{}{}.partial-{:016x}", folder_of(path), name.substr(0, longest_name - added), bits);
}

int create_partial(const std::string& path, std::string& partial) {
  check_may_write(path);
  struct stat st {};
  if (::stat(path.c_str(), &st) == 0) {
    if (S_ISDIR(st.st_mode)) fail_data("cannot be written: it is a folder", path);
    if (!S_ISREG(st.st_mode)) fail_data("cannot be written: it is a device or a pipe, not a file", path, "name a file");
  }
  for (int i = 0; i < attempts; ++i) {
    partial = partial_name(path);
    const int fd = ::open(partial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd >= 0) return remember_partial(partial), fd;
    if (errno != EEXIST) break;
  }
  fail_to_make(errno, path);
}

std::string make_partial_folder(const std::string& path, bool own) {
  check_may_write(path);
  for (int i = 0; i < attempts; ++i) {
    std::string folder = partial_name(path);
    if (::mkdir(folder.c_str(), own ? 0700 : 0777) == 0) return folder;
    if (errno != EEXIST) break;
  }
  fail_to_make(errno, path);
}

void remember_partial(const std::string& partial) noexcept {
  if (partial.size() >= sizeof Slot::name) return;
  for (Slot& s : slots) {
    int free = 0;
    if (!s.state.compare_exchange_strong(free, 1)) continue;
    std::memcpy(s.name, partial.c_str(), partial.size() + 1);
    s.owner = ::getpid();
    s.state = 2;
    return;
  }
}

void forget_partial(const std::string& partial) noexcept {
  for (Slot& s : slots) {
    int holds = 2;
    if (!s.state.compare_exchange_strong(holds, 1)) continue;
    s.state = partial == s.name ? 0 : 2;
  }
}

void remove_partials_at_exit() noexcept {
  for (const bool folders : {false, true})  // a folder goes after what is in it
    for (Slot& s : slots)
      if (s.state == 2 && s.owner == ::getpid()) folders ? ::rmdir(s.name) : ::unlink(s.name);
}

CleaningUp::CleaningUp() noexcept { ++cleaning; }
CleaningUp::~CleaningUp() { --cleaning; }
bool CleaningUp::any() noexcept { return cleaning > 0; }

PartialFile::PartialFile(const std::string& path) : path_(path) {
  struct stat st {};
  if (::stat(path.c_str(), &st) == 0) {
    if (S_ISDIR(st.st_mode)) fail_data("cannot be written: it is a folder", path);
    if (!S_ISREG(st.st_mode)) fail_data("cannot be written: it is a device or a pipe, not a file", path, "name a file");
  }
  const std::string folder = make_partial_folder(path, true);
  folder_ = folder + "/";
  const std::string ext = extension_of(path);
  name_ = folder_ + (ext.empty() ? "file" : "file." + ext);
  remember_partial(folder);
  remember_partial(name_);
}

PartialFile::~PartialFile() {
  const CleaningUp busy;
  std::error_code ignored;
  forget_partial(name_), forget_partial(folder_.substr(0, folder_.size() - 1));
  std::filesystem::remove_all(folder_, ignored);
}

void PartialFile::commit() {
  check_files_unchanged();  // nothing is kept that was made of half a file
  struct stat st {};
  if (::stat(name_.c_str(), &st) != 0) fail_data("cannot be written: no data was written", path_);
  if (::rename(name_.c_str(), path_.c_str()) != 0) fail_data(std::string("cannot be written: ") + std::strerror(errno), path_);
}

}  // namespace sg
