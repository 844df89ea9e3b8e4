// SPDX-License-Identifier: Apache-2.0
// From YAML to PipelineFile, collecting all mistakes, and back.
#include "pipeline/file/pipeline_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>

#include "base/file/file.h"
#include "base/text/quoted_word.h"
#include "base/text/text.h"
#include "pipeline/file/scene_part.h"
#include "pipeline/file/yaml_tree.h"
#include "pipeline/graph/graph_state.h"

namespace sg {

namespace {

using Kind = YamlNode::Kind;

constexpr size_t most_steps = 1000, most_shows = 250;

class FileParser {
 public:
  FileParser(const std::string& origin, const PipelineVocabulary& vocabulary)
      : origin_(origin.empty() ? "pipeline" : origin), vocabulary_(vocabulary) {}

  PipelineFile parse(const YamlNode& root) {
    PipelineFile file;
    if (root.kind != Kind::map) {
      mistake(root.line, "a pipeline file must be a map with the keys sightglass, steps, show, scene, picture");
      finish();
    }
    static const std::vector<std::string> keys{"sightglass", "steps", "show", "scene", "picture"};
    bool versioned = false;
    const YamlNode* scene = nullptr;
    unique_keys(root, "");
    for (const auto& [key, value] : root.pairs) {
      if (key.text == "sightglass") versioned = true, check_version(value);
      else if (key.text == "steps") parse_steps(value, file);
      else if (key.text == "show") parse_shows(value, -1, file);
      else if (key.text == "scene") scene = &value;
      else if (key.text == "picture") file.picture_line = key.line, parse_picture(value, file);
      else mistake(key.line, fmt::format("unknown key '{}'; {}", key.text, unknown_name_hint(key.text, keys)));
    }
    if (scene) read_scene(*scene, file);  // its shows follow those beside it
    if (!versioned) mistake(1, "the key 'sightglass' is missing; begin the file with sightglass: 1");
    if (file.steps.empty() && mistakes_.empty()) mistake(1, "there are no steps; write steps: {name: {read: FILE}}");
    finish();
    return file;
  }

 private:
  void mistake(int line, const std::string& text) {
    mistakes_.push_back({line, ErrorKind::usage, fmt::format("{}:{}: {}", origin_, line, text)});
  }

  void finish() {
    std::stable_sort(mistakes_.begin(), mistakes_.end(), [](const Mistake& a, const Mistake& b) { return a.node < b.node; });
    if (!mistakes_.empty()) throw_mistakes(mistakes_);
  }

  void unique_keys(const YamlNode& map, const std::string& of) {
    std::vector<std::string_view> seen;
    for (const auto& [key, value] : map.pairs) seen.push_back(key.text);
    std::sort(seen.begin(), seen.end());
    for (size_t i = 1; i < seen.size(); ++i)
      if (seen[i] == seen[i - 1] && (i < 2 || seen[i - 2] != seen[i])) {
        int line = map.line;
        for (const auto& [key, value] : map.pairs)
          if (key.text == seen[i]) line = key.line;
        mistake(line, fmt::format("{}the key '{}' appears twice", of, seen[i]));
      }
  }

  void check_version(const YamlNode& value) {
    if (value.kind != Kind::scalar || value.text != "1")
      mistake(value.line, fmt::format("sightglass: '{}' is not a version this program reads; it reads version 1", value.text));
  }

  // "key=value", "key=a,b,c" or the bare key. False after a mistake.
  bool add_word(const std::string& key, const YamlNode& value, int line, const std::string& of, std::vector<std::string>& words) {
    if (key.find('=') != key.npos) return mistake(line, fmt::format("{}: '{}' is not a valid name", of, key)), false;
    if (value.kind == Kind::null) return words.push_back(key), true;
    if (value.kind == Kind::scalar) return words.push_back(key + "=" + value.text), true;
    if (value.kind == Kind::map) return mistake(value.line, fmt::format("{} {}: must be a value or a list, not a map", of, key)), false;
    std::string text;
    for (const YamlNode& item : value.items) {
      if (item.kind != Kind::scalar) return mistake(item.line, fmt::format("{} {}: the items of a list must be values", of, key)), false;
      if (item.text.find(',') != item.text.npos)
        return mistake(item.line, fmt::format("{} {}: '{}': a list item must not contain a comma", of, key, item.text)), false;
      text += (text.empty() && &item == &value.items.front() ? "" : ",") + item.text;
    }
    words.push_back(key + "=" + text);
    return true;
  }

