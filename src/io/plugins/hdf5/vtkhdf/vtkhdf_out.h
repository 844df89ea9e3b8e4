// SPDX-License-Identifier: Apache-2.0
// What the writers of one step and of several share.
#pragma once
#include <string>
#include <vector>

#include "data/dataset.h"
#include "io/plugins/hdf5/h5_write.h"

namespace sg::vtkhdf {

/// A name that a dataset can have, other than those in `used`, to which it is added: '/' would make groups.
std::string safe_name(std::string name, std::vector<std::string>& used);
/// The attribute of PointData or CellData that names the field of this role; null where there is none.
const char* attribute_of(Role role);
Array coordinates(const Points& p);
/// As i64.
Array wide(const Array& ids);
/// The attributes of a group of a grid.
void write_head(h5::Writer& w, const std::string& at, const UniformGrid& g);
/// Version and Type.
void write_head(h5::Writer& w, const std::string& at, const char* type, int64_t major, int64_t minor);
[[noreturn]] void refuse_kind(const Dataset& d, const std::string& path);

}  // namespace sg::vtkhdf
