// SPDX-License-Identifier: Apache-2.0
// AMR grids over [-1, 1]^3 for the tests of volumes: patches by hand or at random, covered cells marked.
#pragma once
#include "data/cells/point_positions.h"
#include "data/cells/shape/cell_map.h"
#include "support/property.h"
#include "volume_cells_support.h"

namespace sg::test {

using Boxes = std::vector<std::array<std::array<int64_t, 3>, 2>>;  ///< lowest and highest cell of each patch, counted in cells of its level

/// `coarse` cells along each axis of level 0; level k + 1 has ratio[k] and the patches finer[k]. Cells that a finer patch covers are
/// marked.
inline DatasetPtr amr_of(int64_t coarse, const std::vector<int>& ratio, const std::vector<Boxes>& finer, const Boxes& coarsest = {}) {
  AmrGrid g;
  g.origin = {-1, -1, -1};
  g.levels.resize(ratio.size() + 1);
  double h = 2.0 / double(coarse);
  size_t cells = 0, points = 0;
  for (size_t l = 0; l < g.levels.size(); ++l) {
    const int r = l ? ratio[l - 1] : 1;
    h /= r;
    g.levels[l].spacing = {h, h, h}, g.levels[l].ratio = {r, r, r};
    const Boxes all{{{{0, 0, 0}, {coarse - 1, coarse - 1, coarse - 1}}}};
    for (const auto& box : l ? finer[l - 1] : coarsest.empty() ? all : coarsest) {
      AmrGrid::Patch p;
      p.lo = {box[0][0], box[0][1], box[0][2]}, p.hi = {box[1][0], box[1][1], box[1][2]};
      p.cell_offset = cells, p.point_offset = points;
      const auto n = p.cells();
      cells += n[0] * n[1] * n[2], points += (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
      g.levels[l].patches.push_back(p);
    }
  }
  std::vector<uint8_t> ghost(cells);
  for (size_t l = 0; l + 1 < g.levels.size(); ++l)
    for (const auto& p : g.levels[l].patches) {
      const auto n = p.cells();
      for (size_t c = 0; c < n[0] * n[1] * n[2]; ++c) {
        const int64_t at[3] = {p.lo[0] + int64_t(c % n[0]), p.lo[1] + int64_t(c / n[0] % n[1]), p.lo[2] + int64_t(c / n[0] / n[1])};
        for (const auto& q : g.levels[l + 1].patches) {
          bool in = true;
          for (size_t a = 0; a < 3; ++a) in = in && ratio[l] * at[a] >= q.lo[a] && ratio[l] * (at[a] + 1) - 1 <= q.hi[a];
          if (in) ghost[p.cell_offset + c] = ghost_refined_cell;
        }
      }
    }
  DatasetParts parts;
  parts.mesh = std::move(g);
  parts.cell_ghost = Array::from_vector(ghost);
  return make_dataset(std::move(parts));
}

/// Two or three levels with a ratio of 2 or 4; level 0 may be several patches; finer patches are side by side, apart, at the border, and
/// may touch a level that is two coarser.
inline DatasetPtr random_amr(Random& random) {
  const int64_t coarse = random.whole(3, 5);
  const size_t finer = size_t(random.whole(1, 2));
  std::vector<int> ratio;
  std::vector<Boxes> patches;
  // Which cells of the level are there, and which of them become fine: blocks of them, one patch each.
  std::vector<std::array<int64_t, 3>> there;
  for (int64_t i = 0; i < coarse * coarse * coarse; ++i) there.push_back({i % coarse, i / coarse % coarse, i / coarse / coarse});
  for (size_t l = 0; l < finer; ++l) {
    const int r = random.chance(0.7) ? 2 : 4;
    ratio.push_back(r);
    Boxes boxes;
    std::vector<std::array<int64_t, 3>> next;
    const double share = l ? 0.1 : random.in(0.05, 0.4);
    for (const auto& c : there) {
      if (!random.chance(share) || boxes.size() > 40) continue;
      std::array<std::array<int64_t, 3>, 2> box;
      for (size_t a = 0; a < 3; ++a) box[0][a] = r * c[a], box[1][a] = r * c[a] + r - 1;
      boxes.push_back(box);
      for (int64_t i = 0; i < r * r * r; ++i) next.push_back({r * c[0] + i % r, r * c[1] + i / r % r, r * c[2] + i / r / r});
    }
    if (boxes.empty()) {
      ratio.pop_back();
      break;
    }
    patches.push_back(std::move(boxes));
    there = std::move(next);
  }
  Boxes split;
  if (random.chance(0.4)) split = {{{{0, 0, 0}, {0, coarse - 1, coarse - 1}}}, {{{1, 0, 0}, {coarse - 1, coarse - 1, coarse - 1}}}};
  return amr_of(coarse, ratio, patches, split);
}

/// Leaves no cell whose middle lies in the box.
inline DatasetPtr with_hole(const DatasetPtr& grid, const Box3& hole) {
  std::vector<uint8_t> ghost(grid->cell_count());
  const View<uint8_t> old = grid->cell_ghost().view<uint8_t>();
  CellMap map(grid);
  for (size_t c = 0; c < ghost.size(); ++c) {
    map.open(c);
    const Vec3 at = map.center();
    bool in = true;
    for (int a = 0; a < 3; ++a) in = in && hole.lo[a] < at[a] && at[a] < hole.hi[a];
    ghost[c] = uint8_t(old[c] | (in ? ghost_hidden_cell : 0));
  }
  DatasetParts parts = grid->parts();
  parts.cell_ghost = Array::from_vector(ghost);
  return make_dataset(std::move(parts));
}

/// With the field "f" of the points or cells, f32.
inline DatasetPtr with_amr_field(const DatasetPtr& grid, const Function& f, Association a) {
  std::vector<float> v;
  if (a == Association::cell) {
    CellMap map(grid);
    for (size_t c = 0; c < grid->cell_count(); ++c) map.open(c), v.push_back(float(f(map.center())));
  } else {
    const Array xyz = point_positions(grid->mesh());
    for (size_t i = 0; i < xyz.count(); ++i) v.push_back(float(f({xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)})));
  }
  DatasetParts parts = grid->parts();
  parts.fields.add({"f", a, Array::from_vector(v), "", Role::scalars});
  return make_dataset(std::move(parts));
}

}  // namespace sg::test
