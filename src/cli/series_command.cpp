// SPDX-License-Identifier: Apache-2.0
// render and run of a time series: one numbered picture per step, the next step read or computed while one is drawn.
#include <fmt/core.h>

#include <cstdio>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "cli/chain.h"
#include "cli/cli.h"
#include "cli/say.h"
#include "data/memory/memory_budget.h"
#include "image/codec.h"
#include "io/file_series.h"
#include "io/film/movie.h"
#include "pipeline/file/read_params.h"
#include "pipeline/graph/series_input.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/choose/shared_scale.h"
#include "scene/show/show.h"

namespace sg {

namespace {

constexpr std::string_view mark = "{n}";

std::string numbered(const std::string& pattern, size_t n, size_t count) {
  const size_t at = pattern.find(mark), digits = std::max<size_t>(3, std::to_string(count - 1).size());
  return pattern.substr(0, at) + fmt::format("{:0{}}", n, digits) + pattern.substr(at + mark.size());
}

// Writes the time where a parameter asks for it: 'lic kernel=ripple phase={t}'. False when none does.
bool write_time(PipelineFile& file, double time) {
  constexpr std::string_view here = "{t}";
  bool written = false;
  for (PipelineFile::Step& s : file.steps)
    for (std::string& word : s.words)
      for (size_t at = word.find(here); at != word.npos; at = word.find(here, at)) {
        word.replace(at, here.size(), exact_number(time));
        written = true;
      }
  return written;
}

const Operation* operation_of(const PipelineFile::Step& step) {
  const auto known = operations();
  const auto op = std::find_if(known.begin(), known.end(), [&](const Operation& o) { return o.name == step.operation; });
  return op == known.end() ? nullptr : &*op;
}

// Steps all of whose times an operation on series takes.
std::vector<char> inside_series(const PipelineFile& file) {
  std::vector<char> inside(file.steps.size(), 0);
  const auto mark = [&](const std::string& name) {
    for (size_t k = 0; k < file.steps.size(); ++k)
      if (file.steps[k].name == name) inside[k] = 1;
  };
  for (size_t i = file.steps.size(); i-- > 0;) {
    const PipelineFile::Step& s = file.steps[i];
    const Operation* op = operation_of(s);
    if (!op || op->kind == OperationKind::source) continue;
    const bool series = op->run_series != nullptr;
    if (!series && !inside[i]) continue;
    if (s.from.empty() && i > 0) inside[i - 1] = 1;
    for (size_t k = 0; k < s.from.size(); ++k)
      if (k == 0 || inside[i]) mark(s.from[k]);
  }
  return inside;
}

// The pipeline of one step: the parameters that ask for the time get it, else trails, whose lines stay, else readers and sources with a
// time, and operations on series in place of what lies above them. `still`: steps that read the same at all times.
PipelineFile at_time(PipelineFile file, double time, std::optional<size_t> step, const std::set<std::string>& still) {
  if (write_time(file, time)) return file;
  bool of_trails = false;
  for (PipelineFile::Step& s : file.steps)
    if (s.operation == "trails" && !step && !word_value(s.words, "time")) s.words.push_back("time=" + exact_number(time)), of_trails = true;
  if (of_trails) return file;
  const std::vector<char> inside = inside_series(file);
  bool moves = false;
  std::string source;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    PipelineFile::Step& s = file.steps[i];
    if (inside[i]) continue;
    const Operation* op = operation_of(s);
    if (s.operation == "read") {
      if (still.count(s.name)) continue;
      s.words.push_back(step ? fmt::format("step={}", *step) : "time=" + exact_number(time));
      moves = true;
    } else if (op && (op->run_series || op->kind == OperationKind::source)) {
      if (op->kind == OperationKind::source) source = s.operation;
      if (word_value(s.words, "time") || !op->make_params().schema.find("time")) continue;
      s.words.push_back("time=" + exact_number(time));
      moves = true;
    }
  }
  if (!moves && !source.empty())
    fail_usage(fmt::format("the source '{}' has no time, or states one", source), "--times",
               "a series needs a source with a parameter 'time'");
  return file;
}

std::vector<Data> results_of(const PipelineFile& file, const std::shared_ptr<Cache>& cache, Context& context) {
  GraphOptions options;
  options.cache = cache;
  const PipelineGraph built = build_graph(file, options);
  std::vector<Target> targets;
  for (NodeId n : built.show) targets.push_back({n, {}});
  if (targets.empty()) targets.push_back({built.last, {}});
  return built.graph.evaluate(targets, context);
}

// Computes the results of a step beside the drawing of another, and holds them so that the cache finds them.
class Ahead {
 public:
  Ahead(PipelineFile file, std::shared_ptr<Cache> cache, Context& context)
      : thread_([this, file = std::move(file), cache = std::move(cache), &context] {
          try {
            results_ = results_of(file, cache, context);
          } catch (...) {
            // The drawing meets the same error and says it.
          }
        }) {}
  ~Ahead() { wait(); }
  Ahead(const Ahead&) = delete;
  Ahead& operator=(const Ahead&) = delete;
  void wait() {
    if (thread_.joinable()) thread_.join();
  }

