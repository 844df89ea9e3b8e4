// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits/edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/picture/picture.h"
#include "serve/session/edits/light_edits.h"
#include "serve/session/edits/node_edits.h"
#include "serve/session/params_of.h"

namespace sg::serve {

namespace {

constexpr size_t most_edits = 200, most_steps = 1000, most_shows = 250;

enum class Addition { step, show, light, environment, node };
constexpr auto enum_words(Addition) {
  using enum Addition;
  return std::array{Word{"step", step}, Word{"show", show}, Word{"light", light}, Word{"environment", environment}, Word{"node", node}};
}

class Editing {
 public:
  Editing(PipelineFile& file, std::vector<EditMistake>& mistakes) : file_(file), mistakes_(mistakes) {}

  // Throws Error(usage) where lights as they stand cannot be read.
  void make(const Json& edit) {
    if (edit.contains("at")) return set(edit["at"].text(), edit["set"]);
    if (edit.contains("move")) return move(edit["move"].text(), edit["to"]);
    if (edit.contains("remove")) return remove(edit["remove"].text());
    const auto adds = value_of_word<Addition>(edit["add"].text());
    if (!adds) return mistake("", "", "an edit has 'at' and 'set', 'add', 'move' or 'remove'");
    const std::string kind = bytes_of_text(edit["kind"].text());
    switch (*adds) {
      case Addition::step: return add_step(edit);
      case Addition::show: return add_show(edit);
      case Addition::light: return add_light(file_, kind, edit["set"], mistakes_);
      case Addition::environment: return put_environment(file_, kind, edit["set"], mistakes_);
      case Addition::node: return add_node(file_, edit, mistakes_);
    }
  }

 private:
  void mistake(std::string at, std::string word, std::string text) {
    mistakes_.push_back({std::move(at), std::move(word), std::move(text)});
  }

  // "show/2": the third; null where there is none.
  PipelineFile::Show* show_at(const std::string& at) {
    const auto n = at.starts_with("show/") ? parse_int(std::string_view(at).substr(5)) : std::nullopt;
    return n && *n >= 0 && size_t(*n) < file_.show.size() ? &file_.show[size_t(*n)] : nullptr;
  }
  PipelineFile::Step* step_named(std::string_view name) {
    const auto it = std::find_if(file_.steps.begin(), file_.steps.end(), [&](const auto& s) { return s.name == name; });
    return it == file_.steps.end() ? nullptr : &*it;
  }
  PipelineFile::Step* step_at(const std::string& at) {
    return at.starts_with("steps/") ? step_named(bytes_of_text(at.substr(6))) : nullptr;
  }

  void set(const std::string& at, const Json& words) {
    try {
      if (at == word_of(EntryKind::picture)) {
        PictureParams picture;
        Schema schema = schema_of(picture);
        set_words(at, words, schema, file_.picture, mistakes_);
      } else if (PipelineFile::Step* step = step_at(at)) {
        ParamSet params = params_of_step(*step);
        set_words(at, words, params.schema, step->words, mistakes_);
      } else if (PipelineFile::Show* show = show_at(at)) {
        ParamSet params = params_of_show(show->kind);
        set_words(at, words, params.schema, show->words, mistakes_);
      } else if (is_light_place(at)) {
        set_light(file_, at, words, mistakes_);
      } else if (is_node_place(at)) {
        set_node(file_, at, words, mistakes_);
      } else {
        mistake(at, "", "there is nothing there to set");
      }
    } catch (const Error& e) {
      mistake(at, "", e.what());
    }
  }

