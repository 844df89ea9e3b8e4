// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/bodies/octree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace sg::swarm {

namespace {

constexpr int deepest = 21;  // bits of an axis
constexpr uint32_t leaf_bodies = 8;

// Two zeros between the bits.
uint64_t spread_bits(uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffffull, v = (v | v << 16) & 0x1f0000ff0000ffull, v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  return (v | v << 2) & 0x1249249249249249ull;
}

// What a mass at d away does; nothing where both are in one place.
inline void add_pull(Vec3 d, double mass, double soft2, Vec3& a, double& potential) {
  const double r2 = dot(d, d) + soft2;
  if (!(r2 > 0)) return;
  const double r = std::sqrt(r2), f = mass / (r2 * r);
  a += f * d, potential -= mass / r;
}

}  // namespace

Octree::Octree(std::span<const Vec3> x, std::span<const double> mass, const Context* context) : x_(x.size()), mass_(x.size()) {
  const size_t n = x.size();
  Box3 box;
  for (const Vec3& p : x) box.add(p);
  if (n == 0) return;
  const Vec3 extent = box.size();
  const double size = std::max({extent.x, extent.y, extent.z, 1e-300}) * (1 + 1e-9);
  std::vector<uint64_t> code(n);
  const double scale = double(1 << deepest) / size;
  parallel_for(
      n, 1 << 14,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          const Vec3 q = (x[i] - box.lo) * scale;
          const auto bits = [](double v) { return spread_bits(uint64_t(std::clamp(v, 0.0, double((1 << deepest) - 1)))); };
          code[i] = bits(q.x) | bits(q.y) << 1 | bits(q.z) << 2;
        }
      },
      context);
  order_.resize(n);
  std::iota(order_.begin(), order_.end(), 0u);
  std::sort(order_.begin(), order_.end(), [&](uint32_t a, uint32_t b) { return code[a] != code[b] ? code[a] < code[b] : a < b; });
  code_.resize(n);
  for (size_t i = 0; i < n; ++i) code_[i] = code[order_[i]], x_[i] = x[order_[i]], mass_[i] = mass[order_[i]];
  nodes_.reserve(n);
  build(0, uint32_t(n), 0, box.lo + Vec3(1, 1, 1) * (size / 2), size);
}

void Octree::build(uint32_t begin, uint32_t end, int level, Vec3 middle, double size) {
  const size_t me = nodes_.size();
  nodes_.push_back({});
  Vec3 sum;
  double mass = 0;
  for (uint32_t i = begin; i < end; ++i) sum += mass_[i] * x_[i], mass += mass_[i];
  Node n{mass > 0 ? sum * (1 / mass) : middle, mass, size, 0, begin, end, 0, end - begin <= leaf_bodies || level == deepest};
  n.off = length(n.center - middle);
  if (!n.leaf) {
    const int shift = 3 * (deepest - 1 - level);
    for (uint32_t from = begin; from < end;) {
      const uint64_t child = code_[from] >> shift & 7;
      uint32_t to = from;
      while (to < end && (code_[to] >> shift & 7) == child) ++to;
      const Vec3 step = Vec3(child & 1 ? 1 : -1, child & 2 ? 1 : -1, child & 4 ? 1 : -1) * (size / 4);
      build(from, to, level + 1, middle + step, size / 2);
      from = to;
    }
  }
  n.next = uint32_t(nodes_.size());
  nodes_[me] = n;
}

void Octree::pull(const Pull& p, std::span<Vec3> a, std::span<double> potential, const Context* context) const {
  const double soft2 = p.softening * p.softening, inverse = p.angle > 0 ? 1 / p.angle : HUGE_VAL;
  parallel_for(
      x_.size(), 128,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Vec3 sum;
          double energy = 0;
          for (uint32_t k = 0; k < nodes_.size();) {
            const Node& n = nodes_[k];
            const Vec3 d = n.center - x_[i];
            const double far = n.size * inverse + n.off;
            if (dot(d, d) > far * far) {
              add_pull(d, n.mass, soft2, sum, energy);
              k = n.next;
            } else if (n.leaf) {
              for (uint32_t j = n.begin; j < n.end; ++j)
                if (j != i) add_pull(x_[j] - x_[i], mass_[j], soft2, sum, energy);
              k = n.next;
            } else {
              ++k;
            }
          }
          a[order_[i]] = p.constant * sum;
          if (!potential.empty()) potential[order_[i]] = p.constant * energy;
        }
      },
      context);
}

void pull_directly(const Pull& p, std::span<const Vec3> x, std::span<const double> mass, std::span<Vec3> a, std::span<double> potential,
                   const Context* context) {
  const double soft2 = p.softening * p.softening;
  parallel_for(
      x.size(), 32,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Vec3 sum;
          double energy = 0;
          for (size_t j = 0; j < x.size(); ++j)
            if (j != i) add_pull(x[j] - x[i], mass[j], soft2, sum, energy);
          a[i] = p.constant * sum;
          if (!potential.empty()) potential[i] = p.constant * energy;
        }
      },
      context);
}

}  // namespace sg::swarm
