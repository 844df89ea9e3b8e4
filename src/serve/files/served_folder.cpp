// SPDX-License-Identifier: Apache-2.0
#include "serve/files/served_folder.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/io.h"
#include "serve/files/series_groups.h"

namespace sg::serve {

namespace {

constexpr size_t most_entries = 20'000;
constexpr size_t most_looked_into = 200;  // files without a known extension, folders: each costs opening a file or two

const std::set<std::string, std::less<>>& read_extensions() {
  static const auto all = [] {
    std::set<std::string, std::less<>> out;
    for (const Format& format : formats())
      if (format.read)
        for (const std::string_view extension : words(format.extensions)) out.emplace(extension);
    return out;
  }();
  return all;
}

bool has_read_extension(const std::string& name) {
  const std::string lower = to_lower(name);
  const size_t last = lower.rfind('.');
  if (last == lower.npos) return false;
  const size_t before = last == 0 ? last : lower.rfind('.', last - 1);
  return read_extensions().contains(lower.substr(last + 1)) ||
         (before != lower.npos && read_extensions().contains(lower.substr(before + 1)));
}

// By its first bytes; formats that only a guess would know are left to their extensions.
bool is_known_by_content(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return false;
  std::array<std::byte, 4096> head;
  const ssize_t got = ::read(fd, head.data(), head.size());
  ::close(fd);
  const std::span<const std::byte> bytes(head.data(), got > 0 ? size_t(got) : 0);
  return std::ranges::any_of(formats(), [&](const Format& format) { return format.read && format.sniff && format.sniff(bytes); });
}

bool is_folder_of_data(const std::string& path) {
  for (const Format& format : formats())
    if (format.read && format.sniff_folder && format.sniff_folder(path)) return true;
  return false;
}

bool is_step(std::string_view file, std::string_view front, std::string_view behind) {
  if (file.size() <= front.size() + behind.size() || !file.starts_with(front) || !file.ends_with(behind)) return false;
  const std::string_view number = file.substr(front.size(), file.size() - front.size() - behind.size());
  return number.find_first_not_of("0123456789") == number.npos;
}

std::string below_of(const std::string& below, const std::string& name) { return below.empty() ? name : below + "/" + name; }

}  // namespace

std::string ServedFolder::list_json(const std::string& below) const {
  std::vector<ConfinedFolder::Entry> entries = folder_.list(below, most_entries + 1);
  const bool more = entries.size() > most_entries;
  if (more) entries.pop_back();
  size_t looked_into = 0;
  std::string folders;
  std::vector<ConfinedFolder::Entry> files;
  for (auto& entry : entries) {
    const std::string path = folder_.path() + "/" + below_of(below, entry.name);
    if (entry.kind == Inside::folder) {
      folders += (folders.empty() ? "" : ",") + json_string(entry.name);
      if (looked_into < most_looked_into && ++looked_into && is_folder_of_data(path)) files.push_back(std::move(entry));
    } else if (has_read_extension(entry.name) || (looked_into < most_looked_into && ++looked_into && is_known_by_content(path))) {
      files.push_back(std::move(entry));
    }
  }
  std::string listed;
  for (const ListedFile& file : grouped_as_series(files))
    listed += fmt::format("{}{{\"name\":{},\"bytes\":{},\"series\":{}}}", listed.empty() ? "" : ",", json_string(file.name), file.bytes,
                          file.series);
  return fmt::format("{{\"folders\":[{}],\"files\":[{}],\"more\":{}}}", folders, listed, more);
}

std::string ServedFolder::to_open(const std::string& name) const {
  const size_t slash = name.rfind('/');
  const std::string below = slash == name.npos ? "" : name.substr(0, slash), last = slash == name.npos ? name : name.substr(slash + 1);
  std::string front, behind;
  if (!split_series_name(last, front, behind)) {
    if (name.empty()) fail_data("no file is named");
    return folder_.find(name).path;
  }
  confined_parts(name);
  // Readers take the path as a pattern: its folders must be no patterns.
  if (has_series_signs(folder_.path() + "/" + below))
    fail_data("cannot be opened as a series: a folder above it has one of * ? , { } in its name", name);
  // The reader follows links: none may be among them.
  if (folder_.count_plain(below, [&](std::string_view file) { return is_step(file, front, behind); }) == 0)
    fail_data(fmt::format("no file is called like '{}'", name));
  return folder_.path() + "/" + name;
}

}  // namespace sg::serve
