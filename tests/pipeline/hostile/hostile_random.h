// SPDX-License-Identifier: Apache-2.0
// Random data and words that nobody means, for property tests of operations and ways to show.
#pragma once
#include <string>
#include <vector>

#include "base/schema/schema.h"
#include "data/dataset.h"
#include "support/property.h"

namespace sg::test::hostile {

/// A small mesh of any kind at any scale, some without cells or points, with points that coincide, lie in a plane or are not finite; fields
/// of any type, number of components, role and values. Sometimes a collection, seldom a table.
Data random_data(Random& random);
DatasetPtr random_dataset(Random& random);

/// NAME=VALUE: mostly of the range that is declared, from its ends, or beyond. Names of fields are those of `data`, sometimes others.
std::string random_word(Random& random, const ParamDecl& d, const Data& data);

/// Words for each parameter by that chance, but for those that name files.
std::vector<std::string> random_words(Random& random, const Schema& schema, const Data& data, double chance);

/// What of its parameters makes work by itself, small: 8 or so.
std::vector<std::string> small_sizes(const Schema& schema, std::string_view operation, const std::vector<Data>& inputs);

}  // namespace sg::test::hostile
