// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "io/io_files.h"

using namespace sg;
using namespace sg::test;

namespace {

UniformGrid some_grid() {
  UniformGrid g;
  g.dims = {13, 9, 11};
  g.origin = {1, -2, 30};
  g.spacing = {0.5, 0.25, 2};
  g.direction.m[0][0] = 0, g.direction.m[1][0] = 1, g.direction.m[0][1] = -1, g.direction.m[1][1] = 0;
  return g;
}

// Mostly zero, so that tiles are pruned; a NaN and corners of zero.
std::vector<float> some_values(size_t components) {
  std::vector<float> v(13 * 9 * 11 * components);
  for (size_t i = v.size() / 3; i < v.size() / 2; ++i) v[i] = float(i % 97) * 0.1f - 3;
  v[v.size() / 2] = std::nanf("");
  return v;
}

std::string written(const char* name = "w.vdb") {
  DatasetParts p;
  p.mesh = some_grid();
  p.fields.add({"density", Association::point, Array::from_vector(some_values(1)), "", Role::scalars});
  p.fields.add({"wind", Association::point, Array::from_vector(some_values(3), 3), "", Role::vectors});
  p.fields.add({"exact", Association::point, Array::from_vector(some_values(1)).converted(ElementType::f64), "", Role::none});
  Context context;
  write_data(temp_folder() + name, make_dataset(p), {}, context);
  return temp_folder() + name;
}

}  // namespace

TEST_CASE("vdb: what is written reads back the same, background and all") {
  const auto r = read_file(written());
  const UniformGrid g = some_grid();
  const auto* h = r->as<UniformGrid>();
  REQUIRE(h);
  CHECK(h->dims == g.dims);
  CHECK(length(h->origin - g.origin) < 1e-12);
  CHECK(length(h->spacing - g.spacing) < 1e-12);
  const Lattice a(make_dataset(Mesh(g))->mesh()), b(r->mesh());
  CHECK(length(a.view().position(12, 5, 7) - b.view().position(12, 5, 7)) < 1e-12);
  CHECK(same_array(r->fields().require("density").array, Array::from_vector(some_values(1))));
  CHECK(same_array(r->fields().require("wind").array, Array::from_vector(some_values(3), 3)));
  CHECK(r->fields().require("wind").role == Role::vectors);
  CHECK(r->fields().require("exact").array.type() == ElementType::f64);
}

TEST_CASE("vdb: a level set is one again, and outside everywhere beyond its box") {
  UniformGrid g;
  g.dims = {12, 12, 12};
  std::vector<float> v;
  for (int k = 0; k < 12; ++k)
    for (int j = 0; j < 12; ++j)
      for (int i = 0; i < 12; ++i) v.push_back(std::clamp(std::hypot(float(i) - 5.5f, float(j) - 5.5f, float(k) - 5.5f) - 4, -1.5f, 1.5f));
  DatasetParts p;
  p.mesh = g;
  p.fields.add({"ball", Association::point, Array::from_vector(v), "", Role::scalars, {.shows = FieldLook::Shows::zero}});
  p.fields.add({"smoke", Association::point, Array::from_vector(v), "", Role::none});
  Context context;
  const std::string path = temp_folder() + "ball.vdb";
  write_data(path, make_dataset(p), {}, context);
  const auto r = read_file(path);
  CHECK(r->fields().require("ball").look.shows == FieldLook::Shows::zero);
  CHECK(r->fields().require("smoke").look.shows == FieldLook::Shows::any);
  CHECK(same_array(r->fields().require("ball").array, Array::from_vector(v)));
}

