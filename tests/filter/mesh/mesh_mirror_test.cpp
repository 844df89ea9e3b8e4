// SPDX-License-Identifier: Apache-2.0
// What is turned, scaled and mirrored is the same thing elsewhere: operations and transforms may change places.
#include "data/cells/cell_cases.h"
#include "data/cells/point_positions.h"
#include "data/cells/shape/cell_map.h"
#include "filter/every_mesh.h"
#include "filter/field/derivatives/derivatives.h"
#include "filter/field/derivatives/gradient.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/transform/transform.h"
#include "filter/stats/integrate.h"
#include "filter/surface/normals.h"
#include "filter/tensor/tensor_measures.h"
#include "support/property.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

struct Moved {
  Mat3 m;
  Vec3 shift;
  TransformParams params;
  double det() const { return determinant(m); }
  Vec3 operator()(Vec3 p) const { return m * p + shift; }
};

// A rotation about a random axis, scaled and perhaps mirrored along the axes before it; `grid`: no rotation.
Moved random_map(Random& random, bool even, bool grid = false) {
  Vec3 u;
  do u = {random.in(-1, 1), random.in(-1, 1), random.in(-1, 1)};
  while (!(length(u) > 0.1 && length(u) < 1));
  u = normalize(u);
  const double a = grid ? 0 : random.in(-3, 3), c = std::cos(a), s = std::sin(a), size = random.magnitude(0.1, 10);
  const double cross_matrix[3][3] = {{0, -u.z, u.y}, {u.z, 0, -u.x}, {-u.y, u.x, 0}};
  Moved r;
  for (int j = 0; j < 3; ++j) {
    const double scale = (random.chance(0.5) ? -1 : 1) * (even ? size : random.magnitude(0.3, 3));
    for (int i = 0; i < 3; ++i) r.m.m[i][j] = scale * ((i == j ? c : 0.0) + s * cross_matrix[i][j] + (1 - c) * u[i] * u[j]);
  }
  r.shift = {random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) r.params.matrix.push_back(r.m.m[i][j]);
    r.params.matrix.push_back(r.shift[i]);
  }
  for (double x : {0.0, 0.0, 0.0, 1.0}) r.params.matrix.push_back(x);
  return r;
}

double distance(const Array& a, const Array& b) {
  REQUIRE(a.count() == b.count());
  REQUIRE(a.components() == b.components());
  double most = 0, size = 1e-300;
  for (size_t i = 0; i < a.count(); ++i)
    for (int c = 0; c < a.components(); ++c) {
      const double x = a.get(i, c), y = b.get(i, c);
      if (std::isnan(x) && std::isnan(y)) continue;
      size = std::max(size, std::abs(y));
      if (!(std::abs(x - y) <= most)) most = std::abs(x - y);
    }
  return most / size;
}

// Signed measures of all cells.
std::vector<double> measures(const DatasetPtr& d) {
  CellMap map(d);
  std::vector<double> r;
  for (size_t c = 0; c < d->cell_count(); ++c) map.open(c), r.push_back(map.measure());
  return r;
}

// Solid meshes whose lattice axes make a left-handed system, before any mirror.
bool left_handed(const DatasetPtr& d) {
  for (const double v : measures(d))
    if (v < 0) return is_lattice(d->mesh());
  return false;
}

// The mesh with a scalar, a vector and tensors that are linear in space and that nothing marks.
DatasetPtr with_fields(const DatasetPtr& mesh, Random& random) {
  double k[40];
  for (double& x : k) x = random.in(-1, 1);
  DatasetPtr d = with_values(mesh, "f", 1, [&](Vec3 p, double* v) { *v = 0.3 + k[0] * p.x + k[1] * p.y + k[2] * p.z; });
  d = with_values(d, "u", 3, [&](Vec3 p, double* v) {
    for (int c = 0; c < 3; ++c) v[c] = k[3 + c] + k[6 + c] * p.x + k[9 + c] * p.y + k[12 + c] * p.z;
  });
  const auto tensor = [&](Vec3 p, double* v) {
    for (int c = 0; c < 6; ++c) v[c] = k[15 + c] + k[21 + c] * p.x + k[27 + c] * p.y + k[33 + c] * p.z;
    for (int c = 0; c < 3; ++c) v[c] += 8;
  };
  d = with_values(d, "T6", 6, tensor);
  return with_values(d, "T9", 9, [&](Vec3 p, double* v) {
    double t[6];
    tensor(p, t);
    const int place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
    for (int c = 0; c < 9; ++c) v[c] = t[place[c]];
  });
}

