// SPDX-License-Identifier: Apache-2.0
// Mapped files under watch. Simulations write while people look: a file truncated while mapped would end the program by SIGBUS, and one
// that is overwritten changes what was checked. Missing pages read as zeros instead, and code that passes on what was read first checks
// that the files have not changed.
#pragma once
#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace sg {

/// One watch for the program; plug-ins, which have their own copy of this layer, share the program's.
class MappedWatch {
 public:
  virtual ~MappedWatch() = default;
  /// From now on [begin, begin + bytes) is a mapping of a file that was in state `st` when it was opened.
  virtual void add(const void* begin, size_t bytes, const std::string& path, const struct stat& st) = 0;
  /// To be called before unmapping.
  virtual void remove(const void* begin) noexcept = 0;
  /// Whether an address lies in a mapped file.
  virtual bool holds(const void* p) const = 0;
  /// A number that grows with every mapping.
  virtual uint64_t now() const = 0;
  /// Bytes of all files that were ever mapped, together.
  virtual uint64_t bytes_ever() const = 0;
  /// The path of a file that was mapped at `since` or later and has changed since it was opened: was cut, or has another size or time of
  /// its last change. "" when there is none. A file that was replaced (a new one under its name) has not changed: the old one is still
  /// mapped. Files no longer mapped are reported once, and only when `since` is not 0.
  virtual std::string changed(uint64_t since) = 0;
};

MappedWatch& mapped_watch();
/// For plug-ins: uses the program's watch. To be called before any file is mapped.
void share_mapped_watch(MappedWatch* watch);

/// Throws Error(data) when a file changed that was mapped at `since` or later (0: any that is mapped still).
void check_files_unchanged(uint64_t since = 0);

}  // namespace sg
