// SPDX-License-Identifier: Apache-2.0
// Names for what is being written: beside the place where it is going to be, new, and such as nobody can foresee, so that no link that
// somebody has planted is followed and two writers never share one.
#pragma once
#include <string>

namespace sg {

/// "PATH.partial-3f2a..." beside `path`; shorter where the name would be too long for a file.
std::string partial_name(const std::string& path);

/// A new file of that kind, open for writing. Throws Error(data) naming `path`. Also refuses a path that is there and is no plain file.
int create_partial(const std::string& path, std::string& partial);
/// A new folder of that kind, for the owner alone when `own`, else as the user's mask says.
std::string make_partial_folder(const std::string& path, bool own);

/// Files under way are removed when the program is told by a signal to end at once.
void remove_partials_at_exit() noexcept;  ///< safe in a signal handler
void forget_partial(const std::string& partial) noexcept;
void remember_partial(const std::string& partial) noexcept;

/// While one lives, what is under way is being removed: who would end the program waits. For folders, which take their time.
class CleaningUp {
 public:
  CleaningUp() noexcept;
  ~CleaningUp();
  CleaningUp(const CleaningUp&) = delete;
  CleaningUp& operator=(const CleaningUp&) = delete;
  static bool any() noexcept;  ///< safe in a signal handler
};

/// For libraries and programs that open files by name: a place in a new folder of the user's alone; commit() moves what was written there
/// to `path`. Without it all is removed. Throws Error(data) naming `path`.
class PartialFile {
 public:
  explicit PartialFile(const std::string& path);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  const std::string& name() const { return name_; }      ///< write this
  const std::string& folder() const { return folder_; }  ///< with '/' at its end; for logs and the like
  void commit();

 private:
  std::string path_, folder_, name_;
};

}  // namespace sg