const Array& values(const DatasetPtr& d, const std::string& name) { return d->fields().require(name).array; }

}  // namespace

TEST_CASE("mirror: cells of every type and order keep the sign of their volume, and their functions") {
  Context ctx;
  std::vector<CellCase> cases = fixed_cases();
  for (const CellCase& c : order_cases(1, 6)) cases.push_back(c);
  Random random(1);
  for (const CellCase& c : cases) {
    CAPTURE(c.name());
    const CellShape& s = c.shape();
    if (s.dimension() < 2) continue;
    std::vector<Vec3> at;
    std::vector<double> f;
    for (size_t k = 0; k < s.nodes(); ++k) {
      at.push_back(s.node(k) + random_vector(7, k) * 0.02);
      f.push_back(random.in(1, 2));
    }
    std::vector<double> weights;
    if (is_bezier(c.type))
      for (size_t k = 0; k < s.nodes(); ++k) weights.push_back(random.in(0.8, 1.2));
    DatasetParts parts = one_cell(c.type, at, c.orders, weights)->parts();
    parts.fields.add({"f", Association::point, Array::from_vector(f), "", Role::none});
    const DatasetPtr in = make_dataset(parts), out = transform(in, {.scale = {-1, 2, 0.5}}, ctx);
    const double near = is_bezier(c.type) ? 1e-5 : 1e-12;  // quadrature of rational functions is not exact
    // Exact: the lengths along y and z make up for each other in space, not on surfaces.
    if (s.dimension() == 3) {
      REQUIRE(measures(in)[0] > 0);
      CHECK(measures(out)[0] == doctest::Approx(measures(in)[0]).epsilon(near));
      CHECK(values(out, "f").get(0) == f[0]);
      const TablePtr a = integrate(in, {{"f"}}, ctx), b = integrate(out, {{"f"}}, ctx);
      for (size_t i = 0; i < a->columns.size(); ++i)
        if (a->columns[i].name == "integral")
          CHECK(b->columns[i].array.get(0) == doctest::Approx(a->columns[i].array.get(0)).epsilon(near));
    } else {
      // The vector area of the mirrored cell points where the inverse transpose says.
      const auto area = [](const DatasetPtr& d) {
        CellMap map(d);
        map.open(0);
        const CellShape& shape = *CellShape::find(map.reader().type(), map.reader().ids().size(), map.reader().orders());
        Vec3 sum;
        const auto& q = shape.quadrature(12);
        for (size_t i = 0; i < q.at.size(); ++i) {
          const Mat3 j = map.jacobian(q.at[i]);
          sum += cross(j.column(0), j.column(1)) * q.weight[i];
        }
        return sum;
      };
      const Vec3 n = area(in), want = n * Vec3(-1, 0.5, 2);
      CHECK(length(area(out) - want) < 1e3 * near * length(want));
    }
  }
}

