// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/arrays.h"

#include <libdeflate.h>
#include <xxhash.h>

#include <cstring>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::offline {

namespace {

constexpr int deflate_level = 8;

std::vector<uint8_t> deflated(const std::vector<uint8_t>& in) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> c(libdeflate_alloc_compressor(deflate_level),
                                                                                   libdeflate_free_compressor);
  std::vector<uint8_t> out(libdeflate_deflate_compress_bound(c.get(), in.size()));
  out.resize(libdeflate_deflate_compress(c.get(), in.data(), in.size(), out.data(), out.size()));
  if (out.empty()) throw Error(ErrorKind::internal, "an array of a page could not be deflated");
  return out;
}

template <class T>
std::vector<uint8_t> with_differences(const PackedArray& a) {
  const size_t n = a.count, stride = a.stride;
  std::vector<T> in(n);
  if (n) std::memcpy(in.data(), a.bytes.data(), n * sizeof(T));
  std::vector<uint8_t> out(n * sizeof(T));
  constexpr int top = 8 * sizeof(T) - 1;
  for (size_t i = 0; i < n; ++i) {
    const T d = T(in[i] - (i >= stride ? in[i - stride] : T(0))), zigzag = T(T(d << 1) ^ T(d >> top ? T(~T(0)) : T(0)));
    for (size_t k = 0; k < sizeof(T); ++k) out[k * n + i] = uint8_t(zigzag >> (8 * k));
  }
  return out;
}

template <class T>
std::vector<uint8_t> from_differences(const PackedArray& a, const std::vector<uint8_t>& coded_bytes) {
  const size_t n = a.count, stride = a.stride;
  std::vector<T> out(n);
  for (size_t i = 0; i < n; ++i) {
    T zigzag = 0;
    for (size_t k = 0; k < sizeof(T); ++k) zigzag = T(zigzag | T(T(coded_bytes[k * n + i]) << (8 * k)));
    const T d = T(T(zigzag >> 1) ^ T(zigzag & 1 ? T(~T(0)) : T(0)));
    out[i] = T(d + (i >= stride ? out[i - stride] : T(0)));
  }
  std::vector<uint8_t> bytes(n * sizeof(T));
  if (n) std::memcpy(bytes.data(), out.data(), bytes.size());
  return bytes;
}

std::vector<uint8_t> planes_of(const PackedArray& a, const std::vector<uint8_t>& from, bool back) {
  const size_t size = bytes_of(a.type), n = a.count;
  std::vector<uint8_t> out(from.size());
  for (size_t i = 0; i < n; ++i)
    for (size_t k = 0; k < size; ++k) {
      if (back) out[i * size + k] = from[k * n + i];
      else out[k * n + i] = from[i * size + k];
    }
  return out;
}

std::string_view name_of(PackedArray::Type t) {
  constexpr std::string_view names[] = {"u8", "u16", "u32", "f32"};
  return names[size_t(t)];
}
std::string_view name_of(Coding c) {
  constexpr std::string_view names[] = {"plain", "differences", "planes"};
  return names[size_t(c)];
}

}  // namespace

size_t bytes_of(PackedArray::Type type) {
  constexpr size_t sizes[] = {1, 2, 4, 4};
  return sizes[size_t(type)];
}

std::vector<uint8_t> coded(const PackedArray& a, Coding coding) {
  if (coding == Coding::plain) return a.bytes;
  if (coding == Coding::planes) return planes_of(a, a.bytes, false);
  switch (bytes_of(a.type)) {
    case 1: return with_differences<uint8_t>(a);
    case 2: return with_differences<uint16_t>(a);
    default: return with_differences<uint32_t>(a);
  }
}

std::vector<uint8_t> decoded(const PackedArray& a, const std::vector<uint8_t>& coded_bytes) {
  if (a.coding == Coding::plain) return coded_bytes;
  if (a.coding == Coding::planes) return planes_of(a, coded_bytes, true);
  switch (bytes_of(a.type)) {
    case 1: return from_differences<uint8_t>(a, coded_bytes);
    case 2: return from_differences<uint16_t>(a, coded_bytes);
    default: return from_differences<uint32_t>(a, coded_bytes);
  }
}

uint64_t ArrayStore::add(PackedArray::Type type, const void* values, size_t count, uint32_t stride) {
  PackedArray a;
  a.type = type, a.stride = stride, a.count = count, a.bytes.resize(count * bytes_of(type));
  if (count) std::memcpy(a.bytes.data(), values, a.bytes.size());
  const uint64_t hash = XXH3_64bits_withSeed(a.bytes.data(), a.bytes.size(), uint64_t(type) << 32 | stride);
  for (auto [it, end] = by_hash_.equal_range(hash); it != end; ++it) {
    const PackedArray& other = arrays_[it->second];
    if (other.type == type && other.stride == stride && other.bytes == a.bytes) return it->second;
  }
  by_hash_.emplace(hash, arrays_.size());
  arrays_.push_back(std::move(a));
  return arrays_.size() - 1;
}

void ArrayStore::compress() {
  parallel_for(arrays_.size(), 1, [&](size_t i, size_t) {
    PackedArray& a = arrays_[i];
    a.coding = a.type == PackedArray::Type::f32 ? Coding::planes : Coding::differences;
    std::vector<uint8_t> best = deflated(coded(a, a.coding));
    if (a.type == PackedArray::Type::u8)  // noisy bytes are better off alone
      if (std::vector<uint8_t> plain = deflated(a.bytes); plain.size() <= best.size()) best = std::move(plain), a.coding = Coding::plain;
    a.bytes = std::move(best);
  });
  by_hash_.clear();
}

Json ArrayStore::description() const {
  std::vector<Json> list;
  for (const PackedArray& a : arrays_)
    list.emplace_back(Json::Members{{"type", Json(std::string(name_of(a.type)))},
                                    {"coding", Json(std::string(name_of(a.coding)))},
                                    {"stride", Json(uint64_t(a.stride))},
                                    {"count", Json(uint64_t(a.count))}});
  return Json(std::move(list));
}

size_t ArrayStore::text_bytes() const {
  constexpr size_t around = 48;  // the element that holds it
  size_t sum = 0;
  for (const PackedArray& a : arrays_) sum += base64_size(a.bytes.size()) + around;
  return sum;
}

std::string base64(const uint8_t* bytes, size_t count) {
  constexpr char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(base64_size(count));
  for (size_t i = 0; i < count; i += 3) {
    const size_t left = std::min<size_t>(3, count - i);
    const uint32_t word = uint32_t(bytes[i]) << 16 | (left > 1 ? uint32_t(bytes[i + 1]) << 8 : 0) | (left > 2 ? bytes[i + 2] : 0);
    out += letters[word >> 18], out += letters[word >> 12 & 63];
    out += left > 1 ? letters[word >> 6 & 63] : '=', out += left > 2 ? letters[word & 63] : '=';
  }
  return out;
}

}  // namespace sg::offline
