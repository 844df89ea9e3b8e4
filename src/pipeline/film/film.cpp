// SPDX-License-Identifier: Apache-2.0
// The pictures of a film, one after the other: the next step is read or computed while one is drawn.
#include "pipeline/film/film.h"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "base/error.h"
#include "base/text/text.h"
#include "data/fields/sampled_cloud.h"
#include "data/memory/memory_budget.h"
#include "io/film/movie.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/film/film_times.h"
#include "pipeline/picture/layers/picture_layers.h"
#include "pipeline/picture/picture_parts.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "pipeline/picture/settle_choices.h"
#include "scene/choose/shared_scale.h"
#include "scene/show/parts.h"
#include "scene/show/volume.h"
#include "simulate/run/kept_frames.h"

namespace sg {

namespace {

std::vector<Data> results_of(const PipelineFile& file, const StepResults& results, const std::shared_ptr<Cache>& cache, Context& context) {
  GraphOptions options;
  options.cache = cache;
  const PipelineGraph built = build_graph(file, options, results);
  std::vector<Target> targets;
  for (NodeId n : built.show) targets.push_back({n, {}});
  if (targets.empty()) targets.push_back({built.last, {}});
  return built.graph.evaluate(targets, context);
}

// Computes the results of one step while another is drawn, and holds them so that the cache finds them.
class Ahead {
 public:
  Ahead(PipelineFile file, const PictureOptions& options, Context& context)
      : thread_([this, file = std::move(file), &options, &context] {
          try {
            results_ = results_of(file, options.results, options.cache, context);
          } catch (...) {
            // Drawing meets the same error and reports it.
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

// What the i-th show shows at each of some times, one time after the other.
void for_each_shown(const std::vector<PipelineFile>& some, size_t i, const PictureOptions& options, Context& context,
                    const std::function<void(const DatasetPtr&, size_t n)>& f) {
  for (size_t n = 0; n < some.size(); ++n) {
    const std::vector<Data> data = results_of(some[n], options.results, std::make_shared<Cache>(0), context);
    for_each_dataset(data[std::min(i, data.size() - 1)], [&](const std::string&, const DatasetPtr& d) { f(d, n); });
  }
}

// Whether the words of a show state what transfer_words() says with `word`.
bool states(const PipelineFile::Show& show, const std::string& word) {
  const std::string_view key = std::string_view(word).substr(0, word.find('='));
  if (word_value(show.words, key)) return true;
  return key == "colors" && (word_value(show.words, "map") || word_value(show.words, "color"));
}

// What is seen through a volume, and in which colours, is the same in all pictures: what is not stated is chosen over the values of up to
// five steps spread over the series.
void fix_volume(PipelineFile::Show& show, const std::vector<PipelineFile>& some, size_t i, const PictureOptions& options,
                Context& context) {
  constexpr size_t samples = 500000;
  const ParamSet params = show_params(show_kind<VolumeShow>(), show.words);
  ShownParts first{{}, &show_kind<VolumeShow>(), &params};
  std::vector<DatasetPtr> others;
  for_each_shown(some, i, options, context, [&](const DatasetPtr& d, size_t n) {
    if (n == 0) first.parts.push_back(d);
    else others.push_back(sampled_cloud(*d, samples));
  });
  Scene scene;
  show_parts(scene, first, others, 1, context);
  if (scene.items.empty()) return;
  const auto& item = std::get<VolumeItem>(scene.items[0]);
  std::vector<std::string> words = transfer_words(item);
  words.push_back(fmt::format("range={},{}", exact_number(item.color.lo), exact_number(item.color.hi)));
  std::erase_if(words, [&](const std::string& word) { return states(show, word); });
  show.words.insert(show.words.end(), words.begin(), words.end());
  context.info(fmt::format("one range for all pictures: {} to {}, and one opacity, chosen over {} steps spread over the series",
                           short_number(item.color.lo), short_number(item.color.hi), some.size()));
}

// Colours mean the same in all pictures: where no range is stated, that of up to five steps spread over the series.
void fix_ranges(PipelineFile& first, const std::vector<PipelineFile>& some, const PictureOptions& options, Context& context) {
  for (size_t i = 0; i < first.show.size(); ++i) {
    PipelineFile::Show& show = first.show[i];
    const ShowKind& kind = find_show(show.kind);
    const ParamSet params = show_params(kind, show.words);
    if (kind.is<VolumeShow>()) fix_volume(show, some, i, options, context);
    if (kind.is<VolumeShow>() || !kind.coloring || !kind.coloring(params)->color.empty()) continue;
    ColoringParams& coloring = *kind.coloring(params);
    Range all;
    std::optional<Field> one;
    for_each_shown(some, i, options, context, [&](const DatasetPtr& d, size_t) {
      const Field* f = shown_field(kind, params, *d);
      if (!f || f->association == Association::whole || f->role == Role::colors) return;
      all.add(d->range(*f, f->components() > 1 ? coloring.component : 0));
      if (!one) one = *f;
    });
    if (!one || !share_range(*one, all, coloring)) continue;
    const Range range{coloring.range[0], coloring.range[1]};
    show.words.push_back(fmt::format("range={},{}", exact_number(range.lo), exact_number(range.hi)));
    context.info(fmt::format("one range for all pictures: {} to {}, that of {} steps spread over the series", short_number(range.lo),
                             short_number(range.hi), some.size()));
  }
}

// The camera stands still and the axes stay: where nothing is said of them, all pictures are of the box of up to five steps.
void fix_frame(PipelineFile& first, const std::vector<PipelineFile>& some, const PictureOptions& options, Context& context) {
  const StatedPicture stated = stated_in(some[0]);
  if (!stated.picture.frame.empty() || stated.camera.position || stated.camera.target || in_panels(stated.picture)) return;
  Box3 all;
  bool same = true;
  for (const PipelineFile& file : some) {
    Box3 box;
    for (const Data& data : placed(file, results_of(file, options.results, std::make_shared<Cache>(0), context), options.results, context))
      for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) { box.add(d->bounds()); });
    same = same && (all.empty() || box == all);
    all.add(box);
  }
  if (same || all.empty()) return;
  const std::string ends = box_words(all);
  first.picture.push_back("frame=" + ends);
  context.info(fmt::format("one box for all pictures, that of {} steps spread over the series: frame={}", some.size(), ends));
}

// Up to five steps spread over the series; one where all are the same.
std::vector<PipelineFile> spread(const PipelineFile& file, const FilmTimes& film) {
  const size_t count = film.times.size(), most = std::min<size_t>(5, count);
  std::vector<PipelineFile> some;
  for (size_t i = 0; i < most; ++i) {
    PipelineFile one = at_time(file, film, count == 1 ? 0 : i * (count - 1) / (most - 1));
    if (some.empty() || some.back().steps != one.steps || some.back().scene != one.scene) some.push_back(std::move(one));
  }
  return some;
}

// The pipeline of a film with the looks that its first picture gets.
PipelineFile with_looks(const PipelineFile& plain, PipelineFile first, const PictureOptions& options, Context& context) {
  std::vector<std::string> notes;
  std::vector<Data> looked;
  GraphOptions graph;
  graph.cache = options.cache;
  choose_looks(first, options, graph, looked, notes, context);
  // Without its time; the part of a volume in which something is seen is that of the first step alone.
  for (size_t i = 0; i < plain.steps.size(); ++i) first.steps[i].words = plain.steps[i].words;
  first.scene = plain.scene;
  std::vector<std::string> picture = plain.picture;
  for (const std::string& word : first.picture) {
    const std::string_view key = std::string_view(word).substr(0, word.find('='));
    if (key != "frame" && !word_value(plain.picture, key)) picture.push_back(word);
  }
  first.picture = std::move(picture);
  return first;
}

}  // namespace

std::vector<double> make_film(PipelineFile plain, const FilmParams& params, const PictureOptions& options, const FilmCallbacks& callbacks,
                              Context& outer) {
  // Every picture gives the same notes; two are under way at a time.
  std::mutex mutex;
  std::set<std::string> told;
  Context context(outer, 0, 1);
  context.on_log = [&](LogLevel level, std::string_view text) {
    const std::lock_guard lock(mutex);
    if (told.emplace(text).second) outer.log(level, text);
  };
  // Progress is that of the drawing: what goes on beside it tells none.
  Context silent(context, 0, 1);
  silent.on_progress = nullptr;
  if (params.turntable > 0 && !params.times.empty())
    fail_usage("a turntable has no times", "film turntable", "leave times out, or let the camera orbit with them: azimuth={t}");
  const FilmTimes film = params.turntable > 0 ? turn_camera(plain, params.turntable) : film_times(plain, params.times, silent);
  const size_t count = film.times.size();
  // What runs by is told where it is; title= (empty) tells nothing.
  if (!film.steps.empty() && is_movie(params.output) && !word_value(plain.picture, "title"))
    plain.picture.push_back("title=step {n} of {count}, t = {t}");
  if (callbacks.begin) callbacks.begin(film.times);
  // Before anything is drawn steps from all over the series are looked at: simulations run once for that and for the pictures.
  const KeptFrames kept(film.turns || !film.steps.empty() ? std::vector<double>() : film.times, allowed_memory() / 2);

  // The first picture chooses the looks of all.
  const auto cache = std::make_shared<Cache>(0);
  PictureOptions each = options;
  each.cache = cache, each.layers = !params.layers.empty();
  std::vector<Data> held;
  std::vector<PipelineFile> some = spread(plain, film);
  if (some.size() > 1) {
    GraphOptions graph;
    graph.cache = cache;
    settle_choices(plain, some, graph, each.results, held, silent);
  }
  held = results_of(at_time(plain, film, 0), each.results, cache, silent);
  const size_t one_step = array_memory() - std::min(array_memory(), KeptFrames::bytes());
  PipelineFile base = with_looks(plain, at_time(plain, film, 0), each, silent);
  each.coloring.clear();
  load_transfer_files(base);  // what they state is not chosen
  some = spread(base, film);
  if (some.size() > 1) {  // else the data are the same: so is all that is chosen from them
    fix_ranges(base, some, each, silent);
    fix_frame(base, some, each, silent);
  }

  const bool prefetch = outer.memory_limit == 0 || 2 * one_step < outer.memory_limit;
  if (!prefetch) context.info("two steps do not fit into the allowed memory: each is read when it is drawn");
  std::unique_ptr<Ahead> ahead;
  for (size_t n = 0; n < count; ++n) {
    context.check();
    PipelineFile file = at_time(base, film, n);
    if (n > 0 && !prefetch) held.clear();
    if (ahead) ahead->wait();
    const std::unique_ptr<Ahead> current = std::move(ahead);  // holds this step until it is drawn
    if (prefetch && n + 1 < count) ahead = std::make_unique<Ahead>(at_time(base, film, n + 1), each, silent);
    Context drawing(context, double(n) / double(count), double(n + 1) / double(count));
    Picture picture = make_picture(file, each, drawing);
    held.clear();
    const DatasetPtr layers = each.layers ? layers_of(picture) : nullptr;
    callbacks.frame({std::move(picture.image), layers, file, n, count, film.times[n]});
    context.progress(double(n + 1) / double(count), "drawing");
  }
  return film.times;
}

}  // namespace sg
