// SPDX-License-Identifier: Apache-2.0
#include "pipeline/film/film_params.h"

#include <algorithm>

#include "base/text/text.h"

namespace sg {

void describe(Schema& s, FilmParams& p) {
  s("output", p.output, "Picture to write; {n} in its name numbers the pictures of a time series; .webm, .mp4: a film of them.")
      .unit("new file");
  s("times", p.times,
    "With {n} in the output, or a film: the times to draw, like 0:10:101 (first:last:count), 0,0.5,1 or 0:114 (the steps of the file in "
    "between); default: all of the file. A parameter written as {t} takes the time, also one of the camera: with azimuth={t} it goes "
    "around.")
      .unit("time");
  s("fps", p.fps, "Films: pictures per second.").range(0.1, 1000);
}

bool is_film_word(std::string_view word) {
  FilmParams params;
  return schema_of(params).find(trim(word.substr(0, word.find('=')))) != nullptr;
}

void take_film_words(PipelineFile& file, FilmParams& params) {
  const auto mine = std::stable_partition(file.picture.begin(), file.picture.end(), [](const std::string& w) { return !is_film_word(w); });
  Schema schema = schema_of(params);
  set_params(schema, {mine, file.picture.end()}, "picture");
  file.picture.erase(mine, file.picture.end());
}

}  // namespace sg
