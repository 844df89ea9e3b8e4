// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "filter/tensor/degenerate/degenerate_face.h"
#include "filter/tensor/degenerate/degenerate_lines.h"
#include "filter/tensor/degenerate/degenerate_points.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

// f = x, g = y: a wedge at the place; g = -y: a trisector. In the plane across a direction when turned.
SymTensor wedge(Vec3 p, double sign = 1) { return {3 + p.x, 3 - p.x, 0, sign * p.y, 0, 0}; }

// How often the eigenvector turns along a circle: half turns.
double index_around(const std::function<SymTensor(Vec3)>& f, Vec3 middle, double radius) {
  double turn = 0, before = 0;
  for (int i = 0; i <= 400; ++i) {
    const double a = 2 * M_PI * i / 400;
    const SymTensor d = f(middle + Vec3(std::cos(a), std::sin(a), 0) * radius);
    const double angle = std::atan2(d.xy, (d.xx - d.yy) / 2) / 2;
    if (i > 0) {
      double step = angle - before;
      step -= M_PI * std::round(step / M_PI);
      turn += step;
    }
    before = angle;
  }
  return turn / (2 * M_PI);
}

DatasetPtr turned_square(int n, const std::function<SymTensor(Vec3)>& f, const Mat3& turn = {}) {
  SurfaceMesh mesh;
  std::vector<double> xyz;
  std::vector<int32_t> ids;
  std::vector<SymTensor> d;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Vec3 p(-1 + 2.0 * i / n, -1 + 2.0 * j / n, 0), q = turn * p;
      xyz.insert(xyz.end(), {q.x, q.y, q.z});
      d.push_back(rotated(f(p), turn));
      if (i < n && j < n) {
        const int a = i + (n + 1) * j;
        for (int k : {a, a + 1, a + n + 2, a, a + n + 2, a + n + 1}) ids.push_back(k);
      }
    }
  mesh.points.xyz = Array::from_vector(xyz, 3);
  mesh.polygons.connectivity = Array::from_vector(ids), mesh.polygons.fixed = 3;
  FieldSet fields;
  fields.add(tensor_field(d));
  return make_dataset(mesh, fields);
}

}  // namespace

TEST_CASE("degenerate_points: a wedge and a trisector lie where they were put, in triangles, quads and tilted planes") {
  Context context;
  const Vec3 at(0.137, -0.211, 0);
  for (double sign : {1.0, -1.0}) {
    auto f = [&](Vec3 p) { return wedge(p - at, sign); };
    const Mat3 tilt = random_rotation(8);
    for (const auto& [d, turn] : {std::pair(turned_square(7, f), Mat3()), std::pair(turned_square(7, f, tilt), tilt),
                                  std::pair(tensor_grid({8, 6, 1}, {-1, -1, 0}, {1, 1, 0}, f), Mat3())}) {
      const DatasetPtr p = degenerate_points(d, {}, context);
      REQUIRE(p->point_count() == 1);
      CHECK(length(point(p, 0) - turn * at) < 1e-12);
      CHECK(value(p, "index", 0) == sign * 0.5);
      CHECK(value(p, "index", 0) == doctest::Approx(index_around(f, at, 0.1)));
      CHECK(value(p, "type", 0) == (sign > 0 ? 1 : 0));
      CHECK(value(p, "delta", 0) == doctest::Approx(sign));
      CHECK(value(p, "eigenvalue", 0) == doctest::Approx(3));
      CHECK(value(p, "separatrices", 0) == (sign > 0 ? 1 : 3));
      // A line of the larger eigenvalue runs along each.
      for (int k = 0; k < (sign > 0 ? 1 : 3); ++k) {
        const std::string name = fmt::format("separatrix {}", k + 1);
        const Vec3 along = transpose(turn) * Vec3(value(p, name.c_str(), 0, 0), value(p, name.c_str(), 0, 1), value(p, name.c_str(), 0, 2));
        CHECK(std::abs(dot(eigen_in_plane(f(at + along * 0.1)).vector[0], along)) == doctest::Approx(1));
      }
    }
  }
}

