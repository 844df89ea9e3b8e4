// SPDX-License-Identifier: Apache-2.0
#include "serve/session/edits.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/schema/file_params.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "color/map_files/colormap_file.h"
#include "io/options.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/picture/picture.h"
#include "scene/light/environment_params.h"
#include "scene/show/show.h"

namespace sg::serve {

namespace {

constexpr size_t most_edits = 200, most_steps = 1000, most_shows = 250;

ParamSet params_of_step(const PipelineFile::Step& step) {
  if (step.reads()) return make_param_set<ReadParams>();
  return find_operation(step.operation).make_params();
}
ParamSet params_of_show(const std::string& kind) {
  if (kind == auto_show) return make_param_set<ColoringParams>();
  return find_show(kind).make_params();
}

enum class Addition { step, show };
constexpr auto enum_words(Addition) { return std::array{Word{"step", Addition::step}, Word{"show", Addition::show}}; }

class Editing {
 public:
  Editing(PipelineFile& file, std::vector<EditMistake>& mistakes) : file_(file), mistakes_(mistakes) {}

  void make(const Json& edit) {
    const auto adds = value_of_word<Addition>(edit["add"].text());
    if (edit.contains("at")) set(edit["at"].text(), edit["set"]);
    else if (edit.contains("remove")) remove(edit["remove"].text());
    else if (adds == Addition::step) add_step(edit);
    else if (adds == Addition::show) add_show(edit);
    else mistake("", "", "an edit has 'at' and 'set', 'add' or 'remove'");
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

  // Each word is checked by itself, so that a mistake is told at its control.
  void set_words(const std::string& at, const Json& set, Schema& schema, std::vector<std::string>& words) {
    for (const auto& [name, value] : set.members()) {
      const std::string key = bytes_of_text(name);
      if (key.empty() || key.find('=') != key.npos || !(value.is_text() || value.is_null())) {
        mistake(at, key, "a word has a name and, as text, a value");
        continue;
      }
      const std::string written = bytes_of_text(value.text());
      if (value.is_text()) {
        try {
          set_param(schema, key, written, "");
        } catch (const Error& e) {
          mistake(at, key, e.what());
          continue;
        }
      }
      std::erase_if(words, [&](const std::string& w) { return std::string_view(w).substr(0, w.find('=')) == key; });
      if (value.is_text()) words.push_back(key + "=" + written);
    }
  }

  void set(const std::string& at, const Json& words) {
    try {
      if (at == word_of(EntryKind::picture)) {
        PictureParams picture;
        Schema schema = schema_of(picture);
        set_words(at, words, schema, file_.picture);
      } else if (PipelineFile::Step* step = step_at(at)) {
        ParamSet params = params_of_step(*step);
        set_words(at, words, params.schema, step->words);
      } else if (PipelineFile::Show* show = show_at(at)) {
        ParamSet params = params_of_show(show->kind);
        set_words(at, words, params.schema, show->words);
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
    set(fmt::format("show/{}", file_.show.size() - 1), edit["set"]);
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

struct NamedFiles {
  std::vector<std::string> read;
  bool written = false;
};

void collect_files(const ParamSet& params, const std::vector<std::string>& words, NamedFiles& files) {
  for (const std::string& w : words) {
    const size_t sign = w.find('=');
    const ParamDecl* d = params.schema.find(trim(std::string_view(w).substr(0, sign)));
    if (!d || sign == w.npos) continue;
    const std::string value = w.substr(sign + 1);
    if (names_file(*d) || (d->name == "map" && names_colormap_file(value)) || (d->name == "transfer" && names_transfer_file(value)))
      files.read.push_back(value);
    else if (names_new_file(*d)) files.written = true;
  }
}

NamedFiles files_of(const PipelineFile& file) {
  NamedFiles files;
  for (const PipelineFile::Step& s : file.steps)
    if (s.reads() || known_operation(s.operation)) collect_files(params_of_step(s), s.words, files);
  for (const PipelineFile::Show& s : file.show) collect_files(params_of_show(s.kind), s.words, files);
  if (const std::string hall = environment_file(word_value(file.picture, "environment").value_or("")); !hall.empty())
    files.read.push_back(hall);
  files.written = files.written || word_value(file.picture, "output");
  return files;
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

std::vector<std::string> files_read(const PipelineFile& file) { return files_of(file).read; }

std::vector<EditMistake> forbidden(const PipelineFile& before, const PipelineFile& after) {
  std::vector<EditMistake> mistakes;
  const NamedFiles known = files_of(before), wanted = files_of(after);
  if (wanted.written && !known.written)
    mistakes.push_back({"", "", "a window writes no files here: the browser saves pictures and pipelines"});
  for (const std::string& path : wanted.read)
    if (std::find(known.read.begin(), known.read.end(), path) == known.read.end())
      mistakes.push_back(
          {"", "", fmt::format("'{}' is no file of this session; files are chosen where a session is opened", printable(path))});
  return mistakes;
}

}  // namespace sg::serve
