// SPDX-License-Identifier: Apache-2.0
// Where the pictures of a film go.
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/file/file.h"
#include "image/codec.h"
#include "io/film/movie.h"
#include "pipeline/film/film.h"

namespace sg {

namespace {

constexpr std::string_view mark = "{n}";

}  // namespace

bool is_film(const std::string& output) { return output.find(mark) != std::string::npos || is_movie(output); }

FilmWriter::FilmWriter(const FilmParams& params, size_t count)
    : output_(params.output), layers_(params.layers), digits_(std::max<size_t>(3, count > 0 ? std::to_string(count - 1).size() : 0)) {
  if (!is_film(output_))
    fail_usage(output_.empty() ? "is not named" : fmt::format("'{}' is the name of one picture", output_), "film output",
               "out_{n}.png numbers the pictures, film.webm is a film of them");
  if (!layers_.empty()) {
    format_to_write(layers_);
    if (layers_.find(mark) == std::string::npos)
      fail_usage(fmt::format("'{}' is the name of one picture's layers", layers_), "film layers", "layers_{n}.vti numbers those of all");
  }
  if (is_movie(output_)) {
    MovieSettings settings;
    settings.fps = pictures_per_second(params, count);
    movie_ = std::make_unique<MovieWriter>(output_, settings);
  } else {
    AtomicFile probe(numbered(output_, 0));
  }
}
FilmWriter::~FilmWriter() = default;

void FilmWriter::add_layers(const DatasetPtr& layers, Context& context) const {
  write_data(numbered(layers_, written_), layers, {}, context);
}

void FilmWriter::add(Image image, const PipelineFile& pipeline) {
  if (movie_) {
    movie_->add(image);
  } else {
    const std::string name = numbered(output_, written_);
    attach_recipe(image, pipeline, name);
    write_image(name, image);
  }
  ++written_;
}

std::string FilmWriter::finish() {
  if (written_ == 0) fail_usage("has no picture", output_);
  if (!movie_) return numbered(output_, 0) + " ... " + numbered(output_, written_ - 1);
  movie_->finish();
  return output_;
}

std::string FilmWriter::numbered(const std::string& name, size_t n) const {
  const size_t at = name.find(mark);
  return name.substr(0, at) + fmt::format("{:0{}}", n, digits_) + name.substr(at + mark.size());
}

FilmWritten write_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, Context& context) {
  std::unique_ptr<FilmWriter> writer;
  FilmWritten written;
  written.times = make_film(std::move(file), params, options,
                            {[&](const std::vector<double>& times) { writer = std::make_unique<FilmWriter>(params, times.size()); },
                             [&](FilmFrame&& frame) {
                               if (frame.layers) writer->add_layers(frame.layers, context);
                               writer->add(std::move(frame.image), frame.pipeline);
                             }},
                            context);
  written.what = writer->finish();
  return written;
}

}  // namespace sg
