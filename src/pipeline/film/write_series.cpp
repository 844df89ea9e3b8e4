// SPDX-License-Identifier: Apache-2.0
#include "pipeline/film/write_series.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "io/steps/steps.h"
#include "pipeline/film/film_times.h"
#include "pipeline/graph/graph.h"
#include "pipeline/graph/key.h"

namespace sg {

namespace {

// What tells series apart: all that the data depend on, without where a run keeps its state.
std::string recipe_of(PipelineFile file) {
  for (PipelineFile::Step& s : file.steps)
    std::erase_if(s.words, [](const std::string& w) { return w.starts_with("store=") || w.starts_with("store_every="); });
  file.show.clear(), file.picture.clear();
  const std::string text = emit_pipeline(file);
  return key_text(hash_bytes(text.data(), text.size()));
}

}  // namespace

SeriesWritten write_series(const PipelineFile& file, const SeriesParams& params, const WriteOptions& options, Context& context,
                           const std::function<void(size_t, double, const Data&)>& wrote) {
  const FilmTimes times = film_times(file, params.times, context, "leave --all-times (and --times) out: it is converted whole");
  if (times.times.size() > 1 && at_time(file, times, 0).steps == at_time(file, times, 1).steps)
    fail_usage("nothing in it changes with time", "--times", "leave it out, or read a series, or compute one: --source");
  const auto writer = write_steps(params.output, {times.times, recipe_of(file), params.resume}, options, context);
  const SeriesWritten written{times.times.size(), writer->done()};
  if (written.before > 0)
    context.info(fmt::format("{} steps are there; going on behind time {}", written.before, exact_number(times.times[written.before - 1])));
  GraphOptions graph;
  graph.cache = std::make_shared<Cache>(graph.cache_limit);  // of steps that are the same at all times
  for (size_t n = writer->done(); n < times.times.size(); ++n) {
    context.check();
    Context part(context, double(n) / double(written.steps), double(n + 1) / double(written.steps));
    const PipelineGraph built = build_graph(at_time(file, times, n), graph);
    const Data data = built.graph.evaluate(built.last, {}, part);
    writer->add(data, part);
    if (wrote) wrote(n, times.times[n], data);
  }
  writer->finish();
  return written;
}

}  // namespace sg