 private:
  std::vector<Data> results_;
  std::thread thread_;
};

// Colours mean the same in all pictures: where no range is stated, that of up to five steps spread over the series.
void fix_ranges(PipelineFile& first, const std::vector<PipelineFile>& some, Context& context) {
  for (size_t i = 0; i < first.show.size(); ++i) {
    PipelineFile::Show& show = first.show[i];
    const ShowKind& kind = find_show(show.kind);
    const ParamSet params = show_params(kind, show.words);
    if (!kind.coloring || !kind.coloring(params)->color.empty()) continue;
    ColoringParams& coloring = *kind.coloring(params);
    Range all;
    std::optional<Field> one;
    for (const PipelineFile& file : some) {
      const std::vector<Data> data = results_of(file, std::make_shared<Cache>(0), context);
      for_each_dataset(data[std::min(i, data.size() - 1)], [&](const std::string&, const DatasetPtr& d) {
        const Field* f = shown_field(kind, params, *d);
        if (!f || f->association == Association::whole || f->role == Role::colors) return;
        all.add(d->range(*f, f->components() > 1 ? coloring.component : 0));
        if (!one) one = *f;
      });
    }
    if (!one || !share_range(*one, all, coloring)) continue;
    const Range range{coloring.range[0], coloring.range[1]};
    show.words.push_back(fmt::format("range={},{}", exact_number(range.lo), exact_number(range.hi)));
    context.info(fmt::format("one range for all pictures: {} to {}, that of {} steps spread over the series", short_number(range.lo),
                             short_number(range.hi), some.size()));
  }
}

// What reads files: the series, whose steps are drawn, and what reads the same at all times.
struct Reads {
  std::string path, first;  // of the series ("" = none has steps); of the first of all
  std::vector<double> times;
  std::set<std::string> still;
};

Reads reads_of(const PipelineFile& file, Context& context) {
  Reads r;
  for (const PipelineFile::Step& s : file.steps) {
    if (s.operation != "read") continue;
    ReadParams params;
    Schema schema = schema_of(params);
    set_params(schema, s.words, "read");
    const std::string path = series_beside(file.origin, params.path);
    std::vector<double> times = file_times(path, read_options(params), context);
    if (r.first.empty()) r.first = path;
    const bool further = s.name.starts_with("with") && file.origin.empty();  // of -f 'probe with=FILE'
    if (times.empty() || params.time || params.step >= 0) r.still.insert(s.name);
    else if (r.path.empty() && !further) r.path = path, r.times = std::move(times);
  }
  return r;
}

// "0:114" = those of the file in between; for sources 0, 1, ... 114.
std::vector<double> times_to_draw(const std::string& asked, const PipelineFile& file, const Reads& reads, bool& by_step,
                                  std::vector<size_t>& numbers) {
  const auto ends = split(asked, ':');
  const bool range = ends.size() == 2;
  if (!asked.empty() && !range) return parse_times(asked, "--times");
  const auto first = range ? parse_double(ends[0]) : -HUGE_VAL, last = range ? parse_double(ends[1]) : HUGE_VAL;
  if (!first || !last || !(*first <= *last))
    fail_usage(fmt::format("'{}' is no range of times", asked), "--times", "FIRST:LAST, FIRST:LAST:COUNT, or a list");
  std::vector<double> times;
  const bool computed = std::any_of(file.steps.begin(), file.steps.end(), [](const PipelineFile::Step& s) {
    const Operation* op = operation_of(s);
    return op && op->kind == OperationKind::source;
  });
  if (reads.path.empty() && !computed) fail_usage("has no time steps", reads.first, "a picture without {n} in its name shows it");
  if (const std::vector<double>& all = reads.times; !reads.path.empty()) {
    by_step = true;
    for (size_t k = 0; k < all.size(); ++k)
      if (all[k] >= *first && all[k] <= *last) times.push_back(all[k]), numbers.push_back(k);
    if (times.empty())
      fail_usage(
          fmt::format("no time step of '{}' lies there: it has {} to {}", reads.path, exact_number(all.front()), exact_number(all.back())),
          "--times", "FIRST:LAST in the times of the file");
  } else if (range && *last - *first < 1e6) {
    for (int k = 0; *first + k <= *last; ++k) times.push_back(*first + k);
  } else {
    fail_usage("a series of a source needs its times", "--times", "FIRST:LAST:COUNT, like --times 0:10:101");
  }
  return times;
}

// Where the pictures go: numbered files, or frames of one film.
class Sink {
 public:
  Sink(const std::string& output, double fps, size_t count) : output_(output), count_(count) {
    if (!is_movie(output_)) {
      AtomicFile probe(numbered(output_, 0, count));
      return;
    }
    settings_.fps = fps;
    movie_ = std::make_unique<MovieWriter>(output_, settings_);
  }
  void add(Image image, const PipelineFile& file, size_t n) {
    if (movie_) return movie_->add(image);
    const std::string name = numbered(output_, n, count_);
    attach_recipe(image, file, name);
    write_image(name, image);
  }
  /// What was written.
  std::string finish() {
    if (!movie_) return numbered(output_, 0, count_) + " ... " + numbered(output_, count_ - 1, count_);
    movie_->finish();
    return output_;
  }