TEST_CASE("mirror: prisms, polyhedra, polygons and strips are listed the other way round") {
  Context ctx;
  for (const int n : {5, 6}) {
    std::vector<Vec3> at;
    for (double z : {0.0, 1.0})
      for (int k = 0; k < n; ++k) at.emplace_back(std::cos(2 * M_PI * k / n), std::sin(2 * M_PI * k / n), z);
    const DatasetPtr in = one_cell(n == 5 ? CellType::pentagonal_prism : CellType::hexagonal_prism, at);
    const DatasetPtr out = transform(in, {.scale = {1, -1, 1}}, ctx);
    CHECK(measures(out)[0] == doctest::Approx(measures(in)[0]));
    CHECK(measures(out)[0] > 0);
  }
  const auto area = [](const DatasetPtr& d) {  // sum of the vector areas of the triangles
    CellReader r(d);
    Vec3 sum;
    for (size_t c = 0; c < r.count(); ++c) {
      r.open(c);
      if (r.type() != CellType::triangle_strip) {
        sum += polygon_vector_area(r.at().first(r.type() == CellType::quadratic_polygon ? r.at().size() / 2 : r.at().size()));
        continue;
      }
      for (size_t k = 0; k + 2 < r.at().size(); ++k) {
        const Vec3 a = r.at()[k], b = r.at()[k + 1 + k % 2], e = r.at()[k + 2 - k % 2];
        sum += cross(b - a, e - a);
      }
    }
    return sum;
  };
  for (const CellType type : {CellType::polygon, CellType::quadratic_polygon, CellType::triangle_strip})
    for (size_t n = type == CellType::quadratic_polygon ? 6 : 3; n < 10; n += type == CellType::quadratic_polygon ? 2 : 1) {
      CAPTURE(n);
      std::vector<Vec3> at;
      const size_t corners = type == CellType::quadratic_polygon ? n / 2 : n;
      for (size_t k = 0; k < n; ++k) {
        const double a = 2 * M_PI * (double(k % corners) + (k < corners ? 0 : 0.5)) / double(corners), z = k < corners ? 0 : 0.1;
        if (type == CellType::triangle_strip) at.emplace_back(double(k), double(k % 2), 0.1 * double(k * k));
        else at.emplace_back(std::cos(a), std::sin(a), z);
      }
      DatasetParts parts = one_cell(type, at)->parts();
      parts.fields.add({"c", Association::cell, Array::from_vector(std::vector<double>{7}), "", Role::none});
      const DatasetPtr in = make_dataset(parts), out = transform(in, {.scale = {-1, 1, 1}}, ctx);
      CHECK(length(area(out) - area(in) * Vec3(-1, 1, 1)) < 1e-12);
      for (size_t c = 0; c < out->cell_count(); ++c) CHECK(values(out, "c").get(c) == 7);
    }
  // The same strips in a surface, with a cell field over all kinds of cells.
  SurfaceMesh s;
  std::vector<double> xyz;
  for (int k = 0; k < 8; ++k) xyz.insert(xyz.end(), {double(k), double(k % 2), 0.1 * k * k});
  s.points.xyz = Array::from_vector(std::move(xyz), 3);
  s.polygons = {Array::from_vector(std::vector<int64_t>{0, 1, 2}), Array::from_vector(std::vector<int64_t>{0, 3}), 0};
  s.strips = {Array::from_vector(std::vector<int64_t>{0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2}), Array::from_vector(std::vector<int64_t>{0, 8, 11}),
              0};
  FieldSet fields;
  fields.add({"c", Association::cell, Array::from_vector(std::vector<double>{1, 2, 3}), "", Role::none});
  const DatasetPtr in = make_dataset(s, fields), out = transform(in, {.scale = {-1, 1, 1}}, ctx);
  CHECK(length(area(out) - area(in) * Vec3(-1, 1, 1)) < 1e-12);
  REQUIRE(out->cell_count() == 4);
  for (size_t c = 0; c < 4; ++c) CHECK(values(out, "c").get(c) == std::array<double, 4>{1, 2, 2, 3}[c]);
}

TEST_CASE("mirror: points and cells of mirrored grids are numbered anew with their fields, and spacing is positive") {
  Context ctx;
  const DatasetPtr in = meshes::uniform_box(4, 3, 2);
  const DatasetPtr out = transform(in, {.scale = {1, -2, 1}}, ctx);
  const UniformGrid& g = *out->as<UniformGrid>();
  CHECK(g.spacing.y > 0);
  CHECK(determinant(g.direction) > 0);
  const Array at = point_positions(out->mesh());
  for (size_t i = 0; i < at.count(); ++i)  // f = x + 2 y + 3 z - 1 of the place before
    REQUIRE(values(out, "f").get(i) == doctest::Approx(at.get(i, 0) - at.get(i, 1) + 3 * at.get(i, 2) - 1));
  CHECK(values(out, "c").get(0) == 8);  // the last row of cells came first
  // AMR grids likewise; their patches keep their order.
  const DatasetPtr amr = with_values(flow::amr_cube(4, 1), "f", 1, [](Vec3 p, double* v) { *v = p.x + 2 * p.y + 3 * p.z; });
  const DatasetPtr turned = transform(amr, {.scale = {-1, -1, 2}, .translate = {1, 2, 3}}, ctx);
  for (const auto& level : turned->as<AmrGrid>()->levels)
    for (int a = 0; a < 3; ++a) CHECK(level.spacing[a] > 0);
  const Array places = point_positions(turned->mesh());
  for (size_t i = 0; i < places.count(); ++i)
    REQUIRE(values(turned, "f").get(i) ==
            doctest::Approx(1 - places.get(i, 0) + 2 * (2 - places.get(i, 1)) + 3 * (places.get(i, 2) - 3) / 2));
}

