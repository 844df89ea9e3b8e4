// SPDX-License-Identifier: Apache-2.0
// Rays through cells of every kind, by what is known of cubes.
#include "render/volume/sources/cells/cell_volume.h"
#include "render/volume/sources/cells/tet_walk.h"
#include "support/test.h"
#include "volume_cells_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double curved(Vec3 p) { return std::sin(3 * p.x) * std::cos(2 * p.y) + p.z * p.z; }

/// A name for messages.
std::string name_of(CellType t) { return std::string(cell_type_info(t).name); }

}  // namespace

TEST_CASE("volume cells: stretches of every kind of cell add up to the chord, and a linear field to its exact integral") {
  for (const Warp& warp : {Warp(straight), Warp(bent)})
    for (CellType kind : linear_kinds()) {
      if (kind == CellType::voxel && warp({.5, .5, .3}).x != .5) continue;
      CAPTURE(name_of(kind));
      const VolumeItem item = item_of(with_field(cube(kind, 3, warp), linear));
      Context context;
      const auto source = volume::cell_source(item, context);
      const auto walker = source->walker();
      for (const TestRay& ray : some_rays(100)) {
        const auto [a, b] = chord(ray.o, ray.d);
        const RaySum r = gather(*source, *walker, ray.o, ray.d);
        CHECK(r.length == doctest::Approx(b - a).epsilon(1e-9));
        CHECK(r.gap < 1e-9);
        CHECK(r.integral == doctest::Approx((b - a) * linear(ray.o + ray.d * (0.5 * (a + b)))).epsilon(3e-6));
      }
    }
}

TEST_CASE("volume cells: curved cells add up to the chord, and a linear field to its exact integral") {
  for (CellType kind : {CellType::quadratic_tetra, CellType::triquadratic_hexahedron, CellType::lagrange_hexahedron}) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(cube(kind, 2), linear));
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    for (const TestRay& ray : some_rays(50)) {
      const auto [a, b] = chord(ray.o, ray.d);
      const RaySum r = gather(*source, *walker, ray.o, ray.d);
      CHECK(r.length == doctest::Approx(b - a).epsilon(1e-9));
      CHECK(r.gap < 1e-9);
      CHECK(r.integral == doctest::Approx((b - a) * linear(ray.o + ray.d * (0.5 * (a + b)))).epsilon(3e-6));
    }
  }
}

TEST_CASE("volume cells: fields in curved cells are read in reference space") {
  // A quadratic field is in the space of straight-sided quadratic cells: exact, however few they are.
  const auto quadratic = [](Vec3 p) { return 1 + p.x * p.x - 2 * p.y * p.z + 3 * p.z * p.z + p.x; };
  for (CellType kind : {CellType::quadratic_tetra, CellType::triquadratic_hexahedron, CellType::lagrange_hexahedron}) {
    CAPTURE(name_of(kind));
    for (const Warp& warp : {Warp(straight), Warp(bent)}) {
      const bool exact = warp({.5, .5, .3}).x == .5;
      const VolumeItem item = item_of(with_field(cube(kind, exact ? 1 : 3, warp), exact ? Function(quadratic) : Function(linear)));
      Context context;
      const auto source = volume::cell_source(item, context);
      const auto walker = source->walker();
      for (const TestRay& ray : some_rays(40)) {
        const auto [a, b] = chord(ray.o, ray.d);
        if (b - a < 1e-3) continue;
        double truth = 0;
        constexpr int n = 2000;
        for (int i = 0; i < n; ++i) {
          const Vec3 x = ray.o + ray.d * (a + (i + 0.5) / n * (b - a));
          truth += (exact ? quadratic(x) : linear(x)) * (b - a) / n;
        }
        const RaySum r = gather(*source, *walker, ray.o, ray.d);
        CHECK(r.length == doctest::Approx(b - a).epsilon(1e-9));
        CHECK(r.integral == doctest::Approx(truth).epsilon(exact ? 1e-4 : 3e-4));
      }
    }
  }
}

