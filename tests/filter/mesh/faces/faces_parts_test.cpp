// SPDX-License-Identifier: Apache-2.0
// Outer faces of meshes in parts: pieces with ghost layers, levels of patches. No wall may stand between the parts.
#include <cstring>
#include <set>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/select/piece.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

std::multiset<double> numbers(const Dataset& d) {
  std::multiset<double> r;
  const Array& c = d.fields().require("c", Association::cell).array;
  for (size_t i = 0; i < c.count(); ++i) r.insert(c.get(i));
  return r;
}

// Three levels of ratio 2 over [0,1]^3, the coarsest 4^3; patches may overlap. Refined cells are marked, and a few are hidden.
struct Levels {
  AmrGrid grid;
  std::vector<uint8_t> ghost;
  std::vector<double> filled;  // the finest cells: is there a cell to see?

  explicit Levels(bool hide) {
    grid.levels.resize(3);
    for (int l = 0; l < 3; ++l) {
      grid.levels[size_t(l)].spacing = Vec3(0.25, 0.25, 0.25) / double(1 << l);
      if (l == 0) grid.levels[0].ratio = {1, 1, 1};
    }
    grid.levels[0].patches = {{{0, 0, 0}, {3, 3, 1}}, {{0, 0, 2}, {3, 3, 3}}};
    grid.levels[1].patches = {{{0, 2, 2}, {5, 7, 5}}, {{4, 2, 2}, {7, 5, 5}}};  // they share a corner
    grid.levels[2].patches = {{{0, 6, 6}, {7, 9, 9}}, {{8, 8, 6}, {13, 11, 9}}};
    size_t cell = 0, point = 0;
    for (size_t l = 0; l < 3; ++l)
      for (auto& p : grid.levels[l].patches) {
        p.cell_offset = cell, p.point_offset = point;
        const auto n = p.cells();
        for (size_t c = 0; c < n[0] * n[1] * n[2]; ++c, ++cell) {
          const long long at[3] = {p.lo[0] + (long long)(c % n[0]), p.lo[1] + (long long)(c / n[0] % n[1]),
                                   p.lo[2] + (long long)(c / n[0] / n[1])};
          // Whole faces of coarser cells only: those next to a part of them show wholly.
          const bool hidden = hide && (l == 2   ? at[1] / 2 == 3 && at[2] / 2 == 3
                                       : l == 1 ? at[0] / 2 == 2 && at[2] / 2 == 1
                                                : at[0] == 3 && at[2] == 3);
          ghost.push_back(covered(l, at) ? ghost_refined_cell : hidden ? ghost_hidden_cell : 0);
        }
        point += (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
      }
    filled.assign(16 * 16 * 16, 0);
    for (size_t l = 0; l < 3; ++l)
      for (const auto& p : grid.levels[l].patches) {
        const auto n = p.cells();
        const size_t k = size_t(4) >> l;
        for (size_t c = 0; c < n[0] * n[1] * n[2]; ++c) {
          if (ghost[p.cell_offset + c] != 0) continue;
          const size_t at[3] = {size_t(p.lo[0]) + c % n[0], size_t(p.lo[1]) + c / n[0] % n[1], size_t(p.lo[2]) + c / n[0] / n[1]};
          for (size_t f = 0; f < k * k * k; ++f)
            filled[(at[0] * k + f % k) + 16 * ((at[1] * k + f / k % k) + 16 * (at[2] * k + f / k / k))] = 1;
        }
      }
  }
  bool covered(size_t l, const long long* at) const {
    if (l == 2) return false;
    for (const auto& q : grid.levels[l + 1].patches) {
      bool in = true;
      for (size_t a = 0; a < 3; ++a) in = in && 2 * at[a] >= q.lo[a] && 2 * at[a] + 1 <= q.hi[a];
      if (in) return true;
    }
    return false;
  }
  // Faces between what is filled and what is not.
  double area() const {
    double sum = 0;
    auto at = [&](int i, int j, int k) {
      return i >= 0 && j >= 0 && k >= 0 && i < 16 && j < 16 && k < 16 && filled[size_t(i + 16 * (j + 16 * k))] > 0;
    };
    for (int k = -1; k < 16; ++k)
      for (int j = -1; j < 16; ++j)
        for (int i = -1; i < 16; ++i)
          sum += (at(i, j, k) != at(i + 1, j, k)) + (at(i, j, k) != at(i, j + 1, k)) + (at(i, j, k) != at(i, j, k + 1));
    return sum / 256;
  }
};

}  // namespace

