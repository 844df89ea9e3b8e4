// SPDX-License-Identifier: Apache-2.0
// Names that clients give, kept below one folder.
#pragma once
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace sg::serve {

/// "a/b c/d.vti" as its parts. Throws Error(data) for what is not plainly below the folder: "", "." and ".." and empty parts, a "/" in
/// front or at the end, backslashes, control characters, bytes that are not UTF-8 (longer forms of "/" among them), hidden files (a "." in
/// front), more than 64 parts, more than 4096 bytes. Nothing is decoded.
std::vector<std::string> confined_parts(std::string_view name);

enum class Inside { file, folder };

class ConfinedFolder {
 public:
  /// Throws Error(usage) when it is no folder, or the root of all.
  explicit ConfinedFolder(const std::string& folder);
  ~ConfinedFolder();
  ConfinedFolder(const ConfinedFolder&) = delete;
  ConfinedFolder& operator=(const ConfinedFolder&) = delete;

  /// Absolute, links resolved, without "/" at its end.
  const std::string& path() const { return path_; }
  struct Found {
    Inside kind;
    std::string path;  ///< absolute
    size_t bytes = 0;
  };
  /// What lies there: a plain file or a folder. "" is the folder itself. Throws Error(data) for a name that is not confined, a symbolic
  /// link in any part of it, a device or a pipe, and for what is not there; the message names `name` alone.
  Found find(std::string_view name) const;

  struct Entry {
    std::string name;
    Inside kind;
    size_t bytes = 0;
  };
  /// The plain files and folders in one of its folders, at most `most` of them, in natural order. Hidden ones, links, devices, names that
  /// are no UTF-8 or have control characters are left out.
  std::vector<Entry> list(std::string_view name, size_t most) const;
  /// How many of the names in one of its folders are meant. Throws Error(data) when one of them is no plain file.
  size_t count_plain(std::string_view name, const std::function<bool(std::string_view)>& is_meant) const;

 private:
  template <class F>
  void for_each_entry(std::string_view name, F&& f) const;
  int open_folder(const std::vector<std::string>& parts, size_t count, std::string_view name) const;
  std::string path_;
  int root_ = -1;
};

}  // namespace sg::serve
