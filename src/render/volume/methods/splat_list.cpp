// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/splat_list.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

SplatList::SplatList(const Stage& stage, const Footprints& footprints, bool classified) : stage_(stage) {
  const Volume& v = stage.volume;
  if (v.voxels.dims[0] * v.voxels.dims[1] * v.voxels.dims[2] > 0xFFFFFFFFu)
    fail_usage("method=splat draws at most 4 billion voxels", "volume", "use method=ray for more");
  for (int a = 0; a < 3; ++a)
    for (size_t i = 0; i < v.voxels.dims[size_t(a)]; ++i) {
      const double lo = std::max(v.lo[a], double(i) - 0.5), hi = std::min(v.hi[a], double(i) + 0.5);
      axis_share_[a].push_back(float(std::max(0.0, hi - lo)));
    }
  collect(classified);
  sort(footprints);
  bin(footprints);
}

Vec3 SplatList::lattice(uint32_t voxel) const {
  const auto& n = stage_.volume.voxels.dims;
  const size_t layer = n[0] * n[1], k = voxel / layer, in = voxel - k * layer, j = in / n[0];
  return {double(in - j * n[0]), double(j), double(k)};
}

float SplatList::share(const size_t at[3]) const {
  const float whole = axis_share_[0][at[0]] * axis_share_[1][at[1]] * axis_share_[2][at[2]];
  const Volume& v = stage_.volume;
  if (v.hidden().empty()) return whole;
  int cells = 0, drawn = 0;  // around the voxel
  for (int corner = 0; corner < 8; ++corner) {
    size_t id = 0;
    bool exists = true;
    for (int a = 3; a-- > 0;) {
      const size_t c = at[a] - size_t(corner >> a & 1), n = v.voxels.dims[size_t(a)] - 1;
      exists = exists && c < n;
      id = id * n + c;
    }
    if (exists) ++cells, drawn += !v.hidden()[id];
  }
  return cells > 0 ? whole * float(drawn) / float(cells) : whole;
}

Splat SplatList::splat_of(uint32_t voxel) const {
  const Vec3 q = lattice(voxel);
  const size_t at[3] = {size_t(q.x), size_t(q.y), size_t(q.z)};
  float value = 0;
  const void* p = stage_.volume.voxels.array.raw();
  switch (stage_.volume.voxels.array.type()) {
    case ElementType::u8: value = float(static_cast<const uint8_t*>(p)[voxel]); break;
    case ElementType::i8: value = float(static_cast<const int8_t*>(p)[voxel]); break;
    case ElementType::u16: value = float(static_cast<const uint16_t*>(p)[voxel]); break;
    case ElementType::i16: value = float(static_cast<const int16_t*>(p)[voxel]); break;
    default: value = static_cast<const float*>(p)[voxel];
  }
  return {q, value, share(at)};
}

void SplatList::collect(bool classified) {
  const Volume& v = stage_.volume;
  const auto& n = v.voxels.dims;
  const bool composite = stage_.item.mode == RayFunction::composite;
  std::vector<std::vector<uint32_t>> rows(n[2]);
  parallel_for(
      n[2], 1,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
          for (size_t j = 0; j < n[1]; ++j)
            for (size_t i = 0; i < n[0]; ++i) {
              // A kernel reaches less than a brick: with all bricks around clear, no sheet's value can be seen there.
              const size_t brick = v.fine().id(std::min(i >> FineBricks::shift, v.fine().dims[0] - 1),
                                               std::min(j >> FineBricks::shift, v.fine().dims[1] - 1),
                                               std::min(k >> FineBricks::shift, v.fine().dims[2] - 1));
              if (composite && v.distance[brick] > (classified ? 0 : 1)) {
                i |= FineBricks::edge - 1;
                continue;
              }
              const uint32_t voxel = uint32_t(i + n[0] * (j + n[1] * k));
              const Splat s = splat_of(voxel);
              if (s.value != s.value || s.share == 0) continue;
              if (classified && !(stage_.transfer().medium(stage_.transfer().index(s.value)).density > 0)) continue;
              rows[k].push_back(voxel);
            }
      },
      &stage_.context);
  std::vector<size_t> first(n[2]);
  for (size_t k = 0; k < n[2]; ++k) first[k] = rows[k].size();
  voxels_.resize(exclusive_scan(first));
  parallel_for(n[2], 1, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) std::copy(rows[k].begin(), rows[k].end(), voxels_.begin() + ptrdiff_t(first[k]));
  });
}