TEST_CASE("volume cells: the same curved field on cells of every kind has the same integrals, better with more cells") {
  const std::vector<TestRay> rays = some_rays(40);
  for (CellType kind : linear_kinds()) {
    CAPTURE(name_of(kind));
    double error[2] = {0, 0};
    for (int level = 0; level < 2; ++level) {
      const VolumeItem item = item_of(with_field(cube(kind, level ? 8 : 4), curved));
      Context context;
      const auto source = volume::cell_source(item, context);
      const auto walker = source->walker();
      for (const TestRay& ray : rays) {
        const auto [a, b] = chord(ray.o, ray.d);
        double truth = 0;
        for (int i = 0; i < 400; ++i) truth += curved(ray.o + ray.d * (a + (i + 0.5) / 400 * (b - a))) * (b - a) / 400;
        error[level] = std::max(error[level], std::abs(gather(*source, *walker, ray.o, ray.d).integral - truth));
      }
    }
    CHECK(error[1] < 0.013);
    CHECK(error[1] < 0.35 * error[0]);  // order 2
  }
}

TEST_CASE("volume cells: prisms of five and six sides are as long as their chords and have linear fields") {
  for (int n : {5, 6}) {
    UnstructuredMesh mesh;
    std::vector<float> xyz, f;
    std::vector<int64_t> ids;
    for (int k = 0; k < 2; ++k)
      for (int i = 0; i < n; ++i) {
        const Vec3 p(std::cos(2 * 3.14159265358979 * i / n), std::sin(2 * 3.14159265358979 * i / n), k);
        xyz.insert(xyz.end(), {float(p.x), float(p.y), float(p.z)});
        f.push_back(float(linear(p)));
        ids.push_back(int64_t(ids.size()));
      }
    mesh.points.xyz = Array::from_vector(xyz, 3);
    mesh.cells.fixed = 2 * n, mesh.cells.connectivity = Array::from_vector(ids);
    mesh.single_type = n == 5 ? CellType::pentagonal_prism : CellType::hexagonal_prism;
    DatasetParts parts;
    parts.mesh = mesh;
    parts.fields.add({"f", Association::point, Array::from_vector(f), "", Role::scalars});
    const RaySum r = gather(item_of(make_dataset(parts)), {0.1, 0.2, -2}, {0, 0, 1});
    CHECK(r.length == doctest::Approx(1).epsilon(1e-6));
    CHECK(r.integral == doctest::Approx(linear({0.1, 0.2, 0.5})).epsilon(1e-4));
  }
}

TEST_CASE("volume cells: rays along faces, edges and through vertices lose nothing") {
  for (CellType kind : linear_kinds()) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(cube(kind, 4), linear));
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    for (int axis = 0; axis < 3; ++axis)
      for (double u : {0.125, 0.25, 0.5, 0.75})
        for (double v : {0.2, 0.25, 0.5, 0.75}) {
          Vec3 d, o;
          d[axis] = 1, o[axis] = -2, o[(axis + 1) % 3] = u, o[(axis + 2) % 3] = v;
          const RaySum r = gather(*source, *walker, o, d);
          CHECK(r.length == doctest::Approx(1).epsilon(1e-12));
          CHECK(r.integral == doctest::Approx(linear(o + d * 2.5)).epsilon(1e-6));
        }
    // Diagonals: through vertices all the way, and in the plane of faces.
    for (Vec3 d : {Vec3(1, 1, 1), Vec3(1, 1, 0), Vec3(1, -1, 1), Vec3(0, 1, 1), Vec3(2, 1, 1)}) {
      d = normalize(d);
      const Vec3 o = Vec3(0.5, 0.5, 0.5) - d * 4.0;
      const auto [a, b] = chord(o, d);
      CHECK(gather(*source, *walker, o, d).length == doctest::Approx(b - a).epsilon(1e-12));
    }
    // In the skin itself: all of it or nothing.
    const RaySum skin = gather(*source, *walker, {0, 0.3, -1}, {0, 0, 1});
    CHECK((skin.length == 0 || std::abs(skin.length - 1) < 1e-9));
  }
}

