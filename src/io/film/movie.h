// SPDX-License-Identifier: Apache-2.0
// Films: pictures one after the other into a .webm file (VP9, by an encoder in a plug-in), a .gif, or into .mp4 by the program ffmpeg.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "image/gif.h"
#include "image/image.h"
#include "image/webm.h"

namespace sg {

class FfmpegPipe;

struct MovieSettings {
  int width = 0, height = 0;  ///< of the film, even but in a .gif; 0: of the first picture, with a row or column more where that is odd
  double fps = 25;
  int quality = 16;  ///< of VP9: 0 (best) to 63
};

/// Takes a picture (null: there are no more) and gives the encoded ones that are ready.
using MovieEncoder = std::function<std::vector<VideoFrame>(const Image* picture)>;

/// Whether it is the name of a film (.webm, .gif, .mp4).
bool is_movie(const std::string& path);

/// Written to a temporary file, which finish() renames. Encoded pictures of .webm and .gif are kept in memory until then; the bytes are the
/// same for any number of threads.
class MovieWriter {
 public:
  /// Throws Error(usage) for other names, Error(data) when the file cannot be written or the encoder is not there.
  MovieWriter(std::string path, MovieSettings settings);
  ~MovieWriter();
  /// Throws Error(usage) for a picture of another size than the first. Transparent pixels are shown over white.
  void add(const Image& picture);
  void finish();

 private:
  std::string path_;
  MovieSettings settings_;
  int width_ = 0, height_ = 0;
  MovieEncoder encoder_;
  std::vector<VideoFrame> frames_;
  std::unique_ptr<GifWriter> gif_;
  std::unique_ptr<FfmpegPipe> other_;
};

}  // namespace sg
