// SPDX-License-Identifier: Apache-2.0
// Films: one picture per time step of a pipeline, all with the looks and colours of one.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/film/film_params.h"
#include "pipeline/picture/picture.h"

namespace sg {

class MovieWriter;

/// Whether it is the name of a film or of numbered pictures.
bool is_film(const std::string& output);

/// One picture of a film.
struct FilmFrame {
  Image image;
  DatasetPtr layers;             ///< layers_of() it; null where they are not asked for
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
/// set one. options.results are of steps that are the same at all times. The next step is read or computed while one is drawn, where
/// context.memory_limit lets two be in memory. Notes are given once. Throws Error(usage) where nothing has times.
std::vector<double> make_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, const FilmCallbacks& callbacks,
                              Context& context);

/// Where the pictures of a film go: numbered files, or frames of one film.
class FilmWriter {
 public:
  /// `count`: of all pictures, for the digits of their numbers; 0: not known. Throws Error(usage) for names that are no film's, and Error
  /// where the film cannot be written.
  explicit FilmWriter(const FilmParams& params, size_t count = 0);
  ~FilmWriter();
  /// A numbered picture gets `pipeline` as its recipe, and is there at once. Throws Error(usage) for frames of different sizes.
  void add(Image image, const PipelineFile& pipeline);
  /// layers_of() the picture that add() is given next.
  void add_layers(const DatasetPtr& layers, Context& context) const;
  /// Returns what was written: "film.webm", or "out_000.png ... out_100.png". Throws Error(usage) when nothing was added.
  std::string finish();

 private:
  std::string numbered(const std::string& name, size_t n) const;
  std::string output_, layers_;
  size_t digits_, written_ = 0;
  std::unique_ptr<MovieWriter> movie_;
};

struct FilmWritten {
  std::string what;  ///< as FilmWriter::finish()
  std::vector<double> times;
};
/// make_film() into params.output; numbered pictures get their recipes.
FilmWritten write_film(PipelineFile file, const FilmParams& params, const PictureOptions& options, Context& context);

}  // namespace sg