// A face that a ray sees edge-on has shares for its corners that are rounding alone: it was met anywhere, with the value of that place.
TEST_CASE("volume cells: rays in the planes of faces, but for rounding, have the value of the places where they meet them") {
  const Mat3 turn{{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}};
  const auto turned = [&](Vec3 p) { return turn * (bent(p) + Vec3{0.1, 0.2, 0.3}); };
  const DatasetPtr mesh = with_field(cube(CellType::tetra, 2, turned), linear);
  const auto& tets = *mesh->as<UnstructuredMesh>();
  const VolumeItem item = item_of(mesh);
  Context context;
  const auto source = volume::cell_source(item, context);
  const auto walker = source->walker();
  double worst = 0;
  size_t ends = 0;
  for (size_t t = 0; t < mesh->cell_count(); ++t) {
    Vec3 v[4];
    for (size_t k = 0; k < 4; ++k) v[k] = tets.points.at(size_t(tets.cells.connectivity.get(4 * t + k)));
    for (size_t k = 0; k < 4; ++k)
      for (double f : {0.13, 0.37, 0.71}) {
        const Vec3 a = v[k], p = v[(k + 1) % 4] - a, q = v[(k + 2) % 4] - a;
        const Vec3 d = normalize(p * f - q * (1 - f)), o = a + (p + q) * 0.3 - d * 3.0;
        walker->start(o, d, -100, 100);
        volume::Stretch s[5];
        while (const size_t n = walker->next(s))
          for (size_t i = 0; i < n; ++i, ends += 2) {
            worst = std::max(worst, std::abs(double(s[i].b[0]) - linear(o + d * s[i].from)));
            worst = std::max(worst, std::abs(double(s[i].b[3]) - linear(o + d * s[i].to)));
          }
      }
  }
  CHECK(ends > 1000);
  CHECK(worst < 1e-5);
}

TEST_CASE("volume cells: a point in a flat triangle is the mean of its corners by their weights") {
  const double needles[][3][2] = {{{-1, -1e-17}, {2, 3e-17}, {3, -2e-17}},
                                  {{-0.1, -0.3}, {0.2, 0.6}, {0.3, 0.9 + 2e-16}},
                                  {{1, 1}, {2, 2}, {-3, -3}},
                                  {{0, 0}, {0, 0}, {1, 2}},
                                  {{0, 0}, {-1, 2}, {3, 1}}};
  for (const auto& v : needles) {
    double w[3];
    volume::weights_in_face(v, w);
    CHECK(w[0] + w[1] + w[2] == doctest::Approx(1));
    for (int a = 0; a < 2; ++a) CHECK(std::abs(w[0] * v[0][a] + w[1] * v[1][a] + w[2] * v[2][a]) < 1e-15);
  }
}

TEST_CASE("volume cells: a ray may begin and end inside, and see nothing behind it") {
  for (CellType kind : linear_kinds()) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(cube(kind, 3), linear));
    const Vec3 d = normalize(Vec3(1, 2, 3));
    const RaySum r = gather(item, {0.3, 0.2, 0.1}, d, 0.05, 0.45);
    CHECK(r.length == doctest::Approx(0.4).epsilon(1e-12));
    CHECK(r.first == 0.05);
    CHECK(r.integral == doctest::Approx(0.4 * linear(Vec3(0.3, 0.2, 0.1) + d * 0.25)).epsilon(1e-6));
    CHECK(gather(item, {0.3, 0.2, 0.1}, d, 5, 6).stretches == 0);
    CHECK(gather(item, {0.3, 0.2, 0.1}, d, -6, -5).stretches == 0);
    CHECK(gather(item, {3, 0.2, 0.1}, {0, 0, 1}).stretches == 0);
  }
}

TEST_CASE("volume cells: cells that are turned inside out draw the same") {
  for (CellType kind : {CellType::tetra, CellType::hexahedron, CellType::wedge}) {
    CAPTURE(name_of(kind));
    const DatasetPtr right = with_field(cube(kind, 3, bent), linear);
    UnstructuredMesh mesh = *right->as<UnstructuredMesh>();
    std::vector<int64_t> ids;
    const CellsView cells = cells_view(mesh.cells);
    for (size_t c = 0; c < cells.count; ++c) {
      std::vector<int64_t> v;
      for (size_t k = 0; k < cells.size(c); ++k) v.push_back(cells.point(c, k));
      if (c % 2) {  // every other one: base and top exchanged, or two corners
        if (kind == CellType::tetra) std::swap(v[0], v[1]);
        else std::rotate(v.begin(), v.begin() + int(v.size() / 2), v.end());
      }
      ids.insert(ids.end(), v.begin(), v.end());
    }
    mesh.cells.connectivity = Array::from_vector(std::move(ids));
    DatasetParts parts = right->parts();
    parts.mesh = mesh;
    Context context;
    const auto a = volume::cell_source(item_of(right), context), b = volume::cell_source(item_of(make_dataset(parts)), context);
    const auto wa = a->walker(), wb = b->walker();
    for (const TestRay& ray : some_rays(60)) {
      const RaySum x = gather(*a, *wa, ray.o, ray.d), y = gather(*b, *wb, ray.o, ray.d);
      CHECK(x.length == doctest::Approx(y.length).epsilon(1e-9));
      CHECK(x.integral == doctest::Approx(y.integral).epsilon(1e-5));
    }
  }
}

