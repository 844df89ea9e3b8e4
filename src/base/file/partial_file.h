// SPDX-License-Identifier: Apache-2.0
// Names for files being written: next to their destination, new and unpredictable, so that no planted link is followed and two writers
// never share one.
#pragma once
#include <string>

namespace sg {

/// "PATH.partial-3f2a..." beside `path`; shorter where the name would be too long.
std::string partial_name(const std::string& path);

/// A new file of that kind, open for writing. Throws Error(data) naming `path`. Also refuses an existing path that is not a plain file.
int create_partial(const std::string& path, std::string& partial);
/// A new folder of that kind, accessible only to its owner when `own`, else according to the umask.
std::string make_partial_folder(const std::string& path, bool own);

/// Partial files are removed when a signal ends the program at once.
void remove_partials_at_exit() noexcept;  ///< safe in a signal handler
void forget_partial(const std::string& partial) noexcept;
void remember_partial(const std::string& partial) noexcept;

/// While one exists, partial files are being removed, and code that would end the program waits. For folders, whose removal takes time.
class CleaningUp {
 public:
  CleaningUp() noexcept;
  ~CleaningUp();
  CleaningUp(const CleaningUp&) = delete;
  CleaningUp& operator=(const CleaningUp&) = delete;
  static bool any() noexcept;  ///< safe in a signal handler
};

/// For libraries and programs that open files by name: a path in a new folder private to the user; commit() moves what was written there to
/// `path`. Without it everything is removed. Throws Error(data) naming `path`.
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
