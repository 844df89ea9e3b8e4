// SPDX-License-Identifier: Apache-2.0
// Colour maps of few published colours: ColorBrewer's and Tableau's.
#pragma once
#include "color/published_maps.h"

namespace sg {

std::span<const PublishedMap> brewer_maps();

}  // namespace sg
