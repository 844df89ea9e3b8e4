// SPDX-License-Identifier: Apache-2.0
// Parameters of a film besides its pipeline and its pictures; in a pipeline file they are under `picture`.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "base/schema/schema.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

struct FilmParams {
  std::string output;  ///< "out_{n}.png" (numbered pictures), "film.webm" or "film.mp4"
  std::string
      times;  ///< FIRST:LAST:COUNT, a list, or FIRST:LAST (of files: their steps in between; of sources: 0, 1, 2, ...); "" = all steps
  std::optional<double> fps;
  int turntable = 0;   ///< pictures of one turn of the camera in place of times; 0 = none
  std::string layers;  ///< file of layers_of() a picture; of a film with {n} in its name
};
void describe(Schema& s, FilmParams& p);

/// The stated pictures per second, else as many as let `count` pictures last for four seconds, but no more than 25 and no fewer than 2;
/// 25 where their number is not known (0).
double pictures_per_second(const FilmParams& params, size_t count);

/// Words under `picture` that are parameters of the film. A recipe and a single picture do without them.
bool is_film_word(std::string_view word);
/// Takes what a pipeline file says about its film out of the file. Throws Error(usage).
void take_film_words(PipelineFile& file, FilmParams& params);

}  // namespace sg
