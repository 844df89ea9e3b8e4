// SPDX-License-Identifier: Apache-2.0
#include "filter/tensor/lines/tensor_lines.h"

#include "filter/tensor/lines/hyperstreamlines.h"
#include "filter/tensor/lines/tractography.h"
#include "filter/tensor/tensor_support.h"

using namespace sg;
using namespace sg::test;

namespace {

HyperstreamlinesParams lines_from(std::vector<double> seeds, TensorSection section = TensorSection::line) {
  HyperstreamlinesParams p;
  p.seeds = std::move(seeds), p.section = section, p.min_radius = 0;
  return p;
}

// A tensor whose eigenvectors turn about z: the first circles around the z-axis, the second points away from it.
SymTensor ring(Vec3 p) {
  const double r = std::hypot(p.x, p.y);
  return outer({-p.y / r, p.x / r, 0}, 3) + outer({p.x / r, p.y / r, 0}, 2) + outer({0, 0, 1}, 1);
}

}  // namespace

TEST_CASE("hyperstreamlines: a constant tensor gives straight lines along each eigenvector, from border to border, on every mesh kind") {
  Context context;
  std::vector<DatasetPtr> meshes;
  for (const std::string& kind : solid_kinds()) {
    const DatasetPtr d = solid_mesh(
        kind, 3, 1, [](Vec3) { return 0.0; }, 0.05);
    meshes.push_back(with_tensors(
        d, [](Vec3) { return constant; }, places(d->as<UnstructuredMesh>()->points.xyz)));
  }
  meshes.push_back(tensor_grid({9, 9, 9}, {-1, -1, -1}, {1, 1, 1}, [](Vec3) { return constant; }));
  CurvilinearGrid bent;
  bent.dims = {5, 6, 7};
  std::vector<double> xyz;
  std::vector<SymTensor> d;
  for (int k = 0; k < 7; ++k)
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 5; ++i) {
        const Vec3 p(-1 + i / 2.0, -1 + j / 2.5, -1 + k / 3.0);
        xyz.insert(xyz.end(), {p.x + 0.05 * std::sin(3 * p.y), p.y + 0.05 * std::sin(2 * p.z), p.z});
        d.push_back(constant);
      }
  bent.points.xyz = Array::from_vector(xyz, 3);
  FieldSet fields;
  fields.add(tensor_field(d));
  meshes.push_back(make_dataset(bent, fields));
  AmrGrid amr;
  amr.origin = {-1, -1, -1};
  amr.levels.push_back({{0.5, 0.5, 0.5}, {1, 1, 1}, {{{0, 0, 0}, {3, 3, 3}, 0, 0}}});
  FieldSet cells;
  cells.add(tensor_field(std::vector<SymTensor>(64, constant), Association::cell));
  meshes.push_back(make_dataset(amr, cells));

  const Eigen3 e = eigen_of(constant);
  for (const DatasetPtr& mesh : meshes)
    for (int k = 0; k < 3; ++k) {
      INFO(std::string(mesh->kind()), " ", k);
      HyperstreamlinesParams p = lines_from({0.05, 0.02, -0.03});
      p.eigenvector = k + 1;
      const DatasetPtr l = hyperstreamlines(mesh, p, context);
      const size_t n = l->point_count();
      REQUIRE(n > 8);
      for (size_t i = 0; i < n; ++i) {
        const Vec3 off = point(l, i) - Vec3(0.05, 0.02, -0.03);
        CHECK(length(off - e.vector[k] * dot(off, e.vector[k])) < 1e-12);
        CHECK(value(l, "eigenvalue", i) == doctest::Approx(e.value[k]));
      }
      for (size_t i = 1; i < n; ++i) CHECK(dot(point(l, i) - point(l, i - 1), point(l, n - 1) - point(l, 0)) > 0);
      CHECK(value(l, "length", n - 1) == doctest::Approx(length(point(l, n - 1) - point(l, 0))));
      CHECK(value(l, "stop", 0) == 0);
      // Both ends lie at the border: within 1/100 of the size.
      for (size_t end : {size_t(0), n - 1}) {
        const Vec3 q = point(l, end);
        const double reach = std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
        CHECK(reach > 0.93);
      }
    }
}

