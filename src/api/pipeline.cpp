// SPDX-License-Identifier: Apache-2.0
// Pipelines that are kept, changed and run again.
#include <fmt/format.h>

#include <algorithm>

#include "api/held.h"
#include "base/file/file.h"
#include "image/codec.h"
#include "io/options.h"
#include "pipeline/offline/page.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture.h"

namespace sightglass {

struct Pipeline::State {
  sg::PipelineFile file;
  sg::StepResults results;                              // numbers from memory
  std::vector<std::shared_ptr<const Data::Held>> held;  // those, as long as the cache may know them by their place
  std::shared_ptr<const Made> made;                     // of what it was made of
  std::shared_ptr<sg::Cache> cache = std::make_shared<sg::Cache>(uint64_t(512) << 20);

  sg::PipelineGraph graph() const {
    sg::GraphOptions options;
    options.cache = cache;
    return sg::build_graph(file, options, results);
  }
  // 0: as it states.
  sg::PipelineFile sized(int width, int height) const {
    sg::PipelineFile sized = file;
    if (width > 0 && height > 0) sized.picture.push_back(fmt::format("size={}x{}", width, height));
    return sized;
  }
  sg::PipelineFile::Step& step(std::string_view name) {
    std::vector<std::string> names;
    for (auto& s : file.steps) {
      if (s.name == name) return s;
      names.push_back(s.name);
    }
    sg::fail_usage(fmt::format("unknown step '{}'", name), "Pipeline", sg::unknown_name_hint(name, names));
  }
};

namespace {

// The steps that made it, those above first.
template <class F>
void for_each_step(const std::shared_ptr<const Made>& made, const F& f) {
  for (const auto& input : made->inputs) for_each_step(input, f);
  f(made);
}

std::pair<std::string, std::string> stated(const std::string& word) {
  const size_t equals = word.find('=');
  return equals == word.npos ? std::pair{word, std::string()} : std::pair{word.substr(0, equals), word.substr(equals + 1)};
}

// What is stated anew, checked against what the step takes.
std::vector<std::string> checked(const sg::PipelineFile::Step& step, const Params& params) {
  if (sg::step_kind(step.operation) == sg::StepKind::memory)
    sg::fail_usage("its numbers come from memory", step.name, "make a pipeline of other data");
  if (sg::step_kind(step.operation) == sg::StepKind::read) {
    sg::ReadParams p;
    sg::Schema schema = sg::schema_of(p);
    set_values(schema, params, "read");
    return stated_words(schema);
  }
  const sg::ParamSet set = sg::find_operation(step.operation).make_params();
  set_values(const_cast<sg::Schema&>(set.schema), params, step.operation);
  return stated_words(set.schema);
}

}  // namespace

Pipeline::Pipeline(std::shared_ptr<State> state) : state_(std::move(state)) {}

Pipeline::Pipeline(const Data& data) : state_(std::make_shared<State>()) {
  guarded([&] {
    StepsOf steps;
    state_->made = held_by(data).made;
    steps.add(state_->made);
    for_each_step(state_->made, [&](const std::shared_ptr<const Made>& made) {
      if (sg::step_kind(made->operation) != sg::StepKind::memory) return;
      const auto held = made->memory.lock();
      if (!held)
        sg::fail_usage("numbers from memory that it came from are gone (" + made->words.at(0) + ")", "Pipeline",
                       "keep the Data that hold them");
      state_->held.push_back(held);
      // The cache is of this pipeline alone, which holds the data: their place in memory stands for them.
      state_->results.insert_or_assign(steps.add(made), sg::StepResult(held->data, fmt::format("memory {}", fmt::ptr(held.get()))));
    });
    state_->file = std::move(steps.file);
  });
}

Pipeline Pipeline::parse(std::string_view yaml) {
  return guarded([&] {
    auto state = std::make_shared<State>();
    state->file = sg::parse_pipeline(yaml, "", sg::picture_vocabulary());
    return Pipeline(std::move(state));
  });
}

Pipeline Pipeline::read(const std::string& path) {
  return guarded([&] {
    auto state = std::make_shared<State>();
    state->file = sg::read_pipeline(path, sg::picture_vocabulary());
    return Pipeline(std::move(state));
  });
}

Pipeline Pipeline::open(const std::string& picture, std::vector<std::string>* changed) {
  return guarded([&] {
    auto state = std::make_shared<State>();
    std::vector<std::string> inputs;
    state->file = sg::recipe_in(sg::read_png(picture), picture, inputs);
    if (changed) *changed = std::move(inputs);
    return Pipeline(std::move(state));
  });
}

std::vector<Pipeline::Step> Pipeline::steps() const {
  std::vector<Step> all;
  for (const auto& s : state_->file.steps) {
    Step step{s.name, s.operation, {}, s.from};
    for (const std::string& w : s.words) step.stated.push_back(stated(w));
    all.push_back(std::move(step));
  }
  return all;
}

Pipeline& Pipeline::set(std::string_view name, const Params& params) {
  return guarded([&]() -> Pipeline& {
    auto next = std::make_shared<State>(*state_);
    sg::PipelineFile::Step& step = next->step(name);
    Params stated_ones;
    for (const Param& p : params)
      if (!std::holds_alternative<std::monostate>(p.value.alternatives())) stated_ones.push_back(p);
    for (const std::string& word : checked(step, stated_ones)) {
      const std::string key = word.substr(0, word.find('=') + 1);
      std::erase_if(step.words, [&](const std::string& w) { return w.starts_with(key); });
      step.words.push_back(word);
    }
    for (const Param& p : params)
      if (std::holds_alternative<std::monostate>(p.value.alternatives()))
        std::erase_if(step.words, [&](const std::string& w) { return w.starts_with(p.name + "="); });
    state_ = std::move(next);
    return *this;
  });
}

Data Pipeline::result(std::string_view name, const Context& context) const {
  return guarded([&] {
    const sg::PipelineGraph built = state_->graph();
    sg::NodeId node = built.last;
    if (!name.empty()) {
      const std::string& wanted = state_->step(name).name;
      node = std::find_if(built.nodes.begin(), built.nodes.end(), [&](const auto& n) { return n.first == wanted; })->second;
    }
    sg::Data data = built.graph.evaluate(node, {}, context.state().core);
    // Known as what it is: what is set later does not change where it came from.
    std::string about = fmt::format("result of a pipeline, step {}", name.empty() ? state_->file.steps.back().name : std::string(name));
    return data_from_memory(std::move(data), std::move(about));
  });
}

Image Pipeline::render(int width, int height, const Context& context) const {
  return guarded([&] {
    sg::PictureOptions options;
    options.cache = state_->cache;
    options.results = state_->results;
    sg::PipelineFile file = state_->sized(width, height);
    watch(options, file, context);
    sg::Picture picture = sg::make_picture(file, options, context.state().core);
    return Image(std::make_shared<const Image::Held>(Image::Held{std::move(picture.image), std::move(file), std::move(picture.notes),
                                                                 std::move(picture.seen), told_legends(picture.legends)}));
  });
}

std::string Pipeline::page(const Params& params, int width, int height, const Context& context) const {
  return guarded([&] {
    const auto [page, film] = page_words(params);
    sg::PictureOptions options;
    options.cache = state_->cache, options.results = state_->results;
    return sg::make_page(state_->sized(width, height), page, film, options, context.state().core, sg::UnstatedTimes::one).html;
  });
}

std::string Pipeline::explain() const {
  return guarded([&] {
    const sg::PipelineGraph built = state_->graph();
    return built.graph.explain(built.last);
  });
}

std::string Pipeline::text() const {
  return guarded([&] { return sg::emit_pipeline(sg::without_lent(state_->file)); });
}

void Pipeline::write(const std::string& path) const {
  guarded([&] { sg::write_file(path, text()); });
}

void Pipeline::set_cache_limit(size_t bytes) { state_->cache->set_limit(bytes); }

}  // namespace sightglass
