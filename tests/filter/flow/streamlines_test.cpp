// SPDX-License-Identifier: Apache-2.0
// streamlines and seeds: what they give, and what they say to bad input.
#include "filter/flow/streamlines.h"

#include <numbers>

#include "base/parallel.h"
#include "filter/field/derivatives/derivatives.h"
#include "filter/flow/flow_meshes.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::flow;

namespace {

using std::numbers::pi;

DatasetPtr run(const Data& mesh, const StreamlinesParams& p) {
  Context context;
  return std::get<DatasetPtr>(streamlines({mesh}, p, context));
}
StreamlinesParams from_points(std::vector<double> points) {
  StreamlinesParams p;
  p.seeds.points = std::move(points);
  return p;
}
std::vector<Vec3> seeds_of(const DatasetPtr& mesh, const SeedParams& p, const DatasetPtr& second = nullptr) {
  Context context;
  return make_seeds(p, {mesh}, second, {}, context);
}
std::string error_with(const Data& mesh, const StreamlinesParams& p) {
  return error_of([&] { run(mesh, p); });
}
/// The ABC flow on [0, 2 pi]^3, a = sqrt 3, b = sqrt 2, c = 1.
DatasetPtr abc_grid(size_t n) {
  return with_velocity(make_dataset(uniform({n, n, n}, {0, 0, 0}, {2 * pi, 2 * pi, 2 * pi})), [](Vec3 p) {
    const double a = std::sqrt(3.0), b = std::sqrt(2.0);
    return Vec3(a * std::sin(p.z) + std::cos(p.y), b * std::sin(p.x) + a * std::cos(p.z), std::sin(p.y) + b * std::cos(p.x));
  });
}

}  // namespace

TEST_CASE("streamlines: one poly-line a seed with speed, velocity, time, length, the mesh's fields, seed and stop") {
  DatasetPtr mesh = with_velocity(mesh_of("uniform", 8, 1), [](Vec3 p) { return Vec3(1, 0.5 * p.x, 0); });
  DatasetParts parts = mesh->parts();
  std::vector<double> x;
  std::vector<int32_t> c;
  for (int i = 0; i < 729; ++i) x.push_back(i % 9 / 4.0 - 1);
  for (int i = 0; i < 512; ++i) c.push_back(i % 8);
  parts.fields.add({"x", Association::point, Array::from_vector(x), "m", Role::none});
  parts.fields.add({"column", Association::cell, Array::from_vector(c), "", Role::none});
  mesh = make_dataset(std::move(parts));
  const DatasetPtr lines = run(mesh, from_points({-0.3, 0.1, 0.2, 5, 5, 5, 0.4, -0.2, 0}));
  validate(lines->mesh());
  const auto& s = *lines->as<SurfaceMesh>();
  CHECK(s.lines.size() == 2);
  CHECK(s.vertices.size() == 0);
  const FieldSet& f = lines->fields();
  CHECK(f.active()->name == "speed");
  CHECK(f.require("u").role == Role::vectors);
  CHECK(f.require("u").unit == "m/s");
  CHECK(f.require("seed", Association::cell).array.get(0) == 0);
  CHECK(f.require("seed", Association::cell).array.get(1) == 2);
  CHECK(f.require("stop", Association::cell).array.get(0) == double(StopReason::outside));
  const CellsView v = cells_view(s.lines);
  for (size_t l = 0; l < 2; ++l) {
    double along = 0;
    for (size_t i = v.begin(l); i < v.end(l); ++i) {
      const Vec3 p = s.points.at(i);
      if (i > v.begin(l)) along += length(p - s.points.at(i - 1));
      CHECK(f.require("x").array.get(i) == doctest::Approx(p.x).epsilon(1e-5));
      CHECK(std::abs(f.require("column").array.get(i) - 4 * (p.x + 1)) < 1.0001);
      CHECK(f.require("u").array.get(i, 0) == doctest::Approx(1));
      CHECK(f.require("speed").array.get(i) == doctest::Approx(std::hypot(1, 0.5 * p.x)).epsilon(1e-5));
      CHECK(f.require("time").array.get(i) == doctest::Approx(p.x - (l == 0 ? -0.3 : 0.4)).epsilon(1e-4));
    }
    CHECK(s.points.at(v.begin(l)).x == doctest::Approx(-1).epsilon(1e-3));
    CHECK(s.points.at(v.end(l) - 1).x == doctest::Approx(1).epsilon(1e-3));
    const Array& arc = f.require("length").array;
    CHECK(arc.get(v.end(l) - 1) - arc.get(v.begin(l)) == doctest::Approx(along).epsilon(1e-3));
  }
}

