// SPDX-License-Identifier: Apache-2.0
// Writing of parallel VTK XML files: pieces of grids by their extents, of other meshes one after the other.
#include <algorithm>

#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/vtk/vtk_samples.h"

using namespace sg;
using namespace sg::test;

namespace {

DatasetPtr grid_with_fields(Mesh mesh) {
  DatasetParts p;
  p.mesh = std::move(mesh);
  const size_t points = point_count(p.mesh), cells = cell_count(p.mesh);
  p.fields.add({"T", Association::point, ramp<float>(points, 1, 0.5), {}, Role::scalars});
  p.fields.add({"v", Association::point, ramp<double>(points, 3), {}, Role::vectors});
  p.fields.add({"id", Association::cell, ramp<int32_t>(cells), {}, Role::none});
  p.fields.add({"year", Association::whole, numbers<int32_t>({2024}), {}, Role::none});
  return make_dataset(std::move(p));
}

// The grid in runs of cells along x, each with `ghosts` layers of its neighbours.
CollectionPtr runs_along_x(const DatasetPtr& d, std::initializer_list<size_t> ends, size_t ghosts) {
  auto c = std::make_shared<Collection>();
  const auto dims = lattice_dims(d->mesh());
  size_t begin = 0;
  for (const size_t end : ends) {
    const size_t lo = begin - std::min(begin, ghosts), hi = std::min(dims[0] - 1, end + ghosts);
    DatasetPtr part = crop_lattice(*d, {lo, 0, 0}, {hi, SIZE_MAX, SIZE_MAX});
    if (ghosts > 0) {
      DatasetParts p = part->parts();
      std::vector<uint8_t> bits(part->cell_count());
      for (size_t i = 0; i < bits.size(); ++i) {
        const size_t x = lo + i % (hi - lo);
        bits[i] = x < begin || x >= end ? ghost_duplicate : 0;
      }
      p.cell_ghost = Array::from_vector(std::move(bits));
      part = make_dataset(std::move(p));
    }
    c->parts.push_back({std::to_string(c->parts.size()), part});
    begin = end;
  }
  return c;
}

UniformGrid turned_grid() {
  UniformGrid g;
  g.dims = {6, 4, 3}, g.origin = {1.1, 2.3, 3.7}, g.spacing = {0.1, 0.25, 0.7};
  g.extent_start = {4, -2, 7};
  const double c = std::cos(0.3), s = std::sin(0.3);
  g.direction.m[0][0] = c, g.direction.m[0][1] = -s, g.direction.m[1][0] = s, g.direction.m[1][1] = c;
  return g;
}

std::string text_of(const std::string& path) { return std::string(MappedFile(path).text()); }

void write_parallel(const std::string& name, const Data& data, const WriteOptions& options = {}) {
  Context context;
  write_data(temp(name), data, options, context);
}

}  // namespace

TEST_CASE("vtk parallel writing: a grid in pieces, with ghosts or without, is read as the grid") {
  RectilinearGrid r;
  r.x = numbers<double>({0, 1, 3, 4, 9, 11}), r.y = numbers<double>({0, 1, 2, 5}), r.z = numbers<double>({5, 6, 8});
  r.extent_start = {2, 0, -1};
  CurvilinearGrid c;
  c.dims = {6, 4, 3}, c.points.xyz = ramp<float>(72, 3, 0.1);
  const std::pair<Mesh, const char*> kinds[] = {{turned_grid(), "pvti"}, {r, "pvtr"}, {c, "pvts"}};
  for (const auto& [mesh, extension] : kinds)
    for (const size_t ghosts : {0, 1, 2}) {
      CAPTURE(extension);
      CAPTURE(ghosts);
      const DatasetPtr d = grid_with_fields(mesh);
      const std::string name = std::string("runs.") + extension;
      write_parallel(name, Data(runs_along_x(d, {2, 3, 5}, ghosts)));
      const DatasetPtr back = read(temp(name));
      check_same_mesh(d->mesh(), back->mesh());
      CHECK(back->fields().size() == d->fields().size());
      for (const Field& f : d->fields()) {
        REQUIRE(back->fields().find(f.name, f.association));
        CHECK(same(f.array, back->fields().find(f.name, f.association)->array));
        CHECK(back->fields().find(f.name, f.association)->role == f.role);
      }
      for (size_t i = 0; i < back->cell_ghost().count(); ++i) CHECK(back->cell_ghost().get(i) == 0);
      const std::string text = text_of(temp(name));
      CHECK(text.find("GhostLevel=\"" + std::to_string(ghosts) + "\"") != std::string::npos);
      CHECK(text.find("<Piece Extent=") != std::string::npos);
      CHECK(file_exists(temp(std::string("runs/runs_2.") + (extension + 1))));
    }
}

