// SPDX-License-Identifier: Apache-2.0
// How finely a page holds what it shows.
#pragma once
#include <array>
#include <cstddef>

namespace sg::offline {

struct Quality {
  int position_bits = 20, normal_bits = 12, value_bits = 16;  ///< of a number
  int volume_bits = 16;
  double volume = 1;  ///< voxels along an axis, as a share of those there are
  int cluster = 0;    ///< points of surfaces that lie in one of so many parts along the longest axis become one; 0: all stay
  double marks = 1;   ///< share of points, glyphs, and points along lines
};

/// From all to little; one picture is made of one of them, but what is small stays as in the first.
inline constexpr std::array<Quality, 13> qualities{{{20, 12, 16, 16, 1, 0, 1},
                                                    {20, 12, 16, 8, 1, 0, 1},
                                                    {16, 8, 12, 8, 1, 0, 1},
                                                    {16, 8, 12, 8, 0.8, 0, 1},
                                                    {14, 8, 12, 8, 0.63, 0, 1},
                                                    {14, 8, 8, 8, 0.5, 512, 0.7},
                                                    {13, 8, 8, 8, 0.4, 384, 0.5},
                                                    {12, 8, 8, 8, 0.32, 256, 0.35},
                                                    {12, 8, 8, 8, 0.25, 192, 0.25},
                                                    {12, 8, 8, 8, 0.2, 128, 0.17},
                                                    {12, 8, 8, 8, 0.16, 96, 0.12},
                                                    {11, 6, 8, 8, 0.125, 64, 0.08},
                                                    {10, 6, 8, 8, 0.1, 40, 0.05}}};
inline constexpr size_t finest = 0, coarsest = qualities.size() - 1;
/// Of a series: rather fewer steps than each coarser than this.
inline constexpr size_t coarsest_step = 6;

}  // namespace sg::offline
