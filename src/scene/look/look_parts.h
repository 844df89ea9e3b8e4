// SPDX-License-Identifier: Apache-2.0
// What choose_look() is made of beside look.cpp. Internal to src/scene.
#pragma once
#include "scene/look/look.h"

namespace sg {

template <class P>
void add_show(Look& look, P params, bool of_input) {
  look.shows.push_back({&show_kind<P>(), param_set_of(std::move(params)), of_input, {}});
}

/// Straight along an axis; a scan's slice is seen from the feet.
void face_axis(int axis, bool patient, CameraDefaults& camera);

/// The usual view of what is no patient, with z or y upwards.
CameraDefaults view_with_up(const Box3& bounds, bool y_up);

/// Each completes the look where it suits the data, else leaves it as it is and returns false.
/// A diffusion series: from all of its volumes the directions in which water moves.
bool look_at_diffusion(const Dataset& d, Look& look);
/// Where nothing but tensors tells something, and they can be told apart, or they are few: a glyph each, with the edges of the cells that
/// carry them.
bool look_at_tensors(const Dataset& d, Look& look);
/// Values of a grid along one axis alone: their curve, with the values along the other axis of the picture.
bool look_at_profile(const Dataset& d, const Field& f, Look& look);
/// What `probe_at` read along a line: the curve of a field over the distance; `automatic` where it is a scalar.
bool look_at_line_probe(const Dataset& d, const Field& automatic, Look& look);
/// Stresses, and at most scalars made of them, in a solid: what engineers compare with the strength of the material.
bool look_at_stress(const Dataset& d, Look& look);

}  // namespace sg
