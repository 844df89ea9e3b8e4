// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/operation.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/operation/check_inputs.h"
#include "pipeline/operation/operation_table.h"
#include "scene/show/other_names.h"

namespace sg {

const Operation* known_operation(std::string_view name, std::span<const Operation> table) {
  for (const Operation& o : table)
    if (o.name == name) return &o;
  return nullptr;
}

const Operation& find_operation(std::string_view name, std::span<const Operation> table) {
  std::vector<std::string> names;
  for (const Operation& o : table) {
    if (o.name == name) return o;
    names.emplace_back(o.name);
  }
  fail_usage(fmt::format("unknown operation '{}'", name), {}, said_here(name, names));
}

ParamSet make_params(const Operation& operation, const std::vector<std::string>& words) {
  ParamSet params = operation.make_params();
  set_params(params.schema, words, operation.name);
  return params;
}

Data run_operation(const Operation& operation, const std::vector<Data>& inputs, const std::vector<std::string>& words, Context& context) {
  const int n = int(inputs.size());
  if (n < operation.min_inputs || (operation.max_inputs >= 0 && n > operation.max_inputs))
    fail_usage(fmt::format("takes {} input{}, not {}", operation.min_inputs, operation.min_inputs == 1 ? "" : "s", n),
               std::string(operation.name));
  const ParamSet params = make_params(operation, words);
  check_inputs(operation, params.schema, inputs);
  return operation.run(inputs, params, context);
}

Series detail::one_step(const Data& data) {
  auto* d = std::get_if<DatasetPtr>(&data);
  return {{d && *d ? (*d)->time().value_or(0) : 0.0}, [data](size_t) { return data; }};
}

std::string makes_text(const Operation& o) {
  const KindSet kept = o.keeps & o.takes;
  std::string r;
  if (kept == o.takes && o.makes.empty()) r = o.takes == kinds::table ? "a table" : "the same kind of mesh";
  else if (kept.empty()) r = kinds_text(o.makes);
  else if ((kept - o.makes).empty()) r = kinds_text(o.makes | kept);
  else r = fmt::format("of {} the same kind, else {}", kinds_text(kept), kinds_text(o.makes));
  return o.makes_parts ? r + ", or several as parts" : r;
}

std::string kinds_help(const Operation& o) {
  if (o.kind == OperationKind::source) return fmt::format("Makes: {}.", makes_text(o));
  std::string further;
  if (o.max_inputs != 1) {
    const bool alike = o.takes_further == o.takes;
    further = o.min_inputs > 1 ? " and " : ", or with ";
    if (o.max_inputs < 0) further += alike ? "more of them" : "more: each " + kinds_text(o.takes_further);
    else further += alike ? "another" : kinds_text(o.takes_further) + " beside it";
  }
  return fmt::format("Takes: {}{}; makes: {}.", kinds_text(o.takes), further, makes_text(o));
}

std::string ops_help(std::string_view name, std::span<const Operation> table) {
  if (!name.empty()) {
    const Operation& o = find_operation(name, table);
    const ParamSet params = o.make_params();
    std::string r = fmt::format("{} ({}{})\n  {}\n", o.name, o.family, o.kind == OperationKind::filter ? " filter" : "", o.sentence);
    if (o.min_inputs > 1) r += fmt::format("  Takes {} inputs.\n", o.min_inputs);
    else if (o.max_inputs < 0) r += "  Takes any number of inputs.\n";
    r += "  " + kinds_help(o) + "\n";
    const std::string help = params_help(params.schema);
    return r + (help.empty() ? "\nNo parameters.\n" : "\nParameters (key=value):\n" + help) + words_help(o);
  }
  std::vector<std::string_view> families;
  size_t width = 0;
  for (const Operation& o : table) {
    if (std::find(families.begin(), families.end(), o.family) == families.end()) families.push_back(o.family);
    width = std::max(width, o.name.size());
  }
  std::string r;
  for (std::string_view family : families) {
    r += fmt::format("{}{}\n", r.empty() ? "" : "\n", family);
    for (const Operation& o : table)
      if (o.family == family) r += fmt::format("  {:<{}}  {}\n", o.name, width, o.sentence);
  }
  return r;
}

std::string words_help(const Operation& operation) {
  if (!operation.words) return {};
  const std::vector<HelpWord> words = operation.words();
  size_t width = 0;
  for (const HelpWord& w : words) width = std::max(width, w.form.size());
  std::string r;
  std::string_view group;
  for (const HelpWord& w : words) {
    if (w.group != group) r += fmt::format("\n{}s\n", w.group), group = w.group;
    r += fmt::format("  {:<{}}  {}\n", w.form, width, w.sentence);
  }
  return r;
}

}  // namespace sg