TEST_CASE("hyperstreamlines: the section of a constant tensor is an ellipse with the other two eigenvalues as half axes") {
  Context context;
  const DatasetPtr mesh = tensor_grid({9, 9, 9}, {-1, -1, -1}, {1, 1, 1}, [](Vec3) { return constant; });
  const Eigen3 e = eigen_of(constant);
  HyperstreamlinesParams p = lines_from({0, 0, 0}, TensorSection::ellipse);
  p.factor = 0.01, p.sides = 24;
  const DatasetPtr tube = hyperstreamlines(mesh, p, context);
  const Field& normals = tube->fields().require("Normals");
  CHECK(tube->point_count() % 24 == 0);
  double widest[2] = {0, 0};
  for (size_t i = 0; i < tube->point_count(); ++i) {
    const Vec3 off = point(tube, i);
    const double a = dot(off, e.vector[1]) / 0.02, b = dot(off, e.vector[2]) / 0.01;
    CHECK(a * a + b * b == doctest::Approx(1).epsilon(1e-4));
    widest[0] = std::max(widest[0], std::abs(a)), widest[1] = std::max(widest[1], std::abs(b));
    const Vec3 n(normals.array.get(i, 0), normals.array.get(i, 1), normals.array.get(i, 2));
    const Vec3 right = normalize(e.vector[1] * (a / 0.02) + e.vector[2] * (b / 0.01));
    CHECK(dot(n, right) == doctest::Approx(1).epsilon(1e-4));
  }
  CHECK(widest[0] == doctest::Approx(1).epsilon(1e-4));
  CHECK(widest[1] == doctest::Approx(1).epsilon(1e-4));
  p.section = TensorSection::cross;
  const DatasetPtr cross_of = hyperstreamlines(mesh, p, context);
  CHECK(cross_of->point_count() == tube->point_count() / 6);
  CHECK(std::abs(dot(point(cross_of, 1) - point(cross_of, 0), e.vector[1])) == doctest::Approx(0.04).epsilon(1e-4));
  CHECK(std::abs(dot(point(cross_of, 3) - point(cross_of, 2), e.vector[2])) == doctest::Approx(0.02).epsilon(1e-4));
  // Bounded and raised sections keep their meaning.
  p.section = TensorSection::ellipse, p.max_radius = 0.01;
  Listener l;
  CHECK(hyperstreamlines(mesh, p, l.context)->bounds().diagonal() < tube->bounds().diagonal());
  CHECK(l.notes.find("sections are scaled down to max_radius 0.01") != std::string::npos);
}

TEST_CASE("hyperstreamlines: circles close with the sign kept, radii stay; the order of the path is 4") {
  Context context;
  const DatasetPtr mesh = tensor_grid({41, 41, 3}, {-2, -2, -0.5}, {2, 2, 0.5}, ring);
  HyperstreamlinesParams p = lines_from({1.3, 0, 0});
  const DatasetPtr circle = hyperstreamlines(mesh, p, context);
  CHECK(value(circle, "stop", 0) == int(TensorStop::closed));
  CHECK(point(circle, 0) == point(circle, circle->point_count() - 1));
  CHECK(value(circle, "length", circle->point_count() - 1) == doctest::Approx(2 * M_PI * 1.3).epsilon(2e-3));
  for (size_t i = 1; i < circle->point_count(); ++i) {
    const Vec3 a = point(circle, i - 1), b = point(circle, i);
    CHECK(cross(a, b).z * cross(point(circle, 0), point(circle, 1)).z > 0);
    CHECK(std::hypot(b.x, b.y) == doctest::Approx(1.3).epsilon(2e-3));
  }
  p.eigenvector = 2;  // rays: they end where the tensor is bad, near the axis, or at the border
  const DatasetPtr ray = hyperstreamlines(mesh, p, context);
  for (size_t i = 0; i < ray->point_count(); ++i)
    if (point(ray, i).x > 0.3) CHECK(std::abs(point(ray, i).y) < 1e-9);
  // One cell whose tensor is linear: no error but the integrator's. Direction field of [[1+y, x], [x, 1-y]] (a trisector at 0).
  const DatasetPtr cell =
      tensor_grid({2, 2, 2}, {-2, -2, -2}, {2, 2, 2}, [](Vec3 q) { return SymTensor{1 + q.y, 1 - q.y, -50, q.x, 0, 0}; });
  auto end_of = [&](double step) {
    HyperstreamlinesParams s = lines_from({1, 0.3, 0});
    s.step = step, s.max_length = 0.8, s.direction = LineDirection::forward;
    const DatasetPtr l = hyperstreamlines(cell, s, context);
    return point(l, l->point_count() - 1);
  };
  const Vec3 right = end_of(0.8 / 4 / 512);
  double h[4], off[4];
  for (int i = 0; i < 4; ++i) {
    const int steps = 4 << i;
    h[i] = 1.0 / steps, off[i] = length(end_of(0.8 / 4 / steps) - right);
  }
  CHECK(observed_order(h, off, 4) == doctest::Approx(4).epsilon(0.08));
}