TEST_CASE("streamlines: forward and backward are the two halves of both") {
  const DatasetPtr mesh = with_velocity(mesh_of("rectilinear", 8, 1), [](Vec3 p) { return Vec3(1, p.x, 0.3); });
  StreamlinesParams p = from_points({0.1, 0.1, 0.1});
  p.direction = TraceDirection::both;
  const DatasetPtr both = run(mesh, p);
  p.direction = TraceDirection::forward;
  const DatasetPtr forward = run(mesh, p);
  p.direction = TraceDirection::backward;
  const DatasetPtr backward = run(mesh, p);
  CHECK(forward->point_count() + backward->point_count() - 1 == both->point_count());
  const Points &a = both->as<SurfaceMesh>()->points, &f = forward->as<SurfaceMesh>()->points, &b = backward->as<SurfaceMesh>()->points;
  CHECK(a.at(0) == b.at(0));
  CHECK(b.at(b.count() - 1) == f.at(0));
  CHECK(a.at(a.count() - 1) == f.at(f.count() - 1));
  CHECK(backward->fields().require("time").array.get(0) < 0);
  CHECK(backward->fields().require("length").array.get(0) < 0);
}

TEST_CASE("streamlines: vorticity and rotation of a screw") {
  // Rigid rotation with angular velocity 2 about z, and a drift along it: the vorticity is 4, a ribbon turns by 2 cos(angle to z).
  const DatasetPtr mesh = with_velocity(mesh_of("uniform", 6, 1), [](Vec3 p) { return Vec3(-2 * p.y, 2 * p.x, 0.5); });
  StreamlinesParams p = from_points({0.1, 0, 0});
  p.attributes = {LineAttribute::vorticity, LineAttribute::rotation};
  const DatasetPtr lines = run(mesh, p);
  const FieldSet& f = lines->fields();
  const double cosine = 0.5 / std::hypot(0.5, 0.2);
  for (size_t i = 0; i < lines->point_count(); ++i) {
    CHECK(f.require("vorticity").array.get(i, 2) == doctest::Approx(4).epsilon(1e-5));
    CHECK(std::abs(f.require("vorticity").array.get(i, 0)) < 1e-5);
    CHECK(f.require("angular velocity").array.get(i) == doctest::Approx(2 * cosine).epsilon(1e-3));
    CHECK(f.require("rotation").array.get(i) == doctest::Approx(2 * cosine * f.require("time").array.get(i)).epsilon(1e-3));
  }
  p.attributes = {LineAttribute::none};
  CHECK(run(mesh, p)->fields().size() == 6);
}

