// SPDX-License-Identifier: Apache-2.0
// Numbers in [0, 1) for integration by sampling. Each depends on (kind, seed, samples per pixel, pixel, sample, dimension) alone, so that
// any thread may ask for any of them, in any order, and gets the same bytes.
//
//   Sampler sampler(SamplerKind::sobol, seed, 64);
//   sampler.start(x, y, sample);
//   const Vec2f in_pixel = sampler.next2();   // dimensions 0 and 1
//   const float which_light = sampler.next(); // dimension 2
//
// All kinds are unbiased: each value by itself is uniform, those of different calls of next() and next2() are independent. What
// they differ in is how the samples of a pixel lie to each other.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/schema/enum_words.h"
#include "base/vec.h"

namespace sg::trace {

enum class SamplerKind {
  independent,  ///< random numbers: variance falls as 1/N
  stratified,   ///< multi-jittered (Chiu, Shirley, Wang 1994): one sample in each stratum of each axis and each cell of a grid; any count
  halton,       ///< radical inverses in the first primes, digits scrambled (Owen 1995)
  hammersley,   ///< pairs of (i + random) / N and a scrambled radical inverse: needs the count in advance
  sobol,        ///< pairs of Sobol's sequence, digits scrambled (Burley 2020), order shuffled in blocks of 16; best with powers of two
  blue_noise,   ///< the same sequence dealt along a shuffled Z-curve of the pixels, so that neighbours err in opposite ways (Ahmed, Wonka
                ///< 2020)
};
constexpr auto enum_words(SamplerKind) {
  using enum SamplerKind;
  return std::array{Word{"independent", independent}, Word{"stratified", stratified}, Word{"halton", halton},
                    Word{"hammersley", hammersley},   Word{"sobol", sobol},           Word{"blue_noise", blue_noise}};
}

class Sampler {
 public:
  /// samples_per_pixel: 1 to 2^24; samples beyond it begin another pattern of so many. Throws Error(usage) for other counts.
  Sampler(SamplerKind kind, uint64_t seed, int samples_per_pixel);

  /// Goes to a sample of a pixel, and to the first of its dimensions that is asked for.
  void start(uint32_t x, uint32_t y, uint32_t sample, uint32_t dimension = 0);
  /// The value of the next dimension, in [0, 1).
  float next();
  /// The values of the next two dimensions, which are spread over the square together.
  Vec2f next2();
  /// Of one dimension, for a RandomStream: any number of values that have nothing to do with others.
  uint64_t stream();
  /// The dimension that is asked for next.
  uint32_t dimension() const { return dimension_; }

 private:
  /// Along the curve, for a dimension: what a pattern and a square of 8 x 8 pixels have in common.
  struct OfSquare {
    uint64_t pattern = 0, dimension = ~uint64_t(0);
    uint64_t key = 0, digits = 0;
    uint64_t square = ~uint64_t(0), shuffled = 0;
  };
  /// And what the samples of a block have.
  struct OfBlock {
    uint64_t key = 0, block = ~uint64_t(0), shuffled = 0;
    uint64_t places = 0;  ///< of sample i in four bits from 4 i on
  };
  /// Of Sobol's sequence, and what scrambles the digits of a dimension.
  struct Point {
    uint64_t index, digits;
  };
  static constexpr uint32_t kept_dimensions = 32, pixels_of_square = 64;

  bool is_sobol() const { return kind_ == SamplerKind::sobol || kind_ == SamplerKind::blue_noise; }
  Point point(uint32_t dimension);
  uint32_t block_index(uint64_t key) const;
  uint64_t curve_index(uint64_t key, OfSquare& of_square, OfBlock& of_block) const;
  uint64_t shuffled_digit(uint64_t key, int shift) const;

  SamplerKind kind_;
  uint32_t count_;            // samples of a pattern
  uint32_t columns_, rows_;   // stratified: of the coarse strata, columns * rows >= count
  int curve_bits_ = 0;        // blue noise: bits of the sample in an index along the curve
  int block_bits_ = 0;        // Sobol: of a block of samples in any order, up to 16
  uint64_t seed_;             // mixed
  uint64_t key_ = 0;          // of pixel and pattern; independent: of the sample; blue noise: of the pattern
  uint64_t along_curve_ = 0;  // blue noise: pixel and sample as one number
  std::array<OfSquare, kept_dimensions> of_square_;
  std::vector<OfBlock> of_block_;  // blue noise: of the pixels of a square, dimension by dimension
  uint32_t index_ = 0;             // of the sample in its pattern
  uint32_t dimension_ = 0;
};

}  // namespace sg::trace
