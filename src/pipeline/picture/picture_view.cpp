// SPDX-License-Identifier: Apache-2.0
// Where what is shown comes from, and from where it is seen when nothing is said.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "filter/mesh/clip/clip.h"
#include "filter/mesh/slice/slice.h"
#include "filter/scalar/contour/contour.h"
#include "filter/scalar/line_labels.h"
#include "filter/surface/cap.h"
#include "filter/surface/curvature.h"
#include "filter/surface/normals.h"
#include "filter/surface/smooth.h"
#include "filter/tensor/glyphs/tensor_glyphs.h"
#include "io/stated_format.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture_parts.h"
#include "scene/show/lines.h"
#include "scene/show/surface.h"
#include "scene/show/volume.h"

namespace sg {

std::vector<const PipelineFile::Step*> steps_behind(const PipelineFile& file, std::string name) {
  std::vector<const PipelineFile::Step*> chain;
  while (chain.size() < file.steps.size()) {
    const auto at = std::find_if(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; });
    if (at == file.steps.end()) break;
    chain.push_back(&*at);
    const Operation* op = known_operation(at->operation);
    if (step_kind(at->operation) != StepKind::operation || (op && op->kind == OperationKind::source)) break;
    if (!at->from.empty()) name = at->from[0];
    else if (at != file.steps.begin()) name = std::prev(at)->name;
    else break;
  }
  return chain;
}

namespace {

template <class P>
bool does(const PipelineFile::Step& step) {
  const Operation* op = known_operation(step.operation);
  return op && op->is<P>();
}

// Out of what is kept, across the plane that cut it open; nothing for other clips.
std::optional<Vec3> cut_normal(const PipelineFile::Step& step) {
  if (!does<ClipParams>(step) || step.from.size() > 1) return {};
  const ParamSet set = make_params(*known_operation(step.operation), step.words);
  const ClipParams& p = set.as<ClipParams>();
  if (names_shape(p) || !p.field.empty() || p.value || p.keep == ClipSide::both) return {};
  Vec3 n = p.normal;
  if (p.axis != CutAxis::none) n = Vec3(), n[axis_number(p.axis)] = 1;
  return p.keep == ClipSide::inside ? n : -n;
}

}  // namespace

namespace {

// On the side of a cut, and not so much along it that little of it is seen.
Vec3 facing(Vec3 direction, Vec3 normal) {
  constexpr double least = 0.5;  // cosine
  const Vec3 n = normalize(normal);
  if (const double towards = dot(direction, n); towards < 0) direction -= n * (2 * towards);
  const double towards = dot(direction, n) / length(direction);
  const Vec3 along = direction - n * dot(direction, n);
  return towards >= least ? direction : n * least + normalize(along) * std::sqrt(1 - least * least);
}

}  // namespace

std::string origin_of(const PipelineFile& file, const std::string& step) {
  const auto chain = steps_behind(file, step);
  return !chain.empty() && chain.back()->reads() ? word_value(chain.back()->words, "path").value_or("") : "";
}

std::string extension_of_origin(const PipelineFile& file, const std::string& step) {
  const auto chain = steps_behind(file, step);
  if (chain.empty() || !chain.back()->reads()) return "";
  return telling_extension(origin_of(file, step), word_value(chain.back()->words, "format").value_or(""));
}

void face_cut(const PipelineFile& file, const std::string& step, CameraDefaults& camera) {
  if (camera.parallel) return;
  for (const PipelineFile::Step* s : steps_behind(file, step))
    if (const auto n = cut_normal(*s)) {
      camera.direction = facing(camera.direction, *n);
      return;
    }
}

void face_slab(const PipelineFile& file, const std::string& step, Box3 box, CameraDefaults& camera) {
  constexpr double thin = 0.15;  // of the second longest side, glyphs included
  const auto chain = steps_behind(file, step);
  if (camera.parallel || box.empty() || chain.empty() || !does<TensorGlyphsParams>(*chain.front())) return;
  const Vec3 s = box.size();
  const int a = s.x <= s.y && s.x <= s.z ? 0 : s.y <= s.z ? 1 : 2;
  if (s[a] > thin * std::min(s[(a + 1) % 3], s[(a + 2) % 3])) return;
  box.lo[a] = box.hi[a] = box.center()[a];
  camera = choose_view(box, extension_of_origin(file, step), false);
}

void show_what_is_labelled(PipelineFile& file, std::vector<std::string>& notes) {
  for (size_t i = 0; i < file.show.size(); ++i) {
    PipelineFile::Show& s = file.show[i];
    const auto chain = file.steps.empty() ? std::vector<const PipelineFile::Step*>() : steps_behind(file, shown_step(file, i));
    if (chain.size() < 2 || !does<LineLabelsParams>(*chain.front()) || s.kind == auto_show) continue;
    const ShowKind& kind = find_show(s.kind);
    if (!kind.is<SurfaceShow>() && !kind.is<LinesShow>() && !kind.is<VolumeShow>()) continue;
    s.of = chain[kind.is<LinesShow>() ? 1 : std::min<size_t>(2, chain.size() - 1)]->name;
    notes.push_back(fmt::format("{}: of '{}', as line_labels makes nothing but points (of= names another step)", s.kind, s.of));
  }
}

void show_planes_as_measured(PipelineFile& file) {
  for (size_t i = 0; i < file.show.size(); ++i) {
    PipelineFile::Show& s = file.show[i];
    if (s.kind == auto_show || !find_show(s.kind).is<SurfaceShow>() || word_value(s.words, "lit") || word_value(s.words, "color")) continue;
    const auto chain = steps_behind(file, shown_step(file, i));
    if (chain.empty() || !does<SliceParams>(*chain.front()) || chain.front()->from.size() > 1) continue;
    const ParamSet set = make_params(*known_operation(chain.front()->operation), chain.front()->words);
    if (!names_shape(set.as<SliceParams>())) s.words.emplace_back("lit=false");
  }
}

bool is_shape_of_file(const PipelineFile& file, const std::string& step) {
  const auto chain = steps_behind(file, step);
  return !chain.empty() && chain.back()->reads() && std::all_of(chain.begin(), chain.end() - 1, [](const PipelineFile::Step* s) {
    const Operation* op = known_operation(s->operation);
    const bool of_surfaces = does<SmoothParams>(*s) || does<NormalsParams>(*s) || does<CurvatureParams>(*s) || does<CapParams>(*s);
    return of_surfaces || (op && op->keeps.has(DataKind::surface));
  });
}

bool has_contour(const PipelineFile& file) {
  return std::any_of(file.steps.begin(), file.steps.end(), [](const PipelineFile::Step& s) { return does<ContourParams>(s); });
}

}  // namespace sg
