// SPDX-License-Identifier: Apache-2.0
#include "render/trace/sampling/sampler.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "render/trace/sampling/owen.h"
#include "render/trace/sampling/radical_inverse.h"
#include "render/trace/sampling/sobol.h"
#include "render/trace/sampling/unit_float.h"

namespace sg::trace {

namespace {

constexpr uint32_t upper(uint64_t bits) { return uint32_t(bits >> 32); }
constexpr uint32_t lower(uint64_t bits) { return uint32_t(bits); }

// The bits of v at every other place.
constexpr uint64_t spread(uint32_t v) {
  uint64_t s = v;
  s = (s | s << 16) & 0x0000FFFF0000FFFFull;
  s = (s | s << 8) & 0x00FF00FF00FF00FFull;
  s = (s | s << 4) & 0x0F0F0F0F0F0F0F0Full;
  s = (s | s << 2) & 0x3333333333333333ull;
  return (s | s << 1) & 0x5555555555555555ull;
}

// The n-th of the 24 orders of four things, as where each of them goes.
constexpr auto orders_of_four = [] {
  struct Orders {
    uint8_t to[24][4];
  } all{};
  for (int n = 0; n < 24; ++n) {
    int left[4] = {0, 1, 2, 3}, rest = n;
    for (int i = 0; i < 4; ++i) {
      const int pick = rest % (4 - i);
      rest /= 4 - i;
      all.to[n][i] = uint8_t(left[pick]);
      for (int k = pick; k < 3 - i; ++k) left[k] = left[k + 1];
    }
  }
  return all;
}();

float in_stratum(uint32_t stratum, uint32_t count, uint32_t jitter) { return below_one((stratum + double(unit_float(jitter))) / count); }

}  // namespace

Sampler::Sampler(SamplerKind kind, uint64_t seed, int samples_per_pixel) : kind_(kind), seed_(random_bits(seed, uint64_t(kind))) {
  if (samples_per_pixel < 1 || samples_per_pixel > 1 << 24)
    fail_usage(fmt::format("{} samples per pixel", samples_per_pixel), "sampler", "give 1 to 16777216");
  count_ = uint32_t(samples_per_pixel);
  columns_ = uint32_t(std::sqrt(double(count_)));
  rows_ = (count_ + columns_ - 1) / columns_;
  while (count_ > 1u << curve_bits_) ++curve_bits_;
  if (kind == SamplerKind::blue_noise) {
    block_bits_ = curve_bits_ <= 4 ? curve_bits_ : curve_bits_ % 2 ? 3 : 4;  // the rest by twos
  } else {
    while (block_bits_ < 4 && count_ % (2u << block_bits_) == 0) ++block_bits_;
  }
}

void Sampler::start(uint32_t x, uint32_t y, uint32_t sample, uint32_t dimension) {
  dimension_ = dimension;
  const uint64_t pixel = uint64_t(y) << 32 | x;
  switch (kind_) {
    case SamplerKind::independent: key_ = random_bits(random_bits(seed_, pixel), sample); return;
    case SamplerKind::sobol:  // has no last index
      key_ = random_bits(seed_, pixel), index_ = sample;
      return;
    case SamplerKind::blue_noise: {
      const uint32_t pattern = sample >> curve_bits_, in_pattern = sample & ((1u << curve_bits_) - 1);
      key_ = random_bits(seed_, pattern);
      // Pixels on a Z-curve: pictures of up to 65536 x 65536, beyond which they repeat.
      along_curve_ = (spread(x & 0xFFFF) | spread(y & 0xFFFF) << 1) << curve_bits_ | in_pattern;
      return;
    }
    case SamplerKind::stratified:
    case SamplerKind::halton:
    case SamplerKind::hammersley: key_ = random_bits(random_bits(seed_, pixel), sample / count_), index_ = sample % count_; return;
  }
}

// Sobol's index of the sample, in an order in which every block of 2^block_bits samples stays one, as does every aligned 2^k of blocks.
// Within a block the order is any. Orders that kept all blocks of 2^k, down to pairs, would make pairs of dimensions go together: in a pair
// of samples both would flip their first digit, or none, and products of the two vary 9/7 times as much as those of random numbers.
uint32_t Sampler::block_index(uint64_t key) const {
  const uint32_t block = index_ >> block_bits_, in_block = index_ & ((1u << block_bits_) - 1);
  return owen_scrambled(block, upper(key)) << block_bits_ | permuted(in_block, 1u << block_bits_, random_bits(key, block));
}

uint64_t Sampler::shuffled_digit(uint64_t key, int shift) const {
  const uint64_t digit = along_curve_ >> shift & 3, above = along_curve_ >> (shift + 2);
  const uint64_t drawn = random_bits(key + uint64_t(shift), above) >> 32;
  return uint64_t(orders_of_four.to[drawn * 24 >> 32][digit]) << shift;
}

// The place along the curve in an order that is shuffled within every square of 2^k pixels; blocks of samples of a pixel as above.
uint64_t Sampler::curve_index(uint64_t key, OfSquare& of_square, OfBlock& of_block) const {
  const uint64_t block = along_curve_ >> block_bits_;
  const uint32_t in_block = uint32_t(along_curve_) & ((1u << block_bits_) - 1);
  if (of_block.key != key || of_block.block != block) {
    const int in_square = curve_bits_ + 6;
    if (const uint64_t square = along_curve_ >> in_square; of_square.square != square) {
      of_square.square = square, of_square.shuffled = 0;
      for (int shift = curve_bits_ + 30; shift >= in_square; shift -= 2) of_square.shuffled |= shuffled_digit(key, shift);
    }
    of_block = {key, block, of_square.shuffled, all_permuted(1u << block_bits_, random_bits(key + 64, block))};
    for (int shift = in_square - 2; shift >= block_bits_; shift -= 2) of_block.shuffled |= shuffled_digit(key, shift);
  }
  return of_block.shuffled | (of_block.places >> 4 * in_block & 15);
}

Sampler::Point Sampler::point(uint32_t dimension) {
  if (kind_ == SamplerKind::sobol) {
    const uint64_t key = random_bits(key_, dimension);
    return {block_index(key), random_bits(~key, 0)};
  }
  const uint32_t slot = dimension % kept_dimensions;
  OfSquare& of_square = of_square_[slot];
  if (of_square.dimension != dimension || of_square.pattern != key_) {
    const uint64_t key = random_bits(key_, dimension);
    of_square = {.pattern = key_, .dimension = dimension, .key = key, .digits = random_bits(~key, 0)};
  }
  const size_t in_slot = slot * pixels_of_square + (along_curve_ >> curve_bits_) % pixels_of_square;
  if (in_slot >= of_block_.size()) of_block_.resize(size_t(slot + 1) * pixels_of_square);
  OfBlock& of_block = of_block_[in_slot];
  return {curve_index(of_square.key, of_square, of_block), of_square.digits};
}

uint64_t Sampler::stream() { return random_bits(random_bits(key_ ^ seed_, along_curve_), uint64_t(index_) << 32 | dimension_++); }

float Sampler::next() {
  const uint32_t dimension = dimension_++;
  if (is_sobol()) {
    const Point p = point(dimension);
    return unit_float(scrambled_reverse(uint32_t(p.index), lower(p.digits)));
  }
  const uint64_t key = random_bits(key_, dimension);
  switch (kind_) {
    case SamplerKind::independent: return unit_float(upper(key));
    case SamplerKind::stratified:
    case SamplerKind::hammersley: return in_stratum(permuted(index_, count_, key), count_, upper(random_bits(key, index_)));
    case SamplerKind::halton: {
      // From the last prime on from the first one, with the samples in another order.
      const uint32_t index = dimension < prime_count ? index_ : permuted(index_, count_, key);
      return owen_radical_inverse(prime(dimension % prime_count), index, count_, key);
    }
    case SamplerKind::sobol:
    case SamplerKind::blue_noise: break;
  }
  return 0;
}

Vec2f Sampler::next2() {
  const uint32_t dimension = dimension_;
  if (is_sobol()) {
    dimension_ += 2;
    const Point p = point(dimension);
    return {unit_float(scrambled_reverse(uint32_t(p.index), upper(p.digits))),
            unit_float(scrambled_reverse(sobol_second_digits(p.index), lower(p.digits)))};
  }
  const uint64_t key = random_bits(key_, dimension);
  switch (kind_) {
    case SamplerKind::independent: dimension_ += 2; return {unit_float(upper(key)), unit_float(lower(key))};
    case SamplerKind::stratified: {
      dimension_ += 2;
      // A grid of columns and rows, the last of which may be short. Each column is as many thin ones as there are rows, which those of the
      // column take in an order of its own; the same with rows.
      const uint64_t orders = random_bits(key, 1), place = random_bits(key, uint64_t(2) + index_);
      const uint32_t i = permuted(index_, count_, key), row = i / columns_, first = row * columns_;
      const uint32_t column = permuted(i - first, columns_, orders);
      const uint32_t thin_column = column * rows_ + permuted(row, rows_, random_bits(orders, column));
      const uint32_t thin_row = first + permuted(i - first, std::min(columns_, count_ - first), random_bits(~orders, row));
      return {in_stratum(thin_column, columns_ * rows_, upper(place)), in_stratum(thin_row, count_, lower(place))};
    }
    case SamplerKind::hammersley: {
      dimension_ += 2;
      const uint32_t i = permuted(index_, count_, key);
      return {in_stratum(i, count_, upper(random_bits(key, index_))),
              unit_float(owen_scrambled(reverse_bits(i), upper(random_bits(~key, 0))))};
    }
    case SamplerKind::halton: {
      const float x = next();
      return {x, next()};
    }
    case SamplerKind::sobol:
    case SamplerKind::blue_noise: break;
  }
  return {};
}

}  // namespace sg::trace