TEST_CASE("transform: tensors, gradients and axial vectors follow their laws, colours stay") {
  Context ctx;
  FieldSet fields;
  const auto add = [&](const char* name, int n, std::vector<double> v, Role role = Role::none) {
    fields.add({name, Association::point, Array::from_vector(std::move(v), n), "", role});
  };
  add("stress", 9, {1, 2, 3, 2, 5, 6, 3, 6, 9}, Role::tensors);
  add("six", 6, {1, 5, 9, 2, 6, 3});
  add("upper", 6, {1, 2, 3, 5, 6, 9}, Role::tensors);
  add("plain", 3, {1, 2, 3});
  add("vertex_rgb", 3, {1, 2, 3});
  add("gradient(p)", 3, {1, 2, 3}, Role::vectors);
  add("slope", 3, {1, 2, 3});
  add("vorticity", 3, {1, 2, 3}, Role::vectors);
  add("flat", 2, {1, 2}, Role::vectors);
  add("seven", 7, {1, 1, 2, 3, 5, 6, 9});
  fields.add({"ints", Association::point, Array::from_vector(std::vector<int16_t>{1, 2, 3}, 3), "", Role::vectors});
  const DatasetPtr in = make_dataset(PointCloud{{Array::from_vector(std::vector<double>{0, 0, 0}, 3), {}}}, fields);
  const auto list = [](const DatasetPtr& d, const char* name) {
    const Array& a = values(d, name);
    std::vector<double> v;
    for (int c = 0; c < a.components(); ++c) v.push_back(a.get(0, c));
    return v;
  };
  using List = std::vector<double>;
  TransformParams p;
  p.scale = {-2, 1, 1};
  p.fields.gradients = {"slope"};
  const DatasetPtr out = transform(in, p, ctx);
  CHECK(list(out, "stress") == List{4, -4, -6, -4, 5, 6, -6, 6, 9});
  CHECK(list(out, "six") == List{4, 5, 9, -4, 6, -6});
  CHECK(list(out, "plain") == List{-2, 2, 3});
  CHECK(list(out, "vertex_rgb") == List{1, 2, 3});
  CHECK(list(out, "gradient(p)") == List{-0.5, 2, 3});
  CHECK(list(out, "slope") == List{-0.5, 2, 3});
  CHECK(list(out, "flat") == List{-2, 2});
  CHECK(list(out, "ints") == List{-2, 2, 3});
  CHECK(list(out, "seven") == List{1, 1, 2, 3, 5, 6, 9});
  CHECK(list(transform(in, {.scale = {-1, 1, 1}}, ctx), "vorticity") == List{1, -2, -3});
  p.fields.keep = {"stress", "plain"}, p.fields.turn = {"seven"}, p.fields.order = TensorOrder::upper;
  const DatasetPtr other = transform(in, p, ctx);
  CHECK(list(other, "stress") == List{1, 2, 3, 2, 5, 6, 3, 6, 9});
  CHECK(list(other, "plain") == List{1, 2, 3});
  CHECK(list(other, "upper") == List{4, -4, -6, 5, 6, 9});
  CHECK(list(other, "seven") == List{1, 4, -4, -6, 5, 6, 9});
  // What leaves the plane gets the components that it needs.
  CHECK(list(transform(in, {.axis = {1, 0, 0}, .angle = 90}, ctx), "flat") == List{1, 0, 2});
  p = {};
  p.scale = {-1, 1, 1}, p.fields.unmarked = false;
  CHECK(list(transform(in, p, ctx), "plain") == List{1, 2, 3});
  p.fields.turn = {"seventh"};
  CHECK(error_of([&] { transform(in, p, ctx); }).find("seven") != std::string::npos);
}

