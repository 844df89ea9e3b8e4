// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/confined_path.h"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <memory>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/utf8.h"

namespace sg::serve {

namespace {

constexpr size_t most_parts = 64, most_letters = 4096;
constexpr const char* right_names = "name a file below the served folder: a/b.vti";

[[noreturn]] void fail_name(std::string_view name, const char* why) {
  fail_data(fmt::format("'{}' {}", printable(name.substr(0, 200)), why), {}, right_names);
}

bool has_unseen(std::string_view s) {
  for (size_t i = 0; i < s.size();) {
    uint32_t code = 0;
    const size_t length = decode_utf8(s, i, code);
    if (length == 0 || is_control(code) || s[i] == '\\') return true;
    i += length;
  }
  return false;
}

struct CloseFolder {
  void operator()(DIR* dir) const { ::closedir(dir); }
};

}  // namespace

std::vector<std::string> confined_parts(std::string_view name) {
  if (name.size() > most_letters) fail_name(name, "is too long");
  if (has_unseen(name)) fail_name(name, "has signs that names of files may not have here");
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= name.size();) {
    const size_t end = std::min(name.find('/', begin), name.size());
    const std::string_view part = name.substr(begin, end - begin);
    if (part.empty() || part[0] == '.') fail_name(name, "is not plainly below the served folder");
    if (parts.size() == most_parts) fail_name(name, "has too many folders");
    parts.emplace_back(part);
    begin = end + 1;
  }
  return parts;
}

ConfinedFolder::ConfinedFolder(const std::string& folder) {
  const std::unique_ptr<char, void (*)(void*)> real(::realpath(folder.c_str(), nullptr), ::free);
  if (real && std::string_view(real.get()) == "/")
    fail_usage("is not served: all that the system has lies below it", "/", "name a folder of data");
  if (real) root_ = ::open(real.get(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (root_ < 0) fail_usage("there is no such folder that can be read", folder, "name an existing folder to serve");
  path_ = real.get();
}

ConfinedFolder::~ConfinedFolder() { ::close(root_); }

// Part by part, so that no link is followed wherever it stands.
int ConfinedFolder::open_folder(const std::vector<std::string>& parts, size_t count, std::string_view name) const {
  int at = ::openat(root_, ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  for (size_t i = 0; i < count && at >= 0; ++i) {
    const int next = ::openat(at, parts[i].c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    ::close(at);
    at = next;
  }
  if (at < 0) fail_name(name, errno == EACCES ? "may not be read" : "is not there, or a symbolic link leads to it");
  return at;
}

ConfinedFolder::Found ConfinedFolder::find(std::string_view name) const {
  if (name.empty()) return {Inside::folder, path_, 0};
  const std::vector<std::string> parts = confined_parts(name);
  const int folder = open_folder(parts, parts.size() - 1, name);
  struct stat st {};
  const bool there = ::fstatat(folder, parts.back().c_str(), &st, AT_SYMLINK_NOFOLLOW) == 0;
  ::close(folder);
  if (!there) fail_name(name, "is not there");
  if (S_ISLNK(st.st_mode)) fail_name(name, "is a symbolic link");
  if (!S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode)) fail_name(name, "is neither a file nor a folder");
  return {S_ISDIR(st.st_mode) ? Inside::folder : Inside::file, path_ + "/" + std::string(name),
          S_ISREG(st.st_mode) ? size_t(st.st_size) : 0};
}

// f(name, what stands there, without following it) until it returns false.
template <class F>
void ConfinedFolder::for_each_entry(std::string_view name, F&& f) const {
  const std::vector<std::string> parts = name.empty() ? std::vector<std::string>() : confined_parts(name);
  const int fd = open_folder(parts, parts.size(), name);
  const std::unique_ptr<DIR, CloseFolder> dir(::fdopendir(fd));
  if (!dir) {
    ::close(fd);
    fail_name(name, "cannot be listed");
  }
  while (const dirent* entry = ::readdir(dir.get())) {
    struct stat st {};
    if (::fstatat(fd, entry->d_name, &st, AT_SYMLINK_NOFOLLOW) == 0 && !f(std::string_view(entry->d_name), st)) break;
  }
}

std::vector<ConfinedFolder::Entry> ConfinedFolder::list(std::string_view name, size_t most) const {
  std::vector<Entry> entries;
  for_each_entry(name, [&](std::string_view found, const struct stat& st) {
    const bool plain = S_ISREG(st.st_mode), folder = S_ISDIR(st.st_mode);
    if (found[0] == '.' || has_unseen(found) || (!plain && !folder)) return true;
    if (entries.size() == most) return false;
    entries.push_back({std::string(found), folder ? Inside::folder : Inside::file, plain ? size_t(st.st_size) : 0});
    return true;
  });
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return natural_less(a.name, b.name); });
  return entries;
}

size_t ConfinedFolder::count_plain(std::string_view name, const std::function<bool(std::string_view)>& is_meant) const {
  size_t count = 0;
  for_each_entry(name, [&](std::string_view found, const struct stat& st) {
    if (!is_meant(found)) return true;
    if (!S_ISREG(st.st_mode)) fail_name(found, S_ISLNK(st.st_mode) ? "is a symbolic link" : "is no plain file");
    ++count;
    return true;
  });
  return count;
}

}  // namespace sg::serve
