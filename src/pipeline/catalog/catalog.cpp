// SPDX-License-Identifier: Apache-2.0
#include "pipeline/catalog/catalog.h"

#include <fmt/core.h>

#include "base/text/text.h"
#include "io/options.h"
#include "pipeline/film/film_params.h"
#include "pipeline/offline/page_params.h"
#include "pipeline/picture/picture.h"
#include "scene/camera_params.h"
#include "scene/graph/node_params.h"
#include "scene/light/environment_params.h"
#include "scene/light/light_params.h"
#include "scene/show/show.h"

namespace sg {

namespace {

CatalogEntry entry_of(EntryKind kind, std::string_view name, std::string_view sentence, ParamSet params) {
  return {kind, std::string(name), std::string(sentence), std::move(params.values), std::move(params.schema), nullptr, nullptr};
}
template <class P>
CatalogEntry entry(EntryKind kind, std::string_view sentence) {
  return entry_of(kind, word_of(kind), sentence, make_param_set<P>());
}

void add_operations(std::vector<CatalogEntry>& all, EntryKind kind, OperationKind wanted) {
  for (const Operation& o : operations())
    if (o.kind == wanted) all.push_back(entry_of(kind, o.name, o.sentence, o.make_params())), all.back().operation = &o;
}

std::string of_extensions(const Format& f) {
  std::string r;
  for (const std::string_view e : words(f.extensions)) r += (r.empty() ? " (." : " .") + std::string(e);
  return r.empty() ? " (a folder, or detected by content)" : r + ")";
}

void add_readers(std::vector<CatalogEntry>& all) {
  for (const Format& f : formats()) {
    if (!f.read) continue;
    auto params = std::make_shared<ReadParams>();
    Schema schema;
    describe(schema, *params, f);
    all.push_back({EntryKind::reader, std::string(f.name), fmt::format("Read {}{}.", f.name, of_extensions(f)), params, std::move(schema),
                   nullptr, &f});
  }
}

void add_writers(std::vector<CatalogEntry>& all) {
  for (const Format& f : formats()) {
    if (!f.write) continue;
    auto options = std::make_shared<WriteOptions>();
    Schema schema;
    if (f.describe_write) f.describe_write(schema, *options);
    all.push_back({EntryKind::writer, std::string(f.name), fmt::format("Write {}{}.", f.name, of_extensions(f)), options, std::move(schema),
                   nullptr, &f});
  }
}

std::string words_json(const Operation& operation) {
  std::string r;
  for (const HelpWord& w : operation.words())
    r += fmt::format("{}{{\"group\":{},\"form\":{},\"sentence\":{}}}", r.empty() ? "" : ",", json_string(w.group), json_string(w.form),
                     json_string(w.sentence));
  return "[" + r + "]";
}

std::string kinds_json(KindSet kinds) {
  std::string r;
  for (const Word<DataKind>& w : enum_words(DataKind()))
    if (kinds.has(w.value)) r += fmt::format("{}\"{}\"", r.empty() ? "" : ",", w.word);
  return "[" + r + "]";
}

// What goes in and comes out.
std::string kinds_json(const Operation& o) {
  std::string takes;
  if (o.kind == OperationKind::filter) takes = kinds_json(o.takes);
  if (o.max_inputs != 1 && !takes.empty()) takes += "," + kinds_json(o.takes_further);
  return fmt::format("\"takes\":[{}],\"makes\":{{\"same\":{},\"else\":{},\"parts\":{}}}", takes, kinds_json(o.keeps & o.takes),
                     kinds_json(o.makes), o.makes_parts);
}

// The key of a kind of which there are several; "" for the others.
std::string_view list_of(EntryKind kind) {
  switch (kind) {
    case EntryKind::source: return "sources";
    case EntryKind::operation: return "operations";
    case EntryKind::show: return "show";
    case EntryKind::reader: return "readers";
    case EntryKind::writer: return "writers";
    case EntryKind::light: return "lights";
    case EntryKind::environment: return "environments";
    case EntryKind::node: return "nodes";
    case EntryKind::read:
    case EntryKind::camera:
    case EntryKind::picture:
    case EntryKind::film:
    case EntryKind::page: return "";
  }
  return "";
}

}  // namespace

std::vector<CatalogEntry> catalog() {
  std::vector<CatalogEntry> all;
  add_operations(all, EntryKind::source, OperationKind::source);
  add_operations(all, EntryKind::operation, OperationKind::filter);
  for (const ShowKind& k : show_kinds()) all.push_back(entry_of(EntryKind::show, k.name, k.sentence, k.make_params()));
  add_readers(all);
  add_writers(all);
  all.push_back(entry<ReadParams>(EntryKind::read, "Read a file (a step of pipeline files)."));
  all.push_back(entry<CameraParams>(EntryKind::camera, "Viewpoint and projection (--camera)."));
  all.push_back(entry<PictureParams>(EntryKind::picture, "Size, background and annotations (--picture)."));
  all.push_back(entry<FilmParams>(EntryKind::film, "Pictures of a time series, numbered or as a film."));
  all.push_back(entry<PageParams>(EntryKind::page, "A picture that turns, as one HTML file (-o scene.html)."));
  for (const LightKind& k : light_kinds()) all.push_back(entry_of(EntryKind::light, k.name, k.sentence, k.make_params()));
  for (const EnvironmentKind& k : environment_kinds()) all.push_back(entry_of(EntryKind::environment, k.name, k.sentence, k.make_params()));
  const auto add_node = [&](std::string_view name, std::string_view sentence, ParamSet params) {
    all.push_back(entry_of(EntryKind::node, name, sentence, std::move(params)));
  };
  add_node("node", "A place in the scene of a pipeline file, with what is shown there (docs/scene.md).", make_param_set<NodeParams>());
  add_node("instance", "One of several copies of a node: an entry of its 'instances'.", make_param_set<InstanceParams>());
  add_node("point_instances", "Copies of a node at the points of a step: 'instances: {of: STEP}'.", make_param_set<PointInstancesParams>());
  add_node("key", "Where a node is at a time: an entry of its 'keys'.", make_param_set<KeyParams>());
  return all;
}

std::string entry_json(const CatalogEntry& e) {
  std::string r =
      fmt::format("{{\"name\":{},\"kind\":\"{}\",\"sentence\":{}", json_string(e.name), word_of(e.kind), json_string(e.sentence));
  if (const Operation* o = e.operation) {
    r += fmt::format(",\"family\":{},\"version\":{},\"inputs\":[{},{}]", json_string(o->family), o->version, o->min_inputs, o->max_inputs);
    r += "," + kinds_json(*o);
    if (o->words) r += ",\"words\":" + words_json(*o);
  }
  if (e.format) {
    std::string extensions;
    for (const std::string_view x : words(e.format->extensions)) extensions += (extensions.empty() ? "" : ",") + json_string(x);
    r += ",\"extensions\":[" + extensions + "]";
    if (e.kind == EntryKind::reader) r += fmt::format(",\"times\":{}", e.format->times != nullptr);
  }
  return r + ",\"params\":" + params_json(e.schema) + "}";
}

std::string catalog_json(const std::vector<CatalogEntry>& entries) {
  std::string r = "{\"sightglass\":" + json_string(SG_VERSION);
  for (size_t i = 0; i < entries.size();) {
    const EntryKind kind = entries[i].kind;
    const std::string_view list = list_of(kind);
    r += fmt::format(",\n\"{}\":{}", list.empty() ? word_of(kind) : list, list.empty() ? "" : "[\n");
    for (const size_t first = i; i < entries.size() && entries[i].kind == kind; ++i) r += (i > first ? ",\n" : "") + entry_json(entries[i]);
    if (!list.empty()) r += "\n]";
  }
  return r + "}\n";
}

}  // namespace sg
