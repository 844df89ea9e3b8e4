// SPDX-License-Identifier: Apache-2.0
#include "simulate/fluid/sources/field_source.h"

#include <cmath>
#include <string>
#include <vector>

#include "base/error.h"
#include "filter/every_mesh.h"
#include "simulate/fluid/smoke.h"
#include "simulate/particles/meshes.h"
#include "support/same_data.h"
#include "support/test.h"

using namespace sg;

namespace {

template <class F>
DatasetPtr with_values(const DatasetPtr& mesh, const char* name, Association on, F&& f) {
  DatasetParts parts = mesh->parts();
  std::vector<double> values(on == Association::point ? mesh->point_count() : mesh->cell_count());
  for (size_t i = 0; i < values.size(); ++i) values[i] = f(i);
  parts.fields.add({name, on, Array::from_vector(std::move(values)), "", Role::scalars});
  return make_dataset(std::move(parts));
}

SmokeParams air() {
  SmokeParams p;
  p.size = 32, p.bounds = {-1, 1, -1, 1, -1, 3}, p.frame = 0.05, p.lift = 3, p.type = FieldType::f64;
  return p;
}

SmokeFromParams from(const SmokeParams& p) {
  SmokeFromParams q;
  static_cast<SmokeParams&>(q) = p;
  return q;
}

const Array& values_of(const DatasetPtr& d, const char* name) { return d->fields().require(name, Association::point).array; }

}  // namespace

TEST_CASE("smoke_from: a constant field of points or cells on any solid mesh of a box is the box") {
  Context context;
  for (const bool gives : {false, true}) {
    SmokeParams p = air();
    p.density = 0.5, p.temperature = 2, p.time = 0.15;
    if (gives) p.rate = 3;
    SmokeParams with_box = p;
    with_box.box = {-0.5, 0.5, -0.5, 0.5, -0.5, 0.5};  // whole cells of the air
    const DatasetPtr expected = smoke(with_box, context);
    for (const test::MeshKind& kind : test::solid_meshes()) {
      if (std::string(kind.name) == "rotated") continue;  // another box
      CAPTURE(kind.name);
      const DatasetPtr mesh = kind.make(4, 0.5);
      for (const Association on : {Association::point, Association::cell}) {
        DatasetParts bare = mesh->parts();
        bare.fields = {};
        // 1.5 as point values is that up to the rounding of weights; halves of factors are exact.
        SmokeFromParams q = from(p);
        q.density /= 2, q.temperature /= 2, q.field = {"two"};
        const DatasetPtr got = smoke_from(with_values(make_dataset(bare), "two", on, [](size_t) { return 2.0; }), q, context);
        double most = 0;
        for (const char* name : {"density", "temperature", "velocity"}) {
          const Array &a = values_of(got, name), &b = values_of(expected, name);
          for (size_t i = 0; i < a.count(); ++i)
            for (int c = 0; c < a.components(); ++c) most = std::max(most, std::abs(a.get(i, c) - b.get(i, c)));
        }
        if (on == Association::cell) CHECK(most == 0);
        else CHECK(most < 1e-5);  // what is left of the divergence differs as the rounding does
      }
    }
  }
}

TEST_CASE("smoke_from: values of linear fields on tetrahedra are met at the middles of the cells, outside there is nothing") {
  Context context;
  const auto linear = [](Vec3 x) { return 2 + x.x + 0.5 * x.y - 0.25 * x.z; };
  const DatasetPtr mesh = test::solid_mesh("tetra", 5, 0.8, linear);
  const Field* f = mesh->fields().active(1);
  REQUIRE(f);
  SmokeFromParams p = from(air());
  p.density = 3, p.temperature = 0.5, p.field = {f->name};
  const DatasetPtr d = smoke_from(mesh, p, context);
  const UniformGrid& g = *d->as<UniformGrid>();
  size_t inside = 0;
  for (size_t i = 0; i < d->point_count(); ++i) {
    const Vec3 x = g.origin + g.spacing * Vec3(double(i % g.dims[0]), double(i / g.dims[0] % g.dims[1]), double(i / g.dims[0] / g.dims[1]));
    const bool in = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) < 0.8;
    inside += in;
    CHECK(std::abs(values_of(d, "density").get(i) - (in ? 3 * linear(x) : 0)) < 1e-5);  // the mesh's field is f32
    CHECK(std::abs(values_of(d, "temperature").get(i) - (in ? 0.5 * linear(x) : 0)) < 1e-5);
  }
  CHECK(inside > 1000);
  // Temperatures of another field, also of cells, and a rate: twice as much after twice the time, without flow.
  const DatasetPtr both = with_values(mesh, "heat", Association::cell, [](size_t c) { return c % 2 ? 1.0 : -1.0; });
  p.temperature_field = {"heat"}, p.rate = 2, p.lift = p.weight = 0, p.time = 0.1;
  const DatasetPtr e = smoke_from(both, p, context);
  for (size_t i = 0; i < d->point_count(); ++i) {
    CHECK(values_of(e, "density").get(i) == doctest::Approx(2 * 0.1 * values_of(d, "density").get(i)));
    if (values_of(d, "density").get(i) > 0) CHECK(std::abs(values_of(e, "temperature").get(i)) == doctest::Approx(2 * 0.1 * 0.5));
  }
}

