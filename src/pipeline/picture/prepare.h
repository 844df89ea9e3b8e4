// SPDX-License-Identifier: Apache-2.0
// A picture in two parts: what it shows, which is computed once, and drawing that at a size and from a camera, any number of times.
#pragma once
#include <string>
#include <vector>

#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

/// All of a picture that neither its size nor its camera changes.
struct PreparedPicture {
  StatedPicture stated;      ///< with what was chosen from the data; {t} in texts is the time
  std::vector<Shown> shown;  ///< of each panel; the legends of all are with the first one
  CameraDefaults camera;     ///< where the stated one leaves it open
  std::vector<std::string> notes, panel_titles;
};

/// The first half of make_picture(): `file` is completed, all steps run. Throws as that does.
PreparedPicture prepare_picture(PipelineFile& file, const PictureOptions& options, Context& context);

/// The second half. `stated`: prepared.stated, or that with another size, camera or background.
Picture draw_prepared(const PreparedPicture& prepared, const StatedPicture& stated, const PictureOptions& options, Context& context);

/// What draw_prepared() draws of a picture that is not in panels.
Panel panel_of(const PreparedPicture& prepared, const StatedPicture& stated);

}  // namespace sg