TEST_CASE("degenerate_points: a bilinear cell may hold two; on corners and edges there is one; indices sum to the turn of the border") {
  Context context;
  // f = x y - 0.06, g = x - y + 0.1: zeros where x = y - 0.1 and y (y - 0.1) = 0.06: y = 0.3, x = 0.2 and y = -0.2, x = -0.3.
  auto two = [](Vec3 p) { return SymTensor{1 + p.x * p.y - 0.06, 1 - p.x * p.y + 0.06, 0, p.x - p.y + 0.1, 0, 0}; };
  const DatasetPtr d = degenerate_points(tensor_grid({2, 2, 1}, {-1, -1, 0}, {1, 1, 0}, two), {}, context);
  REQUIRE(d->point_count() == 2);
  double sum = 0;
  for (size_t i = 0; i < 2; ++i) {
    const Vec3 p = point(d, i);
    CHECK(std::min(length(p - Vec3(0.2, 0.3, 0)), length(p - Vec3(-0.3, -0.2, 0))) < 1e-12);
    sum += value(d, "index", i);
  }
  CHECK(sum == doctest::Approx(index_around(two, {}, 0.9)));
  CHECK(length(point(d, 0) - point(d, 1)) > 0.1);
  for (Vec3 at : {Vec3(0, 0, 0), Vec3(0.25, 0, 0), Vec3(0.25, 0.25, 0)}) {  // a corner of six triangles, an edge, a diagonal
    CHECK(degenerate_points(turned_square(4, [&](Vec3 p) { return wedge(p - at); }), {}, context)->point_count() == 1);
    CHECK(degenerate_points(tensor_grid({5, 5, 1}, {-1, -1, 0}, {1, 1, 0}, [&](Vec3 p) { return wedge(p - at); }), {}, context)
              ->point_count() == 1);
  }
  // Many: the sum of the indices is the turn along the border.
  auto waves = [](Vec3 p) {
    return SymTensor{std::cos(5 * p.x + 1) + 0.3 * p.y, -std::cos(5 * p.x + 1) - 0.3 * p.y, 0, std::sin(4 * p.y + p.x + 0.4), 0, 0};
  };
  const DatasetPtr many = degenerate_points(turned_square(60, waves), {}, context);
  CHECK(many->point_count() >= 4);
  double total = 0, turn = 0, before = 0;
  for (size_t i = 0; i < many->point_count(); ++i) total += value(many, "index", i);
  for (int i = 0; i <= 4000; ++i) {
    const double s = i / 1000.0;
    const Vec3 p = s < 1   ? Vec3(-1 + 2 * s, -1, 0)
                   : s < 2 ? Vec3(1, -3 + 2 * s, 0)
                   : s < 3 ? Vec3(5 - 2 * s, 1, 0)
                           : Vec3(-1, 7 - 2 * s, 0);
    const SymTensor t = waves(p);
    const double angle = std::atan2(t.xy, (t.xx - t.yy) / 2) / 2, step = angle - before;
    if (i > 0) turn += step - M_PI * std::round(step / M_PI);
    before = angle;
  }
  CHECK(total == doctest::Approx(turn / (2 * M_PI)));
}