TEST_CASE("streamlines: the ABC flow has no divergence, is its own curl, and has the mean square a^2 + b^2 + c^2") {
  double h[3], div[3], rot[3];
  for (int k = 0; k < 3; ++k) {
    const size_t n = (size_t(8) << k) + 1;
    Context context;
    const DatasetPtr flow = abc_grid(n);
    const std::string name = "u";
    const DatasetPtr d = divergence(flow, {{name}, "d"}, context), c = curl(flow, {{name}, "c"}, context);
    h[k] = 1.0 / double(n - 1), div[k] = rot[k] = 0;
    double square = 0;
    size_t count = 0;
    for (size_t z = 1; z + 1 < n; ++z)
      for (size_t y = 1; y + 1 < n; ++y)
        for (size_t x = 1; x + 1 < n; ++x) {
          const size_t i = x + n * (y + n * z);
          div[k] = std::max(div[k], std::abs(d->fields().require("d").array.get(i)));
          for (int a = 0; a < 3; ++a)
            rot[k] = std::max(rot[k], std::abs(c->fields().require("c").array.get(i, a) - flow->fields().require(name).array.get(i, a)));
        }
    for (size_t z = 0; z + 1 < n; ++z)
      for (size_t y = 0; y + 1 < n; ++y)
        for (size_t x = 0; x + 1 < n; ++x, ++count)
          for (int a = 0; a < 3; ++a) square += std::pow(flow->fields().require(name).array.get(x + n * (y + n * z), a), 2);
    CHECK(square / double(count) == doctest::Approx(6).epsilon(1e-10));
  }
  CHECK(div[2] < 1e-10);  // each component does not depend on its own coordinate
  CHECK(observed_order(h, rot, 3) == doctest::Approx(2).epsilon(0.1));
}

TEST_CASE("streamlines: along lines of the ABC flow the vorticity is the velocity") {
  const DatasetPtr flow = abc_grid(65);
  StreamlinesParams s;
  s.seeds.seeds = SeedKind::random, s.seeds.count = 20, s.attributes = {LineAttribute::vorticity}, s.stop.max_steps = 100;
  const DatasetPtr lines = run(flow, s);
  const std::string name = "u";
  double worst = 0;
  for (size_t i = 0; i < lines->point_count(); ++i)
    for (int a = 0; a < 3; ++a)
      worst =
          std::max(worst, std::abs(lines->fields().require("vorticity").array.get(i, a) - lines->fields().require(name).array.get(i, a)));
  CHECK(worst < 0.2);  // half a cell times the second derivatives
}

TEST_CASE("streamlines: the same bytes for 1 and 8 threads, through the plain tracer too") {
  for (const char* kind : {"curvilinear", "wedge"}) {
    const DatasetPtr mesh = with_velocity(mesh_of(kind, 6, 1), [](Vec3 p) { return Vec3(0.3 - p.y, p.x, 0.4 * p.x * p.y); });
    StreamlinesParams p;
    p.seeds.count = 100;
    set_thread_count(1);
    const DatasetPtr a = run(mesh, p);
    set_thread_count(8);
    const DatasetPtr b = run(mesh, p);
    set_thread_count(0);
    const Array &x = a->as<SurfaceMesh>()->points.xyz, &y = b->as<SurfaceMesh>()->points.xyz;
    REQUIRE(x.count() == y.count());
    CHECK(std::memcmp(x.raw(), y.raw(), x.bytes()) == 0);
  }
}

TEST_CASE("streamlines: a limit of length, time and steps, and lines that end in a still place, say so") {
  const DatasetPtr mesh = with_velocity(mesh_of("uniform", 8, 1), [](Vec3 p) { return Vec3(0.5 - p.x, 0, 0); });
  const auto stop = [&](StopParams s) {
    StreamlinesParams p = from_points({-0.9, 0, 0});
    p.direction = TraceDirection::forward, p.stop = s;
    const DatasetPtr lines = run(mesh, p);
    return std::pair(StopReason(int(lines->fields().require("stop").array.get(0))),
                     lines->fields().require("length").array.get(lines->point_count() - 1));
  };
  CHECK(stop({.max_length = 0.3}).first == StopReason::length);
  CHECK(stop({.max_length = 0.3}).second == doctest::Approx(0.3).epsilon(1e-3));
  CHECK(stop({.max_time = 0.2}).first == StopReason::time);
  CHECK(stop({.max_time = 0.2}).second == doctest::Approx(1.4 * (1 - std::exp(-0.2))).epsilon(1e-3));
  CHECK(stop({.max_steps = 2}).first == StopReason::steps);
  CHECK(stop({.max_time = 100, .min_speed = 1e-3}).first == StopReason::speed);
}

