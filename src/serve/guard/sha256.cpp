// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/sha256.h"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace sg::serve {

namespace {

constexpr std::array<uint32_t, 64> first_primes() {
  std::array<uint32_t, 64> primes{};
  size_t count = 0;
  for (uint32_t n = 2; count < primes.size(); ++n) {
    bool prime = true;
    for (size_t i = 0; i < count; ++i) prime = prime && n % primes[i] != 0;
    if (prime) primes[count++] = n;
  }
  return primes;
}

// The first 32 bits behind the point of the square root (power 2) or cube root (power 3) of n: floor(root(n * 2^(32 power))), low bits.
constexpr uint32_t root_bits(uint32_t n, int power) {
  using Wide = unsigned __int128;
  const Wide target = Wide(n) << (32 * power);
  Wide root = 0;
  for (int bit = 40; bit >= 0; --bit) {
    const Wide tried = root | (Wide(1) << bit);
    if ((power == 2 ? tried * tried : tried * tried * tried) <= target) root = tried;
  }
  return uint32_t(root);
}

struct Constants {
  std::array<uint32_t, 64> round{};
  std::array<uint32_t, 8> start{};
  constexpr Constants() {
    const auto primes = first_primes();
    for (size_t i = 0; i < 64; ++i) round[i] = root_bits(primes[i], 3);
    for (size_t i = 0; i < 8; ++i) start[i] = root_bits(primes[i], 2);
  }
};
constexpr Constants constants;

using State = std::array<uint32_t, 8>;

// One block of 64 bytes; letters as in FIPS 180-4, section 6.2.2.
void add_block(State& h, const unsigned char* block) {
  std::array<uint32_t, 64> w{};
  for (size_t t = 0; t < 16; ++t)
    w[t] = uint32_t(block[4 * t]) << 24 | uint32_t(block[4 * t + 1]) << 16 | uint32_t(block[4 * t + 2]) << 8 | block[4 * t + 3];
  for (size_t t = 16; t < 64; ++t) {
    const uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ (w[t - 15] >> 3);
    const uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ (w[t - 2] >> 10);
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, last] = h;
  for (size_t t = 0; t < 64; ++t) {
    const uint32_t sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25), choice = (e & f) ^ (~e & g);
    const uint32_t t1 = last + sum1 + choice + constants.round[t] + w[t];
    const uint32_t sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22), majority = (a & b) ^ (a & c) ^ (b & c);
    last = g, g = f, f = e, e = d + t1, d = c, c = b, b = a, a = t1 + sum0 + majority;
  }
  const State more{a, b, c, d, e, f, g, last};
  for (size_t i = 0; i < 8; ++i) h[i] += more[i];
}

}  // namespace

std::string sha256_hex(std::string_view bytes) {
  State h = constants.start;
  // Behind the text: a one bit, zeros, and its length in bits, to whole blocks.
  std::string tail(bytes.substr(bytes.size() / 64 * 64));
  tail += char(0x80);
  while (tail.size() % 64 != 56) tail += char(0);
  for (int shift = 56; shift >= 0; shift -= 8) tail += char(uint64_t(bytes.size()) * 8 >> shift & 0xff);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  for (size_t i = 0; i + 64 <= bytes.size(); i += 64) add_block(h, data + i);
  for (size_t i = 0; i < tail.size(); i += 64) add_block(h, reinterpret_cast<const unsigned char*>(tail.data()) + i);
  std::string out;
  for (const uint32_t word : h) out += fmt::format("{:08x}", word);
  return out;
}

}  // namespace sg::serve
