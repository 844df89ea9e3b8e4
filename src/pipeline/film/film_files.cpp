// SPDX-License-Identifier: Apache-2.0
// Where the pictures of a film go.
#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "image/codec.h"
#include "io/film/movie.h"
#include "pipeline/film/film.h"

namespace sg {

namespace {

constexpr std::string_view mark = "{n}";

std::string numbered(const std::string& pattern, size_t n, size_t count) {
  const size_t at = pattern.find(mark), digits = std::max<size_t>(3, std::to_string(count - 1).size());
  return pattern.substr(0, at) + fmt::format("{:0{}}", n, digits) + pattern.substr(at + mark.size());
}

// Where the pictures go: numbered files, or frames of one film.
class Sink {
 public:
  Sink(const FilmParams& params, size_t count) : output_(params.output), count_(count) {
    if (!is_movie(output_)) {
      AtomicFile probe(numbered(output_, 0, count));
      return;
    }
    settings_.fps = params.fps;
    movie_ = std::make_unique<MovieWriter>(output_, settings_);
  }
  void add(FilmFrame&& frame) {
    if (movie_) return movie_->add(frame.image);
    const std::string name = numbered(output_, frame.number, count_);
    attach_recipe(frame.image, frame.pipeline, name);
    write_image(name, frame.image);
  }
  /// What was written.
  std::string finish() {
    if (!movie_) return numbered(output_, 0, count_) + " ... " + numbered(output_, count_ - 1, count_);
    movie_->finish();
    return output_;
  }

 private:
  std::string output_;
  size_t count_;
  MovieSettings settings_;
  std::unique_ptr<MovieWriter> movie_;
};

}  // namespace

bool is_film(const std::string& output) { return output.find(mark) != std::string::npos || is_movie(output); }

FilmWritten write_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, Context& context) {
  std::unique_ptr<Sink> sink;
  FilmWritten written;
  written.times = make_film(std::move(file), params, options,
                            {[&](const std::vector<double>& times) { sink = std::make_unique<Sink>(params, times.size()); },
                             [&](FilmFrame&& frame) { sink->add(std::move(frame)); }},
                            context);
  written.what = sink->finish();
  return written;
}

}  // namespace sg
