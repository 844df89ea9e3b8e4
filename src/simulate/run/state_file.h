// SPDX-License-Identifier: Apache-2.0
// The state of a run in a file, from which the run goes on where it was broken off.
#pragma once
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

#include "base/error.h"
#include "base/file/file.h"

namespace sg {

/// A list of a state whose length is part of it. A run checks such lengths when it resumes.
template <class List>
struct Growing {
  List& list;
};

/// Parts of a state, as bytes. A file holds the text that tells runs apart, the number of the frame, the parts, and a sum of all that.
class StateFile {
 public:
  /// Reads a file. Throws Error(data) where it is none, or damaged.
  explicit StateFile(const std::string& path);

  const std::string& key() const { return key_; }
  uint64_t frame() const { return frame_; }
  /// Fills a list of numbers with the next part, which must be as long.
  template <class List>
  void fill(List& list) {
    using T = typename List::value_type;
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> part = next();
    if (part.size() != list.size() * sizeof(T)) fail_length();
    if (!part.empty()) std::memcpy(static_cast<void*>(list.data()), part.data(), part.size());
  }
  template <class List>
  void fill(Growing<List>& growing) {
    using T = typename List::value_type;
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> part = next();
    if (part.size() % sizeof(T) != 0) fail_length();
    growing.list.resize(part.size() / sizeof(T));
    if (!part.empty()) std::memcpy(static_cast<void*>(growing.list.data()), part.data(), part.size());
  }
  [[noreturn]] void fail_length() const;

 private:
  std::span<const std::byte> next();

  MappedFile file_;
  std::string key_;
  uint64_t frame_ = 0;
  size_t at_ = 0;
};

/// Writes such a file: beside the old one, which it then replaces.
class StateWriter {
 public:
  StateWriter(const std::string& path, const std::string& key, uint64_t frame);
  ~StateWriter();
  template <class List>
  void add(const List& list) {
    static_assert(std::is_trivially_copyable_v<typename List::value_type>);
    add(list.data(), list.size() * sizeof(typename List::value_type));
  }
  template <class List>
  void add(const Growing<List>& growing) {
    add(growing.list);
  }
  void commit();

 private:
  void add(const void* data, size_t bytes);
  void write(const void* data, size_t bytes);

  AtomicFile file_;
  struct Sum;
  std::unique_ptr<Sum> sum_;
};

}  // namespace sg