  void remove(const std::string& at) {
    if (const PipelineFile::Show* show = show_at(at)) {
      file_.show.erase(file_.show.begin() + (show - file_.show.data()));
      return;
    }
    if (is_light_place(at)) return remove_light(file_, at, mistakes_);
    if (is_node_place(at)) return remove_node(file_, at, mistakes_);
    const PipelineFile::Step* step = step_at(at);
    if (!step) return mistake(at, "", "there is nothing there to remove");
    const std::string name = step->name;
    for (const PipelineFile::Step& s : file_.steps)
      if (std::find(s.from.begin(), s.from.end(), name) != s.from.end())
        return mistake(at, "", fmt::format("'{}' takes it; remove that first", s.name));
    for (const PipelineFile::Node& n : file_.scene)
      if (n.at == name) return mistake(at, "", fmt::format("node '{}' has its instances there; remove that first", n.name));
    std::erase_if(file_.show, [&](const auto& s) { return s.of == name; });
    std::erase_if(file_.steps, [&](const auto& s) { return s.name == name; });
  }

  // What is shown stands in a node, or with "" where the data lie.
  void move(const std::string& at, const Json& to) {
    PipelineFile::Show* show = show_at(at);
    const auto node = node_named(file_, bytes_of_text(to.text()));
    if (!show) return mistake(at, "", "there is nothing there to move");
    if (!node) return mistake(at, "", fmt::format("there is no node '{}'", bytes_of_text(to.text())));
    show->node = *node;
  }

  void add_step(const Json& edit) {
    PipelineFile::Step step;
    step.operation = bytes_of_text(edit["operation"].text());
    const Operation* op = known_operation(step.operation);
    if (!op) return mistake("", "", fmt::format("there is no operation '{}'", step.operation));
    if (file_.steps.size() >= most_steps) return mistake("", "", "there are too many steps");
    for (const Json& from : edit["from"].items()) {
      step.from.push_back(bytes_of_text(from.text()));
      if (!step_named(step.from.back())) return mistake("", "", fmt::format("there is no step '{}'", step.from.back()));
    }
    if (step.from.empty() && op->min_inputs > 0) return mistake("", "", fmt::format("'{}' takes the result of a step", step.operation));
    for (int n = 1; step.name.empty() || step_named(step.name); ++n) step.name = fmt::format("{}{}", step.operation, n);
    file_.steps.push_back(step);
    set("steps/" + step.name, edit["set"]);
    if (!(edit["show"].is_bool() && !edit["show"].boolean())) file_.show.push_back({std::string(auto_show), {}, step.name, 0});
  }

  void add_show(const Json& edit) {
    PipelineFile::Show show;
    show.kind = bytes_of_text(edit["kind"].text()), show.of = bytes_of_text(edit["of"].text());
    if (!step_named(show.of)) return mistake("", "", fmt::format("there is no step '{}'", show.of));
    if (file_.show.size() >= most_shows) return mistake("", "", "there are too many ways to show");
    file_.show.push_back(show);
    const std::string at = fmt::format("show/{}", file_.show.size() - 1);
    if (edit.contains("in")) move(at, edit["in"]);
    set(at, edit["set"]);
  }

  PipelineFile& file_;
  std::vector<EditMistake>& mistakes_;
};

// Inputs that are left open are the step before: named, so that steps may come and go.
void name_inputs(PipelineFile& file) {
  for (size_t i = 1; i < file.steps.size(); ++i) {
    const Operation* op = known_operation(file.steps[i].operation);
    if (op && op->min_inputs > 0 && file.steps[i].from.empty()) file.steps[i].from.push_back(file.steps[i - 1].name);
  }
  for (PipelineFile::Show& s : file.show)
    if (s.of.empty() && !file.steps.empty()) s.of = file.steps.back().name;
}

}  // namespace

PipelineFile edited(PipelineFile file, const Json& edits, std::vector<EditMistake>& mistakes) {
  name_inputs(file);
  if (!edits.is_list() || edits.size() > most_edits) {
    mistakes.push_back({"", "", fmt::format("'edits' is not a list of at most {}", most_edits)});
    return file;
  }
  Editing editing(file, mistakes);
  for (const Json& e : edits.items()) editing.make(e);
  return file;
}

}  // namespace sg::serve
