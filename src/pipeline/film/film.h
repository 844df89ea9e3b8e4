// SPDX-License-Identifier: Apache-2.0
// Films: one picture per time step of a pipeline, all with the looks and colours of one.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/film/film_params.h"
#include "pipeline/picture/picture.h"

namespace sg {

/// Whether it is the name of a film or of numbered pictures.
bool is_film(const std::string& output);

/// One picture of a film.
struct FilmFrame {
  Image image;
  const PipelineFile& pipeline;  ///< makes only this picture
  size_t number, count;
  double time;
};

struct FilmCallbacks {
  /// Before anything is computed; throws where the film cannot be written. May be null.
  std::function<void(const std::vector<double>& times)> begin;
  /// Each picture in order, from the calling thread.
  std::function<void(FilmFrame&& frame)> frame;
};

/// Makes the pictures; returns their times. A parameter written as {t} takes the time; else the steps that have a time do, unless they
/// state one. The next step is read or computed while one is drawn, where context.memory_limit lets two be in memory. Notes are given once.
/// Throws Error(usage) where nothing has times.
std::vector<double> make_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, const FilmCallbacks& callbacks,
                              Context& context);

struct FilmWritten {
  std::string what;  ///< "film.webm", or "out_000.png ... out_100.png"
  std::vector<double> times;
};
/// make_film() into params.output; numbered pictures get their recipes.
FilmWritten write_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, Context& context);

}  // namespace sg
