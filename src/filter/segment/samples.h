// SPDX-License-Identifier: Apache-2.0
// Common base of operations on lattice images: a scalar field on points or cells as an image of samples, which of them count,
// and labels of any number type as 32-bit codes.
#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "base/huge_allocator.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum SampleState : uint8_t { sample_seen = 0, sample_duplicate = 1, sample_hidden = 2 };

/// One SampleState per point or cell; empty when all are seen. A point is hidden (duplicate) by its own mark, or when all cells around it
/// on a lattice are. Throws Error(usage) for fields of the whole.
std::vector<uint8_t> sample_states(const Dataset& in, Association association);

/// The samples of a scalar field on a uniform or rectilinear grid: its points, or the centres of its cells; x fastest.
struct SampleImage {
  Field field;
  std::array<size_t, 3> dims{1, 1, 1};
  std::array<std::vector<double>, 3> at;  ///< places along each axis, ascending or descending
  std::vector<uint8_t> state;             ///< SampleState, empty when all are seen

  size_t count() const { return dims[0] * dims[1] * dims[2]; }
  std::array<size_t, 3> strides() const { return {1, dims[0], dims[0] * dims[1]}; }
  bool hidden(size_t i) const { return !state.empty() && state[i] == sample_hidden; }
  /// Duplicates are left out of counts and fits, but get labels like all others.
  bool counts(size_t i) const { return state.empty() || state[i] == sample_seen; }
  /// Axes with more than one sample.
  int dimension() const { return int(dims[0] > 1) + int(dims[1] > 1) + int(dims[2] > 1); }
  /// Mean distance of neighbours along the axis; 1 where there are none.
  double spacing(size_t axis) const;
};

/// `name` empty: with want_labels the first one-component field of role labels, else the active scalar. Throws Error(usage) naming `who`
/// for other meshes, no such field, or several components.
SampleImage sample_image(const Dataset& in, const FieldName& name, std::string_view who, bool want_labels = false);
/// The same grid and states with another field of the same association.
const Field& companion_field(const Dataset& in, const SampleImage& image, const FieldName& name, std::string_view who);

/// Labels as codes: 0 is "nothing" (background, hidden, NaN), every other code represents one label.
struct LabelCodes {
  Plane<int32_t> code;
  std::vector<int64_t> table;  ///< label of code c is table[c-1]; empty: the code is the label itself, zero_code represents label 0
  static constexpr int32_t zero_code = INT32_MIN;
  int64_t label(int32_t c) const { return table.empty() ? (c == zero_code ? 0 : int64_t(c)) : table[size_t(c) - 1]; }
};

/// `wanted` empty: all but the background. Throws Error(usage) naming `who` for numbers that are not whole numbers below 2^53.
LabelCodes label_codes(const SampleImage& image, std::optional<double> background, const std::vector<int64_t>& wanted, std::string_view who,
                       const Context& context);

/// The 6, 18 or 26 neighbours (4 or 8 in a plane) that lie before a sample in memory, as steps along the axes.
std::vector<std::array<int, 3>> neighbors_before(int connectivity);

}  // namespace sg
