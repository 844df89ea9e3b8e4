// SPDX-License-Identifier: Apache-2.0
// Legends, axes and texts of a picture as JSON: texts are set by the page, numbers and colours are those of the picture.
#pragma once
#include "pipeline/offline/pack/scales.h"
#include "pipeline/picture/picture_parts.h"

namespace sg::offline {

/// {"font","title","caption","box","ticks","legends",...}; places are those in the picture of the stated size.
Json pack_annotation(const Panel& panel, const StatedPicture& stated, ScaleStore& scales);

/// {"position","target","up","angle","parallel","height"}.
Json pack_camera(const Camera& camera);
/// {"front":{"direction","up"},...}: from the data towards the viewer.
Json pack_views(const Panel& panel);

}  // namespace sg::offline
