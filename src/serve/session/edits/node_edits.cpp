// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/node_edits.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/time_text.h"
#include "base/text/utf8.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "scene/graph/node_params.h"

namespace sg::serve {

namespace {

constexpr std::string_view node_place = "scene/";
constexpr size_t most_nodes = 1000, most_name = 200;

std::optional<int> node_at(const PipelineFile& file, const std::string& at) {
  const std::string name = bytes_of_text(at.substr(std::min(at.size(), node_place.size())));
  return name.empty() ? std::nullopt : node_named(file, name);
}

bool stands_in(const PipelineFile& file, int node, int above) {
  while (node > above) node = file.scene[size_t(node)].parent;
  return node == above;
}

// Parents and shows by the new numbers of nodes.
void renumber(PipelineFile& file, const std::vector<int>& numbers) {
  const auto change = [&](int& n) { n = n < 0 ? n : numbers[size_t(n)]; };
  for (PipelineFile::Node& n : file.scene) change(n.parent);
  for (PipelineFile::Show& s : file.show) change(s.node);
}

}  // namespace

bool is_node_place(const std::string& at) { return at.starts_with(node_place); }

std::optional<int> node_named(const PipelineFile& file, const std::string& name) {
  if (name.empty()) return -1;
  const auto it = std::find_if(file.scene.begin(), file.scene.end(), [&](const auto& n) { return n.name == name; });
  return it == file.scene.end() ? std::nullopt : std::optional(int(it - file.scene.begin()));
}

void check_node(PipelineFile::Node node) {
  const auto waits = [](const std::vector<std::string>& words) { return std::any_of(words.begin(), words.end(), has_time_mark); };
  if (waits(node.words) || std::any_of(node.keys.begin(), node.keys.end(), waits) ||
      std::any_of(node.instances.begin(), node.instances.end(), waits))
    return;
  PipelineFile alone;
  node.parent = -1, node.line = 0, node.at.clear(), node.at_words.clear();
  alone.scene.push_back(std::move(node));
  stated_scene(alone);
}

void set_node(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes) {
  const auto number = node_at(file, at);
  if (!number) return mistakes.push_back({at, "", "there is nothing there to set"});
  PipelineFile::Node& node = file.scene[size_t(*number)];
  const size_t before = mistakes.size();
  NodeParams params;
  Schema schema = schema_of(params);
  set_words(at, set, schema, node.words, mistakes);
  if (mistakes.size() > before) return;
  try {
    check_node(node);
  } catch (const Error& e) {
    mistakes.push_back(mistake_of_set(at, set, e.what()));
  }
}

void add_node(PipelineFile& file, const Json& edit, std::vector<EditMistake>& mistakes) {
  PipelineFile::Node node;
  node.name = bytes_of_text(edit["name"].text());
  const auto parent = node_named(file, bytes_of_text(edit["in"].text()));
  if (!parent) return mistakes.push_back({"", "", fmt::format("there is no node '{}'", bytes_of_text(edit["in"].text()))});
  if (file.scene.size() >= most_nodes) return mistakes.push_back({"", "", "there are too many nodes"});
  if (node.name.size() > most_name) return mistakes.push_back({"", "", "the name of the node is too long"});
  if (!node.name.empty() && node_named(file, node.name))
    return mistakes.push_back({"", "", fmt::format("there is a node '{}' already", node.name)});
  for (int n = 1; node.name.empty() || node_named(file, node.name); ++n) node.name = fmt::format("node{}", n);
  node.parent = *parent;
  // Behind all that stands in its parent, as a file has them.
  int place = int(file.scene.size());
  if (*parent >= 0)
    for (place = *parent + 1; place < int(file.scene.size()) && stands_in(file, place, *parent);) ++place;
  std::vector<int> numbers(file.scene.size());
  for (int i = 0; i < int(numbers.size()); ++i) numbers[size_t(i)] = i + int(i >= place);
  renumber(file, numbers);
  const std::string at = std::string(node_place) + text_of_bytes(node.name);
  file.scene.insert(file.scene.begin() + place, std::move(node));
  set_node(file, at, edit["set"], mistakes);
}

void remove_node(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes) {
  const auto removed = node_at(file, at);
  if (!removed) return mistakes.push_back({at, "", "there is nothing there to remove"});
  const PipelineFile whole = file;
  std::erase_if(file.show, [&](const auto& s) { return s.node >= 0 && stands_in(whole, s.node, *removed); });
  file.scene.clear();
  std::vector<int> numbers;
  for (int i = 0; i < int(whole.scene.size()); ++i) {
    numbers.push_back(int(file.scene.size()));
    if (!stands_in(whole, i, *removed)) file.scene.push_back(whole.scene[size_t(i)]);
  }
  renumber(file, numbers);
}

}  // namespace sg::serve