TEST_CASE("faces: those of pieces with ghost layers are together those of the whole, no walls between") {
  Context ctx;
  CurvilinearGrid g;
  g.dims = {5, 4, 6};
  std::vector<double> xyz;
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 5; ++i) xyz.insert(xyz.end(), {i + 0.1 * j, j + 0.1 * k * k, double(k)});
  g.points.xyz = Array::from_vector(xyz, 3);
  std::vector<Vec3> at;
  for (size_t p = 0; p < g.points.count(); ++p) at.push_back(g.points.at(p));
  for (const DatasetPtr& whole :
       {uniform_box(6, 5, 4), with_fields(g, at), solid_box(CellType::tetra, 3), solid_box(CellType::hexahedron, 4),
        solid_box(CellType::polyhedron, 3), solid_box(CellType::wedge, 3), solid_box(CellType::triquadratic_hexahedron, 3)}) {
    const DatasetPtr skin = faces(whole, {}, ctx);
    for (int pieces : {2, 5}) {
      std::multiset<double> seen;
      double area = 0;
      size_t count = 0;
      for (int p = 0; p < pieces; ++p) {
        const DatasetPtr part = take_piece(whole, p, pieces, 1, ctx);
        const DatasetPtr own = faces(part, {}, ctx);
        area += measure(*own->as<SurfaceMesh>()).area;
        count += own->cell_count();
        seen.merge(numbers(*own));
        // Its own numbers name cells of the piece that are its own.
        const Array& cell = own->fields().require("original_cell").array;
        const Array& c = part->fields().require("c", Association::cell).array;
        for (size_t i = 0; i < own->cell_count(); ++i) {
          REQUIRE(c.get(size_t(cell.get(i))) == own->fields().require("c", Association::cell).array.get(i));
          if (!part->cell_ghost().empty()) REQUIRE(part->cell_ghost().get(size_t(cell.get(i))) == 0);
        }
      }
      CHECK(count == skin->cell_count());
      CHECK(area == doctest::Approx(measure(*skin->as<SurfaceMesh>()).area));
      CHECK(seen == numbers(*skin));
    }
  }
}

TEST_CASE("faces: AMR of three levels with overlaps and hidden cells has the area that counting the finest cells gives") {
  Context ctx;
  for (bool hide : {false, true}) {
    CAPTURE(hide);
    const Levels levels(hide);
    DatasetParts p;
    p.mesh = levels.grid;
    p.cell_ghost = Array::from_vector(levels.ghost);
    const DatasetPtr skin = faces(make_dataset(p), {}, ctx);
    const SurfaceFacts facts = measure(*skin->as<SurfaceMesh>());
    double volume = 0;
    for (double f : levels.filled) volume += f / 4096;
    CHECK((volume < 1) == hide);
    CHECK(facts.volume == doctest::Approx(volume));
    CHECK(length(facts.vector_area) < 1e-12);
    CHECK(facts.area == doctest::Approx(levels.area()));
    const Array& cell = skin->fields().require("original_cell").array;
    for (size_t i = 0; i < cell.count(); ++i) REQUIRE(levels.ghost[size_t(cell.get(i))] == 0);
  }
}

TEST_CASE("faces: cells in any order have the same faces as in file order, for 1 and 8 threads") {
  Context ctx;
  // Many blocks of cells; shuffled ones reach over all points and take the other way through the matching.
  const DatasetPtr sorted = solid_box(CellType::tetra, 24);
  const auto& m = *sorted->as<UnstructuredMesh>();
  const CellsView v = cells_view(m.cells);
  std::vector<size_t> order(v.count);
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  for (size_t i = order.size() - 1; i > 0; --i) std::swap(order[i], order[size_t(random_unit(3, i) * double(i + 1))]);
  UnstructuredMesh s = m;
  std::vector<int64_t> ids;
  std::vector<double> number;
  for (size_t c : order) {
    for (size_t k = 0; k < 4; ++k) ids.push_back(v.point(c, k));
    number.push_back(double(c));
  }
  s.cells = {Array::from_vector(ids), {}, 4};
  FieldSet fields;
  fields.add(make_field("c", Association::cell, number));
  const DatasetPtr shuffled = make_dataset(s, fields);
  const DatasetPtr a = faces(sorted, {}, ctx);
  set_thread_count(1);
  const DatasetPtr b = faces(shuffled, {}, ctx);
  set_thread_count(8);
  const DatasetPtr c = faces(shuffled, {}, ctx);
  set_thread_count(0);
  CHECK(same_surface(*b, *c));
  CHECK(a->cell_count() == 24 * 24 * 2 * 6);
  CHECK(numbers(*a) == numbers(*b));
  CHECK(measure(*b->as<SurfaceMesh>()).closed);
}
