// SPDX-License-Identifier: Apache-2.0
// Films of scenes, and of pictures that a program makes itself.
#include "pipeline/film/film.h"

#include <algorithm>
#include <exception>
#include <optional>

#include "api/held.h"
#include "base/schema/value.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/offline/page.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture.h"

namespace sightglass {

namespace {

// What is stated of a film; only parameters in `known` are there.
sg::FilmParams film_params(const std::string& output, Params params, std::initializer_list<std::string_view> known) {
  sg::FilmParams film;
  film.output = output;
  sg::Schema schema = sg::schema_of(film);
  std::erase_if(schema.decls(), [&](const sg::ParamDecl& d) { return std::find(known.begin(), known.end(), d.name) == known.end(); });
  for (Param& p : params)  // times as numbers
    if (p.name == "times") p.value = sg::value_text(p.value.alternatives());
  set_values(schema, params, "film");
  return film;
}

// May a film show it otherwise at other times?
bool may_move(const Made& made, sg::Context& context) {
  if (sg::step_kind(made.operation) == sg::StepKind::memory) return false;
  if (sg::step_kind(made.operation) == sg::StepKind::read) return !open_times(made, context).empty();
  const sg::Operation& operation = sg::find_operation(made.operation);
  const sg::ParamDecl* time = sg::make_params(operation, made.words).schema.find("time");
  const bool of_itself = operation.run_series || operation.shows_moment || made.inputs.empty();
  if (of_itself && time && !time->stated) return true;
  return std::any_of(made.inputs.begin(), made.inputs.end(), [&](const auto& input) { return may_move(*input, context); });
}

// The pipeline of a scene that moves. What does not is taken as it is at hand.
template <class State>
sg::PipelineFile moving_pipeline(const State& scene, int width, int height, sg::StepResults& results, sg::Context& context) {
  sg::PipelineFile file = scene.pipeline(width, height, [&](const std::string& step, const Data::Held& held, StepsOf& steps) {
    if (may_move(*held.made, context)) add_memory(held.made, steps, results, "film()");
    else results.insert_or_assign(step, held.data);
  });
  // Above what is at hand nothing runs.
  for (const auto& step : file.steps)
    if (step.operation == sg::memory_step) results.try_emplace(step.name, sg::DatasetPtr());
  return file;
}

}  // namespace

std::vector<double> Scene::film(const std::string& output, const Params& params, int width, int height, const Context& context) const {
  return guarded([&] {
    const sg::FilmParams film = film_params(output, params, {"times", "fps"});
    sg::Context& core = context.state().core;
    sg::PictureOptions options;
    sg::PipelineFile file = moving_pipeline(*state_, width, height, options.results, core);
    return sg::write_film(std::move(file), film, options, core).times;
  });
}

std::vector<double> Scene::frames(const std::function<void(const Frame&)>& take, const Params& params, int width, int height,
                                  const Context& context) const {
  std::exception_ptr thrown;
  const auto hand_over = [&](sg::FilmFrame&& f) {
    const Frame frame{Image(std::make_shared<const Image::Held>(Image::Held{std::move(f.image), f.pipeline, {}})), f.number, f.count,
                      f.time};
    try {
      take(frame);
    } catch (...) {
      thrown = std::current_exception();
      throw sg::Error(sg::ErrorKind::cancelled, "the program ended the film");
    }
  };
  try {
    return guarded([&] {
      const sg::FilmParams film = film_params("", params, {"times"});
      sg::Context& core = context.state().core;
      sg::PictureOptions options;
      sg::PipelineFile file = moving_pipeline(*state_, width, height, options.results, core);
      return sg::make_film(std::move(file), film, options, {nullptr, hand_over}, core);
    });
  } catch (const Error&) {
    if (thrown) std::rethrow_exception(thrown);
    throw;
  }
}

PageWords page_words(const Params& params) {
  PageWords words;
  Params of_page, of_film;
  for (const Param& p : params) (p.name == "times" ? of_film : of_page).push_back(p);
  sg::Schema schema = sg::schema_of(words.page);
  set_values(schema, of_page, "page");
  words.film = film_params("", of_film, {"times"});
  return words;
}

std::string Scene::page(const Params& params, int width, int height, const Context& context) const {
  return guarded([&] {
    const auto [page, film] = page_words(params);
    sg::Context& core = context.state().core;
    sg::PictureOptions options;
    const auto at_hand = [&](const std::string& step, const Data::Held& held, StepsOf&) {
      options.results.insert_or_assign(step, held.data);
    };
    sg::PipelineFile file =
        film.times.empty() ? state_->pipeline(width, height, at_hand) : moving_pipeline(*state_, width, height, options.results, core);
    if (film.times.empty())
      for (const auto& step : file.steps) options.results.try_emplace(step.name, sg::DatasetPtr());
    return sg::make_page(std::move(file), page, film, options, core).html;
  });
}

struct Film::State {
  std::optional<sg::FilmWriter> writer;  // until it is finished

  sg::FilmWriter& open() {
    if (!writer) sg::fail_usage("is finished", "Film", "begin another one");
    return *writer;
  }
};

Film::Film(const std::string& output, const Params& params) : state_(std::make_shared<State>()) {
  guarded([&] { state_->writer.emplace(film_params(output, params, {"fps"})); });
}

void Film::add(const Image& image) {
  guarded([&] { state_->open().add(image.held().image, image.held().file); });
}

void Film::finish() {
  guarded([&] {
    state_->open().finish();
    state_->writer.reset();
  });
}

}  // namespace sightglass
