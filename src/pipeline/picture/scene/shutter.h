// SPDX-License-Identifier: Apache-2.0
// Motion blur: a picture as the mean of moments while the shutter is open.
#pragma once
#include "pipeline/picture/prepare.h"

namespace sg {

/// The pipelines of the moments of a picture: nodes with keys, and steps that state a time, at times spread evenly over the open shutter,
/// each in the middle of its share. Empty where the shutter is closed or nothing moves.
std::vector<PipelineFile> moments_of(const PipelineFile& file, const CameraParams& camera);

/// The picture with the mean light of the moments; camera, axes and legends are those of `prepared`, which is of `file`, and so are
/// colours. Labels, and what is seen where (Picture::seen), are those of the middle moment.
Picture draw_moments(const std::vector<PipelineFile>& moments, const PreparedPicture& prepared, const PictureOptions& options,
                     Context& context);

/// The mean of frames of one size: of their light, however bright.
class MeanFrame {
 public:
  /// The frame's colours become the mean of all so far. Throws Error(internal) for another size.
  void add(Frame& frame);

 private:
  std::vector<double> sums_;
  size_t count_ = 0;
};

}  // namespace sg
