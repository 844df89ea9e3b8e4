// SPDX-License-Identifier: Apache-2.0
// Shared by the operations that return tables: compensated sums, and columns.
#pragma once
#include <cmath>
#include <string>
#include <vector>

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

/// A column of numbers; with labels, of words.
template <class T>
void add_column(Table& t, const char* name, std::vector<T> values, std::vector<std::string> labels = {}) {
  t.columns.push_back({name, Association::whole, Array::from_vector(std::move(values)), "", Role::none});
  t.labels.push_back(std::move(labels));
}

}  // namespace sg