TEST_CASE("hyperstreamlines: they end at length, at degenerate places, at small eigenvalues, and where there is no value") {
  Context context;
  auto stop_of = [&](auto f, auto change) {
    const DatasetPtr mesh = tensor_grid({21, 5, 5}, {-1, -1, -1}, {1, 1, 1}, f);
    HyperstreamlinesParams p = lines_from({-0.51, 0.1, 0.1});
    change(p);
    const DatasetPtr l = hyperstreamlines(mesh, p, context);
    return std::pair(TensorStop(int(value(l, "stop", 0))), point(l, l->point_count() - 1).x);
  };
  auto nothing = [](HyperstreamlinesParams&) {};
  const auto length_stop = stop_of([](Vec3) { return diagonal(3, 2, 1); }, [](auto& p) { p.max_length = 0.7; });
  CHECK(length_stop.first == TensorStop::length);
  CHECK(length_stop.second == doctest::Approx(0.19));
  const auto degenerate =
      stop_of([](Vec3 q) { return diagonal(2 - q.x, 1, 0); }, [](auto& p) { p.min_gap = 0.25; });  // (1-x)/(2-x) = 1/4 at 2/3
  CHECK(degenerate.first == TensorStop::degenerate);
  CHECK(degenerate.second == doctest::Approx(2.0 / 3).epsilon(0.1));
  const auto small = stop_of([](Vec3 q) { return diagonal(2 - q.x, 0.1, 0); }, [](auto& p) { p.min_eigenvalue = 1.5; });
  CHECK(small.first == TensorStop::eigenvalue);
  CHECK(small.second == doctest::Approx(0.5).epsilon(0.1));
  const auto nan = stop_of([](Vec3 q) { return q.x > 0.55 ? diagonal(NAN, 1, 1) : diagonal(3, 2, 1); }, nothing);
  CHECK(nan.first == TensorStop::outside);
  CHECK(nan.second == doctest::Approx(0.5).epsilon(0.01));
  const auto steps = stop_of([](Vec3) { return diagonal(3, 2, 1); }, [](auto& p) { p.max_steps = 5; });
  CHECK(steps.first == TensorStop::steps);
}

TEST_CASE("hyperstreamlines: lines in a surface follow the part of the tensor in it") {
  Context context;
  // A plane across (1,1,1) in triangles with a 3D tensor.
  const Vec3 u = normalize(Vec3(1, -1, 0)), n = normalize(Vec3(1, 1, 1)), v = cross(n, u);
  SurfaceMesh mesh;
  std::vector<double> xyz;
  for (Vec3 p : {u * -1.0 + v * -1.0, u - v, u + v, v - u}) xyz.insert(xyz.end(), {p.x, p.y, p.z});
  mesh.points.xyz = Array::from_vector(xyz, 3);
  mesh.polygons.connectivity = Array::from_vector(std::vector<int32_t>{0, 1, 2, 0, 2, 3});
  mesh.polygons.fixed = 3;
  FieldSet fields;
  const Vec3 along = normalize(u * 2.0 + v);
  fields.add(tensor_field(std::vector<SymTensor>(4, outer(along, 2) + outer(n, 9) + outer(cross(n, along), 1))));
  HyperstreamlinesParams p = lines_from({0, 0, 0});
  const DatasetPtr l = hyperstreamlines(make_dataset(mesh, fields), p, context);
  CHECK(value(l, "eigenvalue", 0) == doctest::Approx(2));
  CHECK(value(l, "eigenvalue 3", 0) == doctest::Approx(9));
  const Vec3 run = point(l, l->point_count() - 1) - point(l, 0);
  CHECK(std::abs(dot(normalize(run), along)) == doctest::Approx(1));
  CHECK(length(run) == doctest::Approx(2 * std::sqrt(1.25)).epsilon(0.01));
}

