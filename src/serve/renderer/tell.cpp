// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/tell.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text/utf8.h"
#include "data/lattice.h"
#include "pipeline/catalog/catalog.h"
#include "serve/renderer/tell_scene.h"
#include "serve/renderer/tell_transfer.h"
#include "serve/renderer/view_camera.h"

namespace sg::serve {

namespace {

constexpr size_t most_parts = 1000;  // of a collection whose fields are told

std::string size_text(const Dataset& d) {
  if (!is_lattice(d.mesh())) return fmt::format("{} points, {} cells", d.point_count(), d.cell_count());
  const auto n = lattice_dims(d.mesh());
  return fmt::format("{}x{}x{}", n[0], n[1], n[2]);
}

Json range_json(const Range& r) { return r.empty() ? Json() : numbers({r.lo, r.hi}); }

// Fields of all parts, each once, with the range over them.
Json fields_json(const std::vector<DatasetPtr>& parts) {
  struct Told {
    const Field* field;
    Range range;
  };
  std::vector<Told> all;
  for (const DatasetPtr& d : parts)
    for (const Field& f : d->fields()) {
      const auto same = std::find_if(all.begin(), all.end(),
                                     [&](const Told& t) { return t.field->name == f.name && t.field->association == f.association; });
      const Range range = d->range(f);
      if (same == all.end()) all.push_back({&f, range});
      else same->range.add(range);
    }
  std::vector<Json> list;
  for (const auto& [field, range] : all)
    list.emplace_back(Json::Members{{"name", text(field->name)},
                                    {"on", text(std::string(association_name(field->association)))},
                                    {"components", Json(int64_t(field->components()))},
                                    {"unit", text(field->unit)},
                                    {"range", range_json(range)}});
  return Json(std::move(list));
}

// Kind, size and fields of a step's result.
void tell_result(const Data& data, Json::Members& step) {
  if (const auto* table = std::get_if<TablePtr>(&data)) {
    std::vector<Json> columns;
    for (const Field& f : (*table)->columns)
      columns.emplace_back(Json::Members{{"name", text(f.name)},
                                         {"on", text("row")},
                                         {"components", Json(int64_t(f.components()))},
                                         {"unit", text(f.unit)},
                                         {"range", Json()}});
    const size_t rows = (*table)->columns.empty() ? 0 : (*table)->columns[0].array.count();
    step.insert(step.end(), {{"kind", text("table")}, {"size", text(fmt::format("{} rows", rows))}, {"fields", Json(std::move(columns))}});
    return;
  }
  std::vector<DatasetPtr> parts;
  size_t count = 0;
  for_each_dataset(data, [&](const std::string&, const DatasetPtr& d) {
    if (count++ < most_parts) parts.push_back(d);
  });
  const bool lone = std::holds_alternative<DatasetPtr>(data) && !parts.empty();
  step.insert(step.end(), {{"kind", text(lone ? std::string(parts[0]->kind()) : "collection")},
                           {"size", text(lone ? size_text(*parts[0]) : fmt::format("{} parts", count))},
                           {"fields", fields_json(parts)}});
}

// The i-th step as it stands.
Json::Members step_members(const PipelineFile& file, size_t i) {
  const PipelineFile::Step& s = file.steps[i];
  std::vector<std::string> from = s.from;
  const Operation* op = known_operation(s.operation);
  if (from.empty() && op && op->min_inputs > 0 && i > 0) from.push_back(file.steps[i - 1].name);
  return {{"name", text(s.name)}, {"operation", text(s.operation)}, {"words", words_json(s.words)}, {"from", list(from)}};
}

Json::Members show_members(const PipelineFile& file, size_t i) {
  const PipelineFile::Show& s = file.show[i];
  return {{"kind", text(s.kind)}, {"of", text(shown_step(file, i))}, {"in", text(node_of(file, s))}, {"words", words_json(s.words)}};
}

Json picture_json(const PipelineFile& file) {
  std::vector<std::string> words;
  for (const std::string& w : file.picture)
    if (w.substr(0, w.find_first_of(".=")) != word_of(EntryKind::camera)) words.push_back(w);
  return words_json(words);
}

Json steps_json(const PipelineFile& file, const StepSeconds& seconds, const std::shared_ptr<Cache>& cache, Context& context) {
  std::vector<Json> steps;
  for (size_t i = 0; i < file.steps.size(); ++i) {
    Json::Members step = step_members(file, i);
    try {
      const Data data = result_of(file, file.steps[i].name, cache, context);
      tell_result(data, step);
      step.emplace_back("bytes", Json(uint64_t(data_bytes(data))));
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::cancelled) throw;
      step.emplace_back("error", text(e.what()));
    }
    const auto took = seconds.find(file.steps[i].name);
    step.emplace_back("seconds", took == seconds.end() ? Json() : number(took->second));
    steps.emplace_back(std::move(step));
  }
  return Json(std::move(steps));
}

Json shows_json(const PipelineFile& file, const PreparedPicture& prepared, Context& context) {
  std::vector<Json> shows;
  for (size_t i = 0; i < file.show.size(); ++i) {
    Json::Members show = show_members(file, i);
    show.emplace_back("transfer", tell_transfer(prepared, uint32_t(i + 1), context));
    shows.emplace_back(std::move(show));
  }
  return Json(std::move(shows));
}

}  // namespace