TEST_CASE("vdb: a region, a stride and single fields") {
  const std::string path = written();
  const auto whole = read_file(path);
  ReadOptions o;
  o.region.lo = {2, 1, 3};
  o.region.hi = {11, 7, 9};
  for (const size_t stride : {1, 2, 3}) {
    o.region.stride = {stride, 1, stride};
    const auto part = read_file(path, o);
    const auto want = crop_lattice(*whole, o.region.lo, o.region.hi, o.region.stride);
    CHECK(lattice_dims(part->mesh()) == lattice_dims(want->mesh()));
    CHECK(length(part->bounds().lo - want->bounds().lo) < 1e-12);
    for (const char* name : {"density", "wind", "exact"})
      CHECK(same_array(part->fields().require(name).array, want->fields().require(name).array));
  }
  o = {};
  o.fields = {"wind"};
  CHECK(read_file(path, o)->fields().size() == 1);
  o.fields = {};
  o.header_only = true;
  CHECK(read_file(path, o)->point_count() == 13 * 9 * 11);
}

TEST_CASE("vdb: a dense box beyond the memory limit is refused with its size") {
  const std::string path = written();
  Context context;
  context.memory_limit = 4000;
  CHECK(contains(error_of([&] { read_data(path, {}, context); }), "13 x 9 x 11 voxels when made dense: 5.0 KiB"));
  ReadOptions o;
  o.region.stride = {4, 4, 4};
  CHECK(std::get<DatasetPtr>(read_data(path, o, context))->point_count() == 4 * 3 * 3);
}

TEST_CASE("vdb: what cannot be written is said") {
  Context context;
  const std::string path = temp_folder() + "x.vdb";
  CHECK(contains(error_of([&] { write_data(path, make_dataset(PointCloud{}), {}, context); }), "uniform grids"));
  CHECK(contains(error_of([&] { write_data(path, make_dataset(UniformGrid{}), {}, context); }), "no point field"));
  CHECK(contains(error_of([&] { write_data(temp_folder() + "no/such/x.vdb", read_file(written()), {}, context); }), "no/such"));
}

TEST_CASE("vdb: cut and damaged files give errors, never crashes") {
  const std::string bytes(MappedFile(written()).text());
  Context context;
  for (size_t k = 1; k < 64; ++k)  // each costs a process
    CHECK(refusal("cut.vdb", bytes.substr(0, bytes.size() * k / 64)) != "");
  for (size_t k = 0; k < std::min<size_t>(bytes.size(), 1500); k += 31) {
    std::string damaged = bytes;
    damaged[k] = char(damaged[k] ^ (k % 2 ? 0x01 : 0xff));
    try {
      read_data(temp_file("flip.vdb", damaged), {}, context);
    } catch (const Error& e) {
      CHECK(e.kind() == ErrorKind::data);
    }
  }
}

TEST_CASE("vdb: smoke and points of the data folder" * doctest::skip(no_data())) {
  const auto smoke = read_file(data_file("volumes/smoke.vdb"));
  CHECK(lattice_dims(smoke->mesh()) == std::array<size_t, 3>{111, 222, 112});
  size_t active = 0;
  const auto v = smoke->fields().require("density").array.view<float>();
  for (size_t i = 0; i < v.count; ++i) active += v[i] != 0;
  CHECK(active == 1049275);
  CHECK(smoke->range(smoke->fields()[0]).hi == doctest::Approx(5.71484).epsilon(1e-6));
  const auto sphere = read_file(data_file("volumes/sphere_points.vdb"));
  REQUIRE(sphere->as<PointCloud>());
  for (size_t i = 0; i < sphere->point_count(); i += 97)
    CHECK(length(sphere->as<PointCloud>()->points.at(i)) == doctest::Approx(1).epsilon(1e-3));
}

TEST_CASE("vdb: an axis without length is written with one, as it has a single layer") {
  DatasetParts p;
  UniformGrid g;
  g.dims = {3, 2, 1}, g.spacing = {0.5, 0.25, 0};
  p.mesh = g;
  p.fields.add({"z", Association::point, Array::from_vector(std::vector<float>(6, 1)), "", Role::none});
  Context context;
  write_data(temp_folder() + "flat.vdb", make_dataset(p), {}, context);
  const DatasetPtr back = read_file(temp_folder() + "flat.vdb");
  CHECK(lattice_dims(back->mesh()) == g.dims);
  CHECK(back->bounds().hi == Vec3(1, 0.25, 0));
}
