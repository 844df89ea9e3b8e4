// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/entry_edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "scene/graph/node_params.h"
#include "serve/session/edits/node_edits.h"
#include "serve/session/edits/step_edits.h"

namespace sg::serve {

namespace {

using Words = std::vector<std::string>;

constexpr size_t most_entries = 1000;  // more are points of a step

constexpr std::string_view place_of_kind(EntryOf kind) {
  switch (kind) {
    case EntryOf::key: return "keys/";
    case EntryOf::copy: return "copies/";
    case EntryOf::points: return "points/";
  }
  return {};
}
constexpr EntryOf kinds[] = {EntryOf::key, EntryOf::copy, EntryOf::points};

std::vector<Words>& list_of(PipelineFile::Node& node, EntryOf kind) { return kind == EntryOf::key ? node.keys : node.instances; }

struct Entry {
  EntryOf kind;
  PipelineFile::Node* node;
  size_t index = 0;
  Words& words() const { return kind == EntryOf::points ? node->at_words : list_of(*node, kind)[index]; }
};

std::optional<Entry> entry_at(PipelineFile& file, std::string_view at) {
  const auto kind = std::find_if(std::begin(kinds), std::end(kinds), [&](EntryOf k) { return at.starts_with(place_of_kind(k)); });
  if (kind == std::end(kinds)) return std::nullopt;
  at.remove_prefix(place_of_kind(*kind).size());
  size_t index = 0;
  if (*kind != EntryOf::points) {
    const size_t slash = at.find('/');
    const auto n = slash == at.npos ? std::nullopt : parse_int(at.substr(0, slash));
    if (!n || *n < 0) return std::nullopt;
    index = size_t(*n), at.remove_prefix(slash + 1);
  }
  const std::string name = bytes_of_text(std::string(at));
  const auto node = name.empty() ? std::nullopt : node_named(file, name);
  if (!node) return std::nullopt;
  PipelineFile::Node& n = file.scene[size_t(*node)];
  const bool there = *kind == EntryOf::points ? !n.at.empty() : index < list_of(n, *kind).size();
  return there ? std::optional(Entry{*kind, &n, index}) : std::nullopt;
}

ParamSet params_of(EntryOf kind) {
  switch (kind) {
    case EntryOf::key: return make_param_set<KeyParams>();
    case EntryOf::copy: return make_param_set<InstanceParams>();
    case EntryOf::points: break;
  }
  return make_param_set<PointInstancesParams>();
}

// The last one counts, as in files; 0 without one, nothing where it waits for the time of a film.
std::optional<double> time_of(const Words& words) { return parse_double(word_value(words, "time").value_or("0")); }

}  // namespace

bool is_entry_place(const std::string& at) {
  return std::any_of(std::begin(kinds), std::end(kinds), [&](EntryOf k) { return at.starts_with(place_of_kind(k)); });
}

void set_entry(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes) {
  const auto entry = entry_at(file, at);
  if (!entry) return mistakes.push_back({at, "", "there is nothing there to set"});
  const size_t before = mistakes.size();
  ParamSet params = params_of(entry->kind);
  set_words(at, set, params.schema, entry->words(), mistakes);
  if (mistakes.size() > before) return;
  try {
    check_node(*entry->node);
  } catch (const Error& e) {
    mistakes.push_back(mistake_of_set(at, set, e.what()));
  }
}

void add_entry(PipelineFile& file, EntryOf kind, const Json& edit, std::vector<EditMistake>& mistakes) {
  const auto refused = [&](std::string why) { mistakes.push_back({"", "", std::move(why)}); };
  const std::string name = bytes_of_text(edit["to"].text());
  const auto number = node_named(file, name);
  if (!number || *number < 0) return refused(fmt::format("there is no node '{}'", name));
  PipelineFile::Node& node = file.scene[size_t(*number)];
  std::string at(place_of_kind(kind));
  if (kind == EntryOf::points) {
    const std::string of = bytes_of_text(edit["of"].text());
    if (!step_named(file, of)) return refused(fmt::format("there is no step '{}'", of));
    node.at = of, node.at_words.clear(), node.instances.clear();
  } else {
    std::vector<Words>& list = list_of(node, kind);
    if (list.size() >= most_entries) return refused("there are too many of them");
    if (kind == EntryOf::copy) node.at.clear(), node.at_words.clear();
    auto place = list.end();
    if (const auto own = parse_double(bytes_of_text(edit["set"]["time"].text())); kind == EntryOf::key && own)
      place = std::find_if(list.begin(), list.end(), [&](const Words& w) { return time_of(w).value_or(*own) > *own; });
    at += fmt::format("{}/", place - list.begin());
    list.insert(place, Words{});
  }
  set_entry(file, at + text_of_bytes(node.name), edit["set"], mistakes);
}

void remove_entry(PipelineFile& file, const std::string& at, std::vector<EditMistake>& mistakes) {
  const auto entry = entry_at(file, at);
  if (!entry) return mistakes.push_back({at, "", "there is nothing there to remove"});
  PipelineFile::Node& node = *entry->node;
  if (entry->kind == EntryOf::points) {
    node.at.clear(), node.at_words.clear();
    return;
  }
  std::vector<Words>& list = list_of(node, entry->kind);
  list.erase(list.begin() + ptrdiff_t(entry->index));
  if (node.keys.empty()) std::erase_if(node.words, [](const std::string& w) { return w.starts_with("time="); });
}

}  // namespace sg::serve
