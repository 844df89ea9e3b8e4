// SPDX-License-Identifier: Apache-2.0
#include "render/volume/sources/bricks/brick_source.h"

#include <fmt/core.h>

#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

BrickedSource::BrickedSource(BrickedPtr volume, DatasetPtr data, const Projection& projection, size_t memory, double coarser)
    : volume_(std::move(volume)), data_(std::move(data)), projection_(projection), pixels_(coarser) {
  // A part for what walkers hold beside the cache.
  cache_limit_ = memory / 4 * 3, most_bytes_ = 4 * uint64_t(memory / 8 * 7);
  const double brick = double(67 * 67 * 67 * std::min<size_t>(4, element_size(volume_->type)));
  pins_ = size_t(std::clamp(double(memory / 8) / brick / std::max(1, thread_count()), 4.0, 64.0));
  caches_ = brick_caches(*data_);
  const BrickedVolume::Level& fine = volume_->levels[0];
  for (int a = 0; a < 3; ++a) {
    places_.lo[a] = first_place(fine.dims[size_t(a)]), places_.hi[a] = last_place(fine.dims[size_t(a)]);
    for (int c = 0; c < 3; ++c) {
      places_.to_fine.m[a][c] = volume_->direction.m[c][a] / fine.spacing[a];
      places_.to_world.m[c][a] = volume_->direction.m[c][a] / fine.spacing[a];
    }
  }
  for (size_t l = 0; l < volume_->levels.size(); ++l) {
    Vec3 scale, shift;
    level_places(*volume_, l, scale, shift);
    places_.scale.push_back(scale), places_.shift.push_back(shift);
  }
  for (int c = 0; c < 8; ++c) {
    const Vec3 u{c & 1 ? places_.hi.x : places_.lo.x, c & 2 ? places_.hi.y : places_.lo.y, c & 4 ? places_.hi.z : places_.lo.z};
    bounds.add(fine.origin + volume_->direction * (fine.spacing * u));
  }
  edge = finest_edge();
}

const BrickTree& BrickedSource::tree() const {
  std::call_once(planned_, [&] {
    tree_ = std::make_unique<BrickTree>(*volume_, projection_, pixels_, most_bytes_, invisible);
    foresee();
  });
  return *tree_;
}

std::shared_ptr<const BrickData> BrickedSource::brick(size_t level, const std::array<uint32_t, 3>& at) const {
  return caches_->bricks.get(brick_key(level, at), [&] {
    BrickNode n;
    n.level = uint8_t(level), n.at = at;
    Vec3 lo, hi;
    tree_->box(n, lo, hi);
    auto b = load_brick(*volume_, level, lo, hi);
    return std::pair(b, b->bytes());
  });
}

void BrickedSource::expect_lattices() const {
  in_lattices_ = true;
  // Few rays are single ones then. What is left is for chunks, which several lattices share.
  caches_->bricks.set_limit(cache_limit_ / 16), caches_->lattices.set_limit(cache_limit_ / 16 * 13);
}

std::shared_ptr<const BrickLattice> BrickedSource::lattice(const BrickNode& node) const {
  return caches_->lattices.get(lattice_key(node), [&] {
    auto b = load_lattice(*volume_, *tree_, node);
    return std::pair(b, b->bytes());
  });
}

// The system may read what rays will need, the nearest first, while the first rays are cast.
void BrickedSource::foresee() const {
  if (!volume_->expect) return;
  std::vector<std::pair<double, size_t>> order;
  for (size_t i = 0; i < tree_->size(); ++i) {
    const BrickNode& n = tree_->node(int(i));
    if (!n.seen || n.children >= 0) continue;
    Vec3 lo, hi;
    tree_->box(n, lo, hi);
    const BrickedVolume::Level& fine = volume_->levels[0];
    order.emplace_back(projection_.to_eye(fine.origin + volume_->direction * (fine.spacing * (0.5 * (lo + hi)))).z, i);
  }
  std::sort(order.begin(), order.end());
  size_t bytes = 0;
  for (size_t i = 0; i < order.size() && bytes < cache_limit_; ++i) {
    const BrickNode& n = tree_->node(int(order[i].second));
    Vec3 lo, hi;
    tree_->box(n, lo, hi);
    std::array<size_t, 3> from{}, count{};
    size_t size = element_size(volume_->type);
    for (size_t a = 0; a < 3; ++a) {
      const double scale = places_.scale[n.level][int(a)], shift = places_.shift[n.level][int(a)];
      const double last = double(volume_->levels[n.level].dims[a]) - 1;
      from[a] = size_t(std::clamp(std::ceil(lo[int(a)] * scale + shift), 0.0, last));
      count[a] = size_t(std::clamp(std::ceil(hi[int(a)] * scale + shift) - 1, double(from[a]), last)) - from[a] + 1;
      size *= count[a];
    }
    volume_->expect(n.level, from, count);
    bytes += size;
  }
}

// Of the level that the nearest place of the box is drawn from.
double BrickedSource::finest_edge() const {
  double nearest = HUGE_VAL;
  for (int c = 0; c < 8; ++c)
    nearest = std::min(
        nearest,
        projection_.to_eye(Vec3{c & 1 ? bounds.hi.x : bounds.lo.x, c & 2 ? bounds.hi.y : bounds.lo.y, c & 4 ? bounds.hi.z : bounds.lo.z})
            .z);
  const double pixel =
      pixels_ * (projection_.parallel ? 1 / projection_.scale : std::max(nearest, projection_.near_plane) / projection_.scale);
  double best = 0;
  for (const auto& l : volume_->levels) {
    const double e = std::min({l.spacing.x, l.spacing.y, l.spacing.z});
    if (best == 0 || std::max({l.spacing.x, l.spacing.y, l.spacing.z}) <= pixel) best = e;
  }
  return best;
}

std::unique_ptr<RaySource> bricked_source(const VolumeItem& item, const Projection& projection, size_t memory, Context&, double coarser) {
  if (!item.data) return nullptr;
  BrickedPtr volume = item.data->bricks();
  if (!volume || (!item.field.empty() && item.field != volume->field) || item.association != Association::point) return nullptr;
  if (!(coarser >= 1) || !std::isfinite(coarser)) fail_usage(fmt::format("voxels of {} pixels", coarser), "volume", "give 1 or more");
  if (memory == 0) memory = size_t(1) << 30;
  return std::make_unique<BrickedSource>(std::move(volume), item.data, projection, memory, coarser);
}

BrickedUse bricked_use(const RaySource& source) {
  const auto* s = dynamic_cast<const BrickedSource*>(&source);
  if (!s) fail_internal("not the source of a bricked volume");
  const BrickTree& tree = s->tree();
  BrickedUse use;
  use.bricks.resize(s->volume().levels.size());
  for (size_t i = 0; i < tree.size(); ++i)
    if (const BrickNode& n = tree.node(int(i)); n.children < 0 && n.seen) ++use.bricks[n.level];
  use.voxel_pixels = tree.pixels(), use.bytes = tree.bytes();
  return use;
}

}  // namespace sg::volume
