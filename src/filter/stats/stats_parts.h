// SPDX-License-Identifier: Apache-2.0
// Shared by the operations that return tables: compensated sums, and columns.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "base/all_ranks.h"
#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Neumaier's compensated sum: sums of millions of numbers are accurate to the last places. Sums of parts add up to the same.
struct ExactSum {
  double sum = 0, rest = 0;
  void add(double x) {
    const double t = sum + x;
    rest += std::fabs(sum) >= std::fabs(x) ? (sum - t) + x : (x - t) + sum;
    sum = t;
  }
  void add(const ExactSum& s) {
    add(s.sum);
    rest += s.rest;
  }
  double value() const { return sum + rest; }
};

/// Sums of all processes that share the data, in the order of their ranks.
inline void over_all(std::vector<ExactSum>& sums, const Context& context) {
  if (!context.communicator) return;
  const auto all = all_gathered(std::span<const ExactSum>(sums), context.communicator);
  sums = all[0];
  for (size_t rank = 1; rank < all.size(); ++rank)
    for (size_t i = 0; i < std::min(sums.size(), all[rank].size()); ++i) sums[i].add(all[rank][i]);
}

/// A column of numbers; with labels, of words.
template <class T>
void add_column(Table& t, const char* name, std::vector<T> values, std::vector<std::string> labels = {}) {
  t.columns.push_back({name, Association::whole, Array::from_vector(std::move(values)), "", Role::none});
  t.labels.push_back(std::move(labels));
}

}  // namespace sg
