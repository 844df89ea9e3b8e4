// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <numeric>

#include "samples.h"

using namespace sg;
using test::contains;
using test::H5Sample;

namespace {

std::string grid_text(int n, const char* dims, const char* end, const char* left, const char* right, const char* pointers) {
  return fmt::format(
      "\nGrid = {}\nGridRank          = 3\nGridDimension     = {}\nGridStartIndex    = 1 1 1\nGridEndIndex      = {}\n"
      "GridLeftEdge      = {}\nGridRightEdge     = {}\nTime              = 0.25\nBaryonFileName = /elsewhere/run.cpu0000\n"
      "NumberOfParticles   = 0\n{}",
      n, dims, end, left, right, pointers);
}

// Two levels: 4x4x2 cells, and 2x2x2 finer ones on four cells of the lower half... of which two lie along z in one.
std::string hierarchy() {
  return grid_text(1, "6 6 4", "4 4 2", "0 0 0", "4 4 2",
                   "Pointer: Grid[1]->NextGridThisLevel = 0\nPointer: Grid[1]->NextGridNextLevel = 2\n") +
         grid_text(2, "4 4 4", "2 2 2", "1 1 0", "2 2 1",
                   "Pointer: Grid[2]->NextGridThisLevel = 0\nPointer: Grid[2]->NextGridNextLevel = 0\n");
}

void make_fields() {
  H5Sample h("run.cpu0000");
  h.group("/Grid00000001"), h.group("/Grid00000002");
  std::vector<float> coarse(32), fine(8);
  std::iota(coarse.begin(), coarse.end(), 0.f), std::iota(fine.begin(), fine.end(), 100.f);
  h.data("/Grid00000001/Density", coarse, {2, 4, 4}, {{}, false, false, false, H5T_IEEE_F32BE});
  h.data("/Grid00000002/Density", fine, {2, 2, 2});
  std::vector<double> ghosts(6 * 6 * 4, -1), fine_ghosts(4 * 4 * 4, -1);  // with the zones around
  for (size_t k = 0; k < 2; ++k)
    for (size_t j = 0; j < 4; ++j)
      for (size_t i = 0; i < 4; ++i) ghosts[i + 1 + 6 * (j + 1 + 6 * (k + 1))] = double(i);
  for (size_t k = 0; k < 2; ++k)
    for (size_t j = 0; j < 2; ++j)
      for (size_t i = 0; i < 2; ++i) fine_ghosts[i + 1 + 4 * (j + 1 + 4 * (k + 1))] = double(10 + i);
  h.data("/Grid00000001/GZ", ghosts, {4, 6, 6});
  h.data("/Grid00000002/GZ", fine_ghosts, {4, 4, 4});
  h.data<float>("/Grid00000001/particle_mass", {1, 2, 3});
}

std::string write_all(const std::string& text) {
  make_fields();
  test::temp_file("run", "DataLabel[0]              = Density\n#DataCGSConversionFactor[0] = 0.5\n");
  return test::temp_file("run.hierarchy", text);
}

}  // namespace

TEST_CASE("enzo: grids of the hierarchy become levels, covered cells are marked, factors applied") {
  const DatasetPtr d = test::read_file(write_all(hierarchy()));
  const auto* g = d->as<AmrGrid>();
  REQUIRE(g);
  REQUIRE(g->levels.size() == 2);
  CHECK(g->levels[0].spacing == Vec3{1, 1, 1});
  CHECK(g->levels[1].ratio == std::array<int, 3>{2, 2, 2});
  CHECK(g->levels[1].patches[0].lo == std::array<long long, 3>{2, 2, 0});
  CHECK(d->cell_count() == 40);
  CHECK(d->time() == 0.25);
  const Field& f = d->fields().require("Density");
  CHECK(f.array.get(31) == 15.5);
  CHECK(f.array.get(39) == 53.5);
  CHECK(f.unit == "g/cm^3");
  const Field& z = d->fields().require("GZ");
  CHECK(z.array.get(3) == 3);
  CHECK(z.array.get(33) == 11);
  CHECK(!d->fields().find("particle_mass"));
  for (size_t i = 0; i < 40; ++i) CHECK(int(d->cell_ghost().view<uint8_t>()[i]) == (i == 5 ? ghost_refined_cell : 0));
  Context context;
  CHECK(file_times(test::temp_folder() + "run.hierarchy", {}, context) == std::vector<double>{0.25});
  ReadOptions one;
  one.fields = {"GZ"};
  CHECK(test::read_file(test::temp_folder() + "run.hierarchy", one)->fields().size() == 1);
}

TEST_CASE("enzo: circles, missing grids and wrong shapes are refused") {
  auto refused = [&](std::string text, std::string_view from, std::string_view to) {
    text.replace(text.find(from), from.size(), to);
    const std::string path = write_all(text);
    return test::error_of([&] { test::read_file(path); });
  };
  CHECK(contains(refused(hierarchy(), "Grid[2]->NextGridThisLevel = 0", "Grid[2]->NextGridThisLevel = 1"), "reaches grid 1 twice"));
  CHECK(contains(refused(hierarchy(), "Grid[2]->NextGridNextLevel = 0", "Grid[2]->NextGridNextLevel = 7"),
                 "points to grid 7, which does not exist"));
  CHECK(contains(refused(hierarchy(), "NextGridNextLevel = 2", "NextGridNextLevel = 0"), "has no pointer to grid 2"));
  CHECK(contains(refused(hierarchy(), "GridEndIndex      = 4 4 2", "GridEndIndex      = 4 9 2"), "grid 1 extends from 1 to 9 of 6"));
  CHECK(contains(refused(hierarchy(), "GridDimension     = 6 6 4", "GridDimension     = 6 six 4"), "line 4"));
  CHECK(contains(refused(hierarchy(), "GridRightEdge     = 2 2 1", "GridRightEdge     = 1 2 1"), "edges at 1 and 1"));
  CHECK(contains(refused(hierarchy(), "run.cpu0000", "gone.cpu0000"), "gone.cpu0000"));
}

TEST_CASE("enzo: a cut or damaged hierarchy is read or refused") {
  make_fields();
  CHECK(test::cut_and_damage("run.hierarchy", hierarchy()) >= 50);
}
