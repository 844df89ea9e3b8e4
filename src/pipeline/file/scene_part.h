// SPDX-License-Identifier: Apache-2.0
// Private to the pipeline: `scene:` of a pipeline file, a tree of nodes.
//
//   scene:
//     - node: wheel
//       translate: [0, 0, 1]               # words of a node: sightglass ops node
//       keys: [{time: 0}, {time: 1, axis: [0, 1, 0], angle: 120}]
//       show: [{surface: {}, of: rim}]
//       children:
//         - {node: spoke, instances: [{angle: 0}, {angle: 120}, {angle: 240}], show: [{surface: {}, of: rod}]}
//         - {node: bolts, instances: {of: holes, vectors: normals}, show: [{surface: {}, of: bolt}]}
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "pipeline/file/pipeline_file.h"
#include "pipeline/file/yaml_tree.h"

namespace sg {

/// What the file's parser lends.
struct SceneParsing {
  std::function<void(int line, const std::string& text)> mistake;
  std::function<std::vector<std::string>(const YamlNode& map, const std::string& of)> words;
  std::function<void(const YamlNode& shows, int node)> shows;
  std::function<void(const YamlNode& map, const std::string& of)> unique;  ///< tells of keys that stand twice
};
/// Adds the nodes to the file, each after its parent, and the shows of each; all mistakes go to parsing.mistake.
void parse_scene(const YamlNode& scene, const SceneParsing& parsing, PipelineFile& file);

}  // namespace sg
