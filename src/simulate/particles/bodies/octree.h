// SPDX-License-Identifier: Apache-2.0
// Gravity of many bodies by a tree (Barnes, Hut 1986): far groups pull as one body in their centre of mass.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/context.h"
#include "base/vec.h"

namespace sg::swarm {

/// How bodies pull each other: acceleration constant m d / (|d|^2 + softening^2)^(3/2) (Plummer).
struct Pull {
  double constant = 1, softening = 0;
  /// Opening angle, 0 to 1: a group of size s is taken as one body from distances beyond s/angle + |centre of mass - middle| (Barnes
  /// 1994). 0: every pair by itself.
  double angle = 0.5;
};

/// Over bodies of mass 0 or more. Built anew for each set of places, O(n log n); the same for any number of threads.
class Octree {
 public:
  Octree(std::span<const Vec3> x, std::span<const double> mass, const Context* context = nullptr);
  /// Accelerations of the bodies it was built of, and their potentials (per mass) where asked for.
  void pull(const Pull& p, std::span<Vec3> a, std::span<double> potential = {}, const Context* context = nullptr) const;

 private:
  struct Node {
    Vec3 center;        // of mass
    double mass, size;  // edge of the cube
    double off;         // from the cube's middle to the centre of mass
    uint32_t begin, end;
    uint32_t next;  // node behind this one's descendants, which follow it
    bool leaf;
  };
  void build(uint32_t begin, uint32_t end, int level, Vec3 middle, double size);
  std::vector<uint64_t> code_;
  std::vector<uint32_t> order_;
  std::vector<Vec3> x_;  // in the tree's order
  std::vector<double> mass_;
  std::vector<Node> nodes_;
};

/// Sums over all pairs, the measure of the tree.
void pull_directly(const Pull& p, std::span<const Vec3> x, std::span<const double> mass, std::span<Vec3> a,
                   std::span<double> potential = {}, const Context* context = nullptr);

}  // namespace sg::swarm
