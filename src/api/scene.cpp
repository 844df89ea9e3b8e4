// SPDX-License-Identifier: Apache-2.0
// What is to be seen, and pictures of it.
#include <fmt/format.h>

#include "api/held.h"
#include "image/codec.h"
#include "pipeline/picture/picture.h"
#include "scene/camera_params.h"
#include "scene/choose/coloring.h"
#include "scene/show/show.h"

namespace sightglass {

namespace {

// What is stated for a way to show, checked.
std::vector<std::string> words_of_show(std::string_view way, const Params& params) {
  if (way == sg::auto_show) {
    sg::ColoringParams coloring;
    sg::Schema schema = sg::schema_of(coloring);
    set_values(schema, params, way);
    return stated_words(schema);
  }
  const sg::ShowKind& kind = sg::find_show(way);
  sg::ParamSet set = kind.make_params();
  set_values(set.schema, params, way);
  if (kind.check) kind.check(set);
  return stated_words(set.schema);
}

// What is stated, checked; where a film writes its time ("{t}") as it stands.
template <class P>
std::vector<std::string> checked_words(const Params& params, std::string_view owner) {
  P p;
  sg::Schema schema = sg::schema_of(p);
  Params plain;
  std::vector<std::string> timed;
  for (const Param& param : params) {
    const auto* word = std::get_if<std::string>(&param.value.alternatives());
    if (word && word->find("{t}") != word->npos && schema.find(param.name)) timed.push_back(param.name + "=" + *word);
    else plain.push_back(param);
  }
  set_values(schema, plain, owner);
  std::vector<std::string> words = stated_words(schema);
  words.insert(words.end(), timed.begin(), timed.end());
  return words;
}

// In the place of what was stated before.
void state_word(std::vector<std::string>& words, const std::string& word) {
  const std::string key = word.substr(0, word.find('=') + 1);
  std::erase_if(words, [&](const std::string& w) { return w.starts_with(key); });
  words.push_back(word);
}

}  // namespace

sg::PipelineFile Scene::State::pipeline(int width, int height,
                                        const std::function<void(const std::string&, const Data::Held&, StepsOf&)>& each) const {
  if (shown.empty()) sg::fail_usage("there is nothing to show", "Scene", "call show() first");
  StepsOf steps;
  std::vector<sg::PipelineFile::Show> shows;
  for (const Shown& s : shown) {
    const Data::Held& held = held_by(s.data);
    const std::string step = steps.add(held.made);
    each(step, held, steps);
    shows.push_back({s.way, s.words, step, 0});
  }
  sg::PipelineFile file = std::move(steps.file);
  file.show = std::move(shows);
  file.picture = picture;
  file.picture.insert(file.picture.end(), camera.begin(), camera.end());
  file.picture.push_back(fmt::format("size={}x{}", width, height));
  return file;
}

void watch(sg::PictureOptions& options, const sg::PipelineFile& file, const Context& context) {
  if (!context.state().picture) return;
  options.on_draft = [&file, &context](const sg::Picture& picture, const sg::PictureDraft&) {
    context.state().picture(Image(
        std::make_shared<const Image::Held>(Image::Held{picture.image, file, picture.notes, picture.seen, told_legends(picture.legends)})));
  };
}

Scene::Scene() : state_(std::make_shared<State>()) {}

Scene& Scene::show(const Data& data) { return show(data, sg::auto_show); }

Scene& Scene::show(const Data& data, std::string_view way, const Params& params) {
  return guarded([&]() -> Scene& {
    held_by(data);
    State next = *state_;
    next.shown.push_back({data, std::string(way), words_of_show(way, params)});
    state_ = std::make_shared<const State>(std::move(next));
    return *this;
  });
}

Scene& Scene::camera(const Params& params) {
  return guarded([&]() -> Scene& {
    State next = *state_;
    for (const std::string& w : checked_words<sg::CameraParams>(params, "camera")) state_word(next.camera, "camera." + w);
    state_ = std::make_shared<const State>(std::move(next));
    return *this;
  });
}

Scene& Scene::picture(const Params& params) {
  return guarded([&]() -> Scene& {
    State next = *state_;
    for (const std::string& w : checked_words<sg::PictureParams>(params, "picture")) state_word(next.picture, w);
    state_ = std::make_shared<const State>(std::move(next));
    return *this;
  });
}

Image Scene::render(int width, int height, const Context& context) const {
  return guarded([&] {
    sg::PictureOptions options;
    sg::PipelineFile file = state_->pipeline(width, height, [&](const std::string& step, const Data::Held& held, StepsOf&) {
      options.results.insert_or_assign(step, held.data);
    });
    // What is shown is at hand, so nothing above it runs.
    for (const auto& step : file.steps) options.results.try_emplace(step.name, sg::DatasetPtr());
    watch(options, file, context);
    sg::Picture picture = sg::make_picture(file, options, context.state().core);
    return Image(std::make_shared<const Image::Held>(Image::Held{std::move(picture.image), std::move(file), std::move(picture.notes),
                                                                 std::move(picture.seen), told_legends(picture.legends)}));
  });
}

Image::Image(std::shared_ptr<const Held> held) : held_(std::move(held)) {}
int Image::width() const { return held_->image.width; }
int Image::height() const { return held_->image.height; }
int Image::channels() const { return held_->image.channels; }
std::span<const uint8_t> Image::pixels() const { return held_->image.pixels; }
std::span<const float> Image::depth() const { return {held_->seen.depth.data(), held_->seen.depth.size()}; }
std::span<const float> Image::error() const { return {held_->seen.light.error.data(), held_->seen.light.error.size()}; }
std::span<const uint32_t> Image::ids() const { return {held_->seen.show.data(), held_->seen.show.size()}; }
const std::vector<Legend>& Image::legends() const { return held_->legends; }
const std::vector<std::string>& Image::notes() const { return held_->notes; }

std::string Image::recipe() const {
  return guarded([&] { return sg::emit_pipeline(sg::without_lent(held_->file)); });
}

void Image::write(const std::string& path) const {
  guarded([&] {
    sg::Image image = held_->image;
    sg::attach_recipe(image, held_->file, path);
    sg::write_image(path, image);
  });
}

std::vector<uint8_t> Image::png() const {
  return guarded([&] {
    sg::Image image = held_->image;
    sg::attach_recipe(image, held_->file, "");
    return sg::encode_png(image);
  });
}

}  // namespace sightglass