TEST_CASE("degenerate face: the seven forms make the discriminant; places are found to 1e-10") {
  for (uint64_t i = 0; i < 100; ++i) {
    double v[6], f[7];
    for (uint64_t k = 0; k < 6; ++k) v[k] = 2 * random_unit(1, 6 * i + k) - 1;
    const SymTensor d{v[0], v[1], v[2], v[3], v[4], v[5]};
    degeneracy_forms(d, f);
    const Eigen3 e = eigen_of(d);
    const double product = (e.value[0] - e.value[1]) * (e.value[1] - e.value[2]) * (e.value[2] - e.value[0]);
    const double sum = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3] + 15 * (f[4] * f[4] + f[5] * f[5] + f[6] * f[6]);
    CHECK(sum == doctest::Approx(product * product).epsilon(1e-9));
  }
  // Triangles with a known degenerate tensor inside.
  size_t others = 0;
  for (uint64_t i = 0; i < 200; ++i) {
    const bool planar = i % 2;
    const SymTensor in = rotated(planar ? diagonal(2, 2, -1) : diagonal(2, -1, -1), random_rotation(i));
    SymTensor c[3];
    const double s = 0.1 + 0.4 * random_unit(2, i), t = 0.1 + 0.4 * random_unit(3, i), w[3] = {1 - s - t, s, t};
    for (uint64_t k = 0; k < 2; ++k)
      c[k] = in + rotated(diagonal(random_unit(4, 9 * i + k), random_unit(5, 9 * i + k) - 1, random_unit(6, 9 * i + k)),
                          random_rotation(1000 + 2 * i + k));
    c[2] = (in - c[0] * w[0] - c[1] * w[1]) * (1 / w[2]);
    std::vector<DegeneratePlace> found;
    degenerate_places(c[0], c[1], c[2], found);
    bool there = false;
    for (const DegeneratePlace& x : found) {
      const SymTensor d = c[0] + (c[1] - c[0]) * x.s + (c[2] - c[0]) * x.t;
      const Eigen3 e = eigen_of(d);
      CHECK(std::min(e.value[0] - e.value[1], e.value[1] - e.value[2]) < 1e-10 * d.norm());
      if (std::abs(x.s - s) + std::abs(x.t - t) < 1e-9) {
        there = true;
        CHECK(x.planar == planar);
        CHECK(x.twice == doctest::Approx(planar ? 2 : -1));
        CHECK(x.once == doctest::Approx(planar ? -1 : 2));
      }
    }
    CHECK(there);
    others += found.size() - 1;
  }
  CHECK(others > 0);
}

TEST_CASE("degenerate_lines: a known straight line comes out whole on every mesh of solids, linear and planar") {
  // Two equal eigenvalues across z where x = 0.3 z + 0.05 and y = 0.1.
  auto f = [](Vec3 p, double third) {
    const double a = p.x - 0.3 * p.z - 0.05, b = p.y - 0.1;
    return SymTensor{a, -a, third, b, 0, 0};
  };
  Context context;
  for (double third : {9.0, -9.0}) {
    std::vector<DatasetPtr> meshes{tensor_grid({6, 7, 5}, {-1, -1, -1}, {1, 1, 1}, [&](Vec3 p) { return f(p, third); })};
    for (const char* kind : {"hexahedron", "tetra", "wedge", "pyramid", "voxel"}) {
      const DatasetPtr d = solid_mesh(kind, 3, 1, [](Vec3) { return 0.0; });
      meshes.push_back(with_tensors(
          d, [&](Vec3 p) { return f(p, third); }, places(d->as<UnstructuredMesh>()->points.xyz)));
    }
    for (const DatasetPtr& mesh : meshes) {
      INFO(std::string(mesh->kind()));
      DegenerateLinesParams p;
      p.perturb = 1e-9;
      const DatasetPtr l = degenerate_lines(mesh, p, context);
      REQUIRE(l->cell_count() == 1);
      CHECK(value(l, "type", 0) == (third > 0 ? 0 : 1));
      CHECK(value(l, "length", 0) == doctest::Approx(2 * std::sqrt(1.09)).epsilon(1e-6));
      for (size_t i = 0; i < l->point_count(); ++i) {
        const Vec3 q = point(l, i);
        CHECK(std::abs(q.x - 0.3 * q.z - 0.05) < 1e-6);
        CHECK(std::abs(q.y - 0.1) < 1e-6);
        CHECK(value(l, "single eigenvalue", i) == doctest::Approx(third));
        CHECK(std::abs(value(l, "axis", i, 2)) == doctest::Approx(1));
      }
    }
  }
}

TEST_CASE("degenerate_lines: a ring closes, and lines along edges of the cells are found by the perturbation") {
  Listener l;
  // Zeros where the distance from the axis is 0.6 and z = 0.03.
  const DatasetPtr grid = tensor_grid({17, 17, 9}, {-1, -1, -0.5}, {1, 1, 0.5}, [](Vec3 p) {
    const double a = p.x * p.x + p.y * p.y - 0.36, b = p.z - 0.03;
    return SymTensor{a, -a, 9, b, 0, 0};
  });
  const DatasetPtr ring = degenerate_lines(grid, {}, l.context);
  REQUIRE(ring->cell_count() == 1);
  CHECK(value(ring, "closed", 0) == 1);
  CHECK(value(ring, "length", 0) == doctest::Approx(2 * M_PI * 0.6).epsilon(0.02));
  // The axis of a field that is symmetric about it lies on edges of the grid.
  const DatasetPtr axis = degenerate_lines(
      tensor_grid({5, 5, 5}, {-1, -1, -1}, {1, 1, 1}, [](Vec3 p) { return SymTensor{p.x, -p.x, 9, p.y, 0, 0}; }), {}, l.context);
  double total = 0;
  for (size_t i = 0; i < axis->cell_count(); ++i) total += value(axis, "length", i);
  CHECK(total == doctest::Approx(2).epsilon(1e-3));
  CHECK(axis->cell_count() == 1);
  for (size_t i = 0; i < axis->point_count(); ++i) CHECK(std::hypot(point(axis, i).x, point(axis, i).y) < 1e-4);
}

