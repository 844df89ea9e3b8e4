// SPDX-License-Identifier: Apache-2.0
// Clips by shapes that bend as much as cells are large: pieces are not inside out, and both sides make up the whole.
#include "data/cells/cell_reader.h"
#include "filter/every_mesh.h"
#include "filter/mesh/clip/clip.h"
#include "support/property.h"

using namespace sg;
using namespace sg::test;

namespace {

// The volume with a sign, by the faces of a cell, each over its middle.
double signed_volume(CellReader& r) {
  const auto at = r.at();
  double six = 0;
  for (size_t f = 0; f < r.face_count(); ++f) {
    const auto face = r.face(f);
    Vec3 m;
    for (const uint32_t k : face) m += at[k] - at[0];
    m = m / double(face.size());
    for (size_t k = 0; k < face.size(); ++k) six += dot(m, cross(at[face[k]] - at[0], at[face[(k + 1) % face.size()]] - at[0]));
  }
  return six / 6;
}

std::vector<double> volumes_of(const DatasetPtr& d) {
  std::vector<double> v;
  CellReader r(d);
  for (size_t c = 0; c < r.count(); ++c) r.open(c), v.push_back(signed_volume(r));
  return v;
}

}  // namespace

TEST_CASE("property: clips by small curved shapes leave no piece inside out, and both sides make up the whole") {
  for (const uint64_t seed : property_seeds(80)) {
    CAPTURE(seed);
    Random random(seed);
    const std::string kind = solid_kinds()[size_t(random.whole(0, int(solid_kinds().size()) - 1))];
    const bool grid = random.chance(0.3);
    CAPTURE(kind);
    CAPTURE(grid);
    const int n = random.whole(1, 4);
    const DatasetPtr d = grid ? make_dataset(flow::uniform_cube(size_t(n) + 2, 1)) : solid_mesh(kind, n, 1, [](Vec3) { return 0.0; });
    ClipParams p;
    const Vec3 center(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    const double radius = random.in(0.2, 3) / n;
    const int shape = random.whole(0, 2);
    if (shape == 0) p.sphere = {center.x, center.y, center.z, radius};
    else if (shape == 1)
      p.quadric = {random.in(0, 4), 1, random.in(-1, 4), random.in(-1, 1), 0, 0, center.x, center.y, 0, -radius * radius};
    else p.cylinder = {center.x, center.y, center.z, random.in(-1, 1), random.in(-1, 1), random.in(-1, 1), radius};
    p.keep = ClipSide::both;
    DatasetPtr whole = d;
    if (random.chance(0.2)) {  // the same by values at the points alone
      p.sphere.clear(), p.cylinder.clear(), p.quadric.clear();
      whole = with_values(d, "f", 1, [&](Vec3 x, double* v) { *v = radius - length(x - center); });
      p.field.name = "f", p.value = 0.0;
    }
    Context context;
    const auto both = std::get<CollectionPtr>(clip(whole, p, context));
    const std::vector<double> before = volumes_of(whole);
    std::vector<double> after(before.size(), 0.0);
    for (const auto& part : both->parts) {
      const DatasetPtr& pieces = std::get<DatasetPtr>(part.data);
      const std::vector<double> v = volumes_of(pieces);
      const Array from = pieces->fields().require("original_cell").array;
      double least = 0;
      for (size_t c = 0; c < v.size(); ++c) {
        const auto cell = size_t(from.get(c));
        least = std::min(least, before[cell] < 0 ? -v[c] : v[c]);  // some wedges are listed the other way round
        after[cell] += v[c];
      }
      CHECK(least > -1e-12);
    }
    double off = 0;
    for (size_t c = 0; c < before.size(); ++c) off = std::max(off, std::abs(after[c] - before[c]));
    CHECK(off < 1e-12);
  }
}