TEST_CASE("volume cells: ghosts, cells without a value and holes draw nothing, and a ray enters again behind them") {
  for (CellType kind : linear_kinds()) {
    CAPTURE(name_of(kind));
    const size_t n = 4;
    const DatasetPtr whole = with_field(cube(kind, n), linear);
    CellMap map(whole);
    std::vector<uint8_t> ghost(whole->cell_count());
    std::vector<float> by_cell(whole->cell_count(), 2.0f);
    for (size_t c = 0; c < ghost.size(); ++c) {
      map.open(c);
      const double z = map.center().z;
      const bool out = z > 0.25 && z < 0.75;  // the two middle layers
      ghost[c] = out ? uint8_t(ghost_hidden_cell) : uint8_t(0);
      if (out) by_cell[c] = NAN;
    }
    DatasetParts hidden = whole->parts();
    hidden.cell_ghost = Array::from_vector(ghost);
    DatasetParts no_value = whole->parts();
    no_value.fields = {};
    no_value.fields.add({"f", Association::cell, Array::from_vector(by_cell), "", Role::none});
    for (const TestRay& ray : {TestRay{{0.3, 0.4, -1}, {0, 0, 1}}, TestRay{{0.25, 0.5, -1}, {0, 0, 1}}}) {
      const RaySum r = gather(item_of(make_dataset(hidden)), ray.o, ray.d);
      CHECK(r.length == doctest::Approx(0.5).epsilon(1e-9));
      CHECK(r.gap == doctest::Approx(0.5).epsilon(1e-9));
      const RaySum s = gather(item_of(make_dataset(no_value), Association::cell), ray.o, ray.d);
      CHECK(s.length == doctest::Approx(0.5).epsilon(1e-9));
      CHECK(s.integral == doctest::Approx(1.0).epsilon(1e-9));
    }
    // A corner without a value: the cells around it go.
    DatasetParts hole = whole->parts();
    std::vector<float> f(whole->point_count());
    const auto& points = whole->as<UnstructuredMesh>()->points;
    for (size_t i = 0; i < f.size(); ++i) f[i] = points.at(i) == Vec3(0.5, 0.5, 0.5) ? NAN : float(linear(points.at(i)));
    hole.fields.add({"f", Association::point, Array::from_vector(f), "", Role::scalars});
    const RaySum r = gather(item_of(make_dataset(hole)), {0.51, 0.52, -1}, {0, 0, 1});
    CHECK(r.length == doctest::Approx(0.5).epsilon(0.1));
    CHECK(r.length < 0.9);
    CHECK(std::isfinite(r.integral));
  }
}

TEST_CASE("volume cells: fields of cells are constant in each") {
  for (CellType kind : all_kinds()) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(
                                        cube(kind, 3), [](Vec3 p) { return p.x < 1.0 / 3   ? 1.0
                                                                           : p.x < 2.0 / 3 ? 5.0
                                                                                           : 2.0; }, true),
                                    Association::cell);
    const RaySum r = gather(item, {-1, 0.41, 0.37}, {1, 0, 0});
    CHECK(r.length == doctest::Approx(1).epsilon(1e-9));
    CHECK(r.integral == doctest::Approx(8.0 / 3).epsilon(1e-6));
    CHECK(r.lowest == 1.0f);
    CHECK(r.highest == 5.0f);
  }
}

TEST_CASE("volume cells: a curvilinear grid is its hexahedra") {
  CurvilinearGrid g;
  g.dims = {5, 6, 7};
  std::vector<double> xyz;
  for (size_t k = 0; k < 7; ++k)
    for (size_t j = 0; j < 6; ++j)
      for (size_t i = 0; i < 5; ++i) {
        const Vec3 p = bent({double(i) / 4, double(j) / 5, double(k) / 6});
        xyz.insert(xyz.end(), {p.x, p.y, p.z});
      }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = g;
  const VolumeItem item = item_of(with_field(parts, linear));
  for (const TestRay& ray : some_rays(30)) {
    const auto [a, b] = chord(ray.o, ray.d);
    const RaySum r = gather(item, ray.o, ray.d);
    CHECK(r.length == doctest::Approx(b - a).epsilon(1e-9));
    CHECK(r.integral == doctest::Approx((b - a) * linear(ray.o + ray.d * (0.5 * (a + b)))).epsilon(3e-6));
  }
}

