// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/tell_scene.h"

#include "base/error.h"
#include "base/text/text.h"
#include "serve/renderer/stated_lights.h"
#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

Json light_json(const LightText& light) {
  return Json(Json::Members{{"kind", text(to_lower(light.kind))}, {"words", words_json(light.words)}});
}

// The words of so many entries as a person changes one by one; more are counted alone.
Json entries_json(const std::vector<std::vector<std::string>>& entries) {
  constexpr size_t most = 100;
  std::vector<Json> list;
  for (size_t i = 0; i < entries.size() && i < most; ++i) list.push_back(words_json(entries[i]));
  return Json(std::move(list));
}

Json node_json(const PipelineFile& file, const PipelineFile::Node& n) {
  return Json(Json::Members{{"name", text(n.name)},
                            {"in", text(n.parent < 0 ? std::string() : file.scene[size_t(n.parent)].name)},
                            {"words", words_json(n.words)},
                            {"copies", Json(uint64_t(n.instances.size()))},
                            {"copies_of", text(n.at)},
                            {"keys", Json(uint64_t(n.keys.size()))},
                            {"copy_words", entries_json(n.instances)},
                            {"points_words", words_json(n.at_words)},
                            {"key_words", entries_json(n.keys)}});
}

}  // namespace

Json::Members tell_scene(const PipelineFile& file) {
  std::vector<Json> lights, nodes;
  Json environment;
  try {
    for (const LightText& l : stated_lights(file)) lights.push_back(light_json(l));
    if (const auto e = stated_environment(file)) environment = light_json(*e);
  } catch (const Error&) {  // a quote that is not closed: loading the pipeline tells of it
  }
  for (const PipelineFile::Node& n : file.scene) nodes.push_back(node_json(file, n));
  return {{"lights", Json(std::move(lights))}, {"environment", std::move(environment)}, {"scene", Json(std::move(nodes))}};
}

std::string node_of(const PipelineFile& file, const PipelineFile::Show& show) {
  return show.node < 0 ? std::string() : file.scene[size_t(show.node)].name;
}

}  // namespace sg::serve
