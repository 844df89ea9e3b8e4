// SPDX-License-Identifier: Apache-2.0
// Motion blur: a picture as the mean of moments while the shutter is open.
#pragma once
#include "pipeline/picture/prepare.h"

namespace sg {

/// The pipelines of the moments of a picture: nodes with keys, and steps that state a time, at times spread evenly over the open shutter,
/// each in the middle of its share. Empty where the shutter is closed or nothing moves.
std::vector<PipelineFile> moments_of(const PipelineFile& file, const CameraParams& camera);

/// The picture with the mean light of the moments; camera, axes and legends are those of `prepared`, which is of `file`, and so are
/// colours. What is seen where (Picture::seen) is that of the last moment.
Picture draw_moments(const std::vector<PipelineFile>& moments, const PreparedPicture& prepared, const PictureOptions& options,
                     Context& context);

/// The mean of pictures of one size in linear light; alpha by itself, colours by their alpha.
class MeanImage {
 public:
  void add(const Image& image);
  /// Of as many channels as those added.
  Image mean() const;

 private:
  Image like_;
  std::vector<double> sums_;  // premultiplied linear colour, then alpha
  size_t count_ = 0;
};

}  // namespace sg
