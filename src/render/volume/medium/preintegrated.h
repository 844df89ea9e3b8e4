// SPDX-License-Identifier: Apache-2.0
// Preintegrated: what a piece of a ray between two samples shows, from a table by both values and the length.
#pragma once
#include <vector>

#include "base/context.h"
#include "render/volume/medium/medium.h"

namespace sg::volume {

/// Pre-integrated classification with self-attenuation (after Max, Hanrahan, Crawfis 1990; Engel, Kraus, Ertl 2001). The value goes
/// straight from `front` to `back` over a length L:
///   C = integral over s in [0, L] of c tau exp(-integral of tau before s), alpha = 1 - exp(-L mean tau).
/// Nodes lie evenly over the values and on every knot of the medium, so that a spike, however thin, has nodes of its own. At the nodes
/// the table is the integral of the medium in straight lines (Medium::straight()) to 1e-6 of full scale. Between them mean tau and the
/// colour, weighted by opacity, are bilinear in (front, back) and the colour linear in L between four lengths: with 160 nodes within
/// 1/256 of full scale where alpha changes by less than 1/8 from node to node.
class Preintegrated {
 public:
  struct Plan {
    float lo = 0, hi = 1;  ///< stored values that occur
    float length = 1;      ///< longest piece: the step
    int nodes = 160;       ///< evenly over the values; those at knots (two at a jump) come on top, for at most 80 knots
  };
  Preintegrated(const Medium& medium, const Plan& plan, const Context* context = nullptr);

  struct Segment {
    Vec3f color;  ///< premultiplied, linear light
    float depth;  ///< optical: alpha = 1 - exp(-depth)
  };
  Segment at(float front, float back, float length) const;

  const std::vector<float>& nodes() const { return nodes_; }
  size_t bytes() const { return mean_.size() * sizeof(float) + entries_.size() * sizeof(Entry); }
  static constexpr int lengths = 4;  ///< 0 (thin), 1/3, 2/3 and all of the longest

 private:
  struct Entry {
    float r, g, b, alpha;  // of the thin one: per length
  };
  struct Place {
    size_t node;
    float share;
  };
  Place place(float v) const;
  void integrate(const std::vector<Medium::Straight>& lines, size_t i, size_t j);

  float length_ = 1;
  std::vector<float> nodes_, mean_;  // mean tau by [front][back]
  std::vector<Entry> entries_;       // [front][back][length]
  std::vector<uint32_t> first_;      // node at or before the start of a slice of the values
  float per_slice_ = 0;
};

}  // namespace sg::volume
