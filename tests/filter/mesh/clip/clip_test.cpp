// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/clip/clip.h"

#include <cstring>

#include "base/parallel.h"
#include "base/random.h"
#include "data/trusted.h"
#include "filter/cell_meshes.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "filter/mesh/to_unstructured.h"
#include "filter/stats/integrate.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;

namespace {

double measure(const DatasetPtr& d) {
  if (d->cell_count() == 0) return 0;
  Context ctx;
  DatasetParts p;
  p.mesh = d->mesh();
  p.fields.add(meshes::make_field("one", Association::cell, std::vector<double>(d->cell_count(), 1.0)));
  const TablePtr t = integrate(make_dataset(std::move(p)), {}, ctx);
  for (const Field& f : t->columns)
    if (f.name == "integral") return f.array.get(0);
  FAIL("no integral");
  return 0;
}

std::pair<DatasetPtr, DatasetPtr> halves(const DatasetPtr& d, ClipParams p) {
  Context ctx;
  p.keep = ClipSide::both;
  const auto c = std::get<CollectionPtr>(clip(d, p, ctx));
  REQUIRE(c->parts.size() == 2);
  return {std::get<DatasetPtr>(c->parts[0].data), std::get<DatasetPtr>(c->parts[1].data)};
}

double noise(Vec3 p) { return std::sin(17 * p.x + 3) * std::cos(23 * p.y) + std::sin(29 * p.z * p.x + 11 * p.y); }

}  // namespace

TEST_CASE("clip: inside and outside add up to the whole for every kind of cell") {
  for (const std::string& kind : solid_kinds())
    for (const auto& f : {+[](Vec3 p) { return p.x + 0.7 * p.y - 0.3 * p.z - 0.05; }, +[](Vec3 p) { return p.x + p.y; },
                          +[](Vec3 p) { return 0.7 - dot(p, p); }, +[](Vec3 p) { return noise(p); }, +[](Vec3 p) { return p.z; }}) {
      CAPTURE(kind);
      const DatasetPtr mesh = solid_mesh(kind, 4, 1.0, f);
      ClipParams p;
      p.value = 0.0;
      const auto [in, out] = halves(mesh, p);
      CHECK(measure(mesh) == doctest::Approx(8).epsilon(1e-13));
      CHECK(std::abs(measure(in) + measure(out) - 8) < 8e-12);
      CHECK(measure(in) > 0.1);
      CHECK(measure(out) > 0.1);
    }
}

namespace {

// A lattice of [-1,1]^3 with the field f.
template <class F>
DatasetPtr box_lattice(int kind, size_t n, F&& f) {
  const std::vector<double> axis = even_axis(n);
  std::vector<double> v, xyz, c(n * n * n);
  for (const Vec3 p : lattice_places(axis)) v.push_back(f(p)), xyz.insert(xyz.end(), {p.x, p.y, p.z});
  for (size_t i = 0; i < c.size(); ++i) c[i] = double(i);
  FieldSet fields;
  fields.add(meshes::make_field("f", Association::point, v));
  fields.add(meshes::make_field("p", Association::point, xyz, 3));
  fields.add(meshes::make_field("c", Association::cell, c));
  return make_dataset(lattice_mesh(kind, axis), std::move(fields));
}

// Faces of a solid that no other cell shares must lie on the box or where f is the value.
void check_joined(const DatasetPtr& d, double value) {
  Context ctx;
  const DatasetPtr skin = faces(d, {}, ctx);
  const SurfaceMesh& s = *skin->as<SurfaceMesh>();
  const CellsView v = cells_view(s.polygons);
  const Array& f = skin->fields().require("f").array;
  for (size_t c = 0; c < v.count; ++c) {
    bool cut = true, box = false;
    for (int a = 0; a < 3; ++a)
      for (const double side : {-1.0, 1.0}) {
        bool all = true;
        for (size_t k = 0; k < v.size(c); ++k) all = all && std::abs(s.points.at(size_t(v.point(c, k)))[a] - side) < 1e-9;
        box = box || all;
      }
    for (size_t k = 0; k < v.size(c); ++k) cut = cut && std::abs(f.get(size_t(v.point(c, k))) - value) < 1e-6;
    REQUIRE((cut || box));
  }
}

}  // namespace

