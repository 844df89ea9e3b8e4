// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/transform/transform.h"

#include <cstring>

#include "data/lattice.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/mesh/select/threshold.h"
#include "filter/mesh/slice/slice.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

Vec3 point_of(const Dataset& d, size_t id) {
  if (is_lattice(d.mesh())) {
    const Lattice l(d.mesh());
    const auto& v = l.view();
    return v.position(id % v.dims[0], id / v.dims[0] % v.dims[1], id / (v.dims[0] * v.dims[1]));
  }
  if (auto* m = d.as<UnstructuredMesh>()) return m->points.at(id);
  if (auto* m = d.as<SurfaceMesh>()) return m->points.at(id);
  return d.as<PointCloud>()->points.at(id);
}

DatasetPtr rectilinear() {
  RectilinearGrid r;
  r.x = Array::from_vector(std::vector<double>{0, 0.1, 1});
  r.y = Array::from_vector(std::vector<double>{0, 0.5, 0.8, 1});
  r.z = Array::from_vector(std::vector<double>{0, 1});
  return make_dataset(r);
}

}  // namespace

TEST_CASE("transform: every point of every mesh kind goes where the formula says") {
  Context ctx;
  const DatasetPtr hex = solid_box(CellType::hexahedron, 2);
  CurvilinearGrid c;
  c.dims = {3, 3, 3};
  c.points = {Array::from_vector(std::vector<float>(81, 0.5f), 3), {1, 2, 3}};
  const PointCloud cloud{{Array::from_vector(std::vector<double>{1, 2, 3, 4, 5, 6}, 3), {}}};
  const DatasetPtr inputs[] = {uniform_box(2, 3, 1), rectilinear(), hex, faces(hex, {}, ctx), make_dataset(c), make_dataset(cloud)};
  const double a = 30 * M_PI / 180;
  TransformParams p;
  p.scale = {2, -1, 0.5}, p.angle = 30, p.axis = {0, 0, 3}, p.translate = {5, 6, 7}, p.center = Vec3(1, 1, 1);
  for (const DatasetPtr& in : inputs) {
    CAPTURE(in->kind());
    const DatasetPtr out = transform(in, p, ctx);
    REQUIRE(out->point_count() == in->point_count());
    for (size_t i = 0; i < in->point_count(); ++i) {
      const Vec3 s = (point_of(*in, i) - Vec3(1, 1, 1)) * p.scale;
      const Vec3 want = Vec3(std::cos(a) * s.x - std::sin(a) * s.y, std::sin(a) * s.x + std::cos(a) * s.y, s.z) + Vec3(6, 7, 8);
      double nearest = length(point_of(*out, i) - want);  // points of mirrored grids are numbered anew
      for (size_t j = 0; j < out->point_count() && is_lattice(in->mesh()); ++j)
        nearest = std::min(nearest, length(point_of(*out, j) - want));
      REQUIRE(nearest < 1e-6);
    }
    CHECK(out->fields().size() == in->fields().size());
  }
}

