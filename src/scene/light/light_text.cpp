// SPDX-License-Identifier: Apache-2.0
#include "scene/light/light_text.h"

#include <algorithm>

#include "base/text/quoted_word.h"
#include "base/text/text.h"
#include "scene/light/environment_params.h"

namespace sg {

namespace {

// A word that is no kind but has a dot or a slash is a file's name.
bool is_file(const std::string& word) {
  const auto kinds = environment_kinds();
  const bool kind = std::any_of(kinds.begin(), kinds.end(), [&](const EnvironmentKind& k) { return equal_ignoring_case(k.name, word); });
  return !kind && word.find('=') == std::string::npos && word.find_first_of("./") != std::string::npos;
}

std::optional<LightText> light_of(std::string_view text) {
  const std::vector<std::string> all = quoted_words(text);
  if (all.empty()) return {};
  return LightText{all[0], {all.begin() + 1, all.end()}};
}

}  // namespace

std::vector<LightText> lights_of_text(const std::string& text) {
  std::vector<LightText> lights;
  for (const std::string_view part : split(text, ';'))
    if (auto light = light_of(part)) lights.push_back(std::move(*light));
  return lights;
}

std::optional<LightText> environment_of_text(const std::string& text) {
  auto environment = light_of(text);
  if (environment && is_file(environment->kind)) {
    environment->words.insert(environment->words.begin(), "file=" + environment->kind);
    environment->kind = picture_environment;
  }
  return environment;
}

std::string text_of_light(const LightText& light) {
  std::string r = quoted_word(light.kind);
  for (const std::string& w : light.words) r += " " + quoted_word(w);
  return r;
}

std::string text_of_lights(const std::vector<LightText>& lights) {
  std::string r;
  for (const LightText& l : lights) r += (r.empty() ? "" : "; ") + text_of_light(l);
  return r;
}

}  // namespace sg