TEST_CASE("clip: lattices of all kinds give the volumes of lists of cells, noise and planes through points included") {
  for (const auto& f : {+[](Vec3 p) { return noise(p); }, +[](Vec3 p) { return p.x + p.y; }, +[](Vec3 p) { return p.z; },
                        +[](Vec3 p) { return 0.7 - dot(p, p); }})
    for (int kind = 0; kind < 3; ++kind) {
      const DatasetPtr d = box_lattice(kind, 6, f);
      ClipParams p;
      p.value = 0.0;
      const auto [in, out] = halves(d, p);
      const auto [in2, out2] = halves(to_unstructured(d), p);
      CHECK(std::abs(measure(in) + measure(out) - 8) < 8e-12);
      CHECK(std::abs(measure(in) - measure(in2)) < 1e-12);
      CHECK(in->cell_count() == in2->cell_count());
      CHECK(in->point_count() == in2->point_count());
      CHECK(out->point_count() == out2->point_count());
      // Point fields are interpolated with the points, cell fields follow their cells.
      const Array &at = in->as<UnstructuredMesh>()->points.xyz, &carried = in->fields().require("p").array;
      for (size_t i = 0; i < at.count(); ++i)
        for (int c = 0; c < 3; ++c) REQUIRE(std::abs(at.get(i, c) - carried.get(i, c)) < 1e-6);
      const Array &c = in->fields().require("c").array, &o = in->fields().require("original_cell").array;
      for (size_t i = 0; i < c.count(); ++i) REQUIRE(c.get(i) == o.get(i));
    }
}

TEST_CASE("clip: pieces share their faces with whole cells and with each other") {
  for (const auto& f :
       {+[](Vec3 p) { return p.x + 0.7 * p.y - 0.3 * p.z - 0.05; }, +[](Vec3 p) { return noise(p); }, +[](Vec3 p) { return p.x - p.y; }}) {
    Context ctx;
    for (const std::string kind : {"tetra", "hexahedron", "voxel", "mixed"}) {
      CAPTURE(kind);
      ClipParams p;
      p.value = 0.0;
      for (const ClipSide keep : {ClipSide::inside, ClipSide::outside}) {
        p.keep = keep;
        check_joined(std::get<DatasetPtr>(clip(solid_mesh(kind, 4, 1.0, f), p, ctx)), 0);
      }
    }
    ClipParams p;
    p.value = 0.0;
    check_joined(std::get<DatasetPtr>(clip(box_lattice(0, 5, f), p, ctx)), 0);
  }
}

TEST_CASE("clip: a sphere's volume converges with order 2 on every mesh, its points lie on it") {
  Context ctx;
  ClipParams p;
  p.sphere = {0, 0, 0, 0.8};
  double error[2];
  for (int r = 0; r < 2; ++r) {
    const DatasetPtr d = std::get<DatasetPtr>(clip(box_lattice(0, r ? 32 : 16, [](Vec3 x) { return x.x; }), p, ctx));
    error[r] = 4.0 / 3 * M_PI * 0.512 - measure(d);
  }
  CHECK(std::log2(error[0] / error[1]) > 1.8);
  CHECK(std::log2(error[0] / error[1]) < 2.2);
  p.keep = ClipSide::both;
  for (const std::string& kind : solid_kinds()) {
    const DatasetPtr mesh = solid_mesh(kind, 5, 1.0, [](Vec3 x) { return x.x; });
    const auto [in, out] = halves(mesh, p);
    CHECK(std::abs(measure(in) + measure(out) - 8) < 8e-12);
    double furthest = 0;
    const Points& points = in->as<UnstructuredMesh>()->points;
    for (size_t i = 0; i < points.count(); ++i) furthest = std::max(furthest, length(points.at(i)));
    CHECK(std::abs(furthest - 0.8) < 1e-12);
  }
}

