// SPDX-License-Identifier: Apache-2.0
// Columns of a table that are the components of one vector.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg {

struct VectorColumns {
  std::string name;
  std::vector<size_t> columns;  ///< two or three, along x, y and z
};
/// Columns NAME_x, NAME_y and, if there is one, NAME_z: numbers of one component, `but` those left out and where no column is named NAME.
std::vector<VectorColumns> vector_columns(const Table& t, const std::array<int, 3>& but);

/// The vector of these columns, of the wider of their types: f32 where all are, else f64.
Field joined(const Table& t, const VectorColumns& v);

}  // namespace sg
