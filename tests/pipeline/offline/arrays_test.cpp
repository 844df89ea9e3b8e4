// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/arrays.h"

#include <libdeflate.h>

#include <cstring>
#include <memory>

#include "support/test.h"

using namespace sg::offline;

namespace {

std::vector<uint8_t> inflated_bytes(const PackedArray& a) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> d(libdeflate_alloc_decompressor(),
                                                                                       libdeflate_free_decompressor);
  std::vector<uint8_t> out(a.count * bytes_of(a.type));
  size_t got = 0;
  REQUIRE(libdeflate_deflate_decompress(d.get(), a.bytes.data(), a.bytes.size(), out.data(), out.size(), &got) == LIBDEFLATE_SUCCESS);
  REQUIRE(got == out.size());
  return out;
}

template <class T>
std::vector<T> read_back(const PackedArray& a) {
  const std::vector<uint8_t> bytes = decoded(a, inflated_bytes(a));
  std::vector<T> out(a.count);
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
  return out;
}

// Whole numbers of all sizes, that jump and run.
template <class T>
std::vector<T> uneven(size_t n) {
  std::vector<T> v(n);
  uint64_t x = 12345;
  for (size_t i = 0; i < n; ++i) x = x * 6364136223846793005ull + 1442695040888963407ull, v[i] = T(i % 7 < 3 ? i : x >> 33);
  return v;
}

}  // namespace

TEST_CASE("page arrays: every type and stride comes back as it was") {
  ArrayStore store;
  const auto u8 = uneven<uint8_t>(1001);
  const auto u16 = uneven<uint16_t>(999);
  const auto u32 = uneven<uint32_t>(1000);
  const std::vector<float> f32{0, -0.0f, 1.5f, -3e38f, 1e-40f, 7};
  const uint64_t a = store.add(u8), b = store.add(u16, 3), c = store.add(u32, 2), d = store.add(f32, 3),
                 e = store.add(std::vector<uint32_t>{});
  store.compress();
  CHECK(read_back<uint8_t>(store.arrays()[a]) == u8);
  CHECK(read_back<uint16_t>(store.arrays()[b]) == u16);
  CHECK(read_back<uint32_t>(store.arrays()[c]) == u32);
  const std::vector<float> back = read_back<float>(store.arrays()[d]);
  CHECK(std::memcmp(back.data(), f32.data(), 4 * f32.size()) == 0);
  CHECK(read_back<uint32_t>(store.arrays()[e]).empty());
}

TEST_CASE("page arrays: the same numbers are stored once, of another type or stride again") {
  ArrayStore store;
  const std::vector<uint16_t> v{1, 2, 3, 4, 5, 6};
  const uint64_t first = store.add(v, 3);
  CHECK(store.add(v, 3) == first);
  CHECK(store.add(v, 2) != first);
  CHECK(store.add(std::vector<uint16_t>{1, 2, 3, 4, 5, 7}, 3) != first);
  CHECK(store.arrays().size() == 3);
}

TEST_CASE("page arrays: a smooth series of numbers takes a fraction of its bytes") {
  ArrayStore store;
  std::vector<uint32_t> v;
  for (uint32_t i = 0; i < 30000; ++i) v.push_back(500000 + 3 * i + i % 2);
  store.add(v);
  store.compress();
  CHECK(store.arrays()[0].bytes.size() < v.size() * 4 / 50);
}

TEST_CASE("page arrays: base64 of RFC 4648") {
  const auto text = [](std::string_view s) { return base64(reinterpret_cast<const uint8_t*>(s.data()), s.size()); };
  CHECK(text("") == "");
  CHECK(text("f") == "Zg==");
  CHECK(text("fo") == "Zm8=");
  CHECK(text("foobar") == "Zm9vYmFy");
  CHECK(base64_size(5) == text("fooba").size());
}
