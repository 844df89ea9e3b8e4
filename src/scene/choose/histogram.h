// SPDX-License-Identifier: Apache-2.0
// What the histogram of a field tells: where its background ends, how far its foreground reaches.
#pragma once
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

/// Bins over [lo, hi] of one component (magnitude for -1 of several); finite values only. Large fields are sampled evenly. Fields of this
/// name in all parts beside it count too (Context::parts), and with a communicator all pieces on other ranks, each of which calls with its
/// own.
std::vector<size_t> histogram(const Field& field, int component, double lo, double hi, size_t bins, const Context& context = Context());

/// The same of a field of a dataset, which keeps what was counted, as a window asks again at each edit.
std::vector<size_t> histogram(const Dataset& data, const Field& field, int component, double lo, double hi, size_t bins,
                              const Context& context = Context());

/// The value below which the share `q` of a histogram's samples over [lo, hi] lies.
double histogram_quantile(const std::vector<size_t>& bins, double lo, double hi, double q);

/// The fullest bin of the stretch of a twentieth of the range that holds most samples: a spike of one value (saturation, letters burnt in)
/// is less than the spread of a background.
size_t fullest_bin(const std::vector<size_t>& bins);

/// From the end of the background (the most frequent low value and its surroundings) to what all of the others but a share `bright` stay
/// below. Never empty when lo < hi.
Range foreground(const Field& field, int component, double lo, double hi, const Context& context = Context(), double bright = 0.001);

}  // namespace sg