  // The value of an operation or a show: nothing or a map of parameters.
  std::vector<std::string> parse_words(const YamlNode& value, const std::string& of) {
    std::vector<std::string> words;
    if (value.kind == Kind::null) return words;
    if (value.kind != Kind::map) {
      mistake(value.line, fmt::format("{}: must be a map of parameters, e.g. {{{}: {{key: value}}}}", of, of));
      return words;
    }
    unique_keys(value, of + ": ");
    for (const auto& [key, v] : value.pairs) add_word(key.text, v, key.line, of, words);
    return words;
  }

  // The one key of `body` that is not `other` ("from", "of"); null after a mistake.
  const YamlPair* one_besides(const YamlNode& body, const std::string& other, const std::string& of, const std::string& what) {
    const YamlPair* found = nullptr;
    for (const auto& pair : body.pairs) {
      if (pair.first.text == other) continue;
      if (found) {
        const std::string near = nearest_name(pair.first.text, std::span(&other, 1));
        mistake(pair.first.line, fmt::format("{}: has '{}' besides '{}', but may have only one {} and '{}'{}", of, pair.first.text,
                                             found->first.text, what, other, near.empty() ? "" : "; did you mean '" + near + "'?"));
        return nullptr;
      }
      found = &pair;
    }
    if (!found) mistake(body.line, fmt::format("{}: has no {}", of, what));
    return found;
  }

  void parse_steps(const YamlNode& steps, PipelineFile& file) {
    if (steps.kind != Kind::map) return mistake(steps.line, "steps: must be a map of names, e.g. {head: {read: FILE}}");
    if (steps.pairs.size() > most_steps) return mistake(steps.line, fmt::format("steps: more than {}", most_steps));
    unique_keys(steps, "steps: ");
    for (const auto& [key, body] : steps.pairs) {
      PipelineFile::Step step{key.text, {}, {}, {}, key.line};
      const std::string of = fmt::format("step '{}'", key.text);
      if (body.kind != Kind::map) {
        mistake(body.line, of + ": must be a map, e.g. {read: FILE} or {contour: {values: [1]}}");
        continue;
      }
      unique_keys(body, of + ": ");
      const auto* op = one_besides(body, "from", of, "operation");
      if (!op) continue;
      step.operation = op->first.text;
      if (step.reads() && op->second.kind == Kind::scalar) step.words = {"path=" + op->second.text};
      else if (step.reads() && op->second.kind == Kind::list) add_word("path", op->second, op->second.line, "read", step.words);
      else if (step.reads() && op->second.kind != Kind::map) mistake(op->second.line, of + ": read: needs the name of a file");
      else step.words = parse_words(op->second, step.operation);
      for (const auto& [k, v] : body.pairs)
        if (k.text == "from") step.from = names_in(v, of);
      file.steps.push_back(std::move(step));
    }
  }

  std::vector<std::string> names_in(const YamlNode& value, const std::string& of) {
    std::vector<std::string> names;
    if (value.kind == Kind::scalar) names.push_back(value.text);
    for (const YamlNode& item : value.items)
      if (item.kind == Kind::scalar) names.push_back(item.text);
    if (names.empty() || (value.kind == Kind::list && names.size() != value.items.size()))
      mistake(value.line, of + ": from: must be the name of a step or a list of names");
    return names;
  }

  void parse_shows(const YamlNode& shows, int node, PipelineFile& file) {
    if (shows.kind != Kind::list) return mistake(shows.line, "show: must be a list, e.g. [{surface: {opacity: 0.5}, of: bone}]");
    if (file.show.size() + shows.items.size() > most_shows) return mistake(shows.line, fmt::format("show: more than {} items", most_shows));
    for (const YamlNode& body : shows.items) {
      PipelineFile::Show show;
      show.line = body.line, show.node = node;
      if (body.kind == Kind::scalar) {
        show.kind = body.text;
      } else if (body.kind == Kind::map) {
        unique_keys(body, "show: ");
        const auto* kind = one_besides(body, "of", "show", "kind");
        if (!kind) continue;
        show.kind = kind->first.text;
        show.words = parse_words(kind->second, show.kind);
        for (const auto& [k, v] : body.pairs)
          if (k.text == "of") {
            if (v.kind == Kind::scalar) show.of = v.text;
            else mistake(v.line, "show: of: must be the name of a step");
          }
      } else {
        mistake(body.line, "show: each item must be a way to show, e.g. {surface: {opacity: 0.5}, of: bone}");
        continue;
      }
      check_known(show.kind, show.line, "show: unknown way to show", vocabulary_.show);
      file.show.push_back(std::move(show));
    }
  }

