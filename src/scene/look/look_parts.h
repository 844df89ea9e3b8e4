// SPDX-License-Identifier: Apache-2.0
// What choose_look() is made of beside look.cpp. Internal to src/scene.
#pragma once
#include "scene/look/look.h"

namespace sg {

template <class P>
void add_show(Look& look, P params, bool of_input) {
  look.shows.push_back({&show_kind<P>(), param_set_of(std::move(params)), of_input});
}

/// Each completes the look where it suits the data, else leaves it as it is and returns false.
/// A diffusion series: from all of its volumes the directions in which water moves.
bool look_at_diffusion(const Dataset& d, Look& look);
/// Where nothing but tensors tells something, and they can be told apart, or they are few: a glyph each, with the edges of the cells that
/// carry them.
bool look_at_tensors(const Dataset& d, Look& look);
/// Stresses, and at most scalars made of them, in a solid: what engineers compare with the strength of the material.
bool look_at_stress(const Dataset& d, Look& look);

}  // namespace sg