TEST_CASE("smoke_from: flat data make flat air; hot air passes where a field is 0") {
  Context context;
  SmokeFromParams p;
  p.size = 16, p.field = {"c"};
  const DatasetPtr square = test::flat_surface("triangles", 8, 1);
  const DatasetPtr flat = smoke_from(with_values(square, "c", Association::point, [](size_t) { return 1.0; }), p, context);
  CHECK(flat->as<UniformGrid>()->dims == std::array<size_t, 3>{11, 16, 1});
  CHECK(flat->bounds().lo.y < -0.8);
  CHECK(flat->bounds().hi.y > 1.5);
  // The field lies in the upper half as well, where it is 0: what rises there is the box's.
  SmokeParams plain = air();
  plain.time = 1.2, plain.frame = 0.1, plain.box = {-0.5, 0.5, -0.5, 0.5, -0.5, 0};
  const DatasetPtr expected = smoke(plain, context);
  SmokeFromParams q = from(plain);
  q.box.clear(), q.field = {"c"};
  DatasetParts parts;
  UniformGrid g;
  g.dims = {2, 2, 3}, g.origin = {-0.5, -0.5, -0.5}, g.spacing = {1, 1, 0.5};
  parts.mesh = g;
  const DatasetPtr got =
      smoke_from(with_values(make_dataset(parts), "c", Association::cell, [](size_t c) { return c == 0 ? 1.0 : 0.0; }), q, context);
  CHECK(test::same_array(values_of(got, "temperature"), values_of(expected, "temperature")));
  double above = 0;
  for (size_t i = 0; i < got->point_count(); ++i)
    if (i / (16 * 16) > 8) above = std::max(above, values_of(got, "temperature").get(i));
  CHECK(above > 0.1);
}

TEST_CASE("smoke_from: fields that are no sources are refused") {
  Context context;
  const DatasetPtr mesh = test::solid_mesh("tetra", 2, 0.5, [](Vec3) { return 1.0; });
  SmokeFromParams p = from(air());
  p.size = 8;
  const auto error = [&](const DatasetPtr& d) { return test::error_of([&] { smoke_from(d, p, context); }); };
  p.field = {"nothing"};
  CHECK(test::contains(error(mesh), "nothing"));
  p.field = {};
  p.bounds = {5, 6, 5, 6, 5, 6};
  CHECK(test::contains(error(mesh), "no middle of a cell"));
  p.bounds = air().bounds;
  p.field = {"inf"};
  CHECK(test::contains(error(with_values(mesh, "inf", Association::cell, [](size_t) { return HUGE_VAL; })), "infinite"));
  p.field = {"v"};
  DatasetParts parts = mesh->parts();
  parts.fields.add({"v", Association::point, Array::from_vector(std::vector<double>(3 * mesh->point_count()), 3), "", Role::vectors});
  CHECK(test::contains(error(make_dataset(parts)), "no scalar field"));
  p.field = {"minus"};
  size_t warnings = 0;
  context.on_log = [&](LogLevel level, std::string_view) { warnings += level == LogLevel::warning; };
  const DatasetPtr d = smoke_from(with_values(mesh, "minus", Association::cell, [](size_t) { return -1.0; }), p, context);
  CHECK(warnings == 1);
  CHECK(values_of(d, "density").get(0) == 0);
}
