// SPDX-License-Identifier: Apache-2.0
// Pages: a picture that turns, as one HTML file that needs nothing else and asks no network for anything.
#pragma once
#include <string>
#include <vector>

#include "pipeline/film/film_params.h"
#include "pipeline/offline/page_params.h"
#include "pipeline/picture/picture.h"

namespace sg {

/// Whether it is the name of a page.
bool is_page(const std::string& output);

struct Page {
  std::string html;
  size_t steps = 1;
  std::vector<std::string> notes;  ///< what was chosen, and what is coarser than the picture's data
};

/// What a page of a series has where no times are stated.
enum class UnstatedTimes {
  spread,  ///< at most 24, spread over all
  one,     ///< that of the picture
};

/// The picture of `file`, or where it is a series, one for each of film.times. options.on_panel is taken. Throws Error(usage) for a budget
/// that is too small.
Page make_page(PipelineFile file, const PageParams& params, const FilmParams& film, PictureOptions options, Context& context,
               UnstatedTimes unstated = UnstatedTimes::spread);

/// make_page() into film.output, at once or not at all.
Page write_page(PipelineFile file, const PageParams& params, const FilmParams& film, const PictureOptions& options, Context& context);

}  // namespace sg
