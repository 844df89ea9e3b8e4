// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_files.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "base/error.h"
#include "base/file/mapped_watch.h"
#include "base/file/partial_file.h"

namespace sg {

AtomicFiles::AtomicFiles(const std::vector<std::string>& paths) {
  files_.resize(paths.size());
  try {
    for (size_t i = 0; i < paths.size(); ++i) {
      One& one = files_[i];
      one.path = paths[i];
      const int fd = create_partial(one.path, one.partial);
      one.file = ::fdopen(fd, "wb");
      if (!one.file) ::close(fd), fail(one);
    }
  } catch (...) {
    take_back();
    throw;
  }
}

AtomicFiles::~AtomicFiles() { take_back(); }

void AtomicFiles::fail(const One& one) const { fail_data(std::string("write failed: ") + std::strerror(errno ? errno : EIO), one.path); }

void AtomicFiles::write(size_t file, const void* data, size_t bytes) {
  errno = 0;
  if (bytes && std::fwrite(data, 1, bytes, files_[file].file) != bytes) fail(files_[file]);
}

// Into its place. What was there goes under the partial name, so that it can be brought back.
void AtomicFiles::place(One& one) {
  if (::renameat2(AT_FDCWD, one.partial.c_str(), AT_FDCWD, one.path.c_str(), RENAME_EXCHANGE) == 0) {
    one.exchanged = true;
  } else if (::rename(one.partial.c_str(), one.path.c_str()) != 0) {  // nothing was there, or a file system that cannot exchange
    fail(one);
  }
  one.placed = true;
}

void AtomicFiles::finish() {
  for (One& one : files_) {
    if (!one.file) continue;
    errno = 0;
    const bool flushed = std::fflush(one.file) == 0;
    const int error = errno;
    const bool closed = std::fclose(std::exchange(one.file, nullptr)) == 0;
    if (flushed && closed) continue;
    if (!flushed) errno = error;
    fail(one);
  }
}

void AtomicFiles::commit() {
  check_files_unchanged();  // nothing is kept that was made of half a file
  finish();
  for (One& one : files_) place(one);
  for (One& one : files_) {
    if (one.exchanged) ::unlink(one.partial.c_str());  // what was there before
    forget_partial(one.partial);
  }
  files_.clear();
}

void AtomicFiles::take_back() noexcept {
  for (One& one : files_) {
    if (one.file) std::fclose(one.file);
    if (one.exchanged) ::renameat2(AT_FDCWD, one.partial.c_str(), AT_FDCWD, one.path.c_str(), RENAME_EXCHANGE);
    if (one.placed && !one.exchanged) ::unlink(one.path.c_str());
    if (!one.partial.empty()) ::unlink(one.partial.c_str()), forget_partial(one.partial);
  }
  files_.clear();
}

}  // namespace sg
