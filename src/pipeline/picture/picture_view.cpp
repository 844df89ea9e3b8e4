// SPDX-License-Identifier: Apache-2.0
// Where what is shown comes from, and from where it is seen when nothing is said.
#include <algorithm>
#include <cmath>

#include "filter/mesh/clip/clip.h"
#include "pipeline/operation/operation.h"
#include "pipeline/picture/picture_parts.h"

namespace sg {

std::vector<const PipelineFile::Step*> steps_behind(const PipelineFile& file, std::string name) {
  std::vector<const PipelineFile::Step*> chain;
  while (chain.size() < file.steps.size()) {
    const auto at = std::find_if(file.steps.begin(), file.steps.end(), [&](const auto& s) { return s.name == name; });
    if (at == file.steps.end()) break;
    chain.push_back(&*at);
    const Operation* op = known_operation(at->operation);
    if (at->reads() || (op && op->kind == OperationKind::source)) break;
    if (!at->from.empty()) name = at->from[0];
    else if (at != file.steps.begin()) name = std::prev(at)->name;
    else break;
  }
  return chain;
}

namespace {

// Out of what is kept, across the plane that cut it open; nothing for other clips.
std::optional<Vec3> cut_normal(const PipelineFile::Step& step) {
  const Operation* op = known_operation(step.operation);
  if (!op || !op->is<ClipParams>() || step.from.size() > 1) return {};
  const ParamSet set = make_params(*op, step.words);
  const ClipParams& p = set.as<ClipParams>();
  const bool shape = !p.sphere.empty() || !p.cylinder.empty() || !p.box.empty() || !p.quadric.empty() || !p.function.empty();
  if (shape || !p.field.empty() || p.value || p.keep == ClipSide::both) return {};
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

void face_cut(const PipelineFile& file, const std::string& step, CameraDefaults& camera) {
  if (camera.parallel) return;
  for (const PipelineFile::Step* s : steps_behind(file, step))
    if (const auto n = cut_normal(*s)) {
      camera.direction = facing(camera.direction, *n);
      return;
    }
}

}  // namespace sg
