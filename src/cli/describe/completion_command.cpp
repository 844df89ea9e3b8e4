// SPDX-License-Identifier: Apache-2.0
// Completion of the command line. The scripts of the shells ask the program (`sightglass complete WORD...`), which knows its own commands,
// flags, operations and parameters; so they never go stale, and nothing is listed twice.
#include <algorithm>
#include <cstdio>

#include "base/error.h"
#include "base/text/text.h"
#include "cli/cli.h"
#include "color/colormap.h"
#include "pipeline/catalog/catalog.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture.h"
#include "scene/camera_params.h"
#include "scene/choose/coloring.h"
#include "scene/light/environment_params.h"
#include "scene/light/light_params.h"
#include "scene/show/show.h"

namespace sg {

namespace {

using Candidates = std::vector<std::string>;

Candidates colormap_candidates() {
  Candidates all;
  for (const Colormap& m : colormaps()) all.push_back(m.name);
  return all;
}

// What may follow "name=", the last element of a list.
Candidates values_of(const ParamDecl& d) {
  if (d.name == "map") return colormap_candidates();
  Candidates all = d.choices_;
  if (d.ref.type() == ParamType::boolean) all = {"true", "false"};
  if (d.ref.optional()) all.emplace_back("auto");
  return all;
}

// "name=", or the values where the name is written already.
Candidates param_candidates(const Schema& schema, const std::string& word, const std::vector<std::string>& further) {
  Candidates all;
  const size_t sign = word.find('=');
  if (sign == word.npos) {
    for (const ParamDecl& d : schema.decls()) all.push_back(d.name + "=");
    all.insert(all.end(), further.begin(), further.end());
    return all;
  }
  const ParamDecl* d = schema.find(word.substr(0, sign));
  if (!d) return all;
  const size_t comma = word.rfind(',');
  const std::string before = word.substr(0, comma == word.npos || d->ref.type() != ParamType::words ? sign + 1 : comma + 1);
  for (const std::string& v : values_of(*d)) all.push_back(before + v);
  return all;
}

// The text of -f, --source or --show: a name, then parameters of it.
template <class FindSchema>
Candidates named_candidates(const std::string& text, const Candidates& names, const std::vector<std::string>& further, FindSchema&& find) {
  const size_t blank = text.find_last_of(' ');
  const std::string before = blank == text.npos ? "" : text.substr(0, blank + 1), last = text.substr(before.size());
  std::vector<std::string> first = quoted_words(before);
  if (!first.empty() && first[0].ends_with(':')) first.erase(first.begin());  // the name of a step
  Candidates all;
  if (first.empty()) all = names;
  else if (const std::optional<ParamSet> params = find(first[0])) all = param_candidates(params->schema, last, further);
  for (std::string& c : all) c.insert(0, before);
  return all;
}

Candidates operation_candidates(const std::string& text, OperationKind kind) {
  Candidates names;
  for (const Operation& o : operations())
    if (o.kind == kind) names.emplace_back(o.name);
  const Candidates further = kind == OperationKind::filter ? Candidates{"on=", "with="} : Candidates{};
  return named_candidates(text, names, further, [](const std::string& name) -> std::optional<ParamSet> {
    for (const Operation& o : operations())
      if (o.name == name) return o.make_params();
    return std::nullopt;
  });
}

Candidates show_candidates(const std::string& text) {
  Candidates names;
  for (const ShowKind& k : show_kinds()) names.emplace_back(k.name);
  return named_candidates(text, names, {"of="}, [](const std::string& name) -> std::optional<ParamSet> {
    for (const ShowKind& k : show_kinds())
      if (k.name == name) return k.make_params();
    return std::nullopt;
  });
}

// Words of one group of parameters, like those of --camera, where `names` may be given alone.
template <class P>
Candidates group_candidates(const std::string& text, const std::vector<std::string>& names) {
  const size_t blank = text.find_last_of(' ');
  const std::string before = blank == text.npos ? "" : text.substr(0, blank + 1);
  P params;
  Candidates all = param_candidates(schema_of(params), text.substr(before.size()), names);
  for (std::string& c : all) c.insert(0, before);
  return all;
}

// A kind of light or environment, then its words.
Candidates kind_candidates(auto kinds, const std::string& text) {
  Candidates names;
  for (const auto& k : kinds) names.emplace_back(k.name);
  return named_candidates(text, names, {}, [&](const std::string& name) -> std::optional<ParamSet> {
    for (const auto& k : kinds)
      if (k.name == name) return k.make_params();
    return {};
  });
}

// The words of ColoringParams that begin with "legend_", without that.
Candidates legend_candidates(const std::string& text) {
  constexpr std::string_view prefix = "legend_";
  ColoringParams params;
  const size_t blank = text.find_last_of(' ');
  const std::string before = blank == text.npos ? "" : text.substr(0, blank + 1);
  const auto schema = schema_of(params);  // outlives the loop over its declarations
  Candidates all;
  for (const ParamDecl& d : schema.decls())
    if (d.name.starts_with(prefix)) all.push_back(before + d.name.substr(prefix.size()) + "=");
  all.push_back("false");
  return all;
}

template <class E>
std::vector<std::string> words_of_enum() {
  std::vector<std::string> all;
  for (const auto& w : enum_words(E{})) all.emplace_back(w.word);
  return all;
}

// What may follow a flag; nothing where it is a file, a number or free text.
Candidates flag_candidates(const FlagDoc& flag, const std::string& text) {
  const auto is = [&](std::string_view name) { return std::find(flag.names.begin(), flag.names.end(), name) != flag.names.end(); };
  if (is("--filter")) return operation_candidates(text, OperationKind::filter);
  if (is("--source")) return operation_candidates(text, OperationKind::source);
  if (is("--show")) return show_candidates(text);
  if (is("--picture")) return group_candidates<PictureParams>(text, {});
  if (is("--light")) return kind_candidates(light_kinds(), text);
  if (is("--environment")) return kind_candidates(environment_kinds(), text);
  if (is("--map")) return colormap_candidates();
  if (is("--scale")) return words_of_enum<ScaleKind>();
  if (is("--legend")) return legend_candidates(text);
  if (is("--camera")) {
    std::vector<std::string> views = words_of_enum<NamedView>();
    for (std::string& p : words_of_enum<ProjectionKind>()) views.push_back(std::move(p));
    return group_candidates<CameraParams>(text, views);
  }
  return flag.choices;
}

Candidates input_candidates(const CommandDoc& command) {
  const std::optional<Command> known = value_of_word<Command>(command.name);
  if (known == Command::colormap) return colormap_candidates();
  if (known != Command::ops) return command.words;
  Candidates all;
  for (const CatalogEntry& e : catalog()) all.push_back(e.name);
  return all;
}

Candidates candidates(const std::vector<std::string>& words) {
  const std::vector<CommandDoc> commands = command_docs();
  Candidates all;
  if (words.size() < 2) {
    for (const CommandDoc& c : commands) all.push_back(c.name);
    all.insert(all.end(), {"--help", "--version"});
    return all;
  }
  const auto command = std::find_if(commands.begin(), commands.end(), [&](const CommandDoc& c) { return c.name == words[0]; });
  if (command == commands.end()) return all;
  const std::string &word = words.back(), &before = words[words.size() - 2];
  for (const FlagDoc& f : command->flags)
    if (f.takes_value && std::find(f.names.begin(), f.names.end(), before) != f.names.end()) return flag_candidates(f, word);
  if (!word.starts_with('-')) return input_candidates(*command);
  for (const FlagDoc& f : command->flags)
    for (const std::string& n : f.names)
      if (n.size() > 2 || word.size() < 2) all.push_back(n);
  return all;
}

// The shell has taken off quotes; where nothing is known it completes names of files.
constexpr const char* bash_script = R"sh(# sightglass: completion for bash, made by `sightglass completions bash`
_sightglass() {
  local line word words=() i quote='' cur='' c started=''
  line=${COMP_LINE:0:COMP_POINT}
  for ((i = 0; i < ${#line}; i++)); do
    c=${line:i:1}
    if [[ -n $quote ]]; then
      if [[ $c == "$quote" ]]; then quote=''; else cur+=$c; fi
    elif [[ $c == "'" || $c == '"' ]]; then quote=$c started=1
    elif [[ $c == '\' ]]; then i=$((i + 1)); cur+=${line:i:1} started=1
    elif [[ $c == ' ' || $c == $'\t' ]]; then
      if [[ -n $cur || -n $started ]]; then words+=("$cur"); fi
      cur='' started=''
    else cur+=$c started=1
    fi
  done
  words+=("$cur")
  # Readline replaces what follows its own last break: as much is taken off.
  local known=${2#[\'\"]} drop=0
  if [[ -z $quote && $cur == *"$known" ]]; then drop=$((${#cur} - ${#known})); fi
  COMPREPLY=()
  while IFS= read -r word; do
    if [[ $word == "$cur"* ]]; then COMPREPLY+=("${word:drop}"); fi
  done < <("${words[0]/#\~/$HOME}" complete "${words[@]:1}" 2>/dev/null)
  # A second one in quotes, or Readline would close them behind the first.
  if [[ -n $quote && ${#COMPREPLY[@]} -eq 1 ]]; then COMPREPLY+=("${COMPREPLY[0]} "); fi
  for word in ${COMPREPLY[@]+"${COMPREPLY[@]}"}; do
    if [[ $word == *= || -n $quote ]]; then compopt -o nospace; fi
    if [[ -z $quote && $word == *' '* ]]; then compopt -o filenames; fi
  done
}
complete -o default -F _sightglass sightglass
)sh";
constexpr const char* zsh_script = R"sh(#compdef sightglass
# sightglass: completion for zsh, made by `sightglass completions zsh`
_sightglass() {
  local -a found open closed
  found=("${(@f)$("${(Q)words[1]}" complete "${(@Q)words[2,CURRENT-1]}" "${PREFIX//\\ / }" 2>/dev/null)}")
  open=("${(@M)found:#*=}")
  closed=("${(@)found:#*=}")
  closed=("${(@)closed:#}")
  if (( ${#open} + ${#closed} == 0 )); then
    _files
    return
  fi
  (( ${#open} )) && compadd -S '' -- "${open[@]}"
  if [[ -n $QIPREFIX ]]; then
    (( ${#closed} )) && compadd -S '' -- "${closed[@]}"
  else
    (( ${#closed} )) && compadd -- "${closed[@]}"
  fi
}
if [[ $zsh_eval_context[-1] == loadautofunc ]]; then
  _sightglass "$@"
else
  compdef _sightglass sightglass
fi
)sh";
constexpr const char* fish_script = R"sh(# sightglass: completion for fish, made by `sightglass completions fish`
function __sightglass_complete
    set -l words (commandline -opc)
    set -l word (string replace -r '^[\'"]' '' -- (commandline -ct))
    $words[1] complete $words[2..-1] (string unescape -- $word; or echo -- $word) 2>/dev/null
end
complete -c sightglass -f -n 'test -n "$(__sightglass_complete)"' -a '(__sightglass_complete)'
complete -c sightglass -F -n 'test -z "$(__sightglass_complete)"'
)sh";

}  // namespace

int run_complete(const Options& o, Context&) {
  for (const std::string& c : candidates(o.inputs)) std::printf("%s\n", c.c_str());
  return 0;
}

int run_completions(const Options& o, Context&) {
  const std::string& shell = o.inputs[0];
  std::fputs(shell == "bash" ? bash_script : shell == "zsh" ? zsh_script : fish_script, stdout);
  return 0;
}

}  // namespace sg
