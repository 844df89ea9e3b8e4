// SPDX-License-Identifier: Apache-2.0
// A collection as one picture: all of its parts in the same way, with the same colours.
#pragma once
#include "scene/show/show.h"

namespace sg {

/// The parameters for each part: the field is that of the part with the most points (a mask or a numbering says less than the values of
/// another), over the range of all; parts without it take one colour. A single part gets them as they are. Values of their own.
std::vector<ParamSet> params_of_parts(const std::vector<DatasetPtr>& parts, const ShowKind& kind, const ParamSet& stated);

/// Adds the items of all parts, but those of which nothing is left. Volumes are joined: rays see all of them together (`group`: a number
/// that no other volume has, not 0). Returns the legends, not yet compared with each other.
std::vector<Legend> show_parts(Scene& scene, const std::vector<DatasetPtr>& parts, const ShowKind& kind, const ParamSet& stated,
                               uint32_t group, Context& context);

/// The same colours of the same values.
bool same_legend(const Legend& a, const Legend& b);

}  // namespace sg
