// SPDX-License-Identifier: Apache-2.0
// The one place that knows all ways to show.
#include <fmt/core.h>

#include "base/error.h"
#include "scene/show/glyphs.h"
#include "scene/show/labels.h"
#include "scene/show/lines.h"
#include "scene/show/other_names.h"
#include "scene/show/outline.h"
#include "scene/show/points.h"
#include "scene/show/show.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

template <class P>
constexpr ShowKind kind(std::string_view name, std::string_view sentence) {
  ShowKind k;
  k.name = name, k.sentence = sentence;
  k.make_params = make_param_set<P>;
  k.has_params = [](const std::type_info& type) { return type == typeid(P); };
  k.copy = [](const ParamSet& from) {
    ParamSet to = param_set_of(from.as<P>());
    for (size_t i = 0; i < to.schema.decls().size(); ++i) to.schema.decls()[i].stated = from.schema.decls()[i].stated;
    return to;
  };
  if constexpr (requires(P p) { p.coloring; }) k.coloring = [](const ParamSet& params) { return &params.as<P>().coloring; };
  if constexpr (requires(const P p) { check(p); }) k.check = [](const ParamSet& params) { check(params.as<P>()); };
  if constexpr (requires(const P p, const Dataset d) { automatic_field(p, d); })
    k.automatic = [](const ParamSet& params, const Dataset& d) { return automatic_field(params.as<P>(), d); };
  if constexpr (requires(std::vector<P*> all, std::vector<DatasetPtr> parts) { share(parts, all); })
    k.share = [](const std::vector<DatasetPtr>& parts, std::vector<ParamSet>& params) {
      std::vector<P*> all;
      for (const ParamSet& p : params) all.push_back(&p.as<P>());
      share(parts, all);
    };
  k.add = [](Scene& scene, const DatasetPtr& data, const ParamSet& params, Context& context) -> std::optional<Legend> {
    if constexpr (requires(const P p) { add(scene, data, p, params.schema, context); })
      return add(scene, data, params.as<P>(), params.schema, context);
    else return add(scene, data, params.as<P>(), context);
  };
  return k;
}

}  // namespace

std::span<const ShowKind> show_kinds() {
  static constexpr ShowKind kinds[] = {
      kind<SurfaceShow>("surface", "The outer surface, coloured by a field."),
      kind<VolumeShow>("volume", "A scalar field of any mesh with volume, seen through."),
      kind<LinesShow>("lines", "Lines of constant width."),
      kind<PointsShow>("points", "Every point as a dot."),
      kind<LabelsShow>("labels", "Numbers at points, turned along their lines (see line_labels)."),
      kind<GlyphsShow>("glyphs", "Arrows, barbs and other shapes at points, turned and scaled by fields."),
      kind<OutlineShow>("outline", "The box around the data."),
  };
  return kinds;
}

const ShowKind& show_kind(const std::type_info& type) {
  const auto kinds = show_kinds();
  return *std::find_if(kinds.begin(), kinds.end(), [&](const ShowKind& k) { return k.has_params(type); });
}

const ShowKind& find_show(std::string_view name) {
  std::vector<std::string> names;
  for (const ShowKind& k : show_kinds()) {
    if (k.name == name) return k;
    names.emplace_back(k.name);
  }
  fail_usage(fmt::format("unknown way to show '{}'", name), "--show", said_here(name, names));
}

const Field* shown_field(const ShowKind& kind, const ParamSet& params, const Dataset& d) {
  if (!kind.coloring) return nullptr;
  const ColoringParams& c = *kind.coloring(params);
  if (!c.color.empty() || c.field.none()) return nullptr;
  if (!c.field.empty()) return d.fields().find(c.field.name);
  return kind.automatic ? kind.automatic(params, d) : automatic_field(d);
}

ParamSet show_params(const ShowKind& kind, const std::vector<std::string>& words) {
  ParamSet params = kind.make_params();
  set_params(params.schema, words, "show");
  if (kind.check) kind.check(params);
  return params;
}

std::optional<Legend> add_show(Scene& scene, std::string_view kind, const DatasetPtr& data, const std::vector<std::string>& words,
                               Context& context) {
  const ShowKind& k = find_show(kind);
  return k.add(scene, data, show_params(k, words), context);
}

}  // namespace sg
