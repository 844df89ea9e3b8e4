// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/light_edits.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/time_text.h"
#include "scene/light/environment_params.h"
#include "scene/light/light_params.h"
#include "serve/renderer/stated_lights.h"

namespace sg::serve {

namespace {

constexpr std::string_view light_place = "lights/";
constexpr const char* nothing_there = "there is nothing there to set";

void put_word(PipelineFile& file, std::string_view key, const std::string& text) {
  std::erase_if(file.picture, [&](const std::string& w) { return std::string_view(w).substr(0, w.find('=')) == key; });
  if (!text.empty()) file.picture.push_back(std::string(key) + "=" + text);
}

std::optional<size_t> index_of(const std::string& at, size_t count) {
  const auto n = at.starts_with(light_place) ? parse_int(std::string_view(at).substr(light_place.size())) : std::nullopt;
  return n && *n >= 0 && size_t(*n) < count ? std::optional(size_t(*n)) : std::nullopt;
}

template <class Kinds>
ParamSet params_of(const Kinds& kinds, const std::string& name) {
  for (const auto& k : kinds)
    if (equal_ignoring_case(k.name, name)) return k.make_params();
  fail_usage(fmt::format("there is no light or environment '{}'", name));
}

// Sets words of one light and checks it as a whole: what is stated twice, and what no text can hold. A word that waits for the time is
// looked at when there is one.
void set_checked(LightText& light, ParamSet params, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes) {
  const size_t before = mistakes.size();
  set_words(at, set, params.schema, light.words, mistakes);
  if (mistakes.size() > before) return;
  const std::string text = text_of_light(light);
  const bool is_environment = at == environment_word;
  try {
    if (is_environment ? environment_of_text(text) != light : lights_of_text(text) != std::vector{light})
      fail_usage("semicolons, and both kinds of quotes in one word, cannot be written here");
    if (has_time_mark(text)) return;
    if (is_environment) parse_environment(text);
    else parse_lights(text);
  } catch (const Error& e) {
    mistakes.push_back(mistake_of_set(at, set, e.what()));
  }
}

}  // namespace

bool is_light_place(const std::string& at) { return at == environment_word || at.starts_with(light_place); }

void set_light(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes) {
  if (at == environment_word) {
    auto environment = stated_environment(file);
    if (!environment) return mistakes.push_back({at, "", nothing_there});
    set_checked(*environment, params_of(environment_kinds(), environment->kind), at, set, mistakes);
    return put_word(file, environment_word, text_of_light(*environment));
  }
  std::vector<LightText> lights = stated_lights(file);
  const auto i = index_of(at, lights.size());
  if (!i) return mistakes.push_back({at, "", nothing_there});
  set_checked(lights[*i], params_of(light_kinds(), lights[*i].kind), at, set, mistakes);
  put_word(file, lights_word, text_of_lights(lights));
}

void add_light(PipelineFile& file, const std::string& kind, const Json& set, std::vector<EditMistake>& mistakes) {
  std::vector<LightText> lights = stated_lights(file);
  LightText light{kind, {}};
  set_checked(light, params_of(light_kinds(), kind), fmt::format("{}{}", light_place, lights.size()), set, mistakes);
  lights.push_back(std::move(light));
  put_word(file, lights_word, text_of_lights(lights));
}

void put_environment(PipelineFile& file, const std::string& kind, const Json& set, std::vector<EditMistake>& mistakes) {
  LightText environment{kind, {}};
  set_checked(environment, params_of(environment_kinds(), kind), std::string(environment_word), set, mistakes);
  put_word(file, environment_word, text_of_light(environment));
}

void remove_light(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes) {
  if (at == environment_word) return put_word(file, environment_word, "");
  std::vector<LightText> lights = stated_lights(file);
  const auto i = index_of(at, lights.size());
  if (!i) return mistakes.push_back({at, "", "there is nothing there to remove"});
  lights.erase(lights.begin() + ptrdiff_t(*i));
  put_word(file, lights_word, text_of_lights(lights));
}

}  // namespace sg::serve
