// SPDX-License-Identifier: Apache-2.0
// The finite numbers of a field, in order.
#pragma once
#include <cstddef>
#include <memory>
#include <span>

#include "data/array.h"

namespace sg {

class FiniteNumbers {
 public:
  /// Of one component, or for -1 of the magnitude, of arrays one after the other; what `ghost` marks (empty: nothing) is left out.
  struct Source {
    const Array* array;
    const Array* ghost;
  };
  FiniteNumbers(std::span<const Source> sources, int component);
  std::span<double> values() const { return {values_.get(), count_}; }
  size_t missing() const { return missing_; }  ///< NaN
  size_t infinite() const { return infinite_; }

 private:
  std::unique_ptr<double[]> values_;
  size_t count_ = 0, missing_ = 0, infinite_ = 0;
};

}  // namespace sg
