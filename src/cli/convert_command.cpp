// SPDX-License-Identifier: Apache-2.0
// convert: data to another file, whole, slab by slab, or as a series step by step.
#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/chain.h"
#include "cli/cli.h"
#include "cli/hints/step_files.h"
#include "cli/outputs.h"
#include "cli/say.h"
#include "filter/mesh/select/piece.h"
#include "io/file_series.h"
#include "io/formats.h"
#include "pipeline/film/write_series.h"
#include "pipeline/graph/slabs.h"
#include "pipeline/graph/step_report.h"
#include "pipeline/picture/picture_sets.h"

namespace sg {

namespace {

// Without filters a volume goes to a Zarr folder slab by slab, so that it need not fit into memory.
int convert_slabs(const PipelineFile& file, const Options& o, const WriteOptions& write, Context& context) {
  ZarrOptions options;
  options.chunk = size_t(write.chunk);
  if (write.compression) options.compression = word_of(*write.compression);
  const SlabSource source = with_context(fmt::format("writing '{}'", o.output), [&] {
    return o.source.empty() ? slabs_of_file(o.inputs[0], o.read, context)
                            : slabs_of_source(file.steps[0].operation, file.steps[0].words, context);
  });
  write_zarr_slabs(o.output, source, options, context);
  const auto& n = source.grid.dims;
  if (!o.quiet) say(fmt::format("{}: uniform {}x{}x{}, field '{}'\n", printable(o.output), n[0], n[1], n[2], printable(source.field)));
  return 0;
}

// All steps of a series, one after the other.
int convert_series(const PipelineFile& file, const Options& o, const WriteOptions& write, Context& context) {
  SeriesParams params{o.output, o.times, o.resume};
  size_t steps = 0;
  const SeriesWritten written = write_series(file, params, write, context, [&](size_t step, double time, const Data& data) {
    ++steps;
    context.log(LogLevel::debug, fmt::format("{}: step {} at time {}", o.output, step, exact_number(time)));
    if (steps == 1 && !o.quiet)
      for_each_dataset(data, [&](const std::string& part, const DatasetPtr& d) {
        say(fmt::format("{}: {}{}\n", printable(o.output), part.empty() ? "" : printable(part) + ": ", summary(*d)));
      });
  });
  if (!o.quiet)
    say(fmt::format("{}: {} steps{}\n", printable(o.output), written.steps,
                    written.before > 0 ? fmt::format(", {} of them new", written.steps - written.before) : ""));
  return 0;
}

}  // namespace

int run_convert(const Options& given, Context& context) {
  Options o = given;
  if (!o.inputs.empty()) o.output = output_name(o.output, stem_of(o.inputs[0]));
  PipelineFile file = pipeline_of(o);
  if (o.inputs.size() > 1) {
    const std::string series = as_series(o.inputs);
    fail_usage(
        "converts one file at a time", "sightglass convert",
        fmt::format("each by itself: for f in FILES; do sightglass convert \"$f\" -o '{{name}}.{}'; done{}", extension_of(given.output),
                    series.empty() ? "; one mesh of all: -f 'append with=FILE'"
                                   : fmt::format("; a series of them: {} --all-times -o NAME.vtkhdf; one of its steps: --step K", series)));
  }
  if (o.explain) {
    print_explanation(file);
    return 0;
  }
  const std::string target = o.output.substr(0, o.output.find_last_not_of('/') + 1);
  const Format& format = format_to_write(target);
  const bool series = o.all_times || !o.times.empty();
  if (o.resume && !series) fail_usage("goes on with a series", "--resume", "give --times, or --all-times for those of a file");
  if (!series && file_name_of(target).find("{n}") != std::string::npos)
    fail_usage("numbers the steps of a series", o.output, "give --times FIRST:LAST:COUNT, or --all-times for those of a file");
  const WriteOptions write = writing(o, format);
  if (series) return convert_series(file, o, write, context);
  if (format.write == write_zarr && o.filters.empty() && o.read.pieces == 1) return convert_slabs(file, o, write, context);
  const PipelineGraph built = build_graph(file);
  check_memory(built, o);
  Data data = built.graph.evaluate(built.last, {}, context);
  if (!(format.honours & writes_parts)) {
    std::string last = file.steps.back().name;
    std::vector<std::string> notes;
    leave_out_sets(file, last, data, {}, notes, context);
    for (const std::string& note : notes) context.info(note);
  }
  const StopWatch watch;
  write_data(o.output, in_pieces(data, write.pieces, context), write, context);
  context.log(LogLevel::debug, fmt::format("writing '{}': {}", o.output, watch.text()));
  if (!o.quiet)
    for_each_dataset(data, [&](const std::string& part, const DatasetPtr& d) {
      say(fmt::format("{}: {}{}\n", printable(o.output), part.empty() ? "" : printable(part) + ": ", summary(*d)));
    });
  if (auto* t = std::get_if<TablePtr>(&data); t && !o.quiet)
    say(fmt::format("{}: table of {} columns\n", printable(o.output), (*t)->columns.size()));
  return 0;
}

}  // namespace sg
