// SPDX-License-Identifier: Apache-2.0
#include "cli/chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "color/legend_content.h"
#include "io/file_series.h"
#include "io/options.h"
#include "pipeline/file/pipeline_file.h"
#include "pipeline/operation/operation.h"
#include "scene/camera_params.h"

namespace sg {

namespace {

// "contour field=T values=1,2" -> operation and words; "NAME: operation ..." -> label too.
struct Words {
  std::string label, first;
  std::vector<std::string> rest;
  Words(const std::string& text, const char* option) {
    std::vector<std::string> all = quoted_words(text);
    if (all.size() > 1 && all[0].size() > 1 && all[0].back() == ':') label = all[0].substr(0, all[0].size() - 1), all.erase(all.begin());
    if (all.empty()) fail_usage("is empty", option, "write a name followed by key=value words");
    first = all[0];
    rest.assign(all.begin() + 1, all.end());
  }
  /// The value of a word that is for the chain, not for the operation; it is taken out.
  std::string take(std::string_view key) {
    const std::string value = word_value(rest, key).value_or("");
    std::erase_if(rest, [&](const std::string& w) { return w.starts_with(key) && w.size() > key.size() && w[key.size()] == '='; });
    return value;
  }
  /// The same for a word that the operation has too (calc on=cell): what is one of its choices and no step stays with it.
  template <class IsStep>
  std::string take_unless_own(std::string_view key, IsStep&& is_step) {
    const Operation* op = known_operation(first);
    const ParamSet params = op ? op->make_params() : ParamSet();
    const ParamDecl* own = params.schema.find(key);
    std::vector<std::string> kept;
    if (own)
      for (const std::string& w : rest)
        if (const std::string value = word_value({w}, key).value_or("");
            !is_step(value) && std::find(own->choices_.begin(), own->choices_.end(), value) != own->choices_.end())
          kept.push_back(w);
    std::erase_if(rest, [&](const std::string& w) { return std::find(kept.begin(), kept.end(), w) != kept.end(); });
    const std::string value = take(key);
    rest.insert(rest.end(), kept.begin(), kept.end());
    return value;
  }
  /// "contour values=1 name=iso" is "iso: contour values=1", where the operation has no parameter of that name.
  void take_name() {
    const Operation* op = known_operation(first);
    if (label.empty() && op && !op->make_params().schema.find("name")) label = take("name");
  }
};

void add_picture_words(const Options& o, PipelineFile& file) {
  auto add = [&](const char* key, const std::string& value) {
    if (!value.empty()) file.picture.push_back(fmt::format("{}={}", key, value));
  };
  add("size", o.size), add("title", o.title), add("background", o.background), add("layout", o.layout), add("views", o.views);
  add("note", fmt::format("{}", fmt::join(o.notes, ";")));
  add("lights", fmt::format("{}", fmt::join(o.lights, "; ")));
  file.picture.insert(file.picture.end(), o.light.begin(), o.light.end());
  for (const std::string& group : o.picture)
    for (const std::string& w : quoted_words(group)) file.picture.push_back(w);
  for (const std::string& w : camera_words(quoted_words(o.camera))) file.picture.push_back("camera." + w);
}

class Chains {
 public:
  explicit Chains(const Options& o) : o_(o) {}

  void add(PipelineFile::Step begin) {
    const std::string base = begin.name;
    std::vector<PipelineFile::Step> chain;
    names_.clear();
    names_["input"] = names_[base] = base;
    std::string before = base;
    chain.push_back(std::move(begin));
    for (size_t i = 0; i < o_.filters.size(); ++i) {
      Words words(o_.filters[i], "-f");
      words.take_name();
      PipelineFile::Step step;
      step.operation = words.first;
      step.name = words.label.empty() ? fmt::format("{}_{}{}", base, words.first, i + 1) : fmt::format("{}_{}", base, words.label);
      if (!words.label.empty() && names_.count(words.label)) fail_usage(fmt::format("two steps are named '{}'", words.label), "-f");
      const std::string on = words.take_unless_own("on", [&](const std::string&name) { return names_.count(name) > 0; }),
                        with = words.take("with");
      if (!on.empty() || !with.empty()) step.from.push_back(on.empty() ? before : step_named(on, "-f " + words.first + " on"));
      for (const std::string& name : inputs_in(with)) step.from.push_back(further_input(name, "-f " + words.first + " with"));
      step.words = std::move(words.rest);
      before = step.name;
      if (words.label.empty()) names_[words.first] = step.name;
      else names_[words.label] = step.name, names_.try_emplace(words.first, step.name);  // the operation's name is for steps without
      chain.push_back(std::move(step));
    }
    // What chains begin with comes first; a step without `from` takes the one before it.
    for (PipelineFile::Step& read : further_) file.steps.push_back(std::move(read));
    further_.clear();
    for (PipelineFile::Step& step : chain) file.steps.push_back(std::move(step));
    for (const std::string& text : o_.shows) {
      Words words(text, "--show");
      PipelineFile::Show show;
      show.kind = words.first;
      const std::string of = words.take("of");
      show.of = of.empty() ? before : step_named(of, "--show " + words.first + " of");
      show.words = std::move(words.rest);
      file.show.push_back(std::move(show));
    }
  }