TEST_CASE("volume cells: a second field of cells is that of the cell that the ray is in") {
  DatasetParts parts = with_field(cube(CellType::tetra, 3), linear)->parts();
  const size_t cells = make_dataset(parts)->cell_count();
  std::vector<float> first(cells), second(cells);
  for (size_t i = 0; i < cells; ++i) first[i] = float(i), second[i] = float(2 * i + 1);
  parts.fields.add({"f", Association::cell, Array::from_vector(first), "", Role::none});
  parts.fields.add({"g", Association::cell, Array::from_vector(second), "", Role::none});
  VolumeItem item = item_of(make_dataset(parts));
  item.field = "f", item.association = Association::cell;
  item.detail.second = SecondAxis::field, item.detail.second_field = "g";
  Context context;
  const auto source = volume::cell_source(item, context);
  const auto walker = source->walker();
  size_t seen = 0;
  for (const TestRay& ray : some_rays(20)) {
    walker->start(ray.o, ray.d, -100, 100);
    volume::Stretch s[64];
    while (const size_t n = walker->next(s))
      for (size_t i = 0; i < n; ++i) {
        const double t = 0.5 * (s[i].from + s[i].to);
        if (s[i].to - s[i].from < 1e-6) continue;
        CHECK(walker->second(s[i], t) == 2 * (s[i].value(t) + source->base) + 1);
        ++seen;
      }
  }
  CHECK(seen > 40);
}

TEST_CASE("volume cells: gradients and a second field of linear fields are exact") {
  for (CellType kind : all_kinds()) {
    CAPTURE(name_of(kind));
    DatasetParts parts = with_field(cube(kind, 3), linear)->parts();
    std::vector<float> second;
    const auto& points = std::get<UnstructuredMesh>(parts.mesh).points;
    for (size_t i = 0; i < points.count(); ++i) second.push_back(float(points.at(i).x - points.at(i).z));
    parts.fields.add({"g", Association::point, Array::from_vector(second), "", Role::none});
    VolumeItem item = item_of(make_dataset(parts));
    item.detail.second = SecondAxis::field, item.detail.second_field = "g";
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    for (const TestRay& ray : some_rays(5)) {
      walker->start(ray.o, ray.d, -100, 100);
      CHECK(walker->entry() == doctest::Approx(chord(ray.o, ray.d).first).epsilon(1e-9));
      volume::Stretch s[64];
      while (const size_t n = walker->next(s))
        for (size_t i = 0; i < n; ++i) {
          if (s[i].to - s[i].from < 1e-6) continue;
          const double t = 0.3 * s[i].from + 0.7 * s[i].to;
          const Vec3f g = walker->gradient(s[i], t);
          CHECK(length(g - Vec3f(1, 2, 3)) < 2e-3f);
          const Vec3 x = ray.o + ray.d * t;
          CHECK(double(walker->second(s[i], t)) == doctest::Approx(x.x - x.z).epsilon(1e-3));
        }
    }
  }
}

TEST_CASE("volume cells: gradients of quadratic fields are exact up to the border of bent meshes") {
  const auto quadratic = [](Vec3 p) { return p.x * p.x - 2 * p.y * p.z + 0.5 * p.z * p.z + p.y; };
  for (CellType kind : {CellType::tetra, CellType::hexahedron, CellType::wedge, CellType::pyramid, CellType::polyhedron}) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(cube(kind, 4, bent), quadratic));
    Context context;
    const auto source = volume::cell_source(item, context);
    const auto walker = source->walker();
    for (const TestRay& ray : some_rays(10)) {
      walker->start(ray.o, ray.d, -100, 100);
      volume::Stretch s[64];
      while (const size_t n = walker->next(s))
        for (size_t i = 0; i < n; ++i) {
          if (s[i].to - s[i].from < 1e-6) continue;
          const double t = 0.3 * s[i].from + 0.7 * s[i].to;
          const Vec3 x = ray.o + ray.d * t;
          CHECK(length(walker->gradient(s[i], t) - Vec3f(Vec3(2 * x.x, 1 - 2 * x.z, x.z - 2 * x.y))) < 5e-3f);
        }
    }
  }
}

