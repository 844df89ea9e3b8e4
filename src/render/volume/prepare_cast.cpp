// SPDX-License-Identifier: Apache-2.0
#include "render/volume/prepare_cast.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "data/bricked.h"
#include "data/fields/field_component.h"
#include "render/volume/effects/effects.h"
#include "render/volume/sources/bricks/bricked_source.h"
#include "render/volume/sources/bricks/mip_source.h"
#include "render/volume/sources/cells/cell_source.h"
#include "render/volume/sources/cells/cell_volume.h"
#include "render/volume/sources/lattice/lattice_ray.h"
#include "render/volume/sources/lattice/reconstructed_ray.h"

namespace sg::volume {

namespace {

std::unique_ptr<RaySource> source_of(const VolumeItem& item, std::shared_ptr<const Volume> lattice, const Projection& projection,
                                     double coarser, Context& context, Range& reach) {
  if (auto bricked = lattice ? nullptr : bricked_source(item, projection, context.memory_limit / 2, context, coarser)) {
    if (wants_reconstruction(item.sampling))
      fail_usage("volumes larger than memory support only the linear kernel and central gradients", "volume",
                 "leave out kernel and gradient, or allow more --memory");
    if (item.detail.second == SecondAxis::field)
      fail_usage("volumes larger than memory do not support a second field", "volume", "allow more --memory");
    return bricked;
  }
  const VolumeSampling& sampling = item.sampling;
  if (!lattice && sampling.kernel != Kernel::linear)
    fail_usage(
        fmt::format("kernel '{}' needs a uniform or rectilinear grid; this is a {} mesh", word_of(sampling.kernel), item.data->kind()),
        "volume", "use kernel=linear, or resample to a grid first");
  if (sampling.antialias == VolumeAntialias::mip)
    if (auto means = mip_source(item, lattice.get(), projection, context)) return means;
  if (!lattice) {
    auto cells = cell_source(item, context);
    reach = cell_volume_of(*cells).range;  // planes through the middles of AMR cells go on to the corners
    return cells;
  }
  if (wants_reconstruction(sampling) && !lattice->nearest) {
    if (item.detail.second == SecondAxis::field)
      fail_usage("a second field supports only the linear kernel and central gradients", "volume", "leave out kernel and gradient");
    return reconstructed_source(std::move(lattice), sampling, &item.data->memo(), &reach);
  }
  std::shared_ptr<const Volume> second;
  if (item.detail.second == SecondAxis::field) {
    VolumeItem other = item;
    other.field = item.detail.second_field, other.component = -1;
    other.color = ColorScale(), other.opacity.points = {{0, 1}}, other.detail = {};
    second = std::make_shared<const Volume>(prepare(other, 0, {}));
  }
  return lattice_source(std::move(lattice), std::move(second));
}

// Samples of a coarse level are means: the outermost lie inside the box of the volume, or beyond it when they are means of few.
void reach_ends(const BrickedVolume& bricks, Volume& v) {
  if (!(v.hi.x > v.lo.x) || !v.affine) return;
  const BrickedVolume::Level& fine = bricks.levels[0];
  Vec3 last;
  for (int a = 0; a < 3; ++a) last[a] = double(fine.dims[size_t(a)] - 1) * fine.spacing[a];
  const Vec3 lo = v.q(fine.origin), hi = v.q(fine.origin + bricks.direction * last);
  for (int a = 0; a < 3; ++a)
    if (fine.dims[size_t(a)] > 1) v.lo[a] = lo[a], v.hi[a] = hi[a];
}

bool clear_transfer(const void* transfer, float lo, float hi) { return static_cast<const TransferFunction*>(transfer)->clear(lo, hi); }
bool clear_medium(const void* medium, float lo, float hi) { return static_cast<const Medium*>(medium)->clear(lo, hi); }
bool below_level(const void* levels, float, float hi) { return hi < float(static_cast<const std::vector<double>*>(levels)->front()); }
bool without_level(const void* levels, float lo, float hi) {
  for (double l : *static_cast<const std::vector<double>*>(levels))
    if (lo <= float(l) && float(l) <= hi) return false;
  return true;
}

}  // namespace

CastVolume prepare_cast(const VolumeItem& item, uint32_t id, std::shared_ptr<const Volume> lattice, const Projection& projection,
                        const Knobs& knobs, Context& context) {
  CastVolume v;
  v.item = &item, v.id = id;
  Range reach;  // stored values, where they go beyond those of the data: of a kernel, at corners of AMR cells
  const bool on_lattice = lattice != nullptr;
  v.source = source_of(item, std::move(lattice), projection, std::max(1.0, knobs.coarser), context, reach);
  RaySource& source = *v.source;
  v.averaged = on_lattice && is_mip_source(source);
  const double base = double(source.base);
  const Range range = item.data->range(field_of(item), item.component);

  const double diagonal = std::max(item.data->bounds().diagonal(), source.edge);
  Medium::Plan plan;
  plan.unit = item.unit_distance > 0 ? item.unit_distance : 0.01 * diagonal;
  plan.lo = range.empty() ? item.color.lo : range.lo, plan.hi = range.empty() ? item.color.hi : range.hi, plan.base = source.base;
  if (!reach.empty()) plan.lo = std::min(plan.lo, reach.lo + base), plan.hi = std::max(plan.hi, reach.hi + base);
  if (item.group) {
    // Values of the other parts: beyond the colours and the opacity's points nothing changes any more.
    plan.lo = std::min({plan.lo, item.color.lo, item.color.hi, item.opacity.points.front().x});
    plan.hi = std::max({plan.hi, item.color.lo, item.color.hi, item.opacity.points.back().x});
  }
  if (info_of(item.mode).collects()) {
    // These have values of their own, which need not be those of the field.
    const double span = std::abs(item.color.hi - item.color.lo);
    plan.lo = std::min(item.color.lo, item.color.hi) - span, plan.hi = std::max(item.color.lo, item.color.hi) + span, plan.base = 0;
  }
  plan.accuracy = 0.25 * item.sampling.within(), plan.faint = 0.5 / diagonal,
  plan.most_tau = 1e8 / source.edge;  // hides what lies behind the corner of a cell
  const double most_detail = 1e-5 * plan.most_tau;
  v.medium = std::make_unique<Medium>(item.color, item.opacity, plan);
  if (!item.detail.plain() || item.light.ink > 0) {
    v.transfer = std::make_unique<TransferFunction>(item.color, item.opacity, item.detail, base);
    const double most_tau = std::max(most_detail, minus_log_one_minus(1 - 0x1p-53) / plan.unit);  // opacities below 1 keep their own
    v.detail = std::make_unique<Detail>(Detail{*v.transfer, item.detail.second, plan.unit, float(most_tau)});
    if (item.light.ink > 0 && item.mode == RayFunction::composite)
      v.detail->ink = std::min(float(minus_log_one_minus(item.light.ink) / plan.unit), float(most_detail));
  }
  v.budget = {item.sampling.within(), diagonal, knobs.stop_below > 0 ? float(0.2 * item.sampling.within()) : 0};
  v.step = item.sampling.step, v.unit = plan.unit;
  if (v.step > 0 && diagonal / v.step > 1e7)
    fail_usage(fmt::format("a step of {} takes {:.3g} samples through a volume of size {}", v.step, diagonal / v.step, diagonal), "volume",
               "use a longer step");
  if (v.step > 0 && item.sampling.classify == VolumeClassify::table && item.mode == RayFunction::composite && !v.detail)
    v.table = std::make_unique<Preintegrated>(*v.medium, Preintegrated::Plan{float(plan.lo - base), float(plan.hi - base), float(v.step)},
                                              &context);
  v.per_scale = range.lo < range.hi ? float(1 / (0.002 * (range.hi - range.lo))) : 1;
  v.levels = std::make_unique<std::vector<double>>();
  for (double l : item.levels) v.levels->push_back(l - base);
  const VolumeLight& light = item.light;
  v.material = material_of(light, item.shaded);
  using Skips = RayFunctionInfo::Skips;
  switch (info_of(item.mode).skips) {
    case Skips::nothing: break;
    case Skips::transparent:
      if (v.detail && v.detail->ink > 0) break;  // strokes are seen where nothing else is
      if (v.detail) source.invisible = {clear_transfer, v.transfer.get()};
      else source.invisible = {clear_medium, v.medium.get()};
      break;
    case Skips::below_level: source.invisible = {below_level, v.levels.get()}; break;
    case Skips::without_level:
      // Where values are constant around their samples, a surface may lie between two bricks.
      if (item.color.labels.empty()) source.invisible = {without_level, v.levels.get()};
      break;
  }
  // A fixed step counts with the length on which there is a volume, whether that draws anything or not.
  if (!knobs.skip_empty || (v.step > 0 && item.mode == RayFunction::composite && !v.detail)) source.invisible = {};
  return v;
}

CastVolume prepare_volume(const VolumeItem& item, uint32_t id, const Projection& projection, const Knobs& knobs, Context& context,
                          std::shared_ptr<const Volume>& lattice) {
  check(item);
  lattice.reset();
  const BrickedPtr bricks = item.data->bricks();
  const bool of_bricks = bricks && (item.field.empty() || item.field == bricks->field), in_bricks = of_bricks && knobs.coarser > 0;
  if (!in_bricks && (item.data->as<UniformGrid>() || item.data->as<RectilinearGrid>())) {
    Volume prepared = prepare(item, id, knobs);
    if (of_bricks) reach_ends(*bricks, prepared);
    lattice = std::make_shared<const Volume>(std::move(prepared));
    if (!(lattice->hi.x > lattice->lo.x)) return {};
  }
  return prepare_cast(item, id, lattice, projection, knobs, context);
}

}  // namespace sg::volume