TEST_CASE("isovolume: three parts between values add up to the whole") {
  Context ctx;
  for (const std::string& kind : solid_kinds())
    for (const auto& f : {+[](Vec3 p) { return p.x + 0.7 * p.y - 0.3 * p.z; }, +[](Vec3 p) { return noise(p); }}) {
      CAPTURE(kind);
      const DatasetPtr mesh = solid_mesh(kind, 4, 1.0, f);
      double sum = 0;
      for (const auto& [lo, hi] : {std::pair<double, double>{-10, -0.1}, {-0.1, 0.15}, {0.15, 10}}) {
        IsovolumeParams p;
        p.min = lo, p.max = hi;
        const DatasetPtr d = isovolume(mesh, p, ctx);
        sum += measure(d);
        const Range r = d->range(d->fields().require("f"));
        CHECK(r.lo >= lo - 1e-6);
        CHECK(r.hi <= hi + 1e-6);
      }
      if (f(Vec3(1, 0, 0)) == 1) CHECK(std::abs(sum - 8) < 8e-12);
      else CHECK(std::abs(sum - 8) < 0.1);  // cells cut twice are cut one way here and another way there
    }
  IsovolumeParams p;
  p.min = 0, p.max = 0.2;
  CHECK(measure(isovolume(box_lattice(0, 7, [](Vec3 x) { return x.x; }), p, ctx)) == doctest::Approx(0.8).epsilon(1e-12));
}

TEST_CASE("clip: flat cells, lines, surfaces and clouds") {
  Context ctx;
  SurfaceMesh s;
  s.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 2, 0, 0, 2, 1, 0}, 3);
  s.vertices = {Array::from_vector(std::vector<int32_t>{0}), {}, 1};
  s.lines = {Array::from_vector(std::vector<int32_t>{0, 4, 5}), {}, 3};
  s.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3}), {}, 4};
  s.strips = {Array::from_vector(std::vector<int32_t>{1, 4, 2, 5}), {}, 4};
  ClipParams p;
  p.origin = Vec3(0.3, 0.6, 0);
  p.normal = {1, 1, 0};
  const auto [in, out] = halves(make_dataset(s), p);
  REQUIRE(in->as<SurfaceMesh>());
  CHECK(measure(in) + measure(out) == doctest::Approx(2).epsilon(1e-13));
  CHECK(measure(in) == doctest::Approx(0.405).epsilon(1e-13));
  CHECK(in->as<SurfaceMesh>()->vertices.size() == 1);
  CHECK(out->as<SurfaceMesh>()->lines.size() == 2);
  const auto [low, high] = halves(meshes::uniform_box(7, 5, 0), p);
  CHECK(measure(low) + measure(high) == doctest::Approx(1).epsilon(1e-13));
  const auto [left, right] = halves(meshes::uniform_box(5, 0, 0), p);
  CHECK(measure(left) == doctest::Approx(0.9).epsilon(1e-13));
  CHECK(measure(right) == doctest::Approx(0.1).epsilon(1e-12));
  const DatasetPtr cloud = make_dataset(PointCloud{{Array::from_vector(std::vector<double>{0, 0, 0, 1, 1, 0, 0.3, 0.6, 0}, 3), {}}});
  const auto [near, far] = halves(cloud, p);
  CHECK(near->point_count() == 2);
  CHECK(far->point_count() == 1);
}

