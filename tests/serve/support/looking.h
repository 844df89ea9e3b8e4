// SPDX-License-Identifier: Apache-2.0
// Sessions of a pipeline's text, and where places of the data lie in a picture of them.
#pragma once
#include <initializer_list>
#include <memory>
#include <string>

#include "scene/camera.h"
#include "serve/session/session.h"
#include "serve/support/window.h"

namespace sg::test {

PipelineFile parsed(const std::string& text);
std::shared_ptr<serve::Session> opened(const std::string& text);

struct Looking {
  Projection projection;
  double x = 0, y = 0;  ///< where it begins in the picture
  /// "[[x,y],...]" in pixels of the picture.
  std::string pixels(std::initializer_list<Vec3> places) const;
};

/// Draws a view of 400 x 300 pixels. `camera`: members of JSON.
Looking looked(Window& window, const std::string& camera, int view = 0);

inline const std::string along_z = "'position':[0,0,5],'target':[0,0,0],'up':[0,1,0],'parallel':true,'height':3";

}  // namespace sg::test
