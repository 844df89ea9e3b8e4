// SPDX-License-Identifier: Apache-2.0
// The results of all shows as scenes, with what the axes and the colours mean.
#include <algorithm>

#include "base/file/file.h"
#include "data/fields/axis_notes.h"
#include "data/patient/patient_frame.h"
#include "data/ranks/over_all.h"
#include "pipeline/file/transfer_file.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/choose/view/stretch.h"
#include "scene/show/lines.h"
#include "scene/show/outline.h"
#include "scene/show/parts.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

namespace {

// What the axes measure, as the first dataset that tells it has it.
void take_axis_titles(const std::vector<DatasetPtr>& data, const PictureParams& stated, Shown& s) {
  s.axis_titles[0] = stated.x_title, s.axis_titles[1] = stated.y_title, s.axis_titles[2] = stated.z_title;
  for (const DatasetPtr& d : data) {
    for (int a = 0; a < 3; ++a)
      if (const auto note = axis_note(*d, a); note && s.axis_titles[a].empty()) s.axis_titles[a] = note->title();
    if (s.length_unit.empty()) s.length_unit = length_unit(*d);
  }
}

// Isolines in the colours of the surface that they lie upon could not be seen: they are drawn dark. `alike` has the data of other shows
// that are coloured by the same field.
bool vanish(const StatedShow& lines, const ShownParts& shown, const std::vector<DatasetPtr>& alike, const ShownParts& other) {
  if (!lines.kind->is<LinesShow>() || !other.kind->is<SurfaceShow>() || shown.parts.empty() || other.parts.empty()) return false;
  if (!lines.params.as<LinesShow>().coloring.color.empty() || !shown.parts[0]->fields().find("contour value", Association::cell))
    return false;
  return std::find(alike.begin(), alike.end(), other.parts[0]) != alike.end();
}

}  // namespace

std::vector<Shown> collect(const PipelineFile& file, const std::vector<StatedShow>& shows, const std::vector<Data>& results,
                           const std::vector<size_t>& panel_of, const PictureParams& stated, const Copies& copies, Context& context) {
  std::vector<Shown> panels(panel_of.empty() ? 1 : *std::max_element(panel_of.begin(), panel_of.end()) + 1);
  std::vector<Legend>& legends = panels[0].legends;
  std::vector<DatasetPtr> all;
  std::vector<ShownParts> shown;
  for (size_t i = 0; i < results.size(); ++i) {
    const auto& [kind, params] = shows[i];
    Shown& s = panels[panel_of[i]];
    s.outlined = s.outlined || kind->is<OutlineShow>();
    if (std::holds_alternative<TablePtr>(results[i])) fail_no_mesh(results[i], file_name_of(origin_of(file, shown_step(file, i))));
    std::vector<DatasetPtr>& parts = shown.emplace_back(ShownParts{{}, kind, &params}).parts;
    for_each_dataset(results[i], [&](const std::string&, const DatasetPtr& d) {
      parts.push_back(d), all.push_back(d);
      s.any_points = s.any_points || d->point_count() > 0;
      s.patient = s.patient || in_patient_frame(*d);
      s.box.add(d->bounds());
    });
  }
  Box3 box;
  for (Shown& s : panels) take_axis_titles(all, stated, s), box.add(s.box);
  if (const Vec3 stretch = stated.stretch.value_or(chosen_stretch(all, over_all(box, context))); stretch != Vec3{1, 1, 1}) {
    for (Shown& s : panels) s.box = {}, s.stretch = stretch;
    for (size_t i = 0; i < shown.size(); ++i)
      for (DatasetPtr& d : shown[i].parts) d = stretched(d, stretch, context), panels[panel_of[i]].box.add(d->bounds());
  }
  if (const std::vector<double>& f = stated.frame; !f.empty())
    for (Shown& s : panels) {
      s.box = {};
      for (const Vec3 corner : {Vec3{f[0], f[2], f[4]}, Vec3{f[1], f[3], f[5]}}) s.box.add(corner * s.stretch);
    }
  const std::vector<std::vector<DatasetPtr>> beside = colored_alike(shown);
  for (size_t i = 0; i < shown.size(); ++i) {
    const auto& [kind, params] = shows[i];
    ParamSet dark;
    for (size_t k = 0; k < shown.size(); ++k)
      if (panel_of[i] == panel_of[k] && vanish(shows[i], shown[i], beside[i], shown[k])) {
        dark = copy_of(params), dark.as<LinesShow>().coloring.color = "#21242e";
        shown[i].stated = &dark;
      }
    Shown& s = panels[panel_of[i]];
    const size_t first = s.scene.items.size();
    for (const Legend& legend : show_parts(s.scene, shown[i], beside[i], uint32_t(i + 1), context)) {
      if (!stated.legend || (kind->coloring && !kind->coloring(params)->legend)) continue;
      const auto have = std::find_if(legends.begin(), legends.end(), [&](const Legend& l) { return same_legend(l, legend); });
      if (have == legends.end()) legends.push_back(legend);
      else if (legend.glyph && (!have->glyph || have->glyph->most < legend.glyph->most)) have->glyph = legend.glyph;
    }
    for (size_t k = first; k < s.scene.items.size(); ++k)
      if (auto* surface = std::get_if<SurfaceItem>(&s.scene.items[k]))
        if (const auto copy = copies.find(surface->data.get()); copy != copies.end()) surface->copy_of = copy->second;
    s.scene.shows.resize(s.scene.items.size(), uint32_t(i + 1));
    if (!kind->is<VolumeShow>() || s.scene.items.size() == first) continue;
    if (const std::string& path = params.as<VolumeShow>().save; !path.empty())
      save_transfer_file(path_beside(file.origin, path), std::get<VolumeItem>(s.scene.items.back()));
  }
  return panels;
}

}  // namespace sg
