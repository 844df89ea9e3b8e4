// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/step_edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>
#include <utility>

#include "base/text/text.h"
#include "base/text/utf8.h"
#include "serve/session/edits/node_edits.h"
#include "serve/session/params_of.h"

namespace sg::serve {

namespace {

using Step = PipelineFile::Step;

constexpr std::string_view step_place = "steps/";
constexpr size_t most_steps = 1000;

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

Step* step_at(PipelineFile& file, const std::string& at) {
  return is_step_place(at) ? step_named(file, bytes_of_text(at.substr(step_place.size()))) : nullptr;
}

// The step and all that hang on it, near or far.
std::set<std::string> hanging_on(const PipelineFile& file, const std::string& name) {
  std::set<std::string> names{name};
  for (const Step& s : file.steps)
    if (std::any_of(s.from.begin(), s.from.end(), [&](const auto& f) { return names.contains(f); })) names.insert(s.name);
  return names;
}

// Why a step of this operation cannot take these; "" where it can.
std::string why_not(PipelineFile& file, const std::string& operation, const std::vector<std::string>& from) {
  for (const std::string& f : from)
    if (!step_named(file, f)) return fmt::format("there is no step '{}'", f);
  const Operation* op = known_operation(operation);
  const int least = op ? op->min_inputs : 0, most = op ? op->max_inputs : 0, count = int(from.size());
  if (count >= least && (most < 0 || count <= most)) return {};
  if (most == 0) return fmt::format("'{}' takes no step", operation);
  const std::string wanted = most == least ? std::to_string(least)
                             : most < 0    ? fmt::format("{} or more", least)
                                           : fmt::format("{} to {}", least, most);
  return fmt::format("'{}' takes {} step{}, not {}", operation, wanted, most == 1 ? "" : "s", count);
}

// What hangs on `name` cannot be taken by it. "" where nothing does.
std::string why_circle(const PipelineFile& file, const std::string& name, const std::vector<std::string>& from) {
  const auto hanging = hanging_on(file, name);
  for (const std::string& f : from) {
    if (f == name) return fmt::format("'{}' cannot take itself", name);
    if (hanging.contains(f)) return fmt::format("'{}' hangs on '{}': the pipeline would go in a circle", f, name);
  }
  return {};
}

// Each step behind its inputs, as a file has them, and otherwise where it stood.
void put_in_order(std::vector<Step>& steps) {
  std::vector<Step> left = std::exchange(steps, {});
  std::set<std::string> there;
  while (!left.empty()) {
    auto next = std::find_if(left.begin(), left.end(), [&](const Step& s) {
      return std::all_of(s.from.begin(), s.from.end(), [&](const auto& f) { return there.contains(f); });
    });
    if (next == left.end()) next = left.begin();  // takes what is nowhere: told when it is built
    there.insert(next->name);
    steps.push_back(std::move(*next));
    left.erase(next);
  }
}

// What stands at `place` takes `now` in place of `before`; false where it took something else.
bool take_instead(PipelineFile& file, const std::string& place, const std::string& before, const std::string& now) {
  if (Step* step = step_at(file, place)) {
    const bool took = has(step->from, before);
    std::replace(step->from.begin(), step->from.end(), before, now);
    return took;
  }
  std::string* of = nullptr;
  if (const auto show = place.starts_with("show/") ? parse_int(std::string_view(place).substr(5)) : std::nullopt; show) {
    if (*show >= 0 && size_t(*show) < file.show.size()) of = &file.show[size_t(*show)].of;
  } else if (is_node_place(place)) {
    const auto node = node_named(file, bytes_of_text(place.substr(place.find('/') + 1)));
    if (node && *node >= 0) of = &file.scene[size_t(*node)].at;
  }
  if (!of || *of != before) return false;
  *of = now;
  return true;
}

std::vector<std::string> names_in(const Json& list) {
  std::vector<std::string> names;
  for (const Json& name : list.items()) names.push_back(bytes_of_text(name.text()));
  return names;
}

}  // namespace

bool is_step_place(const std::string& at) { return at.starts_with(step_place); }

Step* step_named(PipelineFile& file, std::string_view name) {
  const auto it = std::find_if(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; });
  return it == file.steps.end() ? nullptr : &*it;
}

