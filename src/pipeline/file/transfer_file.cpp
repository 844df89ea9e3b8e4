// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/transfer_file.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "pipeline/file/yaml_tree.h"
#include "scene/show/show.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

constexpr std::string_view head = "sightglass-transfer";

std::vector<std::string> read_words(const std::string& path) {
  const MappedFile bytes(path);
  const YamlNode root = parse_yaml(bytes.text(), path);
  const auto fail = [&](int line, const std::string& what, const std::string& hint) {
    fail_usage(what, fmt::format("{}:{}", path, line), hint);
  };
  if (root.kind != YamlNode::Kind::map)
    fail(root.line, "is not a transfer function", "use a map of the parameters of --show volume, e.g. opacity: '0:0,1:0.5'");
  std::vector<std::string> words;
  bool known = false;
  for (const auto& [key, value] : root.pairs) {
    if (key.text == head) {
      if (value.text != "1")
        fail(value.line, fmt::format("version '{}' is not supported by this program", value.text), "it reads version 1");
      known = true;
      continue;
    }
    std::string text = value.text;
    if (value.kind == YamlNode::Kind::map) fail(value.line, fmt::format("'{}' holds a map", key.text), "use a value, or a list of values");
    for (size_t i = 0; i < value.items.size(); ++i) {
      if (value.items[i].kind != YamlNode::Kind::scalar)
        fail(value.items[i].line, fmt::format("'{}' contains more than values", key.text), "use a list of values");
      text += (i ? "," : "") + value.items[i].text;
    }
    if (key.text == "transfer" || key.text == "save") fail(key.line, fmt::format("'{}' names another file", key.text), "leave it out");
    const std::string word = key.text + "=" + text;
    with_context(fmt::format("reading '{}' line {}", path, key.line), [&] {
      ParamSet params = make_param_set<VolumeShow>();
      set_params(params.schema, {word}, "volume");
    });
    words.push_back(word);
  }
  if (!known) fail(root.line, "is not a transfer function", fmt::format("its first line is '{}: 1'", head));
  with_context(fmt::format("reading '{}'", path), [&] { show_params(show_kind<VolumeShow>(), words); });
  return words;
}

}  // namespace

bool names_transfer_file(const std::string& word) { return word.find('.') != word.npos || word.find('/') != word.npos; }

void load_transfer_files(PipelineFile& file) {
  for (auto& show : file.show) {
    if (show.kind != show_kind<VolumeShow>().name) continue;
    const std::string name = word_value(show.words, "transfer").value_or("");
    if (!names_transfer_file(name)) continue;
    std::vector<std::string> words = read_words(path_beside(file.origin, name));
    for (const std::string& w : show.words)
      if (!w.starts_with("transfer=")) words.push_back(w);
    show.words = std::move(words);
  }
}

void save_transfer_file(const std::string& path, const VolumeItem& item) {
  std::string text = fmt::format("{}: 1\n", head);
  for (const std::string& w : transfer_words(item)) {
    const size_t eq = w.find('=');
    text += w.substr(0, eq) + ": " + yaml_scalar(w.substr(eq + 1)) + "\n";
  }
  write_file(path, text);
}

}  // namespace sg
