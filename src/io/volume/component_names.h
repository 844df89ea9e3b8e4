// SPDX-License-Identifier: Apache-2.0
// Vectors and tensors that a file keeps as one number list per component, found by the ends of their names.
#pragma once
#include <string>
#include <vector>

namespace sg {

/// One field of the result: the places of its components among the names.
struct NameGroup {
  std::string name;             ///< the name itself, or what the component names begin with ("DISPL" of DISPLX, DISPLY, DISPLZ)
  std::vector<size_t> members;  ///< 1, 2 (only when `flat`), 3 (X Y Z), 6 (XX YY ZZ XY YZ XZ) or 9 (XX XY XZ YX ...)
};

/// Groups names that end in X, Y, Z (of one case, after the same beginning), and tensors: those that end in XX YY ZZ XY YZ XZ (or
/// ZX), or in all nine. `flat`: X and Y without a Z make a vector too. A group takes the position of its first member; all others stay
/// single.
std::vector<NameGroup> group_components(const std::vector<std::string>& names, bool flat);

}  // namespace sg
