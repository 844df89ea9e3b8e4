// SPDX-License-Identifier: Apache-2.0
#include "scene/show/parts.h"

#include <algorithm>

#include "base/error.h"
#include "base/text/alike_notes.h"
#include "scene/choose/shared_scale.h"
#include "scene/show/glyphs.h"
#include "scene/show/volume.h"
#include "scene/show/volume_parts.h"

namespace sg {

namespace {

// The name of the field that colours all parts; "" for none.
std::string field_of_parts(const std::vector<DatasetPtr>& parts, const ShowKind& kind, const ParamSet& params) {
  std::vector<const Dataset*> by_size;
  for (const DatasetPtr& d : parts) by_size.push_back(d.get());
  std::stable_sort(by_size.begin(), by_size.end(), [](const Dataset* a, const Dataset* b) { return a->point_count() > b->point_count(); });
  for (const bool labels : {false, true})
    for (const Dataset* d : by_size)
      if (const Field* f = shown_field(kind, params, *d); f && (labels || f->role != Role::labels))
        return f->look.bands ? "band low" : f->name;  // bands of parts differ; their values can be compared
  return "";
}

void share_colors(const std::vector<DatasetPtr>& parts, const ShowKind& kind, const std::vector<DatasetPtr>& beside,
                  std::vector<ParamSet>& params) {
  ColoringParams shared = *kind.coloring(params[0]);
  const bool by_themselves = kind.is<GlyphsShow>() && shared.field.empty();  // they choose their field: here the range alone
  const std::string name = field_of_parts(parts, kind, params[0]);
  if (name.empty()) return;
  std::vector<FieldOf> fields;
  for (const auto* some : {&parts, &beside})
    for (const DatasetPtr& d : *some)
      if (const Field* f = d->fields().find(name); f && f->association != Association::whole) fields.push_back({d.get(), f});
  if (fields.empty()) return;  // the show says what there is instead
  const bool own_colors = std::all_of(fields.begin(), fields.end(), [](const FieldOf& f) { return f.field->role == Role::colors; });
  if (!own_colors) share_scale(fields, shared);
  if (tells_beyond(shared)) shared.beyond = count_beyond(fields, shared);
  for (size_t i = 0; i < parts.size(); ++i) {
    ColoringParams& own = *kind.coloring(params[i]);
    const bool has = parts[i]->fields().find(name) != nullptr;
    const FieldName field = by_themselves ? own.field : FieldName{has ? name : "none"};
    if (has) own = shared;
    own.field = field;
  }
}

}  // namespace

std::vector<std::vector<DatasetPtr>> colored_alike(const std::vector<ShownParts>& shown) {
  std::vector<std::string> names;
  std::vector<decltype(ColoringParams::map)> maps;
  for (const ShownParts& s : shown) {
    const ColoringParams* c = s.kind->coloring ? s.kind->coloring(*s.stated) : nullptr;
    const bool chooses = c && c->range.empty() && c->scale == ScaleKind::linear && c->component < 0;
    names.push_back(chooses ? field_of_parts(s.parts, *s.kind, *s.stated) : "");
    maps.push_back(c ? c->map : std::nullopt);
  }
  std::vector<std::vector<DatasetPtr>> beside(shown.size());
  for (size_t i = 0; i < shown.size(); ++i)
    for (size_t k = 0; k < shown.size(); ++k)
      if (i != k && !names[i].empty() && names[i] == names[k] && maps[i] == maps[k] &&
          shown[i].kind->is<VolumeShow>() == shown[k].kind->is<VolumeShow>())
        beside[i].insert(beside[i].end(), shown[k].parts.begin(), shown[k].parts.end());
  return beside;
}

std::vector<ParamSet> params_of_parts(const std::vector<DatasetPtr>& parts, const ShowKind& kind, const ParamSet& stated,
                                      const std::vector<DatasetPtr>& beside) {
  std::vector<ParamSet> params;
  for (size_t i = 0; i < parts.size(); ++i) params.push_back(kind.copy(stated));
  if (kind.coloring && parts.size() + beside.size() > 1) share_colors(parts, kind, beside, params);
  if (kind.share && parts.size() > 1) kind.share(parts, params);
  return params;
}

namespace {

std::vector<Legend> add_parts(Scene& scene, const ShownParts& shown, const std::vector<DatasetPtr>& beside, uint32_t group,
                              Context& context) {
  const std::vector<DatasetPtr>& parts = shown.parts;
  const ShowKind& kind = *shown.kind;
  const std::vector<ParamSet> params = params_of_parts(parts, kind, *shown.stated, beside);
  const size_t first = scene.items.size();
  const bool several = parts.size() > 1, volumes = kind.is<VolumeShow>(), joined = several && volumes;
  std::vector<DatasetPtr> all = parts;
  all.insert(all.end(), beside.begin(), beside.end());
  Context choosing(context, 0, 1);
  if (volumes && all.size() > 1) choosing.parts = &all;  // opacity is chosen over all of them
  std::vector<Legend> legends;
  size_t largest = 0, most = 0;  // of joined volumes: the item that speaks for all
  for (size_t i = 0; i < parts.size(); ++i) {
    const DatasetPtr& d = parts[i];
    if (several && d->point_count() == 0) continue;                  // what a filter left nothing of
    if (joined && kind.coloring(params[i])->field.none()) continue;  // nothing to see through
    const auto legend = kind.add(scene, d, params[i], choosing);
    if (!joined) {
      if (legend) legends.push_back(*legend);
    } else if (scene.items.size() == first + 1 || d->point_count() > most) {
      largest = scene.items.size() - 1, most = d->point_count();
      legends.assign(legend ? 1 : 0, legend.value_or(Legend()));
    }
  }
  if (!joined || scene.items.size() == first) return legends;
  const VolumeItem model = std::get<VolumeItem>(scene.items[largest]);
  join_volumes(std::span(scene.items).subspan(first), model, group);
  for (Legend& l : legends)
    if (!l.volume) static_cast<ColorScale&>(l) = std::get<VolumeItem>(scene.items[largest]).color;
  return legends;
}

}  // namespace

std::vector<Legend> show_parts(Scene& scene, const ShownParts& shown, const std::vector<DatasetPtr>& beside, uint32_t group,
                               Context& context) {
  AlikeNotes notes;  // of all parts, told when all is shown or one of them could not be
  Context each(context, 0, 1);
  each.on_log = [&](LogLevel level, std::string_view text) { notes.add(level, text); };
  std::vector<Legend> legends;
  try {
    legends = add_parts(scene, shown, beside, group, each);
  } catch (const Error&) {
    notes.tell(context);
    throw;
  }
  notes.tell(context);
  if (const ColoringParams* c = shown.kind->coloring ? shown.kind->coloring(*shown.stated) : nullptr)
    for (Legend& l : legends) l.place = c->legend_place, l.bar = c->legend_bar;
  return legends;
}

bool same_legend(const Legend& a, const Legend& b) {
  return a.title == b.title && a.map.name == b.map.name && a.unit == b.unit && a.lo == b.lo && a.hi == b.hi && a.kind == b.kind &&
         a.labels == b.labels && a.limits == b.limits && (!a.glyph || !b.glyph || a.glyph->length == b.glyph->length);
}

}  // namespace sg
