// SPDX-License-Identifier: Apache-2.0
// Lines through tetrahedra that share their corners in any way at all.
#include "render/volume/sources/cells/tet_walk.h"

#include <set>

#include "data/cells/shape/cell_inverse.h"
#include "support/property.h"
#include "support/test.h"
#include "volume_cells_support.h"

using namespace sg;
using namespace sg::test;

namespace {

/// Few points and many tetrahedra: faces of three and more of them, neighbours across two faces, some twice.
DatasetPtr random_tetrahedra(Random& random) {
  const int points = random.whole(4, 9), tets = random.whole(1, 40);
  std::vector<double> xyz;
  for (int k = 0; k < 3 * points; ++k) xyz.push_back(random.unit());
  std::vector<int64_t> ids;
  while (int(ids.size()) < 4 * tets) {
    int64_t t[4];
    for (int64_t& id : t) id = random.whole(0, points - 1);
    if (std::set<int64_t>(t, t + 4).size() == 4) ids.insert(ids.end(), t, t + 4);
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
  mesh.cells = {Array::from_vector(std::move(ids)), {}, 4};
  mesh.single_type = CellType::tetra;
  DatasetParts parts;
  parts.mesh = std::move(mesh);
  return with_field(std::move(parts), [](Vec3 p) { return p.x; });
}

}  // namespace

TEST_CASE("property: a line walks at most once through each of any tetrahedra, and through all whose open faces it crosses") {
  size_t walked = 0;
  const std::vector<uint64_t> seeds = property_seeds(300);
  for (const uint64_t seed : seeds) {
    CAPTURE(seed);
    Random random(seed);
    Context context;
    const volume::CellVolume v = volume::make_cell_volume(item_of(random_tetrahedra(random)), context);
    const volume::TetMesh& mesh = *v.mesh;
    for (int ray = 0; ray < 20; ++ray) {
      const Vec3 through(random.unit(), random.unit(), random.unit());
      const Vec3 d = ray < 3 ? Vec3(ray == 0, ray == 1, ray == 2) : normalize(Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)));
      volume::TetWalk walk(v);
      walk.start(through - d * 3.0, d, HUGE_VAL);
      std::vector<int> times(mesh.size(), 0);
      volume::TetWalk::Piece piece;
      size_t pieces = 0;
      for (; pieces <= mesh.size() && walk.next(piece); ++pieces) ++times[piece.tet];
      CHECK(pieces <= mesh.size());
      CHECK(std::count_if(times.begin(), times.end(), [](int n) { return n > 1; }) == 0);
      for (const volume::TetMesh::Face& f : mesh.boundary) {
        const Vec3 at = mesh.origin + mesh.at[f.v[0]], u = mesh.at[f.v[1]] - mesh.at[f.v[0]], w = mesh.at[f.v[2]] - mesh.at[f.v[0]];
        const Vec3 columns[3] = {u, w, d};
        Vec3 l;
        if (!solve_columns(columns, through - at, l) || std::min({l.x, l.y, 1 - l.x - l.y}) < 1e-9) continue;
        CHECK(times[f.tet] == 1);
        ++walked;
      }
    }
  }
  // A single mesh that a finding is repeated with need not be met.
  CHECK((walked > 0 || seeds.size() < 10));
}
