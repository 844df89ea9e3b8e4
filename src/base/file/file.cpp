// SPDX-License-Identifier: Apache-2.0
#include "base/file/file.h"

#include <dirent.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file/file_fence.h"
#include "base/file/mapped_watch.h"
#include "base/file/partial_file.h"
#include "base/parallel.h"

namespace sg {

MappedFile::MappedFile(const std::string& path) : path_(path) {
  const int fd = open_plain_file(path);
  struct stat st {};
  if (::fstat(fd, &st) != 0) st.st_size = 0;
  size_ = size_t(st.st_size);
  if (size_ == 0) {
    ::close(fd);
    return;
  }
  void* p = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, fd, 0);
  const int error = errno;
  descriptor_ = std::shared_ptr<const int>(new int(fd), [](const int* d) {
    ::close(*d);
    delete d;
  });
  if (p == MAP_FAILED) fail_data(std::string("cannot map the file: ") + std::strerror(error), path);
  const size_t n = size_;
  mapped_watch().add(p, n, path, st);
  owner_ = std::shared_ptr<const void>(p, [n](const void* q) {
    mapped_watch().remove(q);
    ::munmap(const_cast<void*>(q), n);
  });
  data_ = static_cast<const std::byte*>(p);
}

void MappedFile::release(const std::byte* begin, const std::byte* end) const noexcept {
  const auto page = size_t(::sysconf(_SC_PAGESIZE));
  const size_t from = (size_t(begin - data_) + page - 1) / page * page, to = size_t(end - data_) / page * page;
  if (begin >= data_ && end <= data_ + size_ && from < to) ::madvise(const_cast<std::byte*>(data_) + from, to - from, MADV_DONTNEED);
}

void MappedFile::copy_to(void* to, size_t offset, size_t bytes) const {
  if (offset > size_ || bytes > size_ - offset) fail_internal("copy_to reaches beyond the file", path_);
  parallel_for(bytes, size_t(4) << 20, [&](size_t begin, size_t end) {
    while (begin < end) {
      const ssize_t n = ::pread(*descriptor_, static_cast<char*>(to) + begin, end - begin, off_t(offset + begin));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0)
        fail_data(n < 0 ? std::string("cannot read the file: ") + std::strerror(errno) : std::string("ends before its reported size"),
                  path_);
      begin += size_t(n);
    }
  });
}

AtomicFile::AtomicFile(const std::string& path) : path_(path) {
  const int fd = create_partial(path, partial_);
  file_ = ::fdopen(fd, "wb");
  if (file_) return;
  ::close(fd), ::unlink(partial_.c_str());
  fail("cannot be written");
}

AtomicFile::~AtomicFile() {
  if (!file_) return;
  std::fclose(file_);
  ::unlink(partial_.c_str());
  forget_partial(partial_);
}

void AtomicFile::fail(const char* what) const { fail_data(std::string(what) + ": " + std::strerror(errno ? errno : EIO), path_); }

void AtomicFile::write(const void* data, size_t bytes) {
  errno = 0;
  if (bytes && std::fwrite(data, 1, bytes, file_) != bytes) fail("write failed");
  written_ += bytes;
}

void AtomicFile::commit() {
  check_files_unchanged();  // nothing is kept that was made of half a file
  errno = 0;
  if (std::fflush(file_) != 0) fail("write failed");
  const int closed = std::fclose(file_);
  file_ = nullptr;
  forget_partial(partial_);
  if (closed != 0 || ::rename(partial_.c_str(), path_.c_str()) != 0) {
    const int error = errno;
    ::unlink(partial_.c_str());
    errno = error;
    fail("write failed");
  }
}

void write_file(const std::string& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

bool file_exists(const std::string& path) {
  struct stat st {};
  return ::stat(path.c_str(), &st) == 0;
}

bool is_folder(const std::string& path) {
  struct stat st {};
  return ::stat(path.c_str(), &st) == 0 && S_ISDIR(st.st_mode);
}

bool natural_less(std::string_view a, std::string_view b) {
  auto digit = [](std::string_view s, size_t i) { return i < s.size() && s[i] >= '0' && s[i] <= '9'; };
  size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (digit(a, i) && digit(b, j)) {
      while (i < a.size() && a[i] == '0') ++i;  // leading zeros count only when everything else is equal
      while (j < b.size() && b[j] == '0') ++j;
      const size_t i0 = i, j0 = j;
      while (digit(a, i)) ++i;
      while (digit(b, j)) ++j;
      if (i - i0 != j - j0) return i - i0 < j - j0;
      if (const int c = a.substr(i0, i - i0).compare(b.substr(j0, j - j0))) return c < 0;
    } else if (a[i] != b[j]) {
      return uint8_t(a[i]) < uint8_t(b[j]);
    } else {
      ++i, ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i == a.size();
  return a < b;
}

std::vector<std::string> folder_entries(const std::string& path) {
  check_may_read(path);
  DIR* folder = ::opendir(path.c_str());
  if (!folder) fail_data(std::string("cannot list the folder: ") + std::strerror(errno), path);
  std::vector<std::string> names;
  while (const dirent* entry = ::readdir(folder))
    if (const std::string name = entry->d_name; name != "." && name != "..") names.push_back(name);
  ::closedir(folder);
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

std::string folder_of(std::string_view path) {
  const size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? "" : std::string(path.substr(0, slash + 1));
}

std::string file_name_of(std::string_view path) {
  const size_t slash = path.rfind('/');
  return std::string(slash == std::string_view::npos ? path : path.substr(slash + 1));
}

std::string extension_of(std::string_view path) {
  const std::string name = file_name_of(path);
  const size_t dot = name.rfind('.');
  if (dot == std::string::npos || dot == 0) return "";
  std::string ext = name.substr(dot + 1);
  for (char& c : ext) c = char(std::tolower(static_cast<unsigned char>(c)));
  return ext;
}

std::string path_beside(std::string_view beside, std::string_view name) {
  return !name.empty() && name[0] == '/' ? std::string(name) : folder_of(beside) + std::string(name);
}

}  // namespace sg
