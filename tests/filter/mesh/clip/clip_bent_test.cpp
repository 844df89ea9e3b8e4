// SPDX-License-Identifier: Apache-2.0
// Clipped cells with bent faces: both parts make up the cell, whatever cuts it, and their faces have partners.
#include "data/cells/shape/cell_map.h"
#include "filter/every_mesh.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using test::Random;

namespace {

constexpr int corner_place[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

// -1 where the faces of a polyhedron look inwards: a piece whose cut points were moved through it is inside out.
double facing(const UnstructuredMesh& m, size_t cell) {
  if (m.type(cell) != CellType::polyhedron) return 1;
  const CellsView faces = cells_view(m.faces);
  const auto begin = size_t(m.polyhedron_faces.get(cell)), end = size_t(m.polyhedron_faces.get(cell + 1));
  const Vec3 first = m.points.at(size_t(faces.point(begin, 0)));
  double flux = 0;
  for (size_t f = begin; f < end; ++f) {
    const auto at = [&](size_t k) { return m.points.at(size_t(faces.point(f, k))) - first; };
    for (size_t k = 1; k + 1 < faces.size(f); ++k) flux += dot(at(0), cross(at(k), at(k + 1)));
  }
  return flux < 0 ? -1 : 1;
}

double volume(const DatasetPtr& d) {
  CellMap map(d);
  const auto* m = d->as<UnstructuredMesh>();
  double sum = 0;
  for (size_t c = 0; c < d->cell_count(); ++c) {
    map.open(c);
    if (map.dimension() == 3) sum += map.measure() * (m ? facing(*m, c) : 1);
  }
  return sum;
}

DatasetPtr part(const Data& both, size_t i) { return std::get<DatasetPtr>(std::get<CollectionPtr>(both)->parts[i].data); }

// n^3 boxes of moved corners as cells of one kind, with random values at the points.
DatasetPtr bent_mesh(const std::string& kind, int n, double bend, Random& random) {
  const int m = n + 1;
  std::vector<double> xyz, values;
  for (int k = 0; k < m; ++k)
    for (int j = 0; j < m; ++j)
      for (int i = 0; i < m; ++i)
        for (const int a : {i, j, k}) xyz.push_back(a + bend * random.in(-1, 1));
  const size_t points = xyz.size() / 3;
  FieldSet fields;
  const auto finish = [&](auto mesh, size_t count) {
    for (size_t i = 0; i < count; ++i) values.push_back(random.in(-1, 1));
    mesh.points.xyz = Array::from_vector(std::move(xyz), 3);
    fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
    return make_dataset(Mesh(std::move(mesh)), std::move(fields));
  };
  if (kind == "curvilinear") {
    CurvilinearGrid g;
    g.dims = {size_t(m), size_t(m), size_t(m)};
    return finish(g, points);
  }
  UnstructuredMesh u;
  std::vector<int64_t> ids, offsets{0}, face_ids, face_offsets{0}, cell_faces{0};
  const auto add = [&](std::vector<int64_t> c) {
    ids.insert(ids.end(), c.begin(), c.end());
    offsets.push_back(int64_t(ids.size()));
  };
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        std::array<int64_t, 8> c;
        for (size_t q = 0; q < 8; ++q) c[q] = i + corner_place[q][0] + m * (j + corner_place[q][1] + m * (k + corner_place[q][2]));
        if (kind == "hexahedron") add({c.begin(), c.end()});
        if (kind == "wedge") add({c[0], c[1], c[2], c[4], c[5], c[6]}), add({c[0], c[2], c[3], c[4], c[6], c[7]});
        if (kind == "pyramid") {
          const auto middle = int64_t(xyz.size() / 3);
          xyz.insert(xyz.end(), {i + 0.5 + 0.1 * random.in(-1, 1), j + 0.5, k + 0.5});
          for (const auto& f : {std::array{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}})
            add({c[size_t(f[0])], c[size_t(f[1])], c[size_t(f[2])], c[size_t(f[3])], middle});
        }
        if (kind == "polyhedron") {
          add({c.begin(), c.end()});
          for (const auto& f : {std::array{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}) {
            for (const int q : f) face_ids.push_back(c[size_t(q)]);
            face_offsets.push_back(int64_t(face_ids.size()));
          }
          cell_faces.push_back(int64_t(face_offsets.size()) - 1);
        }
      }
  u.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  u.single_type = kind == "hexahedron" ? CellType::hexahedron
                  : kind == "wedge"    ? CellType::wedge
                  : kind == "pyramid"  ? CellType::pyramid
                                       : CellType::polyhedron;
  if (kind == "polyhedron") {
    u.faces = {Array::from_vector(std::move(face_ids)), Array::from_vector(std::move(face_offsets)), 0};
    u.polyhedron_faces = Array::from_vector(std::move(cell_faces));
  }
  return finish(u, xyz.size() / 3);
}

// A random shape or the values of the points.
ClipParams random_cut(Random& random, int n) {
  ClipParams p;
  p.keep = ClipSide::both;
  const auto place = [&] { return Vec3(random.in(0, n), random.in(0, n), random.in(0, n)); };
  const Vec3 o = place(), d(random.in(-1, 1), random.in(-1, 1), random.in(0.1, 1));
  switch (random.whole(0, 3)) {
    case 0: p.origin = o, p.normal = d; break;
    case 1: p.sphere = {o.x, o.y, o.z, random.in(0.3, 1) * n}; break;
    case 2: p.cylinder = {o.x, o.y, o.z, d.x, d.y, d.z, random.in(0.2, 0.7) * n}; break;
    default: p.field.name = "f", p.value = random.in(-0.8, 0.8);
  }
  return p;
}

}  // namespace

TEST_CASE("clip: a pyramid with a bent base keeps its volume") {
  UnstructuredMesh m;
  m.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0.3, 1, 1, 0, 0, 1, 0.2, 0.5, 0.5, 1.2}, 3);
  m.cells = {Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 4}), {}, 5};
  m.single_type = CellType::pyramid;
  const DatasetPtr pyramid = make_dataset(Mesh(m));
  const double whole = volume(pyramid);
  Context ctx;
  for (const Vec3 normal : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(1, 2, 0.5)})
    for (const double at : {0.21, 0.35, 0.5, 0.66}) {
      ClipParams p;
      p.origin = normal * (at / dot(normal, normal) * (normal.x + normal.y + normal.z)), p.normal = normal, p.keep = ClipSide::both;
      const Data both = clip(pyramid, p, ctx);
      CHECK(std::fabs(volume(part(both, 0)) + volume(part(both, 1)) - whole) < 1e-12 * whole);
    }
}

