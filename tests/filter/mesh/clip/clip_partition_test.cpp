// SPDX-License-Identifier: Apache-2.0
// Inside and outside make up the whole, where values are stepped: many corners have the very value that is clipped by.
#include <fmt/core.h>

#include <cmath>

#include "base/random.h"
#include "data/cells/shape/cell_map.h"
#include "filter/cell_meshes.h"
#include "filter/mesh/clip/clip.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/merge_points.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/to_unstructured.h"
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
  double inside = 0;         // the volume there
};
Misses misses(const DatasetPtr& d, ClipParams p) {
  Context ctx;
  p.keep = ClipSide::both;
  const auto both = std::get<CollectionPtr>(clip(d, p, ctx));
  const size_t n = d->cell_count();
  const std::vector<double> whole = volumes(d, n, false), in = volumes(std::get<DatasetPtr>(both->parts[0].data), n, true),
                            out = volumes(std::get<DatasetPtr>(both->parts[1].data), n, true);
  Misses r;
  double sum = 0, total = 0;
  for (size_t c = 0; c < n; ++c) {
    const double miss = in[c] + out[c] - whole[c];
    r.cell = std::max(r.cell, std::abs(miss) / whole[c]);
    sum += miss, total += whole[c], r.inside += in[c];
  }
  r.sum = std::abs(sum) / total;
  for (const auto& part : both->parts) CHECK_NOTHROW(validate(std::get<DatasetPtr>(part.data)->mesh()));
  return r;
}
Misses misses(const DatasetPtr& d, double value) {
  ClipParams p;
  p.value = value;
  return misses(d, p);
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
  std::vector<double> axis = even_axis(n);
  for (size_t i = 0; i <= n && kind == 1; ++i) axis[i] += 0.02 * double(i * i);
  std::vector<T> v;
  for (size_t i = 0; i < (n + 1) * (n + 1) * (n + 1); ++i) v.push_back(T(step_at(seed, i, levels)));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v), {}, Role::scalars});
  return make_dataset(lattice_mesh(kind, axis, [&](Vec3 p) { return moved(p, shape); }), std::move(fields));
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
  return dataset_of(std::move(m), std::move(values));
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