Json text(std::string s) { return Json(text_of_bytes(s)); }

Json list(const std::vector<std::string>& texts) {
  std::vector<Json> all;
  for (const std::string& t : texts) all.push_back(text(t));
  return Json(std::move(all));
}

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(); }

Json numbers(std::initializer_list<double> values) {
  std::vector<Json> all;
  for (const double v : values) all.push_back(number(v));
  return Json(std::move(all));
}

Json words_json(const std::vector<std::string>& words) {
  Json::Members members;
  for (const std::string& w : words) {
    const size_t sign = w.find('=');
    members.emplace_back(text_of_bytes(w.substr(0, sign)), sign == w.npos ? text("true") : text(w.substr(sign + 1)));
  }
  return Json(std::move(members));
}

Data result_of(const PipelineFile& file, const std::string& step, const std::shared_ptr<Cache>& cache, Context& context,
               const Request& request) {
  GraphOptions options;
  options.cache = cache;
  const PipelineGraph built = build_graph(file, options);
  for (const auto& [name, node] : built.nodes)
    if (name == step) return built.graph.evaluate(node, request, context);
  fail_usage(fmt::format("there is no step '{}'", step));
}

Json::Members tell_pipeline(const PipelineFile& file) {
  std::vector<Json> steps, shows;
  for (size_t i = 0; i < file.steps.size(); ++i) steps.emplace_back(step_members(file, i));
  for (size_t i = 0; i < file.show.size(); ++i) shows.emplace_back(show_members(file, i));
  Json::Members members{{"steps", Json(std::move(steps))}, {"show", Json(std::move(shows))}, {"picture", picture_json(file)}};
  for (auto& m : tell_scene(file)) members.push_back(std::move(m));
  return members;
}

Json::Members tell_state(const PipelineFile& file, const PreparedPicture& prepared, const StepSeconds& seconds,
                         const std::shared_ptr<Cache>& cache, Context& context) {
  const Shown& shown = prepared.shown[0];
  Json::Members members{{"steps", steps_json(file, seconds, cache, context)}, {"show", shows_json(file, prepared, context)}};
  members.emplace_back("picture", picture_json(file));
  for (auto& m : tell_scene(file)) members.push_back(std::move(m));
  const Box3& b = shown.box;
  members.emplace_back("bounds", b.empty() ? Json() : numbers({b.lo.x, b.hi.x, b.lo.y, b.hi.y, b.lo.z, b.hi.z}));
  members.emplace_back("stretch", numbers({shown.stretch.x, shown.stretch.y, shown.stretch.z}));
  members.emplace_back("length_unit", text(shown.length_unit));
  if (!in_panels(prepared.stated.picture))
    members.emplace_back("camera", camera_json(view_camera(panel_of(prepared, prepared.stated).camera)));
  members.emplace_back("notes", list(prepared.notes));
  return members;
}

}  // namespace sg::serve
