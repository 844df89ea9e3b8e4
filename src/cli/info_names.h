// SPDX-License-Identifier: Apache-2.0
// The names of a field's numbers, where the file has them (data/fields/label_names.h), as `info` prints them.
#pragma once
#include <string>

#include "data/dataset.h"

namespace sg {

/// "; names 0 = floor, 1 = left wall, ... (6 in all)", of numbers within the field's range unless `quick`; "" for a field of mere numbers.
std::string names_text(const Dataset& d, const Field& f, bool quick);
/// ",\"names\":{\"0\":\"floor\",...}" with all of them; "" for a field of mere numbers.
std::string names_json(const Dataset& d, const Field& f);

}  // namespace sg