TEST_CASE("property: volumes, integrals and outward faces are those of the mesh before a transform") {
  Context ctx;
  for (uint64_t seed : property_seeds(6))
    for (const MeshKind& kind : every_mesh()) {
      CAPTURE(seed);
      CAPTURE(kind.name);
      Random random(seed);
      const DatasetPtr in = with_fields(kind.make(4, 1), random);
      const Moved map = random_map(random, kind.flat, in->as<AmrGrid>());
      CAPTURE(map.det());
      const DatasetPtr out = transform(in, map.params, ctx);
      const double factor = kind.flat ? std::pow(std::abs(map.det()), 2.0 / 3) : std::abs(map.det());
      const TablePtr a = integrate(in, {{"f"}}, ctx), b = integrate(out, {{"f"}}, ctx);
      for (size_t i = 0; i < a->columns.size(); ++i)
        if (a->columns[i].name == "integral" || a->columns[i].name == "measure")
          CHECK(b->columns[i].array.get(0) == doctest::Approx(factor * a->columns[i].array.get(0)).epsilon(1e-8));
      if (kind.flat) continue;
      const std::vector<double> before = measures(in), after = measures(out);
      REQUIRE(before.size() == after.size());
      const bool was_left = left_handed(in);
      double total = 0, all = 0;
      for (size_t c = 0; c < before.size(); ++c) {
        total += std::abs(before[c]), all += after[c] * (is_lattice(out->mesh()) && was_left && map.det() > 0 ? -1 : 1);
        if (!is_lattice(out->mesh()) && !in->as<AmrGrid>())
          REQUIRE(after[c] == doctest::Approx(std::abs(map.det()) * before[c]).epsilon(1e-9));
      }
      if (is_lattice(out->mesh()) || in->as<AmrGrid>()) CHECK(all == doctest::Approx(factor * total).epsilon(1e-9));
      if (!in->as<AmrGrid>())
        CHECK(meshes::measure(*faces(out, {}, ctx)->as<SurfaceMesh>()).volume >
              0.9 * factor * meshes::measure(*faces(in, {}, ctx)->as<SurfaceMesh>()).volume);
    }
}

TEST_CASE("property: derivatives of what was transformed are the transformed derivatives") {
  Context ctx;
  for (uint64_t seed : property_seeds(6))
    for (const MeshKind& kind : every_mesh()) {
      CAPTURE(seed);
      CAPTURE(kind.name);
      Random random(seed + 1000);
      const DatasetPtr in = with_fields(kind.make(4, 1), random);
      const Moved map = random_map(random, kind.flat, in->as<AmrGrid>());
      const DatasetPtr out = transform(in, map.params, ctx);
      CHECK(distance(values(gradient(out, {{"f"}, ""}, ctx), "gradient(f)"),
                     values(transform(gradient(in, {{"f"}, ""}, ctx), map.params, ctx), "gradient(f)")) < 1e-6);
      CHECK(distance(values(gradient(out, {{"u"}, ""}, ctx), "gradient(u)"),
                     values(transform(gradient(in, {{"u"}, ""}, ctx), map.params, ctx), "gradient(u)")) < 1e-6);
      if (kind.flat) continue;
      // Without uneven scales the curl is known too.
      const Moved even = random_map(random, true, in->as<AmrGrid>());
      CHECK(distance(values(curl(transform(in, even.params, ctx), {{"u"}, ""}, ctx), "curl(u)"),
                     values(transform(curl(in, {{"u"}, ""}, ctx), even.params, ctx), "curl(u)")) < 1e-6);
    }
}