TEST_CASE("streamlines: a field of two components flows in its plane, on solid meshes too") {
  const DatasetPtr mesh = with_velocity(mesh_of("hexahedron", 4, 1), rotation, 2);
  const DatasetPtr lines = run(mesh, from_points({0.5, 0, 0.25}));
  for (size_t i = 0; i < lines->point_count(); ++i) {
    CHECK(lines->as<SurfaceMesh>()->points.at(i).z == doctest::Approx(0.25));
    CHECK(std::hypot(lines->as<SurfaceMesh>()->points.at(i).x, lines->as<SurfaceMesh>()->points.at(i).y) ==
          doctest::Approx(0.5).epsilon(1e-3));
  }
  CHECK(lines->fields().require("u").components() == 3);
}

TEST_CASE("streamlines: bad input is named") {
  const DatasetPtr plain = mesh_of("uniform", 4, 1);
  const DatasetPtr good = with_velocity(plain, rotation);
  CHECK(contains(error_with(plain, {}), "no vector field"));
  CHECK(contains(error_with(with_velocity(plain, [](Vec3) { return Vec3(); }), {}), "zero or NaN everywhere"));
  CHECK(contains(error_with(with_velocity(plain, [](Vec3) { return Vec3(NAN, NAN, NAN); }), {}), "zero or NaN everywhere"));
  CHECK(contains(error_with(good, from_points({7, 7, 7})), "none of 1 seeds lies in the flow; the mesh extends over x -1 to 1"));
  CHECK(contains(error_with(good, from_points({7, 7})), "2 numbers do not make points"));
  StreamlinesParams p;
  p.field.name = "velocity";
  CHECK(contains(error_with(good, p), "velocity"));
  p = {};
  p.integration.step = 0.5, p.integration.min_step = 2;
  CHECK(contains(error_with(good, p), "leave no valid step"));
  p = {};
  p.seeds.seeds = SeedKind::mesh;
  CHECK(contains(error_with(good, p), "no second input"));
  DatasetParts parts = plain->parts();
  parts.fields.add({"t", Association::point, Array::from_vector(std::vector<float>(125 * 6), 6), "", Role::none});
  p = {};
  p.field.name = "t";
  CHECK(contains(error_with(make_dataset(std::move(parts)), p), "has 6 components; a velocity has 2 or 3"));
  CHECK(contains(error_with(std::make_shared<const Table>(), {}), "table"));
  PointCloud cloud{{Array::from_vector(std::vector<float>(30), 3), {}}};
  FieldSet fields;
  fields.add({"u", Association::point, Array::from_vector(std::vector<float>(30, 1), 3), "", Role::vectors});
  CHECK(contains(error_with(make_dataset(cloud, fields), {}), "no flow between its points"));
}

TEST_CASE("streamlines: lines end where the flow is NaN, and at cells that are hidden") {
  for (const char* kind : {"uniform", "tetra", "curvilinear"}) {
    CAPTURE(kind);
    const DatasetPtr mesh = with_velocity<float>(mesh_of(kind, 8, 1), [](Vec3 p) { return p.x > 0.45 ? Vec3(NAN, 0, 0) : Vec3(1, 0, 0); });
    StreamlinesParams p = from_points({-0.5, 0.1, 0.1, 0.8, 0, 0});
    p.direction = TraceDirection::forward;
    const DatasetPtr lines = run(mesh, p);
    CHECK(lines->cell_count() == 1);
    const auto last = lines->as<SurfaceMesh>()->points.at(lines->point_count() - 1);
    CHECK(last.x > 0.1);
    CHECK(last.x < 0.6);
  }
  const DatasetPtr mesh = with_velocity(mesh_of("uniform", 8, 1), [](Vec3) { return Vec3(1, 0, 0); });
  DatasetParts parts = mesh->parts();
  std::vector<uint8_t> ghost(512);
  for (size_t i = 0; i < 512; ++i) ghost[i] = i % 8 == 6 ? ghost_hidden_cell : 0;
  parts.cell_ghost = Array::from_vector(std::move(ghost));
  const DatasetPtr lines = run(make_dataset(std::move(parts)), from_points({0, 0.1, 0.1}));
  CHECK(lines->as<SurfaceMesh>()->points.at(lines->point_count() - 1).x == doctest::Approx(0.5).epsilon(1e-2));
}

