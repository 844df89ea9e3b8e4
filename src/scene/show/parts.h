// SPDX-License-Identifier: Apache-2.0
// A collection as one picture: all of its parts in the same way, with the same colours.
#pragma once
#include "scene/show/show.h"

namespace sg {

/// What is shown in one way.
struct ShownParts {
  std::vector<DatasetPtr> parts;
  const ShowKind* kind;
  const ParamSet* stated;
};
/// Of each entry the datasets of the others that are coloured by the same field and choose their colours themselves, as it does: they take
/// one range with it, and one legend. Volumes, whose colours go with their opacity, are alike among themselves.
std::vector<std::vector<DatasetPtr>> colored_alike(const std::vector<ShownParts>& shown);

/// The parameters for each part: the field is that of the part with the most points (a mask or a numbering says less than the values of
/// another), over the range of all and of `beside`; parts without it take one colour. A single part with nothing beside it gets them as
/// they are. Values of their own.
std::vector<ParamSet> params_of_parts(const std::vector<DatasetPtr>& parts, const ShowKind& kind, const ParamSet& stated,
                                      const std::vector<DatasetPtr>& beside = {});

/// Adds the items of all parts, but those of which nothing is left. Volumes are joined: rays see all of them together (`group`: a number
/// that no other volume has, not 0). Returns the legends, not yet compared with each other.
std::vector<Legend> show_parts(Scene& scene, const ShownParts& shown, const std::vector<DatasetPtr>& beside, uint32_t group,
                               Context& context);

/// The same colours of the same values.
bool same_legend(const Legend& a, const Legend& b);

}  // namespace sg