TEST_CASE("property: tensor measures and their directions turn with the tensors") {
  Context ctx;
  for (uint64_t seed : property_seeds(10))
    for (const char* name : {"T6", "T9"}) {
      CAPTURE(seed);
      Random random(seed + 2000);
      const DatasetPtr in = with_fields(solid_mesh("mixed", 2, 1, [](Vec3) { return 0.0; }), random);
      const Moved map = random_map(random, true);
      const DatasetPtr out = transform(in, map.params, ctx);
      const double size2 = std::pow(std::abs(map.det()), 2.0 / 3);
      TensorMeasuresParams p;
      p.tensors.field = {name};
      const DatasetPtr a = tensor_measures(in, p, ctx), b = tensor_measures(out, p, ctx);
      for (const char* each : {"FA", "mode", "cl", "cp", "cs"}) CHECK(distance(values(b, each), values(a, each)) < 1e-6);
      for (size_t i = 0; i < in->point_count(); ++i)
        CHECK(values(b, "MD").get(i) == doctest::Approx(size2 * values(a, "MD").get(i)).epsilon(1e-9));
      TensorEigenParams e;
      e.tensors = p.tensors;
      const DatasetPtr turned = transform(tensor_eigen(in, e, ctx), map.params, ctx), own = tensor_eigen(out, e, ctx);
      for (size_t i = 0; i < in->point_count(); ++i) {
        Vec3 x, y;
        for (int c = 0; c < 3; ++c) x[c] = values(turned, "eigenvector 1").get(i, c), y[c] = values(own, "eigenvector 1").get(i, c);
        CHECK(std::abs(dot(normalize(x), y)) > 1 - 1e-6);
      }
    }
}

TEST_CASE("property: streamlines of an unmarked velocity turn with the mesh, on every kind of it") {
  Context ctx;
  for (uint64_t seed : property_seeds(6))
    for (const MeshKind& kind : every_mesh()) {
      CAPTURE(seed);
      CAPTURE(kind.name);
      Random random(seed + 3000);
      const DatasetPtr in = with_values(kind.make(4, 1), "u", 3,
                                        [&](Vec3 p, double* v) { v[0] = -p.y + 0.1, v[1] = p.x, v[2] = kind.flat ? 0 : 0.1 * p.z + 0.05; });
      const Moved map = random_map(random, kind.flat, in->as<AmrGrid>());
      const DatasetPtr out = transform(in, map.params, ctx);
      TraceOptions o;
      o.scheme = Scheme::rk4, o.unit = StepUnit::time, o.step = 0.05, o.max_steps = 40;
      const auto line = [&](const DatasetPtr& d, Vec3 start) {
        const FlowField flow(d, "", ctx);
        const Vec3 seeds[] = {start};
        return trace_lines(flow, seeds, TraceDirection::forward, o, ctx);
      };
      const Vec3 start{random.in(-0.3, 0.3), random.in(-0.3, 0.3), kind.flat ? 0 : random.in(-0.3, 0.3)};
      const TracedLines a = line(in, start), b = line(out, map(start));
      REQUIRE(a.lines() == 1);
      REQUIRE(b.lines() == 1);
      REQUIRE(a.points.size() == b.points.size());
      for (size_t i = 0; i < a.points.size(); ++i) REQUIRE(length(inverse(map.m) * (b.points[i] - map.shift) - a.points[i]) < 1e-5);
    }
}

TEST_CASE("property: normals of a surface made before or after a transform are the same") {
  Context ctx;
  const DatasetPtr shapes[] = {shapes::sphere(2).dataset(), shapes::torus(16, 8, 1, 0.3).dataset(), shapes::cylinder(12, 1).dataset(),
                               flat_surface("strips", 4, 1), flat_surface("polygons", 4, 1)};
  for (uint64_t seed : property_seeds(10))
    for (const DatasetPtr& in : shapes) {
      CAPTURE(seed);
      Random random(seed + 4000);
      const Moved map = random_map(random, true);
      const NormalsParams p{.feature_angle = 180, .orient = Facing::keep};
      const DatasetPtr a = transform(normals(in, p, ctx), map.params, ctx), b = normals(transform(in, map.params, ctx), p, ctx);
      CHECK(distance(values(b, "Normals"), values(a, "Normals")) < 1e-5);
    }
}
