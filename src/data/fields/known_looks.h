// SPDX-License-Identifier: Apache-2.0
// What the names of fields tell of how they want to be seen: of those that operations make, and of those in files, which tell no more.
#pragma once
#include <string_view>

#include "data/dataset.h"

namespace sg {

/// Of "ftle", "Q", "lambda2", "swirling strength", "speed", "lic", "spot noise" and their like; the plain look for all others.
FieldLook known_look(std::string_view name);

/// The dataset, its fields with the looks that their names tell; the same one when there are none. Filled contours count as such when the
/// limits of the bands are there, too.
DatasetPtr with_known_looks(const DatasetPtr& data);

/// The dataset with one more field (or in place of the one of that name and association), as the result: what it is coloured by.
DatasetPtr with_result(const DatasetPtr& data, Field field);
/// Makes a field that is there the result; no effect without it.
void mark_result(FieldSet& fields, std::string_view name, Association association);

}  // namespace sg