TEST_CASE("streamlines: flat and collapsed cells do not stop lines that pass beside them") {
  // One tetrahedron of the mesh is flattened onto a face of its neighbours, one has a point twice.
  UnstructuredMesh m = *mesh_of("tetra", 4, 1)->as<UnstructuredMesh>();
  std::vector<int32_t> ids;
  for (size_t i = 0; i < m.cells.connectivity.count(); ++i) ids.push_back(int32_t(m.cells.connectivity.get(i)));
  for (const size_t extra : {size_t(40), size_t(400)}) ids.insert(ids.end(), {ids[extra], ids[extra + 1], ids[extra + 2], ids[extra]});
  m.cells.connectivity = Array::from_vector(ids);
  m.cells.offsets = {}, m.cells.fixed = 4;
  m.types = {}, m.single_type = CellType::tetra;
  const DatasetPtr mesh = with_velocity<float>(make_dataset(std::move(m)), [](Vec3) { return Vec3(1, 0.2, 0.1); });
  StreamlinesParams p;
  p.seeds.seeds = SeedKind::plane, p.seeds.normal = Vec3(1, 0, 0), p.seeds.center = Vec3(-0.99, -0.2, -0.1), p.seeds.size = {1.4, 1.4},
  p.seeds.count = 64;
  p.direction = TraceDirection::forward;
  const DatasetPtr lines = run(mesh, p);
  CHECK(lines->cell_count() == 64);
  const CellsView v = cells_view(lines->as<SurfaceMesh>()->lines);
  for (size_t l = 0; l < v.count; ++l) CHECK(lines->as<SurfaceMesh>()->points.at(v.end(l) - 1).x == doctest::Approx(1).epsilon(2e-3));
}

TEST_CASE("seeds: lists, lines, planes, spheres, balls, boxes and meshes") {
  const DatasetPtr mesh = mesh_of("uniform", 4, 1);
  SeedParams p;
  p.points = {1, 2, 3, 4, 5, 6};
  CHECK(seeds_of(mesh, p) == std::vector<Vec3>{{1, 2, 3}, {4, 5, 6}});
  p = {};
  p.from = Vec3(0, 0, 0), p.to = Vec3(1, 2, 2), p.count = 5;
  CHECK(seeds_of(mesh, p)[2] == Vec3(0.5, 1, 1));
  CHECK(seeds_of(mesh, p)[4] == Vec3(1, 2, 2));
  p = {};
  p.normal = Vec3(0, 1, 1), p.size = {2, 1}, p.counts = {5, 3}, p.center = Vec3(0, 0, 1);
  std::vector<Vec3> s = seeds_of(mesh, p);
  CHECK(s.size() == 15);
  for (const Vec3& x : s) CHECK(std::abs(x.y + x.z - 1) < 1e-12);
  CHECK(length(s[4] - s[0]) == doctest::Approx(2));
  CHECK(length(s[10] - s[0]) == doctest::Approx(1));
  p = {};
  p.radius = 0.5, p.count = 1000;
  s = seeds_of(mesh, p);
  Vec3 mean;
  for (const Vec3& x : s) {
    CHECK(length(x) == doctest::Approx(0.5));
    mean += x / 1000;
  }
  CHECK(length(mean) < 2e-3);
  p.seeds = SeedKind::ball;
  s = seeds_of(mesh, p);
  size_t inner = 0;
  for (const Vec3& x : s) {
    CHECK(length(x) <= 0.5);
    inner += length(x) < 0.25;
  }
  CHECK(double(inner) == doctest::Approx(125).epsilon(0.25));
  p = {};
  p.counts = {2, 3, 4};
  s = seeds_of(mesh, p);
  CHECK(s.size() == 24);
  CHECK(length(s[0] - Vec3(-0.5, -2.0 / 3, -0.75)) < 1e-12);
  p = {};
  CHECK(seeds_of(mesh, p, mesh).size() == 125);
  Context context;
  const auto cloud = std::get<DatasetPtr>(seeds({Data(mesh), Data(mesh)}, {}, context));
  CHECK(cloud->as<PointCloud>());
  CHECK(cloud->fields().require("seed").array.get(124) == 124);
}

