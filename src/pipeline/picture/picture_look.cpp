// SPDX-License-Identifier: Apache-2.0
// What is shown when nothing is said.
#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

std::string origin_of(const PipelineFile& file, std::string step) {
  for (int hops = 0; hops < 1000; ++hops) {
    size_t at = file.steps.size();
    for (size_t i = 0; i < file.steps.size(); ++i)
      if (file.steps[i].name == step) at = i;
    if (at == file.steps.size()) return "";
    const auto& s = file.steps[at];
    if (s.reads()) return word_value(s.words, "path").value_or("");
    if (!s.from.empty()) step = s.from[0];
    else if (at > 0) step = file.steps[at - 1].name;
    else return "";
  }
  return "";
}

namespace {

// The steps that nobody takes as input: what is to be seen when nothing is said.
std::vector<std::string> open_ends(const PipelineFile& file) {
  std::vector<std::string> used, ends;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    const auto& s = file.steps[i];
    if (!s.from.empty()) used.insert(used.end(), s.from.begin(), s.from.end());
    else if (i > 0 && !s.reads()) {
      const Operation* op = known_operation(s.operation);
      if (!op || op->kind == OperationKind::filter) used.push_back(file.steps[i - 1].name);
    }
  }
  for (const auto& s : file.steps)
    if (std::find(used.begin(), used.end(), s.name) == used.end()) ends.push_back(s.name);
  return ends;
}

std::string free_name(const PipelineFile& file, const std::string& wanted) {
  for (int n = 0;; ++n) {
    const std::string name = n ? fmt::format("{}_{}", wanted, n + 1) : wanted;
    if (std::none_of(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; })) return name;
  }
}

}  // namespace

void fail_no_mesh(const Data& data, const std::string& where) {
  const Table* table = nullptr;
  std::string parts;
  if (auto* t = std::get_if<TablePtr>(&data)) table = t->get();
  if (auto* c = std::get_if<CollectionPtr>(&data))
    for (const Collection::Part& part : (*c)->parts)
      if (std::holds_alternative<TablePtr>(part.data)) parts += (parts.empty() ? "" : ", ") + part.name;
  if (!parts.empty()) fail_usage(fmt::format("holds tables ({}) and no mesh to show", parts), where, "table_to_points needs one table");
  if (!table) fail_usage("there is no mesh to show", where);
  std::vector<std::string> numbers;
  for (size_t i = 0; i < table->columns.size(); ++i)
    if (!table->words(i)) numbers.push_back(table->columns[i].name);
  if (numbers.size() < 2) fail_usage("is a table with fewer than two columns of numbers; there is no mesh to show", where);
  fail_usage("is a table; there is no mesh to show", where,
             fmt::format("read it with `sightglass info`, keep it with `sightglass convert -o NAME.csv`, or make points of its rows: "
                         "-f \"table_to_points x='{}' y='{}'\"",
                         numbers[0], numbers[1]));
}

namespace {

// What suits the result of a step, as entries under `show`; the filter that it needs is added to the steps.
Look choose_for(const PipelineFile::Show& wanted, const Data& data, PipelineFile& file, std::vector<PipelineFile::Show>& shows) {
  const std::string& end = wanted.of;
  // The largest part speaks for all; one with values before one with a mask or a numbering alone.
  DatasetPtr largest;
  bool has_values = false;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    const Field* f = automatic_field(*d);
    const bool values = f && f->role != Role::labels;
    if (!largest || (values && !has_values) || (values == has_values && d->point_count() > largest->point_count()))
      largest = d, has_values = values;
  });
  if (!largest) fail_no_mesh(data, file_name_of(origin_of(file, end)));
  const std::string stated = word_value(wanted.words, "field").value_or("");
  if (!stated.empty()) largest->fields().require(stated);
  const Field* made = automatic_field(*largest);
  const std::string field = !stated.empty() ? stated : made && made->look.result ? made->name : "";
  std::vector<std::string> coloring = wanted.words;
  if (field != stated) coloring.push_back("field=" + field);
  const Look look = choose_look(*largest, field, extension_of(origin_of(file, end)));
  std::string result = end;
  if (!look.filter.empty()) {
    result = free_name(file, look.filter[0]);
    file.steps.push_back({result, look.filter[0], {look.filter.begin() + 1, look.filter.end()}, {end}, 0});
  }
  for (const Look::Show& s : look.shows) {
    const ShowKind& kind = *s.kind;
    std::vector<std::string> words = changed_words(s.params);
    if (kind.coloring) words.insert(words.end(), coloring.begin(), coloring.end());
    shows.push_back({std::string(kind.name), words, s.of_input ? end : result, 0});
  }
  return look;
}

}  // namespace

Look choose_looks(PipelineFile& file, const PictureOptions& options, const std::shared_ptr<Cache>& cache, std::vector<Data>& held,
                  std::vector<std::string>& notes, Context& context) {
  if (file.show.empty())
    for (const std::string& end : open_ends(file)) file.show.push_back({std::string(auto_show), {}, end, 0});
  for (auto& s : file.show)
    if (s.kind == auto_show || find_show(s.kind).coloring) s.words.insert(s.words.end(), options.coloring.begin(), options.coloring.end());
  const auto open = std::count_if(file.show.begin(), file.show.end(), [](const auto& s) { return s.kind == auto_show; });
  if (open == 0) return {};
  GraphOptions graph_options;
  graph_options.cache = cache;
  const PipelineGraph built = build_graph(file, graph_options, options.results);
  Look first;
  std::vector<PipelineFile::Show> shows;
  for (size_t i = 0; i < file.show.size(); ++i) {
    PipelineFile::Show wanted = file.show[i];
    if (wanted.of.empty()) wanted.of = built.nodes.back().first;  // steps may follow
    if (wanted.kind != auto_show) {
      shows.push_back(std::move(wanted));
      continue;
    }
    const Data data = held.emplace_back(built.graph.evaluate(built.show[i], {}, context));
    const Look look = choose_for(wanted, data, file, shows);
    notes.push_back(open > 1 ? fmt::format("{}: {}", file_name_of(origin_of(file, wanted.of)), look.reason) : look.reason);
    if (first.shows.empty()) first = look;
  }
  file.show = std::move(shows);
  return first;
}

}  // namespace sg