  PipelineFile file;

 private:
  std::string step_named(const std::string& name, const std::string& where) const {
    if (const auto at = names_.find(name); at != names_.end()) return at->second;
    std::vector<std::string> known;
    for (const auto& [n, step] : names_) known.push_back(n);
    fail_usage(fmt::format("there is no step '{}' before it", name), where, unknown_name_hint(name, known));
  }

  static std::vector<std::string> inputs_in(const std::string& text) {
    if (text.empty()) return {};
    if (file_exists(text)) return {text};  // a comma in its name
    std::vector<std::string> names;
    for (const std::string_view part : split(text, ',')) names.emplace_back(part);
    return names;
  }

  // A step of the chain, or a file, which is read once.
  std::string further_input(const std::string& name, const std::string& where) {
    if (const auto at = names_.find(name); at != names_.end()) return at->second;
    if (const auto at = files_.find(name); at != files_.end()) return at->second;
    if (!file_exists(name) && !names_series(name)) {
      std::vector<std::string> known;
      for (const auto& [n, step] : names_) known.push_back(n);
      fail_usage(fmt::format("'{}' is neither a file nor a step before it", name), where, unknown_name_hint(name, known));
    }
    PipelineFile::Step read{fmt::format("with{}", files_.size() + 1), "read", read_words(name, {}), {}, 0};
    further_.push_back(read);
    return files_[name] = read.name;
  }

  const Options& o_;
  std::map<std::string, std::string> names_, files_;  // what is said -> the step
  std::vector<PipelineFile::Step> further_;
};

// The words of --legend as parameters of a way to show. A title of several words is written in quotes.
std::vector<std::string> legend_words(const std::string& text) {
  const std::vector<std::string> given = quoted_words(text);
  std::vector<std::string> words;
  for (size_t i = 0; i < given.size(); ++i) {
    const std::string& w = given[i];
    const bool parameter = w.find('=') != w.npos;
    if (!parameter && i > 0 && given[i - 1].find('=') != std::string::npos && !value_of_word<LegendPlace>(w))
      fail_usage(fmt::format("'{}' is no word of a legend", w), "--legend",
                 fmt::format("a value with blanks stands in quotes: {}='{} {}'", given[i - 1].substr(0, given[i - 1].find('=')),
                             given[i - 1].substr(given[i - 1].find('=') + 1), w));
    words.push_back((parameter ? "legend_" : value_of_word<LegendPlace>(w) ? "legend_place=" : "legend=") + w);
  }
  return words;
}

}  // namespace

PipelineFile pipeline_of(const Options& o) {
  if (o.inputs.empty() == o.source.empty())
    fail_usage(o.inputs.empty() ? "name a file to read, or a source to compute with --source" : "give files or a --source, not both",
               fmt::format("sightglass {}", word_of(o.command)), fmt::format("see: sightglass {} --help", word_of(o.command)));
  for (const std::string& in : o.inputs)
    if (const std::string ending = extension_of(in); (ending == "yaml" || ending == "yml") && file_exists(in))
      fail_usage("is a pipeline file, not data", in, fmt::format("sightglass run {}", in));
  Chains chains(o);
  for (size_t i = 0; i < o.inputs.size(); ++i)
    chains.add({o.inputs.size() == 1 ? "input" : fmt::format("input{}", i + 1), "read", read_words(o.inputs[i], o.read), {}, 0});
  if (!o.source.empty()) {
    Words words(o.source, "--source");
    chains.add({"source", words.first, std::move(words.rest), {}, 0});
  }
  add_picture_words(o, chains.file);
  return chains.file;
}

std::vector<std::string> coloring_words(const Options& o) {
  const std::pair<const char*, const std::string&> stated[] = {{"field=", o.field}, {"map=", o.map},     {"scale=", o.scale},
                                                               {"range=", o.range}, {"below=", o.below}, {"above=", o.above}};
  std::vector<std::string> coloring;
  for (const auto& [key, value] : stated)
    if (!value.empty()) coloring.push_back(key + value);
  for (std::string& word : legend_words(o.legend)) coloring.push_back(std::move(word));
  return coloring;
}

}  // namespace sg