TEST_CASE("hyperstreamlines: fields of the input go along, and the seeds of a second input are its points") {
  Context context;
  DatasetParts parts = tensor_grid({5, 5, 5}, {-1, -1, -1}, {1, 1, 1}, [](Vec3) { return diagonal(3, 2, 1); })->parts();
  std::vector<double> x;
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) x.push_back(-1 + i / 2.0);
  parts.fields.add({"x", Association::point, Array::from_vector(x), "m", Role::none});
  const DatasetPtr mesh = make_dataset(std::move(parts));
  const DatasetPtr seeds = tensor_points({{}, {}});  // (0,0,0) and (1,0,0)
  HyperstreamlinesParams p = lines_from({});
  p.section = TensorSection::ellipse;
  const DatasetPtr l = hyperstreamlines(mesh, seeds, p, context);
  double worst = 0;
  for (size_t i = 0; i < l->point_count(); ++i) worst = std::max(worst, std::abs(value(l, "x", i) - point(l, i).x));
  CHECK(worst < 0.001);  // caps stand across x
  CHECK(l->fields().require("x").unit == "m");
  CHECK(value(l, "seed", l->cell_count() - 1) == 1);
  p.section = TensorSection::line, p.eigenvector = 3;
  CHECK(hyperstreamlines(mesh, seeds, p, context)->cell_count() == 2);
}

TEST_CASE("tensor lines: log-Euclidean interpolation keeps the determinant between its ends; components swell") {
  Listener l;
  const DatasetPtr mesh =
      tensor_grid({2, 2, 2}, {0, 0, 0}, {1, 1, 1}, [](Vec3 p) { return p.x < 0.5 ? diagonal(4, 1, 1) : diagonal(1, 4, 1); });
  const TensorSampler components(mesh, {}, TensorInterpolation::components, "test", l.context),
      logs(mesh, {}, TensorInterpolation::log, "test", l.context);
  TensorCursor a(components), b(logs);
  SymTensor d;
  REQUIRE(a.tensor({0.5, 0.5, 0.5}, d));
  CHECK(d.determinant() == doctest::Approx(6.25));
  REQUIRE(b.tensor({0.5, 0.5, 0.5}, d));
  CHECK(d.determinant() == doctest::Approx(4));
  CHECK(d.xx == doctest::Approx(2));
  CHECK(!a.tensor({2, 0, 0}, d));
  CHECK(l.warnings.empty());
  const DatasetPtr bad = tensor_grid({2, 2, 2}, {0, 0, 0}, {1, 1, 1}, [](Vec3 p) { return diagonal(1, p.x - 0.5, 1); });
  const TensorSampler raised(bad, {}, TensorInterpolation::log, "test", l.context);
  CHECK(l.warnings.find("4 of 8 tensors have no logarithm") != std::string::npos);
  const DatasetPtr none = tensor_grid({2, 2, 2}, {0, 0, 0}, {1, 1, 1}, [](Vec3) { return diagonal(-1, -1, -1); });
  CHECK(error_of([&] {
          TensorSampler(none, {}, TensorInterpolation::log, "test", l.context);
        }).find("no tensor of 'tensor' has a positive eigenvalue") != std::string::npos);
}

