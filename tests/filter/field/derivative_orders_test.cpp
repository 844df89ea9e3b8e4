// SPDX-License-Identifier: Apache-2.0
// Orders of gradients and Hessians up to the border, on distorted meshes of every kind (correctness.md V12).
#include <map>

#include "data/cells/cell_reader.h"
#include "filter/field/derivatives/derivatives.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/smooth_distortion.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::distorted;

namespace {

struct Errors {
  double gradient = 0, hessian = 0;
};
struct Measured {
  Errors inside, all;
};

void keep(double& worst, double e) {
  if (!(e <= worst)) worst = std::isnan(e) ? HUGE_VAL : e;
}

// Largest errors of the derivatives of f on points or cells of a mesh of [-1,1]^3 or [-1,1]^2 that `d` distorts.
Measured measure(const DatasetPtr& straight, bool flat, bool on_cells, const Distortion& d, const Waves& f) {
  Mesh mesh = straight->mesh();
  const bool moved = move_points(mesh, d);
  DatasetParts parts = straight->parts();
  parts.mesh = mesh;
  const DatasetPtr bare = make_dataset(parts);
  std::vector<Vec3> before, at;
  if (on_cells) {
    CellReader a(straight), b(bare);
    const auto middle = [](const CellReader& r) {
      Vec3 s;
      for (const Vec3& p : r.at()) s += p;
      return s / double(r.at().size());
    };
    for (size_t c = 0; c < a.count(); ++c) a.open(c), b.open(c), before.push_back(middle(a)), at.push_back(middle(b));
  } else {
    const Array a = point_positions(straight->mesh()), b = point_positions(mesh);
    for (size_t i = 0; i < a.count(); ++i)
      before.emplace_back(a.get(i, 0), a.get(i, 1), a.get(i, 2)), at.emplace_back(b.get(i, 0), b.get(i, 1), b.get(i, 2));
  }
  std::vector<double> v;
  for (const Vec3& p : at) v.push_back(f.value(p));
  parts.fields.add({"wave", on_cells ? Association::cell : Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  Context context;
  const DatasetPtr r = hessian(gradient(make_dataset(std::move(parts)), {{"wave"}, "g"}, context), {{"wave"}, "h"}, context);
  const Array g = r->fields().require("g").array, h = r->fields().require("h").array;
  Measured m;
  for (size_t i = 0; i < at.size(); ++i) {
    Vec3 right = f.gradient(at[i]);
    Matrix second = f.hessian(at[i]);
    if (flat) along_surface(moved ? d : Distortion{}, before[i], right, second);
    double bend = 0;
    for (size_t a = 0; a < 3; ++a)
      for (size_t b = 0; b < 3; ++b) bend = std::max(bend, std::abs(h.get(i, int(3 * a + b)) - second[a][int(b)]));
    for (int a = 0; a < 9; ++a)
      if (std::isnan(h.get(i, a))) bend = NAN;
    const double slope = length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) - right);
    keep(m.all.gradient, slope), keep(m.all.hessian, bend);
    if (std::max({std::abs(before[i].x), std::abs(before[i].y), std::abs(before[i].z)}) < 0.55)
      keep(m.inside.gradient, slope), keep(m.inside.hessian, bend);
  }
  return m;
}

// Kinds whose cells are larger than the distance of their nodes.
bool has_inner_nodes(const MeshKind& kind) {
  return kind.name.find("lagrange") == 0 || kind.name.find("quadratic") != std::string::npos || kind.name.find("bezier") == 0 ||
         kind.name.find("curved") == 0;
}

// Kinds whose points have neighbours on both sides alike, so that errors of third order cancel.
bool alike_on_both_sides(const MeshKind& kind) {
  for (const char* name : {"uniform", "rotated", "rectilinear", "curvilinear", "hexahedron", "voxel", "tetra", "wedge", "polyhedron",
                           "triangles", "quads", "polygon cells", "pixel cells", "triangle cells"})
    if (kind.name == name) return true;
  return false;
}

}  // namespace