void set_step(PipelineFile& file, const std::string& at, const Json& set, std::vector<EditMistake>& mistakes) {
  Step* step = step_at(file, at);
  if (!step) return mistakes.push_back({at, "", "there is nothing there to set"});
  ParamSet params = params_of_step(*step);
  set_words(at, set, params.schema, step->words, mistakes);
}

void connect_step(PipelineFile& file, const std::string& at, const Json& from, std::vector<EditMistake>& mistakes) {
  Step* step = step_at(file, at);
  if (!step) return mistakes.push_back({at, "", "there is nothing there to connect"});
  std::vector<std::string> names = names_in(from);
  std::string why = why_not(file, step->operation, names);
  if (why.empty()) why = why_circle(file, step->name, names);
  if (!why.empty()) return mistakes.push_back({at, "", why});
  step->from = std::move(names);
  put_in_order(file.steps);
}

std::string add_step(PipelineFile& file, const Json& edit, std::vector<EditMistake>& mistakes) {
  const auto refused = [&](std::string why) {
    mistakes.push_back({"", "", std::move(why)});
    return std::string();
  };
  Step step;
  step.operation = bytes_of_text(edit["operation"].text()), step.from = names_in(edit["from"]);
  if (!known_operation(step.operation)) return refused(fmt::format("there is no operation '{}'", step.operation));
  if (file.steps.size() >= most_steps) return refused("there are too many steps");
  if (const std::string why = why_not(file, step.operation, step.from); !why.empty()) return refused(why);
  for (int n = 1; step.name.empty() || step_named(file, step.name); ++n) step.name = fmt::format("{}{}", step.operation, n);
  const std::string name = step.name;
  const std::vector<std::string> from = step.from;
  const Json& before = edit["before"];
  if (before.size() == 0) {
    file.steps.push_back(std::move(step));
  } else {
    if (from.empty()) return refused(fmt::format("'{}' takes no step, so that it stands in front of none", step.operation));
    const auto last_input = std::find_if(file.steps.rbegin(), file.steps.rend(), [&](const Step& s) { return has(from, s.name); });
    file.steps.insert(last_input.base(), std::move(step));
    for (const Json& place : before.items())
      if (!take_instead(file, place.text(), from[0], name))
        return refused(fmt::format("'{}' does not take '{}'", bytes_of_text(place.text()), from[0]));
    if (const std::string why = why_circle(file, name, from); !why.empty()) return refused(why);
    put_in_order(file.steps);
  }
  set_step(file, std::string(step_place) + text_of_bytes(name), edit["set"], mistakes);
  return name;
}

void remove_step(PipelineFile& file, const std::string& at, const Json& join, std::vector<EditMistake>& mistakes) {
  const auto refused = [&](std::string why) { mistakes.push_back({at, "", std::move(why)}); };
  const Step* step = step_at(file, at);
  if (!step) return refused("there is nothing there to remove");
  const std::string name = step->name, above = step->from.empty() ? "" : step->from[0];
  if (join.size() > 0 && above.empty()) return refused("it takes no step that others could take in its place");
  for (const Json& place : join.items())
    if (!take_instead(file, place.text(), name, above)) return refused(fmt::format("'{}' does not take it", bytes_of_text(place.text())));
  for (const Step& s : file.steps)
    if (has(s.from, name)) return refused(fmt::format("'{}' takes it; remove that first", s.name));
  for (const PipelineFile::Node& n : file.scene)
    if (n.at == name) return refused(fmt::format("node '{}' has its instances there; remove that first", n.name));
  std::erase_if(file.show, [&](const auto& s) { return s.of == name; });
  std::erase_if(file.steps, [&](const auto& s) { return s.name == name; });
}

}  // namespace sg::serve