TEST_CASE("seeds: random places fill solids by volume and surfaces by area, and depend on their number alone") {
  for (const char* kind : {"uniform", "curvilinear", "mixed", "amr"}) {
    CAPTURE(kind);
    const std::vector<Vec3> s = seeds_of(mesh_of(kind, 6, 1), {.seeds = SeedKind::random, .count = 2000});
    REQUIRE(s.size() == 2000);
    size_t left = 0;
    for (const Vec3& x : s) left += x.x < 0;
    CHECK(double(left) == doctest::Approx(1000).epsilon(0.08));
  }
  // A sphere of triangles that are far from equal in size: heights are even (Archimedes).
  const std::vector<Vec3> s = seeds_of(shapes::sphere(3).dataset(), {.seeds = SeedKind::random, .count = 2000});
  REQUIRE(s.size() == 2000);
  size_t low = 0;
  for (const Vec3& x : s) {
    CHECK(length(x) > 0.95);
    low += x.z < -0.5;
  }
  CHECK(double(low) == doctest::Approx(500).epsilon(0.1));
  const std::vector<Vec3> fewer = seeds_of(shapes::sphere(3).dataset(), {.seeds = SeedKind::random, .count = 20});
  for (size_t i = 0; i < 20; ++i) CHECK(fewer[i] == s[i]);
  CHECK(seeds_of(shapes::sphere(3).dataset(), {.seeds = SeedKind::random, .count = 20, .random_seed = 2})[0] != s[0]);
}

TEST_CASE("seeds: bright pixels of a picture on a plane") {
  // A picture of 40 x 20 pixels whose right half is white, of three channels.
  UniformGrid g;
  g.dims = {40, 20, 1};
  std::vector<uint8_t> rgb;
  for (int i = 0; i < 800; ++i) rgb.insert(rgb.end(), 3, i % 40 >= 20 ? 255 : 0);
  FieldSet fields;
  fields.add({"picture", Association::point, Array::from_vector(rgb, 3), "", Role::none});
  const DatasetPtr mesh = mesh_of("uniform", 4, 1), picture = make_dataset(g, fields);
  SeedParams p;
  p.seeds = SeedKind::pixels, p.normal = Vec3(0, 0, 1), p.size = {2, 1}, p.count = 100;
  const std::vector<Vec3> s = seeds_of(mesh, p, picture);
  CHECK(double(s.size()) == doctest::Approx(100).epsilon(0.3));
  for (const Vec3& x : s) {
    CHECK(x.x > 0);
    CHECK(x.x <= 1);
    CHECK(std::abs(x.y) <= 0.5);
    CHECK(x.z == 0);
  }
  CHECK(contains(error_of([&] { seeds_of(mesh, p, mesh); }), "needs a picture"));
  std::vector<uint8_t> black(2400);
  FieldSet none;
  none.add({"picture", Association::point, Array::from_vector(black, 3), "", Role::none});
  CHECK(contains(error_of([&] { seeds_of(mesh, p, make_dataset(g, none)); }), "black"));
}

TEST_CASE("seeds: numbers that make no seeds are named") {
  const DatasetPtr mesh = mesh_of("uniform", 4, 1);
  const auto said = [&](const SeedParams& p, const char* part) { return contains(error_of([&] { seeds_of(mesh, p); }), part); };
  CHECK(said({.from = Vec3(0, 0, 0)}, "add to=x,y,z"));
  CHECK(said({.normal = Vec3(0, 0, 0)}, "no direction"));
  CHECK(said({.seeds = SeedKind::plane, .size = {1, 2, 3}}, "a plane has 2 edges"));
  CHECK(said({.seeds = SeedKind::grid, .counts = {1, 2}}, "a box has 3 edges"));
  CHECK(said({.seeds = SeedKind::points}, "0 numbers do not make points"));
}
