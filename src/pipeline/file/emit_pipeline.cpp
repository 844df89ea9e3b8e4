// SPDX-License-Identifier: Apache-2.0
// A PipelineFile as the text that parse_pipeline() reads.
#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/file/yaml_tree.h"

namespace sg {

namespace {

// "1,2,3" as [1, 2, 3] when the parts are plain numbers: reads back to the same text.
std::string value_text(const std::string& value) {
  if (value.find(',') == value.npos) return yaml_scalar(value);
  std::string list;
  size_t begin = 0;
  while (begin <= value.size()) {
    const size_t end = std::min(value.find(',', begin), value.size());
    const std::string part = value.substr(begin, end - begin);
    if (!parse_double(part) || trim(part) != part) return yaml_scalar(value);
    list += (list.empty() ? "" : ", ") + part;
    begin = end + 1;
  }
  return "[" + list + "]";
}

std::string pair_text(const std::string& word, size_t skip = 0) {
  const size_t eq = word.find('=');
  const std::string key = word.substr(skip, eq == word.npos ? word.npos : eq - skip);
  if (key.empty()) fail_usage("a pipeline file cannot contain a word without a name", word);
  return yaml_scalar(key) + (eq == word.npos ? ":" : ": " + value_text(word.substr(eq + 1)));
}

std::string key_of(const std::string& word) { return word.substr(0, word.find('=')); }

// Of words with the same key the last counts, as in set_params.
std::vector<std::string> last_words(const std::vector<std::string>& words) {
  std::map<std::string, size_t> last;
  for (size_t i = 0; i < words.size(); ++i) last[key_of(words[i])] = i;
  std::vector<std::string> r;
  for (size_t i = 0; i < words.size(); ++i)
    if (last[key_of(words[i])] == i) r.push_back(words[i]);
  return r;
}

std::string words_text(const std::vector<std::string>& all) {
  std::string r;
  for (const std::string& w : last_words(all)) r += (r.empty() ? "" : ", ") + pair_text(w);
  return r.empty() ? "" : "{" + r + "}";
}

std::string picture_text(const std::vector<std::string>& all) {
  const std::vector<std::string> words = last_words(all);
  auto map_of = [](const std::string& word) {
    const std::string key = key_of(word);
    const size_t dot = key.find('.');
    return dot == key.npos || dot == 0 || dot + 1 == key.size() || key.find('.', dot + 1) != key.npos ? std::string() : key.substr(0, dot);
  };
  std::string r;
  std::vector<std::string> written;  // names that stand already; further words of such a map are written flat
  for (const std::string& w : words)
    if (map_of(w).empty()) written.push_back(key_of(w));
  for (size_t i = 0; i < words.size();) {
    r += r.empty() ? "" : ", ";
    const std::string map = map_of(words[i]);
    if (map.empty() || std::find(written.begin(), written.end(), map) != written.end()) {
      r += pair_text(words[i++]);
      continue;
    }
    written.push_back(map);
    r += yaml_scalar(map) + ": {";
    for (bool first = true; i < words.size() && map_of(words[i]) == map; ++i, first = false)
      r += (first ? "" : ", ") + pair_text(words[i], map.size() + 1);
    r += "}";
  }
  return r;
}

std::string show_text(const PipelineFile::Show& s) {
  const std::string words = words_text(s.words);
  return fmt::format("{{{}:{}{}{}}}", yaml_scalar(s.kind), words.empty() ? "" : " ", words,
                     s.of.empty() ? "" : ", of: " + yaml_scalar(s.of));
}

std::string list_text(const char* key, const std::vector<std::string>& items) {
  std::string r;
  for (const std::string& i : items) r += (r.empty() ? "" : ", ") + i;
  return r.empty() ? "" : fmt::format(", {}: [{}]", key, r);
}

std::string node_text(const PipelineFile& file, size_t number) {
  const PipelineFile::Node& n = file.scene[number];
  std::string r = "{node: " + yaml_scalar(n.name);
  for (const std::string& w : last_words(n.words)) r += ", " + pair_text(w);
  const auto maps = [](const std::vector<std::vector<std::string>>& all) {
    std::vector<std::string> texts;
    for (const auto& words : all) texts.push_back(words.empty() ? "{}" : words_text(words));
    return texts;
  };
  r += list_text("keys", maps(n.keys)) + list_text("instances", maps(n.instances));
  if (!n.at.empty()) {
    r += ", instances: {of: " + yaml_scalar(n.at);
    for (const std::string& w : last_words(n.at_words)) r += ", " + pair_text(w);
    r += "}";
  }
  std::vector<std::string> shows, children;
  for (const PipelineFile::Show& s : file.show)
    if (s.node == int(number)) shows.push_back(show_text(s));
  for (size_t i = number + 1; i < file.scene.size(); ++i)
    if (file.scene[i].parent == int(number)) children.push_back(node_text(file, i));
  return r + list_text("show", shows) + list_text("children", children) + "}";
}

}  // namespace

std::string emit_pipeline(const PipelineFile& file) {
  std::string r = "sightglass: 1\nsteps:\n";
  for (const PipelineFile::Step& s : file.steps) {
    const bool only_path = s.reads() && s.words.size() == 1 && s.words[0].starts_with("path=");
    const std::string words = only_path ? yaml_scalar(s.words[0].substr(5)) : words_text(s.words);
    r += fmt::format("  {}: {{{}:{}{}", yaml_scalar(s.name), yaml_scalar(s.operation), words.empty() ? "" : " ", words);
    if (s.from.size() == 1) r += ", from: " + yaml_scalar(s.from[0]);
    if (s.from.size() > 1) {
      r += ", from: [";
      for (size_t i = 0; i < s.from.size(); ++i) r += (i ? ", " : "") + yaml_scalar(s.from[i]);
      r += "]";
    }
    r += "}\n";
  }
  const auto in_world = [](const PipelineFile::Show& s) { return s.node < 0; };
  if (std::any_of(file.show.begin(), file.show.end(), in_world)) r += "show:\n";
  for (const PipelineFile::Show& s : file.show)
    if (in_world(s)) r += "  - " + show_text(s) + "\n";
  if (!file.scene.empty()) r += "scene:\n";
  for (size_t i = 0; i < file.scene.size(); ++i)
    if (file.scene[i].parent < 0) r += "  - " + node_text(file, i) + "\n";
  if (!file.picture.empty()) r += "picture: {" + picture_text(file.picture) + "}\n";
  return r;
}

}  // namespace sg