TEST_CASE("transform: grids keep the plainest kind that can hold them") {
  Context ctx;
  const DatasetPtr box = uniform_box(4, 3, 2);
  CHECK(transform(box, {.axis = {1, 2, 3}, .angle = 77, .translate = {1, 2, 3}}, ctx)->kind() == "uniform");
  CHECK(transform(box, {.scale = {1, 2, -3}}, ctx)->kind() == "uniform");
  CHECK(transform(box, {.matrix = {1, 0.5, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}, ctx)->kind() == "curvilinear");
  CHECK(transform(rectilinear(), {.scale = {-2, 1, 1}, .translate = {1, 0, 0}}, ctx)->kind() == "rectilinear");
  CHECK(transform(rectilinear(), {.angle = 20}, ctx)->kind() == "curvilinear");
  // A turned uniform grid that is then scaled unevenly shears.
  const DatasetPtr turned = transform(box, {.angle = 45}, ctx);
  CHECK(transform(turned, {.scale = {2, 1, 1}}, ctx)->kind() == "curvilinear");
  CHECK(transform(turned, {.scale = {2, 2, 2}}, ctx)->kind() == "uniform");
  const UniformGrid quarter = *transform(box, {.angle = 90}, ctx)->as<UniformGrid>();
  CHECK(quarter.direction.column(0) == Vec3(0, 1, 0));
  // Volume and orientation of the skin survive a mirror.
  for (const DatasetPtr& d : {box, solid_box(CellType::tetra, 2), faces(box, {}, ctx)})
    CHECK(measure(*faces(transform(d, {.scale = {-1, 2, 1}}, ctx), {}, ctx)->as<SurfaceMesh>()).volume == doctest::Approx(2));
}

TEST_CASE("transform: there and back again") {
  Context ctx;
  const DatasetPtr box = uniform_box(3, 3, 3);
  const DatasetPtr back = transform(transform(box, {.axis = {1, 1, 0}, .angle = 33}, ctx), {.axis = {1, 1, 0}, .angle = -33}, ctx);
  for (size_t i = 0; i < box->point_count(); ++i) REQUIRE(length(point_of(*back, i) - point_of(*box, i)) < 1e-14);
}

TEST_CASE("transform: points far from zero keep their f32 offsets") {
  Context ctx;
  PointCloud cloud{{Array::from_vector(std::vector<float>{0.001f, 0, 0}, 3), {1e7, 0, 0}}};
  const DatasetPtr out = transform(make_dataset(cloud), {.angle = 90, .translate = {0, 0, 5e8}}, ctx);
  const Points& p = out->as<PointCloud>()->points;
  CHECK(p.xyz.type() == ElementType::f32);
  CHECK(p.origin == Vec3(0, 1e7, 5e8));
  CHECK(p.xyz.get(0, 1) == doctest::Approx(0.001));
}

TEST_CASE("transform: vectors turn, normals stay perpendicular, the rest stays") {
  Context ctx;
  FieldSet fields;
  auto add = [&](const char* name, Role role, std::vector<double> v, Association a = Association::point) {
    Field f = make_field(name, a, std::move(v), 3);
    f.role = role;
    fields.add(f);
  };
  add("velocity", Role::vectors, {1, 1, 0});
  add("Normals", Role::normals, {std::sqrt(0.5), std::sqrt(0.5), 0});
  add("rgb", Role::colors, {1, 1, 0});
  add("plain", Role::none, {1, 1, 0});
  const DatasetPtr in = make_dataset(PointCloud{{Array::from_vector(std::vector<double>{0, 0, 0}, 3), {}}}, fields);
  auto value = [](const DatasetPtr& d, const char* name) {
    const Array& a = d->fields().require(name).array;
    return Vec3(a.get(0, 0), a.get(0, 1), a.get(0, 2));
  };
  const DatasetPtr out = transform(in, {.scale = {2, 1, 1}}, ctx);
  CHECK(value(out, "velocity") == Vec3(2, 1, 0));
  // The plane x + y = 0 becomes x/2 + y = 0.
  CHECK(length(value(out, "Normals") - normalize(Vec3(0.5, 1, 0))) < 1e-14);
  CHECK(value(out, "rgb") == Vec3(1, 1, 0));
  CHECK(value(out, "plain") == Vec3(2, 1, 0));  // as streamlines would follow it
  TransformParams marked;
  marked.scale = {2, 1, 1}, marked.fields.unmarked = false;
  CHECK(value(transform(in, marked, ctx), "plain") == Vec3(1, 1, 0));
  CHECK(value(transform(in, {.scale = {2, 1, 1}, .vectors = false}, ctx), "velocity") == Vec3(1, 1, 0));
}

TEST_CASE("transform: AMR grids move and scale, and say no to rotation") {
  Context ctx;
  AmrGrid g;
  g.levels.resize(1);
  g.levels[0].patches = {{{0, 0, 0}, {1, 1, 1}, 0, 0}};
  const DatasetPtr amr = make_dataset(g);
  CHECK(measure(*faces(transform(amr, {.scale = {1, 2, -1}, .translate = {3, 0, 0}}, ctx), {}, ctx)->as<SurfaceMesh>()).volume ==
        doctest::Approx(16));
  CHECK(error_of([&] { transform(amr, {.angle = 10}, ctx); }).find("take faces") != std::string::npos);
}

TEST_CASE("transform: mistakes say what would be right") {
  Context ctx;
  const DatasetPtr box = uniform_box(1, 1, 1);
  CHECK(error_of([&] { transform(box, {.scale = {1, 0, 1}}, ctx); }).find("flattens") != std::string::npos);
  CHECK(error_of([&] { transform(box, {.axis = {0, 0, 0}, .angle = 1}, ctx); }).find("axis is zero") != std::string::npos);
  CHECK(error_of([&] { transform(box, {.matrix = {1, 2}}, ctx); }).find("has 2 numbers") != std::string::npos);
  CHECK(error_of([&] { transform(box, {.matrix = std::vector<double>(16, 1.0)}, ctx); }).find("last row") != std::string::npos);
}

TEST_CASE("mesh operations: parameters are set from text and have help") {
  SliceParams slice_params;
  Schema s = schema_of(slice_params);
  set_params(s, {"axis=y", "position=0.25", "origin=1,2,3"}, "slice");
  CHECK(slice_params.axis == CutAxis::y);
  CHECK(slice_params.position == 0.25);
  CHECK(slice_params.origin->z == 3);
  CHECK(error_of([&] { set_params(s, {"axis=q"}, "slice"); }).find("slice") != std::string::npos);
  ThresholdParams t;
  Schema ts = schema_of(t);
  set_params(ts, {"field=T", "min=3", "all_points=false", "invert"}, "threshold");
  CHECK(t.field.name == "T");
  CHECK(t.min == 3);
  CHECK(!t.max);
  CHECK(t.invert);
  TransformParams m;
  Schema ms = schema_of(m);
  set_params(ms, {"scale=1,2,3", "angle=90", "matrix=1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1"}, "transform");
  CHECK(m.matrix.size() == 16);
  FacesParams f;
  Schema fs = schema_of(f);
  for (const Schema* each : {&s, &ts, &ms, &fs})
    for (const ParamDecl& d : each->decls()) CHECK(d.doc.back() == '.');
}