TEST_CASE("clip: concave polygons by a plane, curved cells, AMR, a closed mesh, an expression") {
  Context ctx;
  SurfaceMesh u;  // a U: three bars of one, two legs
  u.points.xyz = Array::from_vector(std::vector<double>{0, 0, 0, 3, 0, 0, 3, 3, 0, 2, 3, 0, 2, 1, 0, 1, 1, 0, 1, 3, 0, 0, 3, 0}, 3);
  u.polygons = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 3, 4, 5, 6, 7}), {}, 8};
  ClipParams p;
  p.axis = CutAxis::y, p.position = 2;
  const auto [below, above] = halves(make_dataset(u), p);
  CHECK(above->cell_count() == 2);
  CHECK(measure(above) == doctest::Approx(2));
  CHECK(measure(below) == doctest::Approx(5));

  p = {};
  p.function = "x^2+y^2-0.25";
  const auto [in, out] = halves(box_lattice(0, 24, [](Vec3 x) { return x.x; }), p);
  CHECK(measure(in) == doctest::Approx(2 * M_PI * 0.25).epsilon(0.01));
  p.function = "f-0.5";
  const auto [low, high] = halves(box_lattice(0, 8, [](Vec3 x) { return x.x; }), p);
  CHECK(measure(low) == doctest::Approx(6).epsilon(1e-9));
  p = {};
  const DatasetPtr ball = std::get<DatasetPtr>(clip(
      box_lattice(0, 8, [](Vec3 x) { return x.x; }), nullptr,
      [] {
        ClipParams q;
        q.box = {-0.5, 0.5, -0.5, 0.5, -0.5, 0.5};
        return q;
      }(),
      ctx));
  CHECK(measure(ball) == doctest::Approx(1).epsilon(1e-9));
  const DatasetPtr inner = std::get<DatasetPtr>(clip(box_lattice(0, 8, [](Vec3 x) { return x.x; }), ball, p, ctx));
  CHECK(measure(inner) == doctest::Approx(1).epsilon(1e-6));
  const DatasetPtr curved = meshes::solid_box(CellType::lagrange_hexahedron, 2, 2);
  const auto [a, b] = halves(curved, p);
  CHECK(measure(a) + measure(b) == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("clip: NaN and hidden cells stay out, one-cell and empty meshes are fine, the same bytes for any number of threads") {
  Context ctx;
  ClipParams p;
  p.value = 0.0;
  DatasetParts parts = box_lattice(0, 4, [](Vec3 x) { return x.x > 0.9 ? NAN : x.x - 0.1; })->parts();
  CHECK(measure(std::get<DatasetPtr>(clip(make_dataset(parts), p, ctx))) == doctest::Approx(4 * 0.4).epsilon(1e-12));
  parts = box_lattice(0, 4, [](Vec3 x) { return x.x - 0.1; })->parts();
  std::vector<uint8_t> ghost(64, 0);
  for (size_t i = 0; i < 64; ++i) ghost[i] = i % 4 == 3 ? ghost_hidden_cell : i % 4 == 2 && i < 16 ? ghost_duplicate : 0;
  parts.cell_ghost = Array::from_vector(ghost);
  const DatasetPtr visible = std::get<DatasetPtr>(clip(make_dataset(parts), p, ctx));
  CHECK(measure(visible) == doctest::Approx(3 * 0.4).epsilon(1e-12));
  CHECK(visible->range(visible->fields().require("p"), 2).lo >= -0.5 - 1e-9);
  const auto [one, other] = halves(box_lattice(0, 1, [](Vec3 x) { return noise(x); }), p);
  CHECK(measure(one) + measure(other) == doctest::Approx(8).epsilon(1e-13));
  std::string note;
  ctx.on_log = [&](LogLevel, std::string_view t) { note = t; };
  p.value = 100;
  const DatasetPtr none = std::get<DatasetPtr>(clip(box_lattice(0, 3, [](Vec3 x) { return x.x; }), p, ctx));
  CHECK(none->cell_count() == 0);
  CHECK(none->fields().find("f", Association::point));
  CHECK(note.find("nothing is left") != std::string::npos);
  CHECK(none->fields().require("original_cell").role == Role::global_ids);  // numbers, nothing to colour by
  p.value = 0;
  for (const DatasetPtr& d :
       {box_lattice(0, 40, [](Vec3 x) { return noise(x); }), solid_mesh("mixed", 14, 1.0, [](Vec3 x) { return noise(x); })}) {
    set_thread_count(1);
    const DatasetPtr a = std::get<DatasetPtr>(clip(d, p, ctx));
    set_thread_count(8);
    const DatasetPtr b = std::get<DatasetPtr>(clip(d, p, ctx));
    set_thread_count(0);
    const auto &ma = *a->as<UnstructuredMesh>(), &mb = *b->as<UnstructuredMesh>();
    CHECK(same_bytes(ma.points.xyz, mb.points.xyz));
    CHECK(same_bytes(ma.cells.connectivity, mb.cells.connectivity));
    CHECK(same_bytes(ma.types, mb.types));
    CHECK(same_bytes(a->fields().require("f").array, b->fields().require("f").array));
  }
}

TEST_CASE("clip: mistakes say what would be right") {
  Context ctx;
  const DatasetPtr box = box_lattice(0, 2, [](Vec3 x) { return x.x; });
  auto says = [&](auto&& change, const char* what) {
    ClipParams p;
    change(p);
    const std::string e = error_of([&] { clip(box, p, ctx); });
    CAPTURE(e);
    CHECK(e.find(what) != std::string::npos);
  };
  says([](ClipParams& p) { p.normal = {0, 0, 0}; }, "normal is zero");
  says([](ClipParams& p) { p.sphere = {0, 0, 0, 0}; }, "radius 0 is not positive");
  says([](ClipParams& p) { p.sphere = {0, 0, 0}; }, "needs 4 numbers, not 3");
  says([](ClipParams& p) { p.cylinder = {0, 0, 0, 0, 0, 0, 1}; }, "direction is zero");
  says([](ClipParams& p) { p.cylinder = {0, 0, 0, 0, 0, 1, -1}; }, "not positive");
  says([](ClipParams& p) { p.box = {0, 1, 1, 0, 0, 1}; }, "empty along y");
  says([](ClipParams& p) { p.quadric = std::vector<double>(10, 0.0); }, "constant");
  says([](ClipParams& p) { p.quadric = {1, NAN, 0, 0, 0, 0, 0, 0, 0, 0}; }, "not finite");
  says([](ClipParams& p) { p.function = "x +* 2"; }, "function");
  says([](ClipParams& p) { p.sphere = {0, 0, 0, 1}, p.function = "x"; }, "both given");
  says([](ClipParams& p) { p.sphere = {0, 0, 0, 1}, p.value = 1; }, "both a shape and a field");
  says([](ClipParams& p) { p.field = {"c"}; }, "not a point field");
  says([](ClipParams& p) { p.field = {"g"}; }, "g");
  says([](ClipParams& p) { p.value = INFINITY; }, "not finite");
  IsovolumeParams p;
  p.min = 2, p.max = 1;
  CHECK(error_of([&] { isovolume(box, p, ctx); }).find("above max") != std::string::npos);
}

TEST_CASE("slice: spheres, cylinders, quadrics and expressions have their area, points lie on them") {
  Context ctx;
  auto area = [](const DatasetPtr& d) { return measure(d); };
  const DatasetPtr lattice = box_lattice(0, 20, [](Vec3 x) { return x.x; });
  for (const DatasetPtr& d :
       {lattice, box_lattice(2, 20, [](Vec3 x) { return x.x; }), solid_mesh("tetra", 12, 1.0, [](Vec3 x) { return x.x; }),
        solid_mesh("mixed", 12, 1.0, [](Vec3 x) { return x.x; })}) {
    SliceParams p;
    p.sphere = {0, 0, 0, 0.8};
    const DatasetPtr s = slice(d, p, ctx);
    CHECK(area(s) == doctest::Approx(4 * M_PI * 0.64).epsilon(0.02));
    for (size_t i = 0; i < s->point_count(); ++i) REQUIRE(std::abs(length(s->as<SurfaceMesh>()->points.at(i)) - 0.8) < 1e-12);
    CHECK(s->fields().find("f", Association::point));
    CHECK(s->fields().find("original_cell", Association::cell));
    p = {};
    p.cylinder = {0, 0, 0, 0, 0, 2, 0.5};
    CHECK(area(slice(d, p, ctx)) == doctest::Approx(2 * M_PI * 0.5 * 2).epsilon(0.02));
    p = {};
    p.quadric = {1, 1, 0, 0, 0, 0, 0, 0, 0, -0.25};
    CHECK(area(slice(d, p, ctx)) == doctest::Approx(2 * M_PI * 0.5 * 2).epsilon(0.02));
    p = {};
    p.function = "x^2+y^2-0.25";
    CHECK(area(slice(d, p, ctx)) == doctest::Approx(2 * M_PI * 0.5 * 2).epsilon(0.02));
  }
}

TEST_CASE("slice: three planes in one word, and several along an axis") {
  Context ctx;
  const DatasetPtr box = box_lattice(0, 9, [](Vec3 x) { return x.x; });
  SliceParams p;
  p.planes = CutPlanes::xyz;
  const DatasetPtr three = slice(box, p, ctx);
  CHECK(measure(three) == doctest::Approx(12).epsilon(1e-12));
  CHECK(three->range(three->fields().require("plane")).hi == 2);
  p = {};
  p.axis = CutAxis::z, p.positions = {-0.5, 0.1, 0.2, 5};
  CHECK(measure(slice(box, p, ctx)) == doctest::Approx(12).epsilon(1e-12));
  p.axis = CutAxis::none;
  CHECK(error_of([&] { slice(box, p, ctx); }).find("need an axis") != std::string::npos);
}

TEST_CASE("slice: rows of a lattice give what its cells give as lists") {
  Context ctx;
  for (int kind = 0; kind < 2; ++kind)
    for (const Vec3 n :
         {Vec3(0.48, 0.36, 0.8), Vec3(-1, 2, -3), Vec3(0, 1, 0.3), Vec3(0, 0, 1), Vec3(-1, 0, 0), Vec3(1, 1, 0), Vec3(0, -1, 0)})
      for (const Vec3 o : {Vec3(0.03, -0.02, 0.05), Vec3(0, 0, 0), Vec3(0.9, 0.9, 0.9), Vec3(1, 1, 1)}) {
        const DatasetPtr box = box_lattice(kind, 10, [](Vec3 x) { return x.x; });
        SliceParams p;
        p.origin = o, p.normal = n;
        const DatasetPtr a = slice(box, p, ctx), b = slice(to_unstructured(box), p, ctx);
        CHECK(a->cell_count() == b->cell_count());
        CHECK(a->point_count() == b->point_count());
        CHECK(measure(a) == doctest::Approx(measure(b)).epsilon(1e-12));
        const auto& m = *a->as<SurfaceMesh>();
        const CellsView v = cells_view(m.polygons);
        const Array& carried = a->fields().require("p").array;
        for (size_t c = 0; c < v.count; ++c) {
          std::vector<Vec3> at;
          for (size_t k = 0; k < v.size(c); ++k) at.push_back(m.points.at(size_t(v.point(c, k))));
          REQUIRE(dot(polygon_vector_area(at), n) > 0);
        }
        for (size_t i = 0; i < a->point_count(); ++i) REQUIRE(std::abs(m.points.at(i).x - carried.get(i, 0)) < 1e-6);
      }
}

TEST_CASE("clip: meshes taken without a second check pass it, values on the level and single ones on it included") {
  Context ctx;
  for (const auto& f : {+[](Vec3 p) { return noise(p); }, +[](Vec3 p) { return std::floor(4 * noise(p)); }, +[](Vec3 p) { return p.x; }})
    for (const DatasetPtr& d :
         {box_lattice(0, 70, f), box_lattice(2, 9, f), solid_mesh("tetra", 9, 1.0, f), solid_mesh("mixed", 5, 1.0, f)}) {
      ClipParams p;
      p.value = 0.0;
      const auto [in, out] = halves(d, p);
      CHECK_NOTHROW(validate(in->mesh()));
      CHECK_NOTHROW(validate(out->mesh()));
      CHECK(in->cell_count() > 0);
      CHECK(out->cell_count() > 0);
      ThresholdParams q;
      q.min = 0.0;
      const DatasetPtr t = threshold(d, q, ctx);
      CHECK_NOTHROW(validate(t->mesh()));
      CHECK(t->range(t->fields().require("f")).lo >= 0);
    }
}

TEST_CASE("clip: tetrahedra, alone or among other cells, and rows of a lattice are the same bytes for one and eight threads") {
  Context ctx;
  ClipParams p;
  p.value = 0.0;
  for (const DatasetPtr& d :
       {solid_mesh("tetra", 14, 1.0, [](Vec3 x) { return noise(x); }), box_lattice(1, 70, [](Vec3 x) { return noise(x); })})
    for (const ClipSide keep : {ClipSide::inside, ClipSide::outside}) {
      p.keep = keep;
      set_thread_count(1);
      const DatasetPtr a = std::get<DatasetPtr>(clip(d, p, ctx));
      set_thread_count(8);
      const DatasetPtr b = std::get<DatasetPtr>(clip(d, p, ctx));
      set_thread_count(0);
      const auto &ma = *a->as<UnstructuredMesh>(), &mb = *b->as<UnstructuredMesh>();
      CHECK(same_bytes(ma.points.xyz, mb.points.xyz));
      CHECK(same_bytes(ma.cells.connectivity, mb.cells.connectivity));
      CHECK(same_bytes(ma.cells.offsets, mb.cells.offsets));
      CHECK(same_bytes(ma.types, mb.types));
      CHECK(same_bytes(a->fields().require("original_cell").array, b->fields().require("original_cell").array));
    }
}

TEST_CASE("trusted datasets: sizes of fields are looked at all the same, and only their own mesh goes unchecked") {
  DatasetParts parts = box_lattice(0, 2, [](Vec3 x) { return x.x; })->parts();
  FieldSet wrong;
  wrong.add(meshes::make_field("f", Association::point, std::vector<double>(5, 0.0)));
  parts.fields = wrong;
  CHECK(error_of([&] { make_trusted_dataset(parts); }).find("5 tuples") != std::string::npos);
  UnstructuredMesh broken;
  broken.points.xyz = Array::from_vector(std::vector<double>(12, 0.0), 3);
  broken.cells = {Array::from_vector(std::vector<int32_t>{0, 1, 2, 4}), {}, 4};
  broken.single_type = CellType::tetra;
  CHECK(error_of([&] { make_dataset(broken); }).find("point id 4") != std::string::npos);  // also after a call that threw
}

TEST_CASE("clip and slice: fields of normals keep their length between points") {
  Context ctx;
  const DatasetPtr grid = to_unstructured(meshes::uniform_box(5, 5, 5), {}, ctx);
  DatasetParts parts = grid->parts();
  std::vector<float> unit, plain;
  for (size_t i = 0; i < grid->point_count(); ++i) {
    const double a = 2.1 * double(i), b = 0.7 * double(i);
    for (double x : {std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)})
      unit.push_back(float(x)), plain.push_back(float(x));
  }
  parts.fields.add({"n", Association::point, Array::from_vector(std::move(unit), 3), "", Role::normals});
  parts.fields.add({"v", Association::point, Array::from_vector(std::move(plain), 3), "", Role::vectors});
  const DatasetPtr in = make_dataset(std::move(parts));
  const Vec3 center = in->bounds().center(), normal{1, 0.3, 0.2};
  ClipParams clipped;
  clipped.origin = center, clipped.normal = normal;
  for (const DatasetPtr& d : {slice(in, {.origin = center, .normal = normal}, ctx), std::get<DatasetPtr>(clip(in, clipped, ctx))}) {
    const Field &n = d->fields().require("n", Association::point), &v = d->fields().require("v", Association::point);
    double shortest = 1;
    REQUIRE(d->point_count() > 10);
    for (size_t i = 0; i < d->point_count(); ++i) {
      CHECK(length(Vec3(n.array.get(i, 0), n.array.get(i, 1), n.array.get(i, 2))) == doctest::Approx(1).epsilon(1e-6));
      shortest = std::min(shortest, length(Vec3(v.array.get(i, 0), v.array.get(i, 1), v.array.get(i, 2))));
    }
    CHECK(shortest < 0.9);  // as other vectors are not
  }
}
