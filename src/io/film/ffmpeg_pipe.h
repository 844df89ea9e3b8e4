// SPDX-License-Identifier: Apache-2.0
// Films that another program encodes: raw pictures into the standard input of ffmpeg, where it is installed.
#pragma once
#include <string>

#include "base/file/partial_file.h"
#include "image/image.h"

namespace sg {

class FfmpegPipe {
 public:
  /// Starts `ffmpeg`, found on PATH, which writes to a temporary file next to `path`. Throws Error(data) when it is not there.
  FfmpegPipe(std::string path, int width, int height, double fps);
  ~FfmpegPipe();  ///< without finish(): stops it and removes what it wrote
  FfmpegPipe(const FfmpegPipe&) = delete;
  FfmpegPipe& operator=(const FfmpegPipe&) = delete;
  /// A picture of at most that size, RGB; the last row and column are repeated.
  void add(const Image& rgb);
  /// Waits for it and renames the file. Throws Error(data) with the end of its output when it failed.
  void finish();

 private:
  std::string last_words() const;
  std::string path_;
  PartialFile partial_;
  std::string log_;
  int width_, height_, socket_ = -1, child_ = -1;
};

}  // namespace sg
