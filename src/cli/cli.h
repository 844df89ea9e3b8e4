// SPDX-License-Identifier: Apache-2.0
// The commands of the sightglass program. Each returns the exit code, prints results to stdout and throws Error.
#pragma once
#include "base/context.h"
#include "cli/options.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/picture/picture.h"

namespace sg {

/// Parses, runs, prints errors as one line on stderr; the exit code of the process.
int cli_main(int argc, char** argv);

int run_info(const Options& o, Context& context);
int run_info_of_pipeline(const Options& o, Context& context);
int run_render(const Options& o, Context& context);
int run_convert(const Options& o, Context& context);
int run_pipeline_file(const Options& o, Context& context);
int run_open(const Options& o, Context& context);
int run_ops(const Options& o, Context& context);
int run_colormap(const Options& o, Context& context);
int run_demo(const Options& o, Context& context);
int run_completions(const Options& o, Context& context);
int run_complete(const Options& o, Context& context);
int run_man(const Options& o, Context& context);

/// Does the name of the output number its pictures ("out_{n}.png")?
bool is_numbered(const std::string& output);
/// Which pictures of a series, and where they go.
struct SeriesRequest {
  std::string output;  ///< numbered, or a film
  std::string times;   ///< as --times says; "" = those of the file
  double fps = 25;
};
/// One picture per time step, all with the looks and colours of one; the next step is loaded while one is drawn. Of `o` the limits and
/// --quiet are read.
int render_series(PipelineFile plain, const SeriesRequest& request, const PictureOptions& options, const Options& o, Context& context);

}  // namespace sg
