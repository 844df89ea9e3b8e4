// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sg {

/// Disjoint sets of 0 .. n-1. The smallest member is the root, so that roots do not depend on the order of joins. Several threads may join
/// concurrently as long as none touches another's members, since root() shortens paths.
template <class Id = uint32_t>
class UnionFind {
 public:
  explicit UnionFind(size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), Id(0)); }
  Id root(Id i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Id a, Id b) {
    a = root(a), b = root(b);
    if (a < b) parent_[b] = a;
    else parent_[a] = b;
  }

 private:
  std::vector<Id> parent_;
};

}  // namespace sg