namespace {

// Meshes of [-1,1]^3 with corners at the quarters: cells of every kind and lattices.
std::vector<std::pair<std::string, DatasetPtr>> cubes() {
  std::vector<std::pair<std::string, DatasetPtr>> r;
  for (const std::string& kind : solid_kinds()) r.emplace_back(kind, solid_mesh(kind, 4, 1.0, [](Vec3 p) { return p.x; }));
  for (int kind = 0; kind < 3; ++kind) r.emplace_back(fmt::format("lattice {}", kind), make_dataset(lattice_mesh(kind, even_axis(4))));
  CellsOf m;  // hexagonal columns of two prisms each; together with the hexahedra around them they would fill a cube
  for (int k = 0; k < 3; ++k)
    for (int i = 0; i < 6; ++i) m.point({std::cos(i * M_PI / 3), std::sin(i * M_PI / 3), -1.0 + k});
  m.cell(CellType::hexagonal_prism, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  m.cell(CellType::hexagonal_prism, {6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17});
  r.emplace_back("prisms", dataset_of(std::move(m), std::vector<double>(18, 0.0)));
  return r;
}

double overlap(double lo, double hi) { return std::max(0.0, std::min(hi, 1.0) - std::max(lo, -1.0)); }

}  // namespace

TEST_CASE("clip: a box has its very volume and its rest the other, with faces on those of cells, between them, thin, or far away") {
  const std::vector<std::vector<double>> boxes{{-0.5, 0.5, -0.5, 0.5, -0.5, 0.5},
                                               {-0.5, 0.5, -0.25, 0.75, 0, 0.5},
                                               {-1, 1, -1, 1, -1, 1},
                                               {-2, 2, -2, 2, -2, 2},
                                               {-0.5, 0.25, -3, 3, -3, 3},
                                               {0.1, 0.2, 0.1, 0.2, 0.1, 0.15},
                                               {-0.7, 0.8, 0, 0.5, -1, -0.5},
                                               {-0.3, 0.3, -0.3, 0.3, -1, 0},
                                               {-0.123, 0.1, -0.4, 0.97, -0.5, 0.501},
                                               {2, 3, -1, 1, -1, 1},
                                               {-1, -0.5, -1, -0.5, -1, -0.5}};
  for (const auto& [name, mesh] : cubes())
    for (const auto& box : boxes) {
      CAPTURE(name);
      CAPTURE(box[1]);
      CAPTURE(box[3]);
      ClipParams p;
      p.box = box;
      const Misses m = misses(mesh, p);
      CHECK(m.cell < 1e-12);
      CHECK(m.sum < 1e-12);
      if (name != "prisms") CHECK(std::abs(m.inside - overlap(box[0], box[1]) * overlap(box[2], box[3]) * overlap(box[4], box[5])) < 1e-12);
    }
}

TEST_CASE("clip: spheres, cylinders and quadrics through corners and along faces of cells leave parts that make up the whole") {
  std::vector<ClipParams> shapes(12);
  shapes[0].sphere = {0, 0, 0, 0.5};
  shapes[1].sphere = {0, 0, 0, 1};
  shapes[2].sphere = {0, 0, 0, std::sqrt(0.75)};
  shapes[3].sphere = {0.25, 0.25, 0.25, std::sqrt(3.0) / 4};
  shapes[4].cylinder = {0, 0, 0, 0, 0, 1, 0.5};
  shapes[5].cylinder = {0, 0, 0, 0, 0, 1, std::sqrt(0.5)};
  shapes[6].cylinder = {0.5, 0.5, 0, 1, 0, 0, 0.5};
  shapes[7].quadric = {1, 0, 0, 0, 0, 0, 0, 0, 0, -0.25};  // |x| < 1/2
  shapes[8].quadric = {0, 0, 0, 1, 0, 0, 0, 0, 0, 0};      // x y < 0
  shapes[9].quadric = {1, 1, -1, 0, 0, 0, 0, 0, 0, 0};     // a cone whose tip is a corner
  shapes[10].quadric = {1, 0, 0, 0, 0, 0, 0, 0, 0, 0};     // x^2 <= 0: nothing but a plane
  shapes[11].quadric = {0, 0, 0, 0, 0, 0, 1, 0, 0, 1};     // x < -1: the border
  for (const auto& [name, mesh] : cubes())
    for (size_t i = 0; i < shapes.size(); ++i) {
      CAPTURE(name);
      CAPTURE(i);
      const Misses m = misses(mesh, shapes[i]);
      CHECK(m.cell < 1e-12);
      CHECK(m.sum < 1e-12);
      if (name == "prisms") continue;
      if (i == 7 || i == 8) CHECK(std::abs(m.inside - 4) < 1e-12);
      if (i >= 10) CHECK(m.inside == 0);
    }
}

TEST_CASE("clip: a box cuts surfaces that lie in its faces, curved cells, AMR and clouds") {
  Context ctx;
  ClipParams p;
  p.box = {0.1, 0.55, 0, 0.5, 0, 1};
  auto inside = [&](const DatasetPtr& d) {
    const auto part = std::get<DatasetPtr>(clip(d, p, ctx));
    const std::vector<double> v = volumes(part, part->cell_count(), false);
    return std::accumulate(v.begin(), v.end(), 0.0);
  };
  const DatasetPtr flat = meshes::uniform_box(4, 4, 0);  // the unit square at z = 0
  CHECK(std::abs(inside(flat) - 0.225) < 1e-13);
  CHECK(std::abs(inside(faces(flat, {}, ctx)) - 0.225) < 1e-13);
  CHECK(faces(flat, {}, ctx)->as<SurfaceMesh>());
  CHECK(std::get<DatasetPtr>(clip(faces(flat, {}, ctx), p, ctx))->as<SurfaceMesh>());
  CHECK(std::abs(inside(meshes::solid_box(CellType::lagrange_hexahedron, 2, 2)) - 0.225) < 1e-12);
  CHECK(misses(meshes::solid_box(CellType::hexahedron, 3), p).sum < 1e-12);
  PointCloud cloud{{Array::from_vector(std::vector<double>{0.1, 0, 0, 0.1, 0.5, 1, 0.3, 0.2, 0.5, 0.3, 0.6, 0.5, 0.09, 0.2, 0.2}, 3), {}}};
  CHECK(std::get<DatasetPtr>(clip(make_dataset(cloud), p, ctx))->point_count() == 3);
  p.keep = ClipSide::outside;
  CHECK(std::get<DatasetPtr>(clip(make_dataset(cloud), p, ctx))->point_count() == 2);
  // Hidden cells stay out, and fields, names and points of both parts are those of the input.
  const DatasetPtr grid = to_unstructured(meshes::uniform_box(5, 5, 5), {}, ctx);
  const DatasetPtr rest = std::get<DatasetPtr>(clip(grid, p, ctx));
  CHECK(rest->fields().size() == grid->fields().size() + 1);
  CHECK(rest->fields().find("original_cell", Association::cell));
  const DatasetPtr merged = merge_points(rest, {}, ctx);
  CHECK(merged->point_count() == rest->point_count());  // the parts behind the planes share theirs
  CHECK(meshes::linear_error(*rest, rest->as<UnstructuredMesh>()->points) < 1e-12);
}
