// SPDX-License-Identifier: Apache-2.0
// The commands of the sightglass program. Each returns the exit code, prints results to stdout and throws Error.
#pragma once
#include "base/context.h"
#include "cli/options.h"

namespace sg {

/// Parses, runs, prints errors as one line on stderr; the exit code of the process.
int cli_main(int argc, char** argv);

int run_info(const Options& o, Context& context);
int run_info_of_pipeline(const Options& o, Context& context);
int run_render(const Options& o, Context& context);
int run_view(const Options& o, Context& context);
int run_serve(const Options& o, Context& context);
int run_convert(const Options& o, Context& context);
int run_pipeline_file(const Options& o, Context& context);
int run_open(const Options& o, Context& context);
int run_ops(const Options& o, Context& context);
int run_colormap(const Options& o, Context& context);
int run_samples(const Options& o, Context& context);
int run_lookdev(const Options& o, Context& context);
int run_demo(const Options& o, Context& context);
int run_completions(const Options& o, Context& context);
int run_complete(const Options& o, Context& context);
int run_man(const Options& o, Context& context);

}  // namespace sg
