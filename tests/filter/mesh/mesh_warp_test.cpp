// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/warp/warp.h"

#include "data/lattice.h"
#include "filter/mesh/faces/faces.h"
#include "filter/mesh/mesh_meshes.h"
#include "filter/surface/normals.h"
#include "support/test.h"

using namespace sg;
using namespace sg::test;
using namespace sg::test::meshes;

namespace {

std::vector<Vec3> places(const Dataset& d) {
  std::vector<Vec3> at(d.point_count());
  const auto listed = [&](const Points& p) {
    for (size_t i = 0; i < at.size(); ++i) at[i] = p.at(i);
  };
  if (is_lattice(d.mesh())) {
    const Lattice lattice(d.mesh());
    const LatticeView& v = lattice.view();
    for (size_t i = 0; i < at.size(); ++i) at[i] = v.position(i % v.dims[0], i / v.dims[0] % v.dims[1], i / (v.dims[0] * v.dims[1]));
  } else if (const auto* m = d.as<UnstructuredMesh>()) {
    listed(m->points);
  } else {
    listed(d.as<SurfaceMesh>()->points);
  }
  return at;
}

DatasetPtr with_point_field(const DatasetPtr& in, const char* name, int components, const std::function<double(Vec3, int)>& f) {
  std::vector<double> values;
  for (const Vec3 p : places(*in))
    for (int c = 0; c < components; ++c) values.push_back(f(p, c));
  DatasetParts parts = in->parts();
  parts.fields.add({name, Association::point, Array::from_vector(std::move(values), components), "", Role::none});
  return make_dataset(std::move(parts));
}

struct Heard {
  Context context;
  std::string text;
  Heard() {
    context.on_log = [this](LogLevel, std::string_view t) { text += std::string(t) + "\n"; };
  }
};

}  // namespace

TEST_CASE("warp: vectors displace every point of every mesh kind by scale times their value") {
  Context context;
  const DatasetPtr hex = solid_box(CellType::hexahedron, 2);
  for (const DatasetPtr& bare : {uniform_box(2, 3, 1), hex, faces(hex, {}, context)}) {
    CAPTURE(bare->kind());
    const auto u = [](Vec3 p, int c) { return c == 0 ? p.y : c == 1 ? -2 * p.x : 0.5; };
    const DatasetPtr in = with_point_field(bare, "displacement", 3, u);
    WarpParams p;
    p.scale = 0.25;
    const DatasetPtr out = warp(in, p, context);
    const auto before = places(*in), after = places(*out);
    REQUIRE(after.size() == before.size());
    CHECK(out->cell_count() == in->cell_count());
    for (size_t i = 0; i < before.size(); ++i) {
      const Vec3 x = before[i];
      CHECK(length(after[i] - (x + 0.25 * Vec3(u(x, 0), u(x, 1), u(x, 2)))) < 1e-6);
    }
  }
}

TEST_CASE("warp: a scalar lifts flat data across it, other data where it is told or along the normals") {
  Context context;
  const DatasetPtr flat = with_point_field(uniform_box(4, 3, 0), "height", 1, [](Vec3 p, int) { return p.x * p.x; });
  WarpParams p;
  p.scale = 2;
  p.field.name = "height";
  const auto before = places(*flat), lifted = places(*warp(flat, p, context));
  for (size_t i = 0; i < before.size(); ++i) CHECK(length(lifted[i] - (before[i] + Vec3(0, 0, 2 * before[i].x * before[i].x))) < 1e-12);

  const DatasetPtr box = with_point_field(uniform_box(2, 2, 2), "s", 1, [](Vec3, int) { return 1.0; });
  p.field.name = "s";
  CHECK(error_of([&] { warp(box, p, context); }).find("direction=0,0,1") != std::string::npos);
  p.direction = Vec3(0, -3, 0);
  CHECK(length(places(*warp(box, p, context))[5] - (places(*box)[5] + Vec3(0, -2, 0))) < 1e-12);
  p.direction = Vec3();
  CHECK(error_of([&] { warp(box, p, context); }).find("direction is zero") != std::string::npos);

  // Along the normals of a sphere-like surface: by a constant, outwards. The normals are gone, since they would be wrong.
  const DatasetPtr surface =
      with_point_field(normals(faces(solid_box(CellType::hexahedron, 2), {}, context), {}, context), "s", 1, [](Vec3, int) { return 1.0; });
  REQUIRE(surface->fields().with_role(Role::normals));
  WarpParams along;
  along.field.name = "s", along.scale = 0.5;
  const DatasetPtr grown = warp(surface, along, context);
  CHECK(!grown->fields().with_role(Role::normals));
  CHECK(grown->bounds().size().x > surface->bounds().size().x);
}

TEST_CASE("warp: an open scale is the true one where that shows, else a round one, and is told") {
  const auto bent = [](double most) {
    return with_point_field(uniform_box(4, 4, 4), "disp", 3, [=](Vec3 p, int c) { return c == 2 ? most * p.x : 0; });
  };
  const double size = bent(1)->bounds().diagonal();
  Heard small, right;
  const auto moved = [&](double most, Context& context) {
    const DatasetPtr in = bent(most);
    return warp(in, {}, context)->bounds().hi.z - in->bounds().hi.z;
  };
  CHECK(moved(1e-4 * size, small.context) == doctest::Approx(0.1 * size).epsilon(0.31));
  CHECK(small.text.find("times 'disp'") != std::string::npos);
  CHECK(moved(0.2 * size, right.context) == doctest::Approx(0.2 * size));
  CHECK(right.text == "warp: displaced by 1 times 'disp'\n");
}

TEST_CASE("warp: points without a value stay, cell fields and matrices are refused with what would do") {
  Heard heard;
  const DatasetPtr holes = with_point_field(uniform_box(2, 2, 0), "h", 1, [](Vec3 p, int) { return p.x > 0.9 ? NAN : 1.0; });
  WarpParams p;
  p.field.name = "h", p.scale = 1;
  const DatasetPtr out = warp(holes, p, heard.context);
  CHECK(heard.text.find("points without a finite value of 'h' stay") != std::string::npos);
  CHECK(out->bounds().lo.z == 0);
  CHECK(out->bounds().hi.z == 1);
  const DatasetPtr matrix = with_point_field(uniform_box(2, 2, 2), "m", 9, [](Vec3, int) { return 1.0; });
  p.field.name = "m";
  CHECK(error_of([&] { warp(matrix, p, heard.context); }).find("9 components") != std::string::npos);
}
