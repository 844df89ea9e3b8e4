// SPDX-License-Identifier: Apache-2.0
#include "render/volume/methods/encoded_volume.h"

#include <array>
#include <bit>
#include <cmath>

#include <fmt/core.h>

#include "base/parallel.h"
#include "data/memory/memo.h"

namespace sg::volume {

namespace {

/// Everything that decides which voxels are seen and what is written down about them.
std::string key_of(const Stage& s, int axis) {
  uint64_t hash = 14695981039346656037u;
  const auto add = [&](uint32_t x) { hash = (hash ^ x) * 1099511628211u; };
  // Entries of a sweep over the values, so that kind and ends of the table count, and which of them are seen.
  const float lo = value_at(s.volume, 0, 0, 0);
  add(std::bit_cast<uint32_t>(s.volume.base)), add(uint32_t(s.transfer().index(lo)));
  const LinearTable t = s.transfer().linear_table();
  add(std::bit_cast<uint32_t>(t.first)), add(std::bit_cast<uint32_t>(t.per_axis)), add(uint32_t(t.count));
  add(uint32_t(s.item.color.kind)), add(std::bit_cast<uint32_t>(float(s.item.color.linear_threshold)));
  for (int i = 0; i < t.count + 3; ++i) add(s.transfer().medium(i).density > 0);
  add(std::bit_cast<uint32_t>(s.volume.shade_plan.per_scale));
  return fmt::format("shear_warp {} {} {} {} {} {:016x}", s.item.field, int(s.item.association), s.item.component, axis, s.item.shaded,
                     hash);
}

/// Whether all cells around the voxel are hidden.
bool all_hidden(const Volume& v, const std::array<size_t, 3>& at) {
  if (v.hidden().empty()) return false;
  for (int corner = 0; corner < 8; ++corner) {
    size_t id = 0;
    bool exists = true;
    for (size_t a = 3; a-- > 0;) {
      const size_t c = at[a] - size_t(corner >> a & 1), n = v.voxels.dims[a] - 1;
      exists = exists && c < n;
      id = id * n + c;
    }
    if (exists && !v.hidden()[id]) return false;
  }
  return true;
}

void encode(const Stage& s, const SliceAxes& axes, size_t k, EncodedVolume::Slice& out) {
  const Volume& v = s.volume;
  const size_t ni = v.voxels.dims[size_t(axes.i)], nj = v.voxels.dims[size_t(axes.j)];
  std::array<size_t, 3> at{};
  at[size_t(axes.k)] = k;
  out.first_run.push_back(0), out.first_voxel.push_back(0);
  for (size_t j = 0; j < nj; ++j) {
    at[size_t(axes.j)] = j;
    bool open = false;
    for (size_t i = 0; i < ni; ++i) {
      at[size_t(axes.i)] = i;
      const int entry = s.transfer().index(value_at(v, at[0], at[1], at[2]));
      if (!(s.transfer().medium(entry).density > 0) || all_hidden(v, at)) {
        open = false;
        continue;
      }
      if (!open) out.runs.push_back({uint32_t(i), uint32_t(i)}), open = true;
      ++out.runs.back().end;
      out.entry.push_back(uint16_t(entry));
      if (!s.item.shaded) continue;
      const PointGradient g = gradient_at_sample(v, at[0], at[1], at[2]);
      const Vec3f normal = world_gradient(s, g.q);
      const float square = dot(normal, normal), surface = std::min(1.0f, g.per_cell * v.shade_plan.per_scale);
      const bool good = square > 0 && square < 1e30f;
      out.normal.push_back(good ? direction_code(normal) : uint16_t(0));
      out.surface.push_back(good ? uint8_t(255 * surface + 0.5f) : uint8_t(0));
    }
    out.first_run.push_back(uint32_t(out.runs.size())), out.first_voxel.push_back(uint32_t(out.entry.size()));
  }
  out.runs.shrink_to_fit(), out.entry.shrink_to_fit(), out.normal.shrink_to_fit(), out.surface.shrink_to_fit();
}

}  // namespace

uint16_t direction_code(Vec3f d) {
  const float sum = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  float u = d.x / sum, v = d.y / sum;
  if (d.z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f), u = folded;
  }
  const auto byte = [](float x) { return uint16_t(std::min(255.0f, std::max(0.0f, (0.5f * x + 0.5f) * 255 + 0.5f))); };
  return uint16_t(byte(u) | byte(v) << 8);
}

Vec3f direction_of(uint16_t code) {
  float u = float(code & 255) / 255 * 2 - 1, v = float(code >> 8) / 255 * 2 - 1;
  const float z = 1 - std::abs(u) - std::abs(v);
  if (z < 0) {
    const float folded = (1 - std::abs(v)) * (u < 0 ? -1.0f : 1.0f);
    v = (1 - std::abs(u)) * (v < 0 ? -1.0f : 1.0f), u = folded;
  }
  return normalize(Vec3f{u, v, z});
}

size_t EncodedVolume::bytes() const {
  size_t sum = 0;
  for (const Slice& s : slices)
    sum += sizeof s + 4 * (s.first_run.size() + s.first_voxel.size()) + sizeof(Run) * s.runs.size() +
           2 * (s.entry.size() + s.normal.size()) + s.surface.size();
  return sum;
}

std::shared_ptr<const EncodedVolume> encoded_volume(const Stage& s, int axis) {
  Memo& memo = s.item.data->memo();
  const std::string key = key_of(s, axis);
  if (auto kept = memo.find<EncodedVolume>(key)) return kept;
  EncodedVolume e;
  e.axes = slice_axes(axis);
  e.slices.resize(s.volume.voxels.dims[size_t(axis)]);
  parallel_for(
      e.slices.size(), 1,
      [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k) encode(s, e.axes, k, e.slices[k]);
      },
      &s.context);
  const size_t bytes = e.bytes(), volume = s.volume.voxels.array.count() * element_size(s.volume.voxels.array.type());
  if (memo.bytes() + bytes > 4 * volume + (size_t(1) << 20)) return std::make_shared<const EncodedVolume>(std::move(e));
  return memo.keep(key, std::move(e), bytes);
}

}  // namespace sg::volume