/// By depth, to 1/4 million of the volume's depth; equal ones in the lattice's order (two stable passes of 11 bits).
void SplatList::sort(const Footprints& footprints) {
  double nearest = HUGE_VAL, farthest = -HUGE_VAL;
  const auto& n = stage_.volume.voxels.dims;
  for (int c = 0; c < 8; ++c) {
    const double z = footprints.depth({c & 1 ? double(n[0]) : 0, c & 2 ? double(n[1]) : 0, c & 4 ? double(n[2]) : 0});
    nearest = std::min(nearest, z), farthest = std::max(farthest, z);
  }
  constexpr int bits = 11, bins = 1 << bits;
  const double scale = farthest > nearest ? double((1 << 2 * bits) - 1) / (farthest - nearest) : 0;
  std::vector<uint32_t> key(voxels_.size()), other(voxels_.size()), other_key(voxels_.size());
  parallel_for(voxels_.size(), 65536, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) key[i] = uint32_t((footprints.depth(lattice(voxels_[i])) - nearest) * scale);
  });
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<size_t> place(bins);
    for (const uint32_t k : key) ++place[k >> (pass * bits) & (bins - 1)];
    exclusive_scan(place);
    for (size_t i = 0; i < key.size(); ++i) {
      const size_t to = place[key[i] >> (pass * bits) & (bins - 1)]++;
      other[to] = voxels_[i], other_key[to] = key[i];
    }
    voxels_.swap(other), key.swap(other_key);
  }
}

void SplatList::bin(const Footprints& footprints) {
  const Projection& p = stage_.projection;
  const size_t bands = size_t(p.height + band - 1) / band, grain = 65536, chunks = (voxels_.size() + grain - 1) / grain;
  const auto rows = [&](uint32_t voxel, size_t& first, size_t& last) {
    Footprint f;
    if (!footprints.at(lattice(voxel), f)) return false;
    if (f.x + f.half_x < 0 || f.x - f.half_x > float(p.width) || f.y + f.half_y < 0 || f.y - f.half_y > float(p.height)) return false;
    if (double(f.depth) + footprints.reach() < p.near_plane || double(f.depth) - footprints.reach() > p.far_plane) return false;
    first = size_t(std::max(0.0f, f.y - f.half_y)) / band, last = std::min(bands - 1, size_t(f.y + f.half_y) / band);
    return true;
  };
  // counts[b][chunk], so that the scan orders each band's entries by depth.
  std::vector<size_t> counts(bands * chunks + 1);
  const auto pass = [&](auto&& each) {
    parallel_for(
        voxels_.size(), grain,
        [&](size_t begin, size_t end) {
          size_t first, last;
          for (size_t i = begin; i < end; ++i)
            if (rows(voxels_[i], first, last))
              for (size_t b = first; b <= last; ++b) each(b * chunks + begin / grain, i);
        },
        &stage_.context);
  };
  pass([&](size_t cell, size_t) { ++counts[cell]; });
  touching_.resize(exclusive_scan(counts));
  start_.resize(bands + 1);
  for (size_t b = 0; b <= bands; ++b) start_[b] = b < bands && chunks > 0 ? counts[b * chunks] : touching_.size();
  pass([&](size_t cell, size_t i) { touching_[counts[cell]++] = uint32_t(i); });
}

}  // namespace sg::volume
