// SPDX-License-Identifier: Apache-2.0
// Memory of the visibility buffer.
#pragma once
#include <cstdint>
#include <mutex>
#include <utility>

#include "data/array.h"

namespace sg::raster {

/// The visibility buffer. One is kept between frames: fresh pages cost more than drawing a million triangles.
class KeyPlane {
 public:
  explicit KeyPlane(size_t pixels) {
    {
      std::lock_guard lock(mutex());
      std::swap(buffer_, spare());
    }
    if (buffer_.size < pixels * sizeof(uint64_t)) {
      std::byte* p = nullptr;
      buffer_ = Buffer::allocate(pixels * sizeof(uint64_t), &p);
    }
  }
  ~KeyPlane() {
    if (buffer_.size > size_t(128) << 20) return;
    std::lock_guard lock(mutex());
    if (spare().size < buffer_.size) std::swap(buffer_, spare());
  }
  KeyPlane(const KeyPlane&) = delete;
  KeyPlane& operator=(const KeyPlane&) = delete;
  uint64_t* data() { return const_cast<uint64_t*>(reinterpret_cast<const uint64_t*>(buffer_.data)); }

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  static Buffer& spare() {
    static Buffer b;
    return b;
  }
  Buffer buffer_;
};

}  // namespace sg::raster
