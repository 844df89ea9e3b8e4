// SPDX-License-Identifier: Apache-2.0
#include "io/film/movie.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "io/film/ffmpeg_pipe.h"
#include "io/plugin.h"

namespace sg {

namespace {

enum class Encoder { plugin, gif, ffmpeg };
struct MovieFormat {
  std::string_view extension;
  Encoder encoder;
};
constexpr MovieFormat movie_formats[] = {{"webm", Encoder::plugin}, {"gif", Encoder::gif}, {"mp4", Encoder::ffmpeg}};

const MovieFormat* movie_format(const std::string& path) {
  const std::string extension = extension_of(path);
  for (const MovieFormat& f : movie_formats)
    if (f.extension == extension) return &f;
  return nullptr;
}

// Transparent pixels over white.
Image in_rgb(const Image& image) {
  if (image.channels == 3) return image;
  Image out(image.width, image.height, 3);
  const bool grey = image.channels < 3, alpha = image.channels % 2 == 0;
  for (size_t i = 0; i < out.pixels.size() / 3; ++i) {
    const uint8_t* p = &image.pixels[i * size_t(image.channels)];
    const int a = alpha ? p[image.channels - 1] : 255;
    for (size_t c = 0; c < 3; ++c) out.pixels[3 * i + c] = uint8_t((p[grey ? 0 : c] * a + 255 * (255 - a) + 127) / 255);
  }
  return out;
}

}  // namespace

bool is_movie(const std::string& path) { return movie_format(path) != nullptr; }

MovieWriter::MovieWriter(std::string path, MovieSettings settings) : path_(std::move(path)), settings_(settings) {
  if (!is_movie(path_)) fail_usage(fmt::format("'{}' is not a film format", extension_of(path_)), path_, "supported: .webm .gif .mp4");
  AtomicFile probe(path_);  // detects a film that cannot be written before it is drawn
  if (movie_format(path_)->encoder == Encoder::plugin) plugin_format("vpx", "webm");
}

MovieWriter::~MovieWriter() = default;

void MovieWriter::add(const Image& picture) {
  if (width_ == 0) {
    width_ = picture.width, height_ = picture.height;
    settings_.width = (width_ + 1) / 2 * 2, settings_.height = (height_ + 1) / 2 * 2;
    const Encoder encoder = movie_format(path_)->encoder;
    if (encoder == Encoder::plugin) encoder_ = plugin_format("vpx", "webm").movie(settings_);
    else if (encoder == Encoder::gif) gif_ = std::make_unique<GifWriter>(width_, height_, settings_.fps);
    else other_ = std::make_unique<FfmpegPipe>(path_, settings_.width, settings_.height, settings_.fps);
  }
  if (picture.width != width_ || picture.height != height_)
    fail_usage(fmt::format("a picture of {} x {} pixels follows one of {} x {}", picture.width, picture.height, width_, height_), path_,
               "all pictures of a film must have the same size");
  if (gif_) return gif_->add(in_rgb(picture));
  if (other_) return other_->add(in_rgb(picture));
  for (VideoFrame& f : encoder_(&picture)) frames_.push_back(std::move(f));
}

void MovieWriter::finish() {
  if (width_ == 0) fail_usage("has no pictures", path_);
  if (gif_) return write_file(path_, gif_->finish());
  if (other_) return other_->finish();
  for (VideoFrame& f : encoder_(nullptr)) frames_.push_back(std::move(f));
  WebmTrack track;
  track.width = settings_.width, track.height = settings_.height, track.fps = settings_.fps;
  write_file(path_, webm_file(track, frames_));
  frames_.clear();
}

}  // namespace sg