TEST_CASE("vtk parallel writing: a lone mesh of each kind is the only piece, and comes back as it was") {
  CurvilinearGrid c;
  c.dims = {3, 2, 2}, c.points.xyz = ramp<double>(12, 3, 0.1);
  const std::pair<Mesh, const char*> kinds[] = {
      {turned_grid(), "pvti"}, {c, "pvts"}, {mixed_mesh(), "pvtu"}, {surface_mesh(), "pvtp"}, {tetra_mesh(5), "pvtu"}};
  for (const auto& [mesh, extension] : kinds) {
    CAPTURE(extension);
    DatasetParts p;
    p.mesh = mesh;
    add_fields(p);
    const DatasetPtr d = make_dataset(std::move(p));
    write_parallel(std::string("lone.") + extension, d, {VtkEncoding::appended, Compression::zlib});
    check_same(*d, *read(temp(std::string("lone.") + extension)));
  }
}

TEST_CASE("vtk parallel writing: weights and orders of high-order cells are named in the index") {
  UnstructuredMesh m;
  m.points.xyz = numbers<double>({0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0, 0, 0.5, 0.5, 0, 0, 0.5, 0}, 3);
  m.cells.connectivity = numbers<int32_t>({0, 1, 2, 3, 4, 5}), m.cells.fixed = 6;
  m.single_type = CellType::bezier_triangle;
  m.weights = numbers<double>({1, 1, 1, 0.7, 0.7, 0.7}), m.degrees = numbers<uint8_t>({2, 2, 2}, 3);
  write_parallel("rational.pvtu", make_dataset(m));
  const std::string text = text_of(temp("rational.pvtu"));
  CHECK(text.find("RationalWeights=\"RationalWeights\"") != std::string::npos);
  CHECK(text.find("Name=\"HigherOrderDegrees\"") != std::string::npos);
  const auto back = read(temp("rational.pvtu"));
  CHECK(same(back->as<UnstructuredMesh>()->weights, m.weights));
  CHECK(same(back->as<UnstructuredMesh>()->degrees, m.degrees));
}

TEST_CASE("vtk parallel writing: parts that are no boxes of one grid are refused, and nothing is left") {
  const DatasetPtr d = grid_with_fields(turned_grid());
  auto error = [&](const Collection& c, const char* name = "refused.pvti") {
    return error_of([&] { write_parallel(name, CollectionPtr(std::make_shared<Collection>(c))); });
  };
  Collection c = *runs_along_x(d, {2, 3, 5}, 0);
  Collection twice = c;
  twice.parts.push_back(c.parts[1]);
  CHECK(error(twice).find("share cells") != std::string::npos);
  Collection gap = c;
  gap.parts.erase(gap.parts.begin() + 1);
  CHECK(error(gap).find("48 cells") == std::string::npos);
  CHECK(error(gap).find("24 of the 30 cells") != std::string::npos);
  Collection moved = c;
  DatasetParts p = std::get<DatasetPtr>(c.parts[2].data)->parts();
  std::get<UniformGrid>(p.mesh).origin.x += 0.05;
  moved.parts[2].data = make_dataset(p);
  CHECK(error(moved).find("part '2' lies on a different grid") != std::string::npos);
  std::get<UniformGrid>(p.mesh).extent_start[0] = 1ll << 50;
  moved.parts[2].data = make_dataset(p);
  CHECK(error(moved).find("too far apart") != std::string::npos);
  RectilinearGrid r;
  r.x = numbers<double>({0, 1, 2, 3}), r.y = numbers<double>({0, 1}), r.z = numbers<double>({0, 1});
  c = *runs_along_x(grid_with_fields(r), {1, 3}, 0);
  p = std::get<DatasetPtr>(c.parts[1].data)->parts();
  std::get<RectilinearGrid>(p.mesh).x = numbers<double>({1.5, 2, 3});
  c.parts[1].data = make_dataset(p);
  CHECK(error(c, "refused.pvtr").find("x = 1.5") != std::string::npos);
  CHECK(error(c, "refused.pvts").find("cannot be a piece of a .pvts") != std::string::npos);
  CHECK(error({}, "refused.pvtu").find("no mesh") != std::string::npos);
  CHECK(!file_exists(temp("refused")));
  CHECK(!file_exists(temp("refused.pvti")));
}

TEST_CASE("vtk parallel writing: formats of one mesh refuse pieces") {
  WriteOptions o;
  o.pieces = 2;
  CHECK(error_of([&] { write_parallel("lone.vti", grid_with_fields(turned_grid()), o); }).find("cannot hold pieces") != std::string::npos);
}
