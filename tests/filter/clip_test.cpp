// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip.h"

#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "filter/cell_meshes.h"
#include "filter/mesh/faces.h"
#include "filter/mesh/transform.h"
#include "filter/mesh_meshes.h"
#include "filter/stats/integrate.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

double measure(const DatasetPtr& d) {
  if (d->cell_count() == 0) return 0;
  Context ctx;
  DatasetParts p;
  p.mesh = d->mesh();
  p.fields.add(meshes::make_field("one", Association::cell, std::vector<double>(d->cell_count(), 1.0)));
  const TablePtr t = integrate(make_dataset(std::move(p)), {}, ctx);
  for (const Field& f : t->columns)
    if (f.name == "integral") return f.array.get(0);
  FAIL("no integral");
  return 0;
}

std::pair<DatasetPtr, DatasetPtr> halves(const DatasetPtr& d, ClipParams p) {
  Context ctx;
  p.keep = "both";
  const auto c = std::get<CollectionPtr>(clip(d, p, ctx));
  REQUIRE(c->parts.size() == 2);
  return {std::get<DatasetPtr>(c->parts[0].data), std::get<DatasetPtr>(c->parts[1].data)};
}

double noise(Vec3 p) { return std::sin(17 * p.x + 3) * std::cos(23 * p.y) + std::sin(29 * p.z * p.x + 11 * p.y); }

const char* const kinds[] = {"tetra", "hexahedron", "voxel", "wedge", "pyramid", "polyhedron", "mixed"};

}  // namespace

TEST_CASE("clip: inside and outside add up to the whole for every kind of cell") {
  for (const std::string kind : kinds)
    for (const auto& f : {+[](Vec3 p) { return p.x + 0.7 * p.y - 0.3 * p.z - 0.05; }, +[](Vec3 p) { return p.x + p.y; },
                          +[](Vec3 p) { return 0.7 - dot(p, p); }, +[](Vec3 p) { return noise(p); }, +[](Vec3 p) { return p.z; }}) {
      CAPTURE(kind);
      const DatasetPtr mesh = solid_mesh(kind, 4, 1.0, f);
      ClipParams p;
      p.value = 0.0;
      const auto [in, out] = halves(mesh, p);
      CHECK(measure(mesh) == doctest::Approx(8).epsilon(1e-13));
      CHECK(std::abs(measure(in) + measure(out) - 8) < 8e-12);
      CHECK(measure(in) > 0.1);
      CHECK(measure(out) > 0.1);
    }
}
