// SPDX-License-Identifier: Apache-2.0
#include "pipeline/film/film_times.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/text/replace.h"
#include "base/text/text.h"
#include "base/text/time_text.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/graph/series_input.h"
#include "pipeline/picture/prepare.h"

namespace sg {

namespace {

constexpr std::string_view here = "{t}";

// Writes the time where a word requests it. False when none does.
bool write_time(std::vector<std::string>& words, double time) {
  bool written = false;
  for (std::string& word : words)
    for (size_t at = word.find(here); at != word.npos; at = word.find(here, at)) {
      word.replace(at, here.size(), exact_number(time));
      written = true;
    }
  return written;
}
// Texts are for people: a short number, and which picture it is of how many.
bool write_texts(std::vector<std::string>& words, double time, size_t n, size_t count) {
  constexpr std::string_view texts[] = {"title=", "caption=", "note="};
  bool written = false;
  for (std::string& word : words) {
    if (std::none_of(std::begin(texts), std::end(texts), [&](std::string_view text) { return word.starts_with(text); })) continue;
    written = written || has_time_mark(word);
    word = with_time(std::move(word), time);
    replace_all(word, "{n}", std::to_string(n + 1));
    replace_all(word, "{count}", std::to_string(count));
  }
  return written;
}
// In a step: 'lic kernel=ripple phase={t}'.
bool write_time_in_steps(PipelineFile& file, double time) {
  bool written = false;
  for (PipelineFile::Step& s : file.steps) written = write_time(s.words, time) || written;
  return written;
}
// In the scene: 'angle: {t}', and nodes with keys.
bool write_time_in_scene(PipelineFile& file, double time) {
  bool written = false;
  for (PipelineFile::Node& n : file.scene) {
    written = write_time(n.words, time) || written;
    for (auto* lists : {&n.instances, &n.keys})
      for (auto& words : *lists) written = write_time(words, time) || written;
    written = write_time(n.at_words, time) || written;
    if (n.keys.empty() || word_value(n.words, "time")) continue;
    n.words.push_back("time=" + exact_number(time)), written = true;
  }
  return written;
}
bool asks_for_time(const PipelineFile& file) {
  PipelineFile scene;
  scene.scene = file.scene;
  if (write_time_in_scene(scene, 0)) return true;
  const auto asks = [](const std::vector<std::string>& words) {
    return std::any_of(words.begin(), words.end(), [](const std::string& w) { return has_time_mark(w); });
  };
  return asks(file.picture) || std::any_of(file.steps.begin(), file.steps.end(), [&](const auto& s) { return asks(s.words); });
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
    const Operation* op = known_operation(s.operation);
    if (!op || op->kind == OperationKind::source) continue;
    const bool series = op->run_series != nullptr;
    if (!series && !inside[i]) continue;
    if (s.from.empty() && i > 0) inside[i - 1] = 1;
    for (size_t k = 0; k < s.from.size(); ++k)
      if (k == 0 || inside[i]) mark(s.from[k]);
  }
  return inside;
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
    if (!s.reads()) continue;
    ReadParams params;
    Schema schema = schema_of(params);
    set_params(schema, s.words, "read");
    check(params.options);
    const std::string path = series_beside(file.origin, params.path);
    std::vector<double> times = file_times(path, params.options, context);
    if (r.first.empty()) r.first = path;
    const bool further = s.name.starts_with("with") && file.origin.empty();  // of -f 'probe with=FILE'
    if (times.empty() || params.options.time || params.options.step >= 0) r.still.insert(s.name);
    else if (r.path.empty() && !further) r.path = path, r.times = std::move(times);
  }
  return r;
}