TEST_CASE(
    "derivative orders: gradients of second order, Hessians of second inside and falling up to the border, on distorted meshes of every "
    "kind, few cells") {
  Random random(1);
  const Distortion d = Distortion::random(random, 0.12);
  const Waves f = Waves::random(random, 3, 0.6, 1.6);
  for (const MeshKind& kind : every_mesh())
    for (const bool cells : {false, true}) {
      if (cells && kind.name == "strips") continue;  // each is a whole row: their middles lie on one line
      CAPTURE(kind.name);
      CAPTURE(cells);
      // Cells of high order are two or three times as large as their nodes lie apart.
      const int n = kind.flat ? cells ? 18 : 12 : cells && has_inner_nodes(kind) ? 12 : kind.name == "lagrange tetra" ? 9 : 6;
      const Measured a = measure(kind.make(n, 1), kind.flat, cells, d, f), b = measure(kind.make(2 * n, 1), kind.flat, cells, d, f);
      const auto order = [](double x, double y) { return std::log2(x / y); };
      CHECK(order(a.inside.gradient, b.inside.gradient) > 1.4);
      CHECK(order(a.all.gradient, b.all.gradient) > 1.4);
      if (!cells && alike_on_both_sides(kind)) CHECK(order(a.inside.hessian, b.inside.hessian) > 1.5);
      CHECK(order(a.all.hessian, b.all.hessian) > 0.5);
    }
}

TEST_CASE("derivative orders: Hessians of grids with straight axes, turned ones and AMR too, are of second order up to every border") {
  Random random(1);
  const Waves f = Waves::random(random, 3, 0.6, 1.6);
  for (const MeshKind& kind : every_mesh())
    for (const char* name : {"uniform", "rotated", "rectilinear", "amr", "flat uniform", "flat rectilinear", "flat amr"})
      for (const bool cells : {false, true}) {
        if (kind.name != name) continue;
        CAPTURE(kind.name);
        CAPTURE(cells);
        const Measured a = measure(kind.make(10, 1), kind.flat, cells, {}, f), b = measure(kind.make(20, 1), kind.flat, cells, {}, f);
        CHECK(std::log2(a.all.hessian / b.all.hessian) > 1.5);
        CHECK(b.all.hessian < 5 * b.inside.hessian);
      }
}

TEST_CASE("derivative orders: Hessians at points are of second order up to every border of distorted meshes of every kind") {
  Random random(1);
  const Distortion d = Distortion::random(random, 0.12);
  const Waves f = Waves::random(random, 3, 0.6, 1.6);
  // Four layers of a cubic have to be a small part of the mesh.
  const std::map<std::string, int> sizes{{"curvilinear", 12}, {"hexahedron", 12},          {"tetra", 12},           {"wedge", 12},
                                         {"pyramid", 12},     {"polyhedron", 12},          {"bent hexahedron", 14}, {"bent tetra", 12},
                                         {"mixed", 12},       {"flat curvilinear", 24},    {"triangles", 24},       {"quads", 24},
                                         {"polygons", 24},    {"quadratic hexahedron", 12}};
  size_t met = 0;
  for (const MeshKind& kind : every_mesh()) {
    const auto n = sizes.find(kind.name);
    if (n == sizes.end()) continue;
    ++met;
    CAPTURE(kind.name);
    const Measured a = measure(kind.make(n->second, 1), kind.flat, false, d, f),
                   b = measure(kind.make(2 * n->second, 1), kind.flat, false, d, f);
    CHECK(std::log2(a.all.hessian / b.all.hessian) > 1.7);
  }
  CHECK(met == sizes.size());
}

TEST_CASE("derivative orders: a flow that is a gradient has no vorticity up to the border of a wavy box of any cells") {
  Random random(5);
  const Distortion d = Distortion::random(random, 0.12);
  const Waves f = Waves::random(random, 3, 0.6, 1.6);
  for (const std::string kind : {"hexahedron", "wedge", "polyhedron", "pyramid", "tetra", "mixed"}) {
    CAPTURE(kind);
    double worst[2] = {0, 0};
    for (int level = 0; level < 2; ++level) {
      const DatasetPtr straight = solid_mesh(kind, 7 << level, 1, [](Vec3) { return 0.0; });
      const DatasetPtr mesh = flow::with_velocity(flow::moved(straight, d), [&](Vec3 p) { return f.gradient(p); });
      Context context;
      const Array w = curl(mesh, {{"u"}, "w"}, context)->fields().require("w").array;
      for (size_t i = 0; i < w.count(); ++i) keep(worst[level], length(Vec3(w.get(i, 0), w.get(i, 1), w.get(i, 2))));
    }
    CHECK(worst[1] < 0.15);
    CHECK(std::log2(worst[0] / worst[1]) > 1.3);
  }
}

