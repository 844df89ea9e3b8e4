// SPDX-License-Identifier: Apache-2.0
// The parts of make_picture(): what is stated, what is chosen, what is drawn.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/picture/picture.h"
#include "render/annotate/annotate.h"
#include "scene/camera_params.h"
#include "scene/look.h"

namespace sg {

/// Settings from the words under `picture`.
struct StatedPicture {
  PictureParams picture;
  CameraParams camera;
  int width = 0, height = 0;
  Vec3f bottom{1, 1, 1};
  std::optional<Vec3f> top;
  bool transparent = false;
};

/// Throws Error(usage).
StatedPicture stated_in(const PipelineFile& file);

/// Throws Error(usage) for data without a mesh; of tables it says how to make points.
[[noreturn]] void fail_no_mesh(const Data& data, const std::string& where);

/// The file a step's data comes from, for hints by extension; "" for sources.
std::string origin_of(const PipelineFile& file, std::string step);
/// Adds options.coloring to every way to show that colours by a field, and puts what suits the data in the place of every `auto` show (when
/// nothing is shown: of every step that no other takes as input), adding steps to the file where needed. Returns the look of the first
/// `auto`; one without shows where there is none. `held` keeps what was looked at, so that the cache finds it again and nothing is computed
/// twice.
Look choose_looks(PipelineFile& file, const PictureOptions& options, const std::shared_ptr<Cache>& cache, std::vector<Data>& held,
                  std::vector<std::string>& notes, Context& context);

/// The edges of the box that do not lie in front of the data: those with a face turned away from the camera.
LinesItem back_edges(const Box3& box, const Camera& camera);
/// Width of the picture itself, without its legends.
int width_beside_legends(const Annotation& annotation, const StatedPicture& stated);
/// Renders to the left of the legends, continues the background to the right, and annotates.
/// `coarser` as in RenderOptions.
Image draw_picture(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation, double coarser,
                   Context& context);
/// Fills in picture.image and picture.drafts, through options.on_draft where that is set.
void draw_drafts(const Scene& scene, const Camera& camera, const StatedPicture& stated, const Annotation& annotation,
                 const PictureOptions& options, Picture& picture, Context& context);

}  // namespace sg