// "0:114" = those of the file in between; for sources 0, 1, ... 114.
std::vector<double> times_to_draw(const std::string& asked, const PipelineFile& file, const Reads& reads, std::vector<size_t>& steps,
                                  std::string_view without) {
  const auto ends = split(asked, ':');
  const bool range = ends.size() == 2;
  if (!asked.empty() && !range) return parse_times(asked, "--times");
  const auto first = range ? parse_double(ends[0]) : -HUGE_VAL, last = range ? parse_double(ends[1]) : HUGE_VAL;
  if (!first || !last || !(*first <= *last))
    fail_usage(fmt::format("'{}' is not a range of times", asked), "--times", "write FIRST:LAST, FIRST:LAST:COUNT, or a list");
  std::vector<double> times;
  const bool computed = asks_for_time(file) || std::any_of(file.steps.begin(), file.steps.end(), [](const PipelineFile::Step& s) {
                          const Operation* op = known_operation(s.operation);
                          return op && op->kind == OperationKind::source;
                        });
  if (reads.path.empty() && !computed) fail_usage("has no time steps", reads.first, std::string(without));
  if (const std::vector<double>& all = reads.times; !reads.path.empty()) {
    for (size_t k = 0; k < all.size(); ++k)
      if (all[k] >= *first && all[k] <= *last) times.push_back(all[k]), steps.push_back(k);
    if (times.empty())
      fail_usage(fmt::format("no time step of '{}' lies in that range: it has {} to {}", reads.path, exact_number(all.front()),
                             exact_number(all.back())),
                 "--times", "give FIRST:LAST within the times of the file");
  } else if (range && *last - *first < 1e6) {
    for (int k = 0; *first + k <= *last; ++k) times.push_back(*first + k);
  } else {
    fail_usage("a series from a source needs times", "--times", "give FIRST:LAST:COUNT, e.g. --times 0:10:101");
  }
  return times;
}

}  // namespace

FilmTimes film_times(const PipelineFile& file, const std::string& asked, Context& context, std::string_view without) {
  Reads reads = reads_of(file, context);
  FilmTimes film;
  film.times = times_to_draw(asked, file, reads, film.steps, without);
  film.still = std::move(reads.still);
  return film;
}

FilmTimes turn_camera(PipelineFile& file, int count) {
  FilmTimes film;
  film.turns = true;
  double first = 0;
  const std::string own = "azimuth=", below = "camera.azimuth=";
  bool stated = false;
  for (std::string& word : file.picture) {
    if (word.starts_with(below)) {
      first = parse_double(word.substr(below.size())).value_or(0);
      word = below + std::string(here), stated = true;
    } else if (word.starts_with("camera=")) {
      std::string text;
      for (const std::string& w : quoted_words(word.substr(7))) {
        if (w.starts_with(own)) first = parse_double(w.substr(own.size())).value_or(0);
        else text += w + " ";
      }
      word = "camera=" + text + own + std::string(here), stated = true;
    }
  }
  if (!stated) file.picture.push_back(below + std::string(here));
  for (int k = 0; k < count; ++k) film.times.push_back(first + 360.0 * k / count);
  return film;
}

PipelineFile at_time(PipelineFile file, const FilmTimes& film, size_t n) {
  const double time = film.times[n];
  const bool of_files = !film.steps.empty();
  const bool in_texts = write_texts(file.picture, time, n, film.times.size());
  const bool in_picture = write_time(file.picture, time) || in_texts;
  if (film.turns) return file;
  const bool shutter = of_files && stated_in(file).camera.shutter > 0;  // which is open before and after the step's time
  const bool in_scene = write_time_in_scene(file, time);
  if (write_time_in_steps(file, time)) return file;
  bool moment = false;
  for (PipelineFile::Step& s : file.steps)
    if (const Operation* op = known_operation(s.operation); op && op->shows_moment && !of_files && !word_value(s.words, "time"))
      s.words.push_back("time=" + exact_number(time)), moment = true;
  if (moment) return file;
  const std::vector<char> inside = inside_series(file);
  bool moves = false;
  std::string source;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    PipelineFile::Step& s = file.steps[i];
    if (inside[i]) continue;
    const Operation* op = known_operation(s.operation);
    if (s.reads()) {
      if (film.still.count(s.name)) continue;
      s.words.push_back(of_files && !shutter ? fmt::format("step={}", film.steps[n]) : "time=" + exact_number(time));
      moves = true;
    } else if (op && (op->run_series || op->kind == OperationKind::source)) {
      if (op->kind == OperationKind::source) source = s.operation;
      if (word_value(s.words, "time") || !op->make_params().schema.find("time")) continue;
      s.words.push_back("time=" + exact_number(time));
      moves = true;
    }
  }
  if (!moves && !source.empty() && !in_picture && !in_scene)
    fail_usage(fmt::format("the source '{}' has no parameter 'time', or it is already set", source), "--times",
               "a series needs a source with a parameter 'time'");
  return file;
}

}  // namespace sg
