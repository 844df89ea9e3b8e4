// SPDX-License-Identifier: Apache-2.0
#include "simulate/particles/near_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "data/cells/cell_reader.h"

namespace sg::swarm {

namespace {

constexpr double cells_along = 96;
constexpr size_t most_entries = size_t(1) << 24;  // many large cells that cross each other: the whole mesh is asked

}  // namespace

NearCells::NearCells(const DatasetPtr& data, double margin) : box_(data->bounds()) {
  const Vec3 wider = Vec3(1, 1, 1) * margin;
  box_.lo -= wider, box_.hi += wider;
  const Vec3 extent = box_.size();
  const double most = std::max({extent.x, extent.y, extent.z});
  for (int a = 0; a < 3; ++a) {
    n_[size_t(a)] = most > 0 ? std::max(1, int(std::ceil(cells_along * extent[a] / most))) : 1;
    scale_[a] = extent[a] > 0 ? n_[size_t(a)] / extent[a] : 0;
  }
  words_ = (size_t(n_[0]) + 63) / 64;
  filled_.assign(row(0, n_[2]), 0);
  struct Entry {
    uint32_t cell, id;  // of the grid, of the mesh
  };
  std::vector<Entry> entries;
  // Lattices are asked as a whole: they know a ray's way.
  bool listed = data->cell_count() <= UINT32_MAX && (data->as<SurfaceMesh>() || data->as<UnstructuredMesh>()) &&
                data->cell_ghost().empty() && data->point_ghost().empty();
  CellReader reader(data);
  for (size_t c = 0; c < data->cell_count(); ++c) {
    reader.open(c);
    Box3 nodes;
    for (const Vec3& p : reader.at()) nodes.add(p);
    const Box3 box = reader.box();
    if (box.empty()) continue;
    // Flat cells fill only what their plane comes near.
    Vec3 normal{};
    double off = HUGE_VAL;
    if (reader.at().size() >= 3 && box == nodes) {
      const auto& at = reader.at();
      normal = normalize(cross(at[1] - at[0], at[2] - at[0]));
      off = length(normal) > 0 ? 0 : HUGE_VAL;
      for (const Vec3& p : at) off = std::max(off, std::abs(dot(p - at[0], normal)));
    }
    Part p;
    if (!part(box.lo - wider, box.hi + wider, p)) continue;
    const Vec3 half = box_.size() * Vec3(0.5 / n_[0], 0.5 / n_[1], 0.5 / n_[2]);
    const double reach = off + std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z + length(wider);
    for (int k = p.lo[2]; k <= p.hi[2]; ++k)
      for (int j = p.lo[1]; j <= p.hi[1]; ++j)
        for (int i = p.lo[0]; i <= p.hi[0]; ++i) {
          const Vec3 middle = box_.lo + Vec3(2 * i + 1, 2 * j + 1, 2 * k + 1) * half;
          if (off != HUGE_VAL && !(std::abs(dot(middle - reader.at()[0], normal)) <= reach)) continue;
          filled_[row(j, k) + size_t(i) / 64] |= uint64_t(1) << (i % 64);
          if (listed) entries.push_back({uint32_t(row(j, k) * 64 + size_t(i)), uint32_t(c)});
        }
    listed = listed && entries.size() <= most_entries;
  }
  if (!listed) return;
  rank_.resize(filled_.size());
  uint32_t count = 0;
  for (size_t w = 0; w < filled_.size(); ++w) rank_[w] = count, count += uint32_t(std::popcount(filled_[w]));
  const auto place = [&](uint32_t cell) {
    const uint64_t below = (uint64_t(1) << (cell % 64)) - 1;
    return rank_[cell / 64] + uint32_t(std::popcount(filled_[cell / 64] & below));
  };
  begin_.assign(size_t(count) + 1, 0), ids_.resize(entries.size());
  for (const Entry& e : entries) ++begin_[place(e.cell) + 1];
  for (size_t c = 0; c < count; ++c) begin_[c + 1] += begin_[c];
  std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
  for (const Entry& e : entries) ids_[next[place(e.cell)]++] = e.id;
}

// False where the box of a and b lies beside the grid.
bool NearCells::part(Vec3 a, Vec3 b, Part& to) const {
  for (int c = 0; c < 3; ++c) {
    const double p = (std::min(a[c], b[c]) - box_.lo[c]) * scale_[c], q = (std::max(a[c], b[c]) - box_.lo[c]) * scale_[c];
    if (!(q >= 0 && p <= n_[size_t(c)])) return false;
    const double last = n_[size_t(c)] - 1;
    to.lo[c] = int(std::clamp(p, 0.0, last)), to.hi[c] = int(std::clamp(q, 0.0, last));
  }
  return true;
}

bool NearCells::may_meet(Vec3 a, Vec3 b, int most_cells) const {
  Part p;
  if (!part(a, b, p)) return false;
  if (p.cells() > most_cells) return true;
  for (int k = p.lo[2]; k <= p.hi[2]; ++k)
    for (int j = p.lo[1]; j <= p.hi[1]; ++j)
      for (size_t w = size_t(p.lo[0]) / 64; w <= size_t(p.hi[0]) / 64; ++w)
        if (filled_[row(j, k) + w] & between(p.lo[0], p.hi[0], w)) return true;
  return false;
}

bool NearCells::collect(Vec3 a, Vec3 b, std::span<uint32_t> ids, size_t& count) const {
  Part p;
  if (!part(a, b, p)) return true;
  if (begin_.empty() || p.cells() > 64) return false;
  for (int k = p.lo[2]; k <= p.hi[2]; ++k)
    for (int j = p.lo[1]; j <= p.hi[1]; ++j)
      for (size_t w = size_t(p.lo[0]) / 64; w <= size_t(p.hi[0]) / 64; ++w) {
        const uint64_t all = filled_[row(j, k) + w];
        for (uint64_t left = all & between(p.lo[0], p.hi[0], w); left; left &= left - 1) {
          const uint64_t below = (left & -left) - 1;
          const size_t place = rank_[row(j, k) + w] + size_t(std::popcount(all & below));
          for (uint32_t e = begin_[place]; e < begin_[place + 1]; ++e) {
            if (std::find(ids.begin(), ids.begin() + std::ptrdiff_t(count), ids_[e]) != ids.begin() + std::ptrdiff_t(count)) continue;
            if (count == ids.size()) return false;
            ids[count++] = ids_[e];
          }
        }
      }
  return true;
}

}  // namespace sg::swarm
