// SPDX-License-Identifier: Apache-2.0
// The numbers of a page: each array once, coded so that it deflates well, then deflated.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/text/json.h"

namespace sg::offline {

/// How the bytes of an array are arranged before they are deflated. Arrays have tuples of `stride` numbers.
enum class Coding : uint8_t {
  plain,        ///< as in memory, little-endian
  differences,  ///< to the number a tuple before, zigzag, then all lowest bytes, all second bytes, ...
  planes,       ///< all lowest bytes, all second bytes, ...
};

struct PackedArray {
  enum class Type : uint8_t { u8, u16, u32, f32 } type = Type::u8;
  Coding coding = Coding::plain;
  uint32_t stride = 1;
  size_t count = 0;            ///< numbers
  std::vector<uint8_t> bytes;  ///< plain; after ArrayStore::compress() coded and deflated (no header)
};
size_t bytes_of(PackedArray::Type type);

/// The bytes of an array with that coding; of u8 `differences` are those of neighbours.
std::vector<uint8_t> coded(const PackedArray& plain, Coding coding);
/// The inverse, into the bytes of a plain array.
std::vector<uint8_t> decoded(const PackedArray& array, const std::vector<uint8_t>& coded_bytes);

class ArrayStore {
 public:
  // Number of the array; the same one for the same content.
  uint64_t add(const std::vector<uint8_t>& values, uint32_t stride = 1) { return add(PackedArray::Type::u8, values, stride); }
  uint64_t add(const std::vector<uint16_t>& values, uint32_t stride = 1) { return add(PackedArray::Type::u16, values, stride); }
  uint64_t add(const std::vector<uint32_t>& values, uint32_t stride = 1) { return add(PackedArray::Type::u32, values, stride); }
  uint64_t add(const std::vector<float>& values, uint32_t stride = 1) { return add(PackedArray::Type::f32, values, stride); }

  /// Codes and deflates all, on all threads; the same bytes on any number of them.
  void compress();
  const std::vector<PackedArray>& arrays() const { return arrays_; }
  /// [{"type":"u16","coding":"differences","stride":3,"count":300}, ...].
  Json description() const;
  /// Of all arrays as base64, after compress().
  size_t text_bytes() const;

 private:
  template <class T>
  uint64_t add(PackedArray::Type type, const std::vector<T>& values, uint32_t stride) {
    return add(type, values.data(), values.size(), stride);
  }
  uint64_t add(PackedArray::Type type, const void* values, size_t count, uint32_t stride);
  std::vector<PackedArray> arrays_;
  std::multimap<uint64_t, uint64_t> by_hash_;
};

std::string base64(const uint8_t* bytes, size_t count);
inline size_t base64_size(size_t bytes) { return (bytes + 2) / 3 * 4; }

}  // namespace sg::offline
