// SPDX-License-Identifier: Apache-2.0
// Which times a film has, and the pipeline of one of them.
#pragma once
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

/// The times of a film, and what moves with them.
struct FilmTimes {
  std::vector<double> times;
  std::vector<size_t> steps;    ///< of the files, where they have them; else empty
  std::set<std::string> still;  ///< steps of the pipeline that read the same at all times
  bool turns = false;           ///< the times are the camera's angles in degrees; nothing else moves
};

/// `asked` as FilmParams::times. Throws Error(usage) where nothing has times, with the hint `without`: what to ask for instead.
FilmTimes film_times(const PipelineFile& file, const std::string& asked, Context& context,
                     std::string_view without = "leave {n} out of the picture's name");

/// One turn of the camera in `count` pictures, from the azimuth that the pipeline states on, which it then states as {t}.
FilmTimes turn_camera(PipelineFile& file, int count);

/// The pipeline at times[n]: parameters of the camera and the picture given as {t} receive the time; in the title {n} is the number of the
/// picture and {count} that of all. So do those of the
/// steps; else operations that show a moment of what they are given (Operation::shows_moment), whose input stays as it is;
/// else readers and sources with a time, and operations on series in place of what lies above them.
PipelineFile at_time(PipelineFile file, const FilmTimes& film, size_t n);

}  // namespace sg