TEST_CASE("derivative orders: a polyline of many points is followed point by point") {
  // A helix: the gradient along it of z is its slope.
  for (const bool closed : {false, true}) {
    double worst[2];
    for (int level = 0; level < 2; ++level) {
      const int n = 40 << level;
      SurfaceMesh m;
      std::vector<double> xyz, z;
      std::vector<int64_t> ids;
      const double turn = 2 * 3.14159265358979323846 / n;
      for (int i = 0; i < n; ++i) {
        xyz.insert(xyz.end(), {std::cos(turn * i), std::sin(turn * i), closed ? 0.1 * std::sin(2 * turn * i) : 0.5 * turn * i});
        z.push_back(xyz.back());
        ids.push_back(i);
      }
      if (closed) ids.push_back(0);
      m.points.xyz = Array::from_vector(std::move(xyz), 3);
      m.lines.offsets = Array::from_vector(std::vector<int64_t>{0, int64_t(ids.size())});
      m.lines.connectivity = Array::from_vector(std::move(ids));
      FieldSet fields;
      fields.add({"z", Association::point, Array::from_vector(std::move(z)), "", Role::scalars});
      Context context;
      const Array g = gradient(make_dataset(std::move(m), std::move(fields)), {}, context)->fields().require("gradient(z)").array;
      worst[level] = 0;
      for (int i = 0; i < n; ++i) {
        const double rise = closed ? 0.2 * std::cos(2 * turn * i) : 0.5;
        const Vec3 t(-std::sin(turn * i), std::cos(turn * i), rise);
        keep(worst[level], length(Vec3(g.get(size_t(i), 0), g.get(size_t(i), 1), g.get(size_t(i), 2)) - t * (rise / dot(t, t))));
      }
    }
    CHECK(worst[1] < 0.01);
    CHECK(std::log2(worst[0] / worst[1]) > 1.8);
  }
}

TEST_CASE("derivatives: one layer of cells keeps linear fields exact and says what it cannot know") {
  for (const bool bent : {false, true}) {
    DatasetPtr slab = make_dataset(uniform({6, 5, 2}, {0, 0, 0}, {1, 1, 0.25}));
    slab = to_unstructured(slab);
    DatasetParts parts = slab->parts();
    Random random(3);
    if (bent) move_points(parts.mesh, Distortion::random(random, 0.05));
    const Vec3 slope(0.5, -2, 3);
    const Array at = point_positions(parts.mesh);
    std::vector<double> v, w;
    for (size_t i = 0; i < at.count(); ++i) {
      const Vec3 p(at.get(i, 0), at.get(i, 1), at.get(i, 2));
      v.push_back(dot(slope, p)), w.push_back(p.x * p.x - 2 * p.x * p.y + p.y);
    }
    parts.fields.add({"linear", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
    parts.fields.add({"flat", Association::point, Array::from_vector(std::move(w)), "", Role::scalars});
    std::vector<std::string> said;
    Context context;
    context.on_log = [&](LogLevel level, std::string_view text) {
      if (level == LogLevel::warning) said.emplace_back(text);
    };
    const DatasetPtr d = make_dataset(std::move(parts));
    const Array g = gradient(d, {{"linear"}, "g"}, context)->fields().require("g").array;
    CHECK(said.size() == 1);
    CHECK(said.front().find("of 60 points 60 have") != std::string::npos);
    const Array h = hessian(d, {{"flat"}, "h"}, context)->fields().require("h").array;
    CHECK(said.size() == 2);
    const double second[9] = {2, -2, 0, -2, 0, 0, 0, 0, 0};
    for (size_t i = 0; i < g.count(); ++i) {
      CHECK(length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) - slope) < 1e-10);
      for (int k = 0; k < 9; ++k)
        if (!bent) CHECK(h.get(i, k) == doctest::Approx(second[k]).epsilon(1e-9));
        else CHECK(std::isfinite(h.get(i, k)));
    }
  }
}

