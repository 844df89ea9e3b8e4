// SPDX-License-Identifier: Apache-2.0
// What a window asks about the data: values at a place of the picture, rows of a table, values along a line, proposals for a look.
#pragma once
#include "pipeline/picture/prepare.h"
#include "serve/renderer/questions/selection.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

/// A picture that has been drawn, to find places of the data in.
struct DrawnPlanes {
  const Seen& seen;
  const Projection& projection;  ///< of the part beside the legends
  Rect area;                     ///< that part
  int width = 0;                 ///< of the whole picture
};

/// The answer "probe" where nothing is seen.
Json::Members nothing_there();
/// The answer "probe": place and values under a pixel of the picture.
Json::Members probe_picture(const DrawnPlanes& drawn, double x, double y, const PipelineFile& file, const PreparedPicture& prepared,
                            const std::shared_ptr<Cache>& cache, Context& context);
/// The answers to all other questions but "over_time"; `area`: of the view that the question names, null where it has no picture. Throws
/// Error(usage) for other questions and for steps, fields and numbers that are not there.
Json::Members answer_about_steps(const Json& question, const PipelineFile& file, const PreparedPicture& prepared,
                                 const std::shared_ptr<Cache>& cache, const DrawnArea* area, Context& context);

}  // namespace sg::serve