TEST_CASE("property: clip parts add up, for cells of all kinds with bent faces") {
  Context ctx;
  for (const uint64_t seed : test::property_seeds(150)) {
    CAPTURE(seed);
    Random random(seed);
    const std::string kind = random.one_of<const char*>({"hexahedron", "wedge", "pyramid", "polyhedron", "curvilinear"});
    CAPTURE(kind);
    const int n = random.whole(1, 3);
    const DatasetPtr mesh = bent_mesh(kind, n, random.chance(0.2) ? 0 : random.magnitude(1e-6, 0.12), random);
    const double whole = volume(mesh);
    const ClipParams p = random_cut(random, n);
    const Data both = clip(mesh, p, ctx);
    CHECK(std::fabs(volume(part(both, 0)) + volume(part(both, 1)) - whole) < 1e-12 * whole);
    // The skin of each part is closed, and no face between two cells is left over. Where cut points were moved onto a curved shape that
    // is small beside the cells, pieces may be inside out, and count as negative above; the skin is not looked at then.
    if (!p.sphere.empty() || !p.cylinder.empty()) continue;
    for (size_t side = 0; side < 2; ++side) {
      const DatasetPtr skin = faces(part(both, side), {}, ctx);
      const auto& s = *skin->as<SurfaceMesh>();
      const CellsView polygons = cells_view(s.polygons);
      Vec3 sum;
      double area = 0;
      for (size_t c = 0; c < polygons.count; ++c) {
        const Vec3 o = s.points.at(size_t(polygons.point(c, 0)));
        for (size_t k = 1; k + 1 < polygons.size(c); ++k) {
          const Vec3 v = cross(s.points.at(size_t(polygons.point(c, k))) - o, s.points.at(size_t(polygons.point(c, k + 1))) - o) * 0.5;
          sum += v, area += length(v);
        }
      }
      CHECK(length(sum) < 1e-6 * (1 + area));
      CHECK(area < 6.0 * n * n * 3 + 100);
    }
  }
}

TEST_CASE("clip: parts of curved cells come as near to the whole as the tolerance says, and converge") {
  // A box [-1,1]^3 of triquadratic hexahedra, bent; the cells' own volume is exact by quadrature.
  const auto bent = [](Vec3 p) { return Vec3(p.x * (1 - 0.3 * p.y * p.y), p.y * (1 - 0.2 * p.z * p.z), p.z); };
  const DatasetPtr curved = test::flow::moved(test::solid_cells(CellType::triquadratic_hexahedron, 27, 2, 1), bent);
  const double whole = volume(curved);
  Context ctx;
  double last = 1;
  for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
    CAPTURE(tolerance);
    ClipParams p;
    p.normal = {1, 0.3, 0.2}, p.keep = ClipSide::both, p.tolerance = tolerance;
    const Data both = clip(curved, p, ctx);
    const double error = std::fabs(volume(part(both, 0)) + volume(part(both, 1)) - whole) / whole;
    CHECK(error < 4 * tolerance);
    CHECK(error <= last);
    last = error;
  }
  CHECK(last < 1e-4);
}