TEST_CASE("derivatives: thin and slanting cells are no reason for warnings, and quadratic fields stay exact") {
  for (const double thin : {1.0, 1e-2, 1e-4}) {
    DatasetPtr box = make_dataset(uniform({6, 5, 5}, {0, 0, 0}, {1, 1, thin}));
    Context context;
    int said = 0;
    context.on_log = [&](LogLevel level, std::string_view) { said += level == LogLevel::warning; };
    box = to_unstructured(box);
    DatasetParts parts = box->parts();
    const Vec3 a = normalize(Vec3(1, 2, 0.5)), b = normalize(cross(a, Vec3(0, 0, 1))), c = cross(a, b);
    auto& mesh = std::get<UnstructuredMesh>(parts.mesh);
    mesh.points = {at_points(parts.mesh, [&](Vec3 p) { return a * (p.x + 0.5 * p.y) + b * p.y + c * p.z; }), {}};
    const Array at = point_positions(parts.mesh);
    std::vector<double> v;
    for (size_t i = 0; i < at.count(); ++i) {
      const Vec3 p(at.get(i, 0), at.get(i, 1), at.get(i, 2));
      v.push_back(1 + 2 * p.x * p.y - p.z * p.z + p.y * p.z);
    }
    parts.fields.add({"q", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
    const Array g = gradient(make_dataset(std::move(parts)), {{"q"}, "g"}, context)->fields().require("g").array;
    CHECK(said == 0);
    double worst = 0;
    for (size_t i = 0; i < g.count(); ++i) {
      const Vec3 p(at.get(i, 0), at.get(i, 1), at.get(i, 2));
      keep(worst, length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) - Vec3(2 * p.y, 2 * p.x + p.z, p.y - 2 * p.z)));
    }
    CHECK(worst < 1e-11 / thin);
  }
}

TEST_CASE("derivatives: a line that ends on a surface, and a face that is a cell of its own, do not disturb their neighbours") {
  // A flat sheet of quads with a line that rises from its middle.
  shapes::Builder sheet;
  std::vector<double> v;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) sheet.point({double(i), double(j), 0}), v.push_back(3.0 * i - j);
  const int64_t top = sheet.point({2, 2, 1});
  v.push_back(100);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      const int64_t a = i + 5 * j;
      sheet.polygon({a, a + 1, a + 6, a + 5});
    }
  SurfaceMesh m = sheet.mesh();
  m.lines.connectivity = Array::from_vector(std::vector<int64_t>{12, top});
  m.lines.offsets = Array::from_vector(std::vector<int64_t>{0, 2});
  FieldSet fields;
  fields.add({"v", Association::point, Array::from_vector(std::move(v)), "", Role::scalars});
  Context context;
  const Array g = gradient(make_dataset(std::move(m), std::move(fields)), {}, context)->fields().require("gradient(v)").array;
  for (size_t i = 0; i < 25; ++i) CHECK(length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) - Vec3(3, -1, 0)) < 1e-12);
}

TEST_CASE("property: derivatives of random waves on randomly distorted meshes of every kind are within a few times Taylor's remainder") {
  for (const uint64_t seed : property_seeds(40)) {
    CAPTURE(seed);
    Random random(seed);
    const auto& kinds = every_mesh();
    const MeshKind& kind = kinds[size_t(random.whole(0, int(kinds.size()) - 1))];
    const bool cells = random.chance(0.5) && kind.name != "strips";
    CAPTURE(kind.name);
    CAPTURE(cells);
    const int n = kind.flat ? random.whole(7, 16) : random.whole(5, 9);
    const Distortion d = Distortion::random(random, random.in(0, 0.15));
    const Waves f = Waves::random(random, 3, 1, 1.0);
    const Measured m = measure(kind.make(n, 1), kind.flat, cells, d, f);
    // Waves of 1 and wave numbers of 1: third derivatives are of order 1. Cells of high order are larger than the distance of their nodes.
    const double h = 2.0 / n * (has_inner_nodes(kind) ? cells ? 3 : 1.5 : 1);
    CHECK(m.all.gradient < 4 * h * h);
    CHECK(m.all.hessian < 6 * h);
  }
}

