// SPDX-License-Identifier: Apache-2.0
// How a head lies in a CT scan whose file does not say it.
#pragma once
#include <optional>

#include "data/dataset.h"
#include "scene/camera_params.h"

namespace sg {

/// Signs along the axes of the grid; 0: not known.
struct HeadPose {
  int crown = 0;  ///< the end of z at which the crown lies
  int face = 0;   ///< the end of y that the face looks to
};

/// Of a field in Hounsfield units + offset on a uniform grid of axial slices. Where bone encloses much of a slice it is the skull: its end
/// of the stack is the crown, where the other end has no such slices. Air inside of a head lies at the face. Looks at 32 slices of 128 x
/// 128 samples.
HeadPose head_pose(const Dataset& data, const Field& field, double offset);
/// The same of a CT scan of which nothing says how the patient lies; nothing for other data.
std::optional<HeadPose> unstated_pose(const Dataset& data);
/// Turns the view of a head upright and to its face; false where the crown is not known.
bool stand_up(const HeadPose& pose, CameraDefaults& camera);

}  // namespace sg