 private:
  std::string output_;
  size_t count_;
  MovieSettings settings_;
  std::unique_ptr<MovieWriter> movie_;
};

// The pipeline of a series with the looks that its first picture gets.
PipelineFile with_looks(const PipelineFile& plain, PipelineFile first, const PictureOptions& options, Context& context) {
  std::vector<std::string> notes;
  std::vector<Data> looked;
  choose_looks(first, options, options.cache, looked, notes, context);
  for (size_t i = 0; i < plain.steps.size(); ++i) first.steps[i].words = plain.steps[i].words;  // without its time
  return first;
}

}  // namespace

bool is_numbered(const std::string& output) { return output.find(mark) != std::string::npos || is_movie(output); }

int render_series(PipelineFile plain, const SeriesRequest& request, const PictureOptions& options, const Options& o, Context& outer) {
  // One picture after the other says the same; two are under way at a time.
  std::mutex mutex;
  std::set<std::string> told;
  Context context(outer, 0, 1);
  context.on_log = [&](LogLevel level, std::string_view text) {
    const std::lock_guard lock(mutex);
    if (told.emplace(text).second) outer.log(level, text);
  };
  bool by_step = false;
  std::vector<size_t> numbers;
  const Reads reads = reads_of(plain, context);
  const std::vector<double> times = times_to_draw(request.times, plain, reads, by_step, numbers);
  const auto step = [&](const PipelineFile& file, size_t n) {
    return at_time(file, times[n], by_step ? std::optional<size_t>(numbers[n]) : std::nullopt, reads.still);
  };
  Sink sink(request.output, request.fps, times.size());

  // The first picture chooses the looks of all.
  const auto cache = std::make_shared<Cache>(0);
  PictureOptions each = options;
  each.cache = cache;
  std::vector<Data> held = results_of(step(plain, 0), cache, context);
  const size_t one_step = array_memory();
  PipelineFile base = with_looks(plain, step(plain, 0), each, context);
  each.coloring.clear();
  std::vector<PipelineFile> some;
  for (size_t i = 0; i < std::min<size_t>(5, times.size()); ++i)
    some.push_back(step(base, times.size() == 1 ? 0 : i * (times.size() - 1) / (std::min<size_t>(5, times.size()) - 1)));
  fix_ranges(base, some, context);

  const bool prefetch = o.memory == 0 || 2 * one_step < o.memory;
  if (!prefetch) context.info("two steps do not fit into the memory allowed: each is read when it is drawn");
  std::unique_ptr<Ahead> ahead;
  for (size_t n = 0; n < times.size(); ++n) {
    context.check();
    PipelineFile file = step(base, n);
    if (n > 0 && !prefetch) held.clear();
    if (ahead) ahead->wait();
    const std::unique_ptr<Ahead> current = std::move(ahead);  // holds this step until it is drawn
    if (prefetch && n + 1 < times.size()) ahead = std::make_unique<Ahead>(step(base, n + 1), cache, context);
    Picture picture = make_picture(file, each, context);
    held.clear();
    sink.add(std::move(picture.image), file, n);
    context.progress(double(n + 1) / double(times.size()), "drawing");
  }
  const std::string what = sink.finish();
  if (!o.quiet)
    say(fmt::format("{}: {} pictures, times {} to {}\n", printable(what), times.size(), short_number(times.front()),
                    short_number(times.back())));
  return 0;
}

}  // namespace sg