TEST_CASE("volume cells: stretches that cannot be seen are left out") {
  for (CellType kind : all_kinds()) {
    CAPTURE(name_of(kind));
    const VolumeItem item = item_of(with_field(cube(kind, 4), [](Vec3 p) { return p.z; }));
    Context context;
    const auto source = volume::cell_source(item, context);
    source->invisible.clear = [](const void*, float lo, float hi) {
      CHECK(std::isfinite(lo));
      CHECK(std::isfinite(hi));
      return hi <= 0.5f;
    };
    const RaySum r = gather(*source, *source->walker(), {0.3, 0.4, -1}, {0, 0, 1});
    CHECK(r.first >= 1.499);
    CHECK(r.length >= 0.5 - 1e-9);
    CHECK(r.length < 0.6);
  }
}

TEST_CASE("volume cells: meshes without a volume are refused") {
  SurfaceMesh surface;
  surface.points.xyz = Array::from_vector(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  surface.polygons.fixed = 3;
  surface.polygons.connectivity = Array::from_vector(std::vector<int64_t>{0, 1, 2});
  DatasetParts parts;
  parts.mesh = surface;
  parts.fields.add({"f", Association::point, Array::from_vector(std::vector<float>{1, 2, 3}), "", Role::scalars});
  CHECK(error_of([&] { gather(item_of(make_dataset(parts)), {}, {0, 0, 1}); }).find("surface mesh") != std::string::npos);
  UnstructuredMesh flat;
  flat.points = surface.points, flat.cells = surface.polygons, flat.single_type = CellType::triangle;
  parts.mesh = flat;
  CHECK(error_of([&] { gather(item_of(make_dataset(parts)), {}, {0, 0, 1}); }).find("no solid cells") != std::string::npos);
  VolumeItem item = item_of(with_field(cube(CellType::tetra, 1), linear));
  item.field = "g";
  CHECK(error_of([&] { gather(item, {}, {0, 0, 1}); }).find("'g'") != std::string::npos);
  item.field = "f", item.component = 3;
  CHECK(error_of([&] { gather(item, {}, {0, 0, 1}); }).find("component") != std::string::npos);
  item.data = nullptr;
  CHECK(error_of([&] { gather(item, {}, {0, 0, 1}); }).find("no dataset") != std::string::npos);
}

TEST_CASE("volume cells: gradients of fields of points and of cells are of second order up to the border, on every linear kind") {
  const auto f = [](Vec3 p) { return std::sin(2 * p.x + p.y) + p.z * p.z * p.y; };
  const auto slope = [](Vec3 p) {
    const double c = std::cos(2 * p.x + p.y);
    return Vec3{2 * c, c + p.z * p.z, 2 * p.z * p.y};
  };
  for (const CellType kind : linear_kinds())
    for (const bool by_cell : {false, true}) {
      double worst[2] = {0, 0};
      for (const int level : {0, 1}) {
        const bool flat = kind == CellType::voxel || kind == CellType::polyhedron;
        DatasetPtr data = with_field(cube(kind, level ? 12 : 6, flat ? Warp(straight) : Warp(bent)), f);
        if (by_cell) {  // at the means of the points
          std::vector<double> values;
          CellReader reader(data);
          for (size_t c = 0; c < data->cell_count(); ++c) {
            reader.open(c);
            Vec3 sum;
            for (const Vec3& p : reader.at()) sum += p;
            values.push_back(f(sum / double(reader.at().size())));
          }
          DatasetParts parts = data->parts();
          parts.fields = {};
          parts.fields.add({"f", Association::cell, Array::from_vector(values), "", Role::scalars});
          data = make_dataset(std::move(parts));
        }
        Context context;
        const volume::CellVolume v = volume::make_cell_volume(item_of(data, by_cell ? Association::cell : Association::point), context);
        const auto gradients = v.gradients();
        for (const auto& tet : v.mesh->corners)
          for (uint32_t k : tet)
            worst[level] = std::max(worst[level], length(Vec3((*gradients)[k]) - slope(v.mesh->at[k] + v.mesh->origin)));
      }
      INFO(std::string(cell_type_info(kind).name), by_cell ? std::string(", cells ") : std::string(", points "), worst[0], " ", worst[1]);
      CHECK(std::log2(worst[0] / worst[1]) > 1.5);
    }
}