  void read_scene(const YamlNode& scene, PipelineFile& file) {
    SceneParsing parsing;
    parsing.mistake = [this](int line, const std::string& text) { mistake(line, text); };
    parsing.words = [this](const YamlNode& map, const std::string& of) { return parse_words(map, of); };
    parsing.shows = [this, &file](const YamlNode& shows, int node) { parse_shows(shows, node, file); };
    parsing.unique = [this](const YamlNode& map, const std::string& of) { unique_keys(map, of); };
    parse_scene(scene, parsing, file);
  }

  void check_known(const std::string& name, int line, const std::string& what, const std::vector<std::string>& known) {
    if (!known.empty() && std::find(known.begin(), known.end(), name) == known.end())
      mistake(line, fmt::format("{} '{}'; {}", what, name, unknown_name_hint(name, known)));
  }

  // Keys of the picture whose values are kinds with words of their own, in a text apart by semicolons: [{sphere: {size: 0.3}}, "sun"] is
  // "sphere size=0.3; sun".
  static bool names_things(std::string_view key) { return key == "lights" || key == "environment"; }
  std::string things_in(const YamlNode& value, const std::string& of) {
    std::string text;
    const auto add = [&](const std::string& thing) { text += (text.empty() ? "" : "; ") + thing; };
    const auto add_pairs = [&](const YamlNode& map) {
      unique_keys(map, of + ": ");
      for (const auto& [kind, body] : map.pairs) {
        std::string thing = kind.text;
        for (const std::string& w : parse_words(body, kind.text)) thing += " " + quoted_word(w);
        add(thing);
      }
    };
    if (value.kind == Kind::map) add_pairs(value);
    for (const YamlNode& item : value.items) {
      if (item.kind == Kind::map) add_pairs(item);
      else if (item.kind == Kind::scalar) add(item.text);
      else mistake(item.line, of + ": each item must be a kind, e.g. {sphere: {size: 0.3}}");
    }
    return text;
  }

  void parse_picture(const YamlNode& picture, PipelineFile& file) {
    if (picture.kind == Kind::null) return;
    if (picture.kind != Kind::map) return mistake(picture.line, "picture: must be a map, e.g. {size: 1280x720, output: out.png}");
    unique_keys(picture, "picture: ");
    std::map<std::string_view, int> lines;
    for (const auto& [key, value] : picture.pairs) lines[key.text] = key.line;
    for (const auto& [key, value] : picture.pairs) {
      check_known(key.text.substr(0, key.text.find('.')), key.line, "picture: unknown key", vocabulary_.picture);
      if (names_things(key.text) && (value.kind == Kind::map || value.kind == Kind::list)) {
        file.picture.push_back(key.text + "=" + things_in(value, "picture " + key.text));
        continue;
      }
      if (value.kind != Kind::map) {
        add_word(key.text, value, key.line, "picture", file.picture);
        continue;
      }
      unique_keys(value, fmt::format("picture {}: ", key.text));
      for (const auto& [k, v] : value.pairs) {
        if (k.text.find('.') != k.text.npos) mistake(k.line, fmt::format("picture {}: '{}' is not a valid name", key.text, k.text));
        const std::string flat = key.text + "." + k.text;
        if (const auto at = lines.find(flat); at != lines.end())
          mistake(at->second, fmt::format("picture: the key '{}' appears twice", flat));
        add_word(key.text + "." + k.text, v, k.line, "picture", file.picture);
      }
    }
  }

  std::string origin_;
  const PipelineVocabulary& vocabulary_;
  std::vector<Mistake> mistakes_;  // with the line in the place of the node
};

}  // namespace

PipelineFile parse_pipeline(std::string_view text, const std::string& origin, const PipelineVocabulary& vocabulary) {
  PipelineFile file = FileParser(origin, vocabulary).parse(parse_yaml(text, origin));
  file.origin = origin;
  return file;
}

PipelineFile read_pipeline(const std::string& path, const PipelineVocabulary& vocabulary) {
  const MappedFile file(path);
  return parse_pipeline(file.text(), path, vocabulary);
}

std::vector<std::string> words_under(const std::vector<std::string>& words, std::string_view map) {
  std::vector<std::string> r;
  for (const std::string& w : words)
    if (w.size() > map.size() + 1 && w.starts_with(map) && w[map.size()] == '.') r.push_back(w.substr(map.size() + 1));
  return r;
}

std::optional<std::string> word_value(const std::vector<std::string>& words, std::string_view key) {
  std::optional<std::string> r;
  for (const std::string& w : words)
    if (w.size() > key.size() && w.starts_with(key) && w[key.size()] == '=') r = w.substr(key.size() + 1);
  return r;
}

}  // namespace sg
