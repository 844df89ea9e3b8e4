// SPDX-License-Identifier: Apache-2.0
// The data of a pipeline at several times, written step by step as they are read or computed.
#pragma once
#include <functional>
#include <string>

#include "io/io.h"
#include "pipeline/file/pipeline_file.h"

namespace sg {

struct SeriesParams {
  std::string output;   ///< "flow_{n}.vtu", or a file of a format with time
  std::string times;    ///< as FilmParams::times; "" = all steps of the file
  bool resume = false;  ///< go on behind the steps that are there
};

struct SeriesWritten {
  size_t steps = 0, before = 0;  ///< in all; that were there already
};

/// What the last step of the pipeline gives at each time. Of a run with a `store` the state is found again when it goes on. `wrote` is told
/// of each step. Throws Error(usage) where nothing has times, or the output holds no series or another one.
SeriesWritten write_series(const PipelineFile& file, const SeriesParams& params, const WriteOptions& options, Context& context,
                           const std::function<void(size_t step, double time, const Data& data)>& wrote = {});

}  // namespace sg
