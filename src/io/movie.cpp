// SPDX-License-Identifier: Apache-2.0
#include "io/movie.h"

#include "base/error.h"
#include "base/file.h"
#include "io/plugin.h"

namespace sg {

bool is_movie(const std::string& path) {
  const std::string ext = extension_of(path);
  return ext == "webm" || ext == "mp4";
}

MovieWriter::MovieWriter(std::string path, MovieSettings settings) : path_(std::move(path)), settings_(settings) {
  if (extension_of(path_) != "webm")
    fail_usage("films are written as .webm alone", path_, "browsers and players show it; ffmpeg -i film.webm film.mp4 makes another of it");
  AtomicFile probe(path_);  // a film that cannot be written is found out before it is drawn
  plugin_format("vpx", "webm");
}

void MovieWriter::add(const Image& picture) {
  if (!encoder_) {
    width_ = picture.width, height_ = picture.height;
    settings_.width = (width_ + 1) / 2 * 2, settings_.height = (height_ + 1) / 2 * 2;
    encoder_ = plugin_format("vpx", "webm").movie(settings_);
  }
  if (picture.width != width_ || picture.height != height_)
    fail_usage(fmt::format("a picture of {} x {} pixels after one of {} x {}", picture.width, picture.height, width_, height_), path_,
               "all pictures of a film have one size");
  for (VideoFrame& f : encoder_(&picture)) frames_.push_back(std::move(f));
}

void MovieWriter::finish() {
  if (!encoder_) fail_usage("has no picture", path_);
  for (VideoFrame& f : encoder_(nullptr)) frames_.push_back(std::move(f));
  WebmTrack track;
  track.width = settings_.width, track.height = settings_.height, track.fps = settings_.fps;
  write_file(path_, webm_file(track, frames_));
  frames_.clear();
}

}  // namespace sg
