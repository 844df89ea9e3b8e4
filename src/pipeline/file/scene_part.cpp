// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/scene_part.h"

#include <fmt/core.h>

#include <algorithm>

namespace sg {

namespace {

using Kind = YamlNode::Kind;
constexpr size_t most_scene_nodes = 1000, most_entries = 100000;

class SceneParser {
 public:
  SceneParser(const SceneParsing& parsing, PipelineFile& file) : p_(parsing), file_(file) {}

  void nodes(const YamlNode& list, int parent, const std::string& of) {
    if (list.kind != Kind::list) return p_.mistake(list.line, of + ": must be a list of nodes, e.g. [{node: lid, angle: 40, show: [...]}]");
    for (const YamlNode& body : list.items) {
      if (body.kind != Kind::map) p_.mistake(body.line, of + ": each item must be a node, e.g. {node: lid, angle: 40, show: [...]}");
      else if (file_.scene.size() >= most_scene_nodes)
        return p_.mistake(body.line, fmt::format("scene: more than {} nodes", most_scene_nodes));
      else node(body, parent);
    }
  }

 private:
  void node(const YamlNode& body, int parent) {
    PipelineFile::Node n;
    n.line = body.line, n.parent = parent;
    for (const auto& [key, value] : body.pairs)
      if (key.text == "node" && value.kind == Kind::scalar) n.name = value.text;
    if (n.name.empty()) return p_.mistake(body.line, "scene: a node has no name; begin it with node: NAME");
    const std::string of = fmt::format("node '{}'", n.name);
    if (std::any_of(file_.scene.begin(), file_.scene.end(), [&](const auto& other) { return other.name == n.name; }))
      p_.mistake(body.line, fmt::format("scene: there are two nodes '{}'", n.name));
    p_.unique(body, of + ": ");
    YamlNode words = body;
    words.pairs.clear();
    const YamlNode *shows = nullptr, *children = nullptr;
    for (const auto& pair : body.pairs) {
      const std::string& key = pair.first.text;
      if (key == "node") continue;
      if (key == "show") shows = &pair.second;
      else if (key == "children") children = &pair.second;
      else if (key == "keys") entries(pair.second, of + " keys", n.keys);
      else if (key == "instances" && pair.second.kind == Kind::map) at_points(pair.second, of, n);
      else if (key == "instances") entries(pair.second, of + " instances", n.instances);
      else words.pairs.push_back(pair);
    }
    n.words = p_.words(words, of);
    const int number = int(file_.scene.size());
    file_.scene.push_back(std::move(n));
    if (shows) p_.shows(*shows, number);
    if (children) nodes(*children, number, of + " children");
  }

  // A list of maps of words.
  void entries(const YamlNode& list, const std::string& of, std::vector<std::vector<std::string>>& out) {
    if (list.kind != Kind::list || list.items.empty())
      return p_.mistake(list.line, of + ": must be a list of transforms, e.g. [{translate: [1, 0, 0]}, {translate: [2, 0, 0], angle: 90}]");
    if (list.items.size() > most_entries)
      return p_.mistake(list.line, fmt::format("{}: more than {}; give them as points: instances: {{of: STEP}}", of, most_entries));
    for (const YamlNode& item : list.items) {
      if (item.kind != Kind::map && item.kind != Kind::null)
        p_.mistake(item.line, of + ": each must be a map, e.g. {translate: [1, 0, 0]}");
      else out.push_back(p_.words(item, of));
    }
  }

  void at_points(const YamlNode& map, const std::string& of, PipelineFile::Node& n) {
    YamlNode words = map;
    words.pairs.clear();
    for (const auto& pair : map.pairs)
      if (pair.first.text != "of") words.pairs.push_back(pair);
      else if (pair.second.kind == Kind::scalar) n.at = pair.second.text;
    if (n.at.empty()) p_.mistake(map.line, of + " instances: of: must be the name of a step, at whose points they stand");
    p_.unique(map, of + " instances: ");
    n.at_words = p_.words(words, of + " instances");
  }

  const SceneParsing& p_;
  PipelineFile& file_;
};

}  // namespace

void parse_scene(const YamlNode& scene, const SceneParsing& parsing, PipelineFile& file) {
  SceneParser(parsing, file).nodes(scene, -1, "scene");
}

}  // namespace sg
