// SPDX-License-Identifier: Apache-2.0
#include "pipeline/film/film_params.h"

#include <algorithm>

#include "base/text/text.h"

namespace sg {

void describe(Schema& s, FilmParams& p) {
  s("output", p.output,
    "Picture to write; {n} in the name numbers the pictures of a time series; .webm, .gif or .mp4 makes a film of them, .html a page that "
    "turns in a browser.")
      .unit("new file");
  s("times", p.times,
    "With {n} in the output, or for a film: the times to draw, e.g. 0:10:101 (first:last:count), 0:10:0.1 (first:last:step, where the "
    "third is not "
    "whole), 0,0.5,1 or 0:114 (the steps of the file in between); default: all in the file. {t} as the value of a parameter stands for the "
    "time, also in the camera: azimuth={t} orbits.")
      .unit("time");
  s("fps", p.fps, "Films: pictures per second; default: 25, or fewer, down to 2, for a film of less than four seconds.").range(0.1, 1000);
  s("turntable", p.turntable, "Films: pictures of one turn of the camera about the shape, in place of times; e.g. 100. 0: none.")
      .range(0, 100000);
  s("layers", p.layers,
    "Also write what lies behind the colours, a number for each pixel, as data on a grid (.vti, .nrrd, .zarr, ...): light, color, depth, "
    "show; with an integrator error, albedo and normal. {n} in the name numbers those of a series.")
      .unit("new file");
}

double pictures_per_second(const FilmParams& p, size_t count) {
  constexpr double usual = 25, slowest = 2, seconds = 4;
  return p.fps ? *p.fps : count == 0 ? usual : std::clamp(double(count) / seconds, slowest, usual);
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