TEST_CASE("property: derivatives of quadratic fields are exact on solids with random points, those of linear ones with holes in them") {
  for (const uint64_t seed : property_seeds(60)) {
    CAPTURE(seed);
    Random random(seed);
    const auto& kinds = solid_kinds();
    const std::string kind = kinds[size_t(random.whole(0, int(kinds.size()) - 1))];
    const bool cells = random.chance(0.3);
    const double scale = random.magnitude(1e-12, 1e12), shake = random.in(0, 0.25),
                 thin = random.chance(0.5) ? 1 : random.magnitude(1e-3, 1);
    CAPTURE(kind);
    CAPTURE(cells);
    const DatasetPtr box = solid_mesh(kind, random.whole(2, 4), 1, [](Vec3) { return 0.0; });
    DatasetParts parts = box->parts();
    parts.fields = {};
    const Mat3 turn = random_rotation(random);
    auto& mesh = std::get<UnstructuredMesh>(parts.mesh);
    mesh.points = {at_points(parts.mesh,
                             [&](Vec3 p) {
                               const Vec3 q = p + 0.4 * shake * Vec3(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
                               return turn * Vec3(q.x, q.y, q.z * thin) * scale;
                             }),
                   {}};
    Matrix second{};
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) second[size_t(i)][j] = second[size_t(j)][i] = random.in(-1, 1) / scale;
    const Vec3 slope(random.in(-1, 1), random.in(-1, 1), random.in(-1, 1));
    const bool linear = random.chance(0.3);
    if (linear) second = {};
    const DatasetPtr bare = make_dataset(parts);
    std::vector<Vec3> at;
    if (cells) {
      CellReader r(bare);
      for (size_t c = 0; c < r.count(); ++c) {
        r.open(c);
        Vec3 s;
        for (const Vec3& p : r.at()) s += p;
        at.push_back(s / double(r.at().size()));
      }
    } else {
      const Array a = point_positions(bare->mesh());
      for (size_t i = 0; i < a.count(); ++i) at.emplace_back(a.get(i, 0), a.get(i, 1), a.get(i, 2));
    }
    std::vector<double> v;
    for (const Vec3& p : at) {
      double sum = dot(slope, p);
      for (int i = 0; i < 3; ++i) sum += 0.5 * p[i] * dot(second[size_t(i)], p);
      v.push_back(linear && random.chance(0.1) ? NAN : sum);
    }
    parts.fields.add({"q", cells ? Association::cell : Association::point, Array::from_vector(v), "", Role::scalars});
    int said = 0, flat = 0;
    Context context;
    context.on_log = [&](LogLevel level, std::string_view text) {
      said += level == LogLevel::warning, flat += text.find("line or plane") != std::string_view::npos;
    };
    const DatasetPtr d = make_dataset(std::move(parts));
    const Array g = gradient(d, {{"q"}, "g"}, context)->fields().require("g").array;
    const Array h = hessian(d, {{"q"}, "h"}, context)->fields().require("h").array;
    const bool full = said == 0;
    double worst = 0, worst_bend = 0;
    for (size_t i = 0; i < at.size(); ++i) {
      if (std::isnan(v[i])) continue;
      Vec3 right = slope;
      for (int a = 0; a < 3; ++a) right[a] += dot(second[size_t(a)], at[i]);
      if (!full && (!linear || flat)) continue;  // of lower order, and said
      if (linear && said && std::isnan(g.get(i, 0))) continue;
      keep(worst, length(Vec3(g.get(i, 0), g.get(i, 1), g.get(i, 2)) - right));
      for (int a = 0; a < 9; ++a)
        if (full) keep(worst_bend, scale * std::abs(h.get(i, a) - second[size_t(a / 3)][a % 3]));
    }
    CHECK(worst < 1e-8 / thin);
    CHECK(worst_bend < 1e-6 / thin / thin);
  }
}
