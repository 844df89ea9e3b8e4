// SPDX-License-Identifier: Apache-2.0
// What a dataset's positions are: the frame of a patient, their unit, what the axes measure.
#pragma once
#include "data/dataset.h"

namespace sg {

/// `result` with the notes "space", "space in the file", "length unit" and "x axis" to "z axis" of the dataset from which it was made, in
/// each of its parts that has none of these.
Data with_place_of(const Dataset& from, Data result);
/// The same with the first dataset of `from`, if there is any.
Data with_place_of(const Data& from, Data result);

}  // namespace sg
