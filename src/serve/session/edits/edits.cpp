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
#include "serve/session/edits/entry_edits.h"
#include "serve/session/edits/light_edits.h"
#include "serve/session/edits/node_edits.h"
#include "serve/session/edits/step_edits.h"
#include "serve/session/params_of.h"

namespace sg::serve {

namespace {

constexpr size_t most_edits = 200, most_shows = 250;

enum class Addition { step, show, light, environment, node, key, copy, points };
constexpr auto enum_words(Addition) {
  using enum Addition;
  return std::array{Word{"step", step}, Word{"show", show}, Word{"light", light}, Word{"environment", environment},
                    Word{"node", node}, Word{"key", key},   Word{"copy", copy},   Word{"points", points}};
}

class Editing {
 public:
  Editing(PipelineFile& file, std::vector<EditMistake>& mistakes) : file_(file), mistakes_(mistakes) {}

  // Throws Error(usage) where lights as they stand cannot be read.
  void make(const Json& edit) {
    if (edit.contains("at")) return change(edit["at"].text(), edit);
    if (edit.contains("move")) return move(edit["move"].text(), edit["to"]);
    if (edit.contains("remove")) return remove(edit["remove"].text(), edit["join"]);
    const auto adds = value_of_word<Addition>(edit["add"].text());
    if (!adds) return mistake("", "", "an edit has 'at' and 'set', 'add', 'move' or 'remove'");
    const std::string kind = bytes_of_text(edit["kind"].text());
    switch (*adds) {
      case Addition::step: return add_step(edit);
      case Addition::show: return add_show(edit);
      case Addition::light: return add_light(file_, kind, edit["set"], mistakes_);
      case Addition::environment: return put_environment(file_, kind, edit["set"], mistakes_);
      case Addition::node: return add_node(file_, edit, mistakes_);
      case Addition::key: return add_entry(file_, EntryOf::key, edit, mistakes_);
      case Addition::copy: return add_entry(file_, EntryOf::copy, edit, mistakes_);
      case Addition::points: return add_entry(file_, EntryOf::points, edit, mistakes_);
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

  void change(const std::string& at, const Json& edit) {
    if (edit.contains("from")) connect_step(file_, at, edit["from"], mistakes_);
    if (edit.contains("of")) show_other(at, bytes_of_text(edit["of"].text()));
    if (edit.contains("set") || !(edit.contains("from") || edit.contains("of"))) set(at, edit["set"]);
  }

  void show_other(const std::string& at, const std::string& step) {
    PipelineFile::Show* show = show_at(at);
    if (!show) return mistake(at, "", "there is nothing there that shows a step");
    if (!step_named(file_, step)) return mistake(at, "", fmt::format("there is no step '{}'", step));
    show->of = step;
  }

  void set(const std::string& at, const Json& words) {
    try {
      if (at == word_of(EntryKind::picture)) {
        PictureParams picture;
        Schema schema = schema_of(picture);
        set_words(at, words, schema, file_.picture, mistakes_);
      } else if (is_step_place(at)) {
        set_step(file_, at, words, mistakes_);
      } else if (PipelineFile::Show* show = show_at(at)) {
        ParamSet params = params_of_show(show->kind);
        set_words(at, words, params.schema, show->words, mistakes_);
      } else if (is_light_place(at)) {
        set_light(file_, at, words, mistakes_);
      } else if (is_node_place(at)) {
        set_node(file_, at, words, mistakes_);
      } else if (is_entry_place(at)) {
        set_entry(file_, at, words, mistakes_);
      } else {
        mistake(at, "", "there is nothing there to set");
      }
    } catch (const Error& e) {
      mistake(at, "", e.what());
    }
  }

  void remove(const std::string& at, const Json& join) {
    if (const PipelineFile::Show* show = show_at(at)) {
      file_.show.erase(file_.show.begin() + (show - file_.show.data()));
      return;
    }
    if (is_light_place(at)) return remove_light(file_, at, mistakes_);
    if (is_node_place(at)) return remove_node(file_, at, mistakes_);
    if (is_entry_place(at)) return remove_entry(file_, at, mistakes_);
    remove_step(file_, at, join, mistakes_);
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
    const std::string name = serve::add_step(file_, edit, mistakes_);
    const bool hidden = edit["show"].is_bool() && !edit["show"].boolean();
    if (!name.empty() && !hidden) file_.show.push_back({std::string(auto_show), {}, name, 0});
  }

  void add_show(const Json& edit) {
    PipelineFile::Show show;
    show.kind = bytes_of_text(edit["kind"].text()), show.of = bytes_of_text(edit["of"].text());
    if (!step_named(file_, show.of)) return mistake("", "", fmt::format("there is no step '{}'", show.of));
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
