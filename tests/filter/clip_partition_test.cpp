// SPDX-License-Identifier: Apache-2.0
// Inside and outside make up the whole, where values are stepped: many corners have the very value that is clipped by.
#include <cmath>

#include "base/random.h"
#include "data/cell_map.h"
#include "filter/cell_meshes.h"
#include "filter/mesh/clip.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

// Volumes of the pieces of each input cell, in double from the output's coordinates, as integrate() takes them: without a sign.
std::vector<double> volumes(const DatasetPtr& d, size_t cells, bool original) {
  std::vector<double> r(cells, 0.0), weights;
  CellMap map(d);
  const Array from = original ? d->fields().require("original_cell").array : Array();
  for (size_t c = 0; c < d->cell_count(); ++c) {
    map.open(c);
    weights.resize(map.reader().ids().size());
    map.integration_weights(weights);
    double v = 0;
    for (const double w : weights) v += w;
    r[original ? size_t(from.get(c)) : c] += v;
  }
  return r;
}

struct Misses {
  double cell = 0, sum = 0;  // of the worst cell, in parts of it, and of all, in parts of the whole
};
Misses misses(const DatasetPtr& d, double value) {
  Context ctx;
  ClipParams p;
  p.value = value;
  p.keep = "both";
  const auto both = std::get<CollectionPtr>(clip(d, p, ctx));
  const size_t n = d->cell_count();
  const std::vector<double> whole = volumes(d, n, false), in = volumes(std::get<DatasetPtr>(both->parts[0].data), n, true),
                            out = volumes(std::get<DatasetPtr>(both->parts[1].data), n, true);
  Misses r;
  double sum = 0, total = 0;
  for (size_t c = 0; c < n; ++c) {
    const double miss = in[c] + out[c] - whole[c];
    r.cell = std::max(r.cell, std::abs(miss) / whole[c]);
    sum += miss, total += whole[c];
  }
  r.sum = std::abs(sum) / total;
  return r;
}

// Whole numbers from 0 to levels - 1; without levels any number from 0 to 1.
double step_at(uint64_t seed, uint64_t i, int levels) {
  return levels == 0 ? random_unit(seed, i) : double(random_bits(seed, i) % uint64_t(levels));
}

enum class Shape { straight, sheared, tapered };  // all of them keep faces flat
Vec3 moved(Vec3 p, Shape s) {
  if (s == Shape::sheared) return {p.x + 0.3 * p.y - 0.2 * p.z, 1.3 * p.y + 0.4 * p.z, 0.7 * p.z - 0.1 * p.x};
  if (s == Shape::tapered) return p / (1 + 0.12 * p.x + 0.1 * p.z);
  return p;
}

DatasetPtr bent(const DatasetPtr& d, Shape s) {
  DatasetParts parts = d->parts();
  UnstructuredMesh m = *d->as<UnstructuredMesh>();
  std::vector<double> xyz;
  for (size_t i = 0; i < m.points.count(); ++i) {
    const Vec3 p = moved(m.points.at(i), s);
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
  }
  m.points.xyz = Array::from_vector(std::move(xyz), 3);
  parts.mesh = std::move(m);
  return make_dataset(std::move(parts));
}

template <class T>
DatasetPtr stepped_lattice(int kind, Shape shape, size_t n, uint64_t seed, int levels) {
  std::vector<double> axis, xyz;
  std::vector<T> v;
  for (size_t i = 0; i <= n; ++i) axis.push_back(-1 + 2.0 * double(i) / double(n) + (kind == 1 ? 0.02 * double(i * i) : 0));
  for (size_t k = 0; k <= n; ++k)
    for (size_t j = 0; j <= n; ++j)
      for (size_t i = 0; i <= n; ++i) {
        const Vec3 p = moved(Vec3(axis[i], axis[j], axis[k]), shape);
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
        v.push_back(T(step_at(seed, v.size(), levels)));
      }
  Mesh mesh;
  if (kind == 0) {
    UniformGrid g;
    g.dims = {n + 1, n + 1, n + 1};
    g.origin = {-1, -1, -1};
    g.spacing = Vec3(2, 2, 2) / double(n);
    mesh = g;
  } else if (kind == 1) {
    RectilinearGrid g;
    g.x = g.y = g.z = Array::from_vector(axis);
    mesh = g;
  } else {
    CurvilinearGrid g;
    g.dims = {n + 1, n + 1, n + 1};
    g.points.xyz = Array::from_vector(xyz, 3);
    mesh = g;
  }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), {}, Role::scalars});
  return make_dataset(std::move(mesh), std::move(fields));
}

