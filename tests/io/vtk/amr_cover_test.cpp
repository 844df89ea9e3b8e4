// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/amr_cover.h"

#include "data/dataset.h"
#include "support/test.h"

using namespace sg;

namespace {

AmrGrid two_levels(std::array<int, 3> ratio, std::vector<AmrGrid::Patch> coarse, std::vector<AmrGrid::Patch> fine) {
  AmrGrid g;
  g.levels.resize(2);
  g.levels[0].ratio = {1, 1, 1};
  g.levels[0].patches = std::move(coarse);
  g.levels[1].ratio = ratio;
  g.levels[1].patches = std::move(fine);
  return g;
}

}  // namespace

TEST_CASE("amr cover: cells under finer patches are marked, across patches and below zero") {
  AmrGrid g = two_levels({3, 2, 1}, {{{-2, -2, 0}, {-1, 1, 1}}, {{0, -2, 0}, {1, 1, 1}}}, {{{-3, -2, 1}, {2, 1, 1}}});
  const size_t cells = number_patches(g);
  CHECK(cells == 2 * 16 + 24);
  CHECK(g.levels[0].patches[1].cell_offset == 16);
  CHECK(g.levels[1].patches[0].point_offset == 2 * 3 * 5 * 3);
  const Array a = refined_cells(g);
  REQUIRE(a.count() == cells);
  const auto bits = a.view<uint8_t>();
  for (const auto& p : g.levels[0].patches)
    for (long long k = 0; k < 2; ++k)
      for (long long j = -2; j < 2; ++j)
        for (long long i = p.lo[0]; i <= p.hi[0]; ++i) {
          const size_t at = p.cell_offset + size_t(i - p.lo[0]) + 2 * (size_t(j + 2) + 4 * size_t(k));
          const bool under = i >= -1 && i <= 0 && j >= -1 && j <= 0 && k == 1;
          CHECK(int(bits[at]) == (under ? ghost_refined_cell : 0));
        }
  for (size_t i = 32; i < cells; ++i) CHECK(int(bits[i]) == 0);
}

TEST_CASE("amr cover: boxes that run backwards or cannot be counted are refused") {
  AmrGrid g = two_levels({2, 2, 2}, {{{0, 0, 0}, {1, -1, 1}}}, {});
  CHECK(test::error_of([&] { number_patches(g); }).find("extends from 0 to -1 along y") != std::string::npos);
  g.levels[0].patches[0].hi = {1ll << 39, 1ll << 39, 1ll << 39};
  CHECK(test::error_of([&] { number_patches(g); }).find("too many cells to count") != std::string::npos);
}