TEST_CASE("tractography: fibres on a ring keep their radius, end at low anisotropy and at sharp turns") {
  Context context;
  auto fibres = [](Vec3 p) {
    const double r = std::hypot(p.x, p.y);
    if (std::abs(r - 1.25) > 0.5) return diagonal(1, 1, 1);
    return outer({-p.y / r, p.x / r, 0}, 1.7) + outer({p.x / r, p.y / r, 0}, 0.3) + outer({0, 0, 1}, 0.3);
  };
  const DatasetPtr mesh = tensor_grid({61, 61, 3}, {-2, -2, -0.2}, {2, 2, 0.2}, fibres);
  TractographyParams p;
  p.seeds = {1.25, 0, 0, 0.1, 0, 0, 5, 5, 5};
  const DatasetPtr ring_of = tractography(mesh, p, context);
  REQUIRE(ring_of->cell_count() == 1);  // low FA at the second seed, nothing at the third
  CHECK(value(ring_of, "line length", 0) == doctest::Approx(2 * M_PI * 1.25).epsilon(0.01));
  CHECK(value(ring_of, "mean FA", 0) == doctest::Approx(0.799).epsilon(0.03));
  for (size_t i = 0; i < ring_of->point_count(); ++i) CHECK(length(point(ring_of, i)) == doctest::Approx(1.25).epsilon(0.01));
  CHECK(ring_of->fields().require("direction").role == Role::colors);
  p.max_angle = 1;  // a cell of the ring turns 3 degrees
  CHECK(tractography(mesh, p, context)->cell_count() == 0);
  p.max_angle = 30, p.max_length = 1, p.min_length = 1.5;
  CHECK(value(tractography(mesh, p, context), "line length", 0) == doctest::Approx(2));
  p.min_length = 2.5;
  CHECK(tractography(mesh, p, context)->cell_count() == 0);
  // A stripe of low anisotropy ends straight fibres.
  const DatasetPtr stripe = tensor_grid({41, 3, 3}, {-1, -1, -1}, {1, 1, 1},
                                        [](Vec3 q) { return std::abs(q.x - 0.5) < 0.08 ? diagonal(1, 1, 1) : diagonal(1.7, 0.3, 0.3); });
  TractographyParams s;
  s.seeds = {-0.5, 0, 0};
  const DatasetPtr cut = tractography(stripe, s, context);
  CHECK(cut->bounds().hi.x < 0.46);
  CHECK(cut->bounds().hi.x > 0.38);
  CHECK(cut->bounds().lo.x < -0.99);
  // Seeds at every point, by stride and by mask.
  TractographyParams every;
  CHECK(tractography(stripe, every, context)->cell_count() == size_t(38 * 9));
  every.stride = 2;
  CHECK(tractography(stripe, every, context)->cell_count() == size_t(21 - 1) * 4);
}

TEST_CASE("tensor lines: the same bytes for 1 and 8 threads") {
  const DatasetPtr mesh = tensor_grid({21, 21, 21}, {-2, -2, -0.5}, {2, 2, 0.5}, [](Vec3 p) { return ring(p + Vec3(0.01, 0.02, 0)); });
  const auto [a, b] = with_threads([&] {
    Context c;
    HyperstreamlinesParams p;
    p.count = 40;
    return hyperstreamlines(mesh, p, c);
  });
  CHECK(a->cell_count() > 1000);
  CHECK(equal_fields(*a, *b));
  CHECK(equal_bytes(a->as<SurfaceMesh>()->points.xyz, b->as<SurfaceMesh>()->points.xyz));
  const auto [s, t] = with_threads([&] {
    Context c;
    TractographyParams p;
    p.stride = 4, p.max_length = 3;
    return tractography(mesh, p, c);
  });
  CHECK(s->cell_count() > 50);
  CHECK(equal_fields(*s, *t));
}

TEST_CASE("tensor lines: bad input is named, and what gives no line is told") {
  Listener l;
  const DatasetPtr mesh = tensor_grid({3, 3, 3}, {-1, -1, -1}, {1, 1, 1}, [](Vec3) { return diagonal(1, 1, 1); });
  const DatasetPtr none = hyperstreamlines(mesh, lines_from({0, 0, 0, 9, 9, 9}, TensorSection::ellipse), l.context);  // isotropic; outside
  CHECK(none->cell_count() == 0);
  CHECK(l.notes.find("2 of 2 seeds give no line") != std::string::npos);
  CHECK(error_of([&] { hyperstreamlines(mesh, lines_from({0, 0}), l.context); }).find("seeds has 2 numbers") != std::string::npos);
  CHECK(error_of([&] { tractography(tensor_points({diagonal(1, 2, 3)}), {}, l.context); }).find("has nothing between its points") !=
        std::string::npos);
  const DatasetPtr flat = tensor_grid({3, 3, 1}, {-1, -1, 0}, {1, 1, 0}, [](Vec3) { return diagonal(2, 1, 0); });
  HyperstreamlinesParams third = lines_from({0, 0, 0});
  third.eigenvector = 3;
  CHECK(error_of([&] { hyperstreamlines(flat, third, l.context); }).find("on a surface there are two eigenvectors") != std::string::npos);
  TractographyParams t;
  t.mask = {"brain"};
  CHECK(error_of([&] { tractography(mesh, t, l.context); }).find("'brain'") != std::string::npos);
  const DatasetPtr negative = tensor_grid({3, 3, 3}, {-1, -1, -1}, {1, 1, 1}, [](Vec3) { return diagonal(1, -1, -1); });
  tractography(negative, {}, l.context);
  CHECK(l.warnings.find("27 of 27 tensors of 'tensor' have negative eigenvalues") != std::string::npos);
}
