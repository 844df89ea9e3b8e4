// SPDX-License-Identifier: Apache-2.0
// What a picture that is saved from a window is called, and as what it is encoded.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/film/film_times.h"

namespace sg::serve {

struct PictureType {
  std::string_view word;   ///< "jpg": in requests, and the end of the name
  std::string_view media;  ///< "image/jpeg"
};
/// The type that a request names, "" for PNG. Throws Error(usage) for others, which names those that there are.
PictureType picture_type(const std::string& word);
std::vector<std::string> picture_types();

/// The name of a picture without its end. Of a series it is that of the file that is shown, or its pattern with the number of the step in
/// the place of what varies where a file has several. `time`: index in `film`, nothing for what the steps state.
std::string picture_stem(const std::string& title, const PipelineFile& file, const std::optional<FilmTimes>& film,
                         std::optional<size_t> time);

}  // namespace sg::serve