TEST_CASE("degenerate points and lines: the same bytes for 1 and 8 threads; the wrong dimension is named") {
  const DatasetPtr volume = tensor_grid({14, 14, 14}, {-1, -1, -1}, {1, 1, 1}, [](Vec3 p) {
    return SymTensor{std::sin(2 * p.x), std::cos(3 * p.y), p.z, p.x * p.y, std::sin(p.z + p.x), p.y - 0.3};
  });
  const auto [a, b] = with_threads([&] {
    Context c;
    return degenerate_lines(volume, {}, c);
  });
  CHECK(a->point_count() > 20);
  CHECK(equal_fields(*a, *b));
  CHECK(equal_bytes(a->as<SurfaceMesh>()->points.xyz, b->as<SurfaceMesh>()->points.xyz));
  const DatasetPtr flat = tensor_grid({90, 90, 1}, {-1, -1, 0}, {1, 1, 0}, [](Vec3 p) {
    return SymTensor{std::sin(9 * p.x), std::cos(7 * p.y), 0, std::sin(5 * p.x * p.y + 1), 0, 0};
  });
  const auto [s, t] = with_threads([&] {
    Context c;
    return degenerate_points(flat, {}, c);
  });
  CHECK(s->point_count() > 4);
  CHECK(equal_fields(*s, *t));
  Context context;
  CHECK(error_of([&] { degenerate_points(volume, {}, context); }).find("slice it first, or use degenerate_lines") != std::string::npos);
  CHECK(error_of([&] { degenerate_lines(flat, {}, context); }).find("use degenerate_points for flat meshes") != std::string::npos);
  CHECK(error_of([&] { degenerate_points(tensor_points({diagonal(1, 2, 3)}), {}, context); }).find("has no degenerate points") !=
        std::string::npos);
  Listener l;
  const DatasetPtr same = tensor_grid({3, 3, 1}, {0, 0, 0}, {1, 1, 0}, [](Vec3) { return diagonal(2, 2, 1); });
  CHECK(degenerate_points(same, {}, l.context)->point_count() == 0);
  CHECK(l.notes.find("4 cells are degenerate throughout") != std::string::npos);
}

TEST_CASE("degenerate_lines: eigenvalues that are equal all over a surface are told of, a plain line is not") {
  Listener l;
  // Along the radius 0.36 - z^2, around the axis r^2: equal on a sphere.
  const DatasetPtr sphere = tensor_grid({33, 33, 33}, {-1, -1, -1}, {1, 1, 1}, [](Vec3 p) {
    const double r = p.x * p.x + p.y * p.y, c = r > 0 ? p.x * p.x / r : 1, s = 1 - c, cs = r > 0 ? p.x * p.y / r : 0;
    const double along = 0.36 - p.z * p.z;
    return SymTensor{along * c + r * s, along * s + r * c, 5, (along - r) * cs, 0, 0};
  });
  const DatasetPtr found = degenerate_lines(sphere, {}, l.context);
  CHECK(found->cell_count() > 100);
  CHECK(l.warnings.find("on whole surfaces") != std::string::npos);
  Listener quiet;
  const DatasetPtr axis = tensor_grid({17, 17, 17}, {-1, -1, -1}, {1, 1, 1}, [](Vec3 p) {
    return SymTensor{3, p.x + 0.03 - 0.1 * p.z, -p.x - 0.03 + 0.1 * p.z, 0, p.y + 0.011, 0};
  });
  CHECK(degenerate_lines(axis, {}, quiet.context)->cell_count() > 0);
  CHECK(quiet.warnings.empty());
}
