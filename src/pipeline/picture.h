// SPDX-License-Identifier: Apache-2.0
// From a pipeline description to an annotated picture with its recipe inside.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/schema.h"
#include "image/image.h"
#include "pipeline/graph.h"
#include "pipeline/pipeline_file.h"

namespace sg {

/// Everything about a picture that is neither data nor camera.
struct PictureParams {
  std::string size = "1280x720";
  std::string background = "white";
  std::string title;
  bool legend = true, axes = true, triad = true;
  int samples = 0;
  double text = 1;
};
void describe(Schema& s, PictureParams& p);

/// "1280x720" to numbers; throws Error(usage).
void parse_size(const std::string& text, int& width, int& height);

struct Picture {
  Image image;                     ///< recipe in image.text under "sightglass"
  std::vector<std::string> notes;  ///< what was chosen and why, one line each
};

/// Evaluates the steps, shows what is asked for (or what the data suggests when nothing is), renders and annotates.
/// `pipeline` is completed with what was chosen, so that emitting it gives the recipe.
Picture make_picture(Pipeline& pipeline, Graph& graph, Context& context);

}  // namespace sg