// A cell of its own for each way in which corners can be below, at and above zero.
DatasetPtr all_patterns(CellType type, Shape shape, uint64_t seed) {
  CellsOf m;
  std::vector<double> values;
  static const Vec3 box[8] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  std::vector<Vec3> at(box, box + 8);
  if (type == CellType::voxel) std::swap(at[2], at[3]), std::swap(at[6], at[7]);
  if (type == CellType::tetra) at = {box[0], box[1], box[3], box[4]};
  if (type == CellType::wedge) at = {box[0], box[1], box[3], box[4], box[5], box[7]};
  if (type == CellType::pyramid) at = {box[0], box[1], box[2], box[3], Vec3(0.5, 0.5, 1)};
  size_t patterns = 1;
  for (size_t c = 0; c < at.size(); ++c) patterns *= 3;
  for (size_t p = 0; p < patterns; ++p) {
    std::vector<int> ids;
    size_t left = p;
    for (const Vec3 v : at) {
      ids.push_back(m.point(moved(v, shape)));
      const double size = seed == 0 ? 1 : 1 + step_at(seed, values.size(), 4);
      values.push_back((double(left % 3) - 1) * size);
      left /= 3;
    }
    if (type == CellType::polyhedron)
      m.polyhedron(ids, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}});
    else m.cell(type, ids);
  }
  UnstructuredMesh mesh;
  mesh.points.xyz = Array::from_vector(std::move(m.xyz), 3);
  mesh.cells.connectivity = Array::from_vector(std::move(m.ids));
  mesh.cells.offsets = Array::from_vector(std::move(m.offsets));
  mesh.types = Array::from_vector(std::move(m.types));
  if (!m.faces.empty()) {
    std::vector<int64_t> ids, offsets{0};
    for (const auto& face : m.faces) {
      ids.insert(ids.end(), face.begin(), face.end());
      offsets.push_back(int64_t(ids.size()));
    }
    mesh.faces.connectivity = Array::from_vector(std::move(ids));
    mesh.faces.offsets = Array::from_vector(std::move(offsets));
    mesh.polyhedron_faces = Array::from_vector(std::move(m.of_cell));
  }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(std::move(mesh), std::move(fields));
}

}  // namespace

TEST_CASE("clip: for every way in which corners are below, at and above the value, the two parts of a cell make up the cell") {
  for (const CellType type :
       {CellType::tetra, CellType::pyramid, CellType::wedge, CellType::voxel, CellType::hexahedron, CellType::polyhedron})
    for (const Shape shape : {Shape::straight, Shape::sheared, Shape::tapered})
      for (const uint64_t seed : {0u, 1u}) {
        if (type == CellType::voxel && shape != Shape::straight) continue;
        if (type == CellType::polyhedron && seed == 0) continue;
        CAPTURE(cell_type_info(type).name);
        CAPTURE(int(shape));
        CAPTURE(seed);
        const Misses m = misses(all_patterns(type, shape, seed), 0);
        CHECK(m.cell < 1e-12);
        CHECK(m.sum < 1e-12);
      }
}

TEST_CASE("clip: meshes of stepped and of random values fall apart into parts that make up the whole, at the steps and between them") {
  for (const std::string& kind : solid_kinds())
    for (const Shape shape : {Shape::straight, Shape::sheared, Shape::tapered})
      for (const int levels : {0, 2, 3, 5}) {
        if (kind == "voxel" && shape != Shape::straight) continue;
        uint64_t i = 0;
        const DatasetPtr d = bent(solid_mesh(kind, 4, 1.0, [&](Vec3) { return step_at(uint64_t(levels), i++, levels); }), shape);
        for (const double value : {1.0, 0.5, 2.0}) {
          if (value >= std::max(levels, 1)) continue;
          CAPTURE(kind);
          CAPTURE(int(shape));
          CAPTURE(levels);
          CAPTURE(value);
          const Misses m = misses(d, value);
          CHECK(m.cell < 1e-12);
          CHECK(m.sum < 1e-12);
        }
      }
}

TEST_CASE("clip: grids of stepped values fall apart into parts that make up the whole, whatever type the values have") {
  for (int kind = 0; kind < 3; ++kind)
    for (const Shape shape : {Shape::straight, Shape::sheared, Shape::tapered}) {
      if (kind < 2 && shape != Shape::straight) continue;
      for (const int levels : {2, 3, 5})
        for (const DatasetPtr& d : {stepped_lattice<uint8_t>(kind, shape, 6, 1, levels),
                                    stepped_lattice<int32_t>(kind, shape, 6, 2, levels), stepped_lattice<float>(kind, shape, 6, 3, levels)})
          for (const double value : {1.0, 0.5, 2.0}) {
            if (value >= levels) continue;
            CAPTURE(kind);
            CAPTURE(int(shape));
            CAPTURE(levels);
            CAPTURE(value);
            const Misses m = misses(d, value);
            CHECK(m.cell < 1e-12);
            CHECK(m.sum < 1e-12);
          }
    }
}
