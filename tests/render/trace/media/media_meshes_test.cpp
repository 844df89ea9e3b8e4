// SPDX-License-Identifier: Apache-2.0
// The same matter on every kind of mesh, seen from outside and from within.
#include <string>

#include "media_support.h"

#include "render/render.h"
#include "render/trace/trace.h"
#include "render/volume/sources/cells/volume_amr_support.h"
#include "support/statistics.h"

using namespace sg;
using namespace sg::trace;
using namespace sg::trace::test;
using doctest::Approx;

namespace {

struct Body {
  std::string mesh;
  DatasetPtr data;
  Association association = Association::point;

  VolumeItem shown(ColorScale color, OpacityCurve opacity) const {
    VolumeItem v = item(data, std::move(color), std::move(opacity));
    v.association = association;
    return v;
  }
  /// Of extinction tau where the field is 1.
  VolumeItem alike(double tau) const { return shown(one_color({1, 1, 1}), constant_opacity(tau)); }
};

DatasetPtr rectilinear_of(const Function& f) {
  const std::vector<double> axis{-1, -0.8, -0.5, -0.4, 0, 0.1, 0.45, 0.7, 1};
  RectilinearGrid g;
  g.x = g.y = g.z = Array::from_vector(axis);
  std::vector<float> values;
  for (const double z : axis)
    for (const double y : axis)
      for (const double x : axis) values.push_back(float(f({x, y, z})));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(values), "", Role::scalars});
  return make_dataset(g, fields);
}

/// Boxes in turn as a hexahedron, as tetrahedra, as wedges.
DatasetPtr mixed_of(const Function& f, const Warp& warp) {
  constexpr size_t n = 6;
  const CellType kinds[] = {CellType::hexahedron, CellType::tetra, CellType::wedge};
  const size_t cells_of_box[] = {1, 6, 2}, corners[] = {8, 4, 6};
  DatasetParts parts = cube(kinds[0], n, warp);
  std::vector<int64_t> ids, offsets{0};
  std::vector<uint8_t> types;
  const DatasetParts of_kind[] = {cube(kinds[0], n, warp), cube(kinds[1], n, warp), cube(kinds[2], n, warp)};
  for (size_t box = 0; box < n * n * n; ++box) {
    const size_t k = box % 3, count = cells_of_box[k] * corners[k];
    const auto& from = std::get<UnstructuredMesh>(of_kind[k].mesh).cells.connectivity;
    for (size_t i = 0; i < count; ++i) {
      ids.push_back(int64_t(from.get(box * count + i)));
      if ((i + 1) % corners[k] == 0) offsets.push_back(int64_t(ids.size())), types.push_back(uint8_t(kinds[k]));
    }
  }
  auto& mesh = std::get<UnstructuredMesh>(parts.mesh);
  mesh.cells = {Array::from_vector(std::move(ids)), Array::from_vector(std::move(offsets)), 0};
  mesh.types = Array::from_vector(std::move(types)), mesh.single_type = CellType::empty;
  return with_field(std::move(parts), f);
}

/// f in [-1, 1]^3 on all of them.
std::vector<Body> bodies(const Function& f) {
  const auto straight_box = [](Vec3 p) { return p * 2.0 - Vec3{1, 1, 1}; };
  const auto bent_box = [](Vec3 p) { return bent(p) * 2.0 - Vec3{1, 1, 1}; };
  std::vector<Body> all{{"one cell", grid(cube(2, -1, 1), f)},
                        {"uniform", grid(cube(9, -1, 1), f)},
                        {"rectilinear", rectilinear_of(f)},
                        {"curvilinear", curvilinear_of(f)},
                        {"mixed cells", mixed_of(f, straight_box)}};
  for (const CellType kind : linear_kinds()) {
    const bool flat = kind == CellType::voxel || kind == CellType::polyhedron;  // boxes; flat faces
    all.push_back({std::string(cell_type_info(kind).name), with_field(flat ? cube(kind, 6, straight_box) : cube(kind, 6, bent_box), f)});
  }
  all.push_back({"quadratic tetrahedra", with_field(cube(CellType::quadratic_tetra, 3, straight_box), f)});
  const DatasetPtr levels = amr_of(6, {2}, {{{{{2, 3, 4}, {7, 8, 9}}}}});
  for (const Association a : {Association::point, Association::cell})
    all.push_back({a == Association::cell ? "refined, by cells" : "refined", with_amr_field(levels, f, a), a});
  return all;
}

/// The share that passes the ray, tracked n times.
sg::test::Moments passing(const Media& media, const Ray& ray, int n) {
  const auto walk = media.borrow();
  sg::test::Moments m;
  for (int i = 0; i < n; ++i) {
    RandomStream random{uint64_t(i)};
    m.add(double(walk->passes(ray, random)));
  }
  return m;
}

const Environment even_light{Vec3f{1, 1, 1}};

}  // namespace

TEST_CASE("media: white matter is invisible in even light on every kind of mesh") {
  const auto lumpy = [](Vec3 p) { return 1.2 - length(p) + 0.3 * std::sin(4 * p.x) * std::cos(3 * p.y + p.z); };
  for (const Body& b : bodies(lumpy)) {
    if (b.mesh == "one cell") continue;  // nothing but its dark corners
    CAPTURE(b.mesh);
    VolumeItem v = b.shown(one_color({1, 1, 1}), density_is_value(0, 2, 100));
    v.unit_distance = 0.4, v.scattering.phase = PhaseKind::henyey_greenstein;
    const Mean got = seen(world_of(scene_of({v}), {}, even_light), {0.1, 0.2, 3}, {0, 0, -1}, 600);
    CAPTURE(got.value);
    CAPTURE(got.passed);
    CHECK(std::abs(got.value + got.passed - 1) <= 4 * got.error + 1e-5);
    CHECK(got.passed < 0.2);  // it is there
  }
}

TEST_CASE("media: even matter is the same on every kind of mesh, unscattered exp(-tau length)") {
  const double tau = 1.3;
  for (const Body& b : bodies(one)) {
    CAPTURE(b.mesh);
    for (const Tracking t : {Tracking::exact, Tracking::mixed, Tracking::delta}) {
      CAPTURE(int(t));
      const auto media = media_of(scene_of({b.alike(tau)}), t);
      for (const TestRay& r : {TestRay{{0.21, 0.13, -3}, {0, 0, 1}}, TestRay{{-0.9, -2, -0.7}, normalize(Vec3{0.4, 2, 0.5})}}) {
        const Ray ray = ray_of(Placement::of(media->bounds()), r.o, r.d);
        const auto [near, far] = chord((r.o + Vec3{1, 1, 1}) * 0.5, r.d * 0.5);
        const sg::test::Moments got = passing(*media, ray, t == Tracking::exact ? 2 : 500);
        CHECK(std::abs(got.mean - std::exp(-tau * (far - near))) <= 4 * got.standard_error() + 2e-5);
      }
    }
  }
}

TEST_CASE("media: even matter is the same on every kind of mesh, scattered once in closed form, and many times") {
  // Looking along y with the sun above: albedo p E exp(-tau (1 - z)) (1 - exp(-2 tau)).
  const double tau = 1.3, albedo = 0.8, z = 0.15;
  const double truth = albedo * double(henyey_greenstein(0, 0.4f)) * 3 * std::exp(-tau * (1 - z)) * (1 - std::exp(-2 * tau));
  const DistantLight sun{{0, 0, 1}, {3, 3, 3}, 0};
  const Environment sky{Vec3f{0.2f, 0.2f, 0.2f}};
  Mean first;
  for (const Body& b : bodies(one)) {
    CAPTURE(b.mesh);
    VolumeItem v = b.alike(tau);
    v.scattering.albedo = albedo, v.scattering.phase = PhaseKind::henyey_greenstein, v.scattering.anisotropy = 0.4;
    v.scattering.light = VolumeLighting::single;
    const Mean once = seen(world_of(scene_of({v}), {sun}, {}), {0.07, -3, z}, {0, 1, 0}, 300);
    CHECK(std::abs(once.value - truth) <= 4 * once.error + 1e-4 * truth);
    v.scattering.light = VolumeLighting::path;
    const Mean often = seen(world_of(scene_of({v}), {sun}, sky), {0.07, -3, z}, {0, 1, 0}, 600);
    if (first.value == 0) first = often;
    CHECK(std::abs(often.value - first.value) <= 4 * std::hypot(often.error, first.error));
    CHECK(often.value > truth + 4 * often.error);
  }
}

TEST_CASE("media: seen from within, what is in front of the viewer counts") {
  const double tau = 1.3, albedo = 0.8, z = 0.15, y = -0.2, length = 1 - y;
  const double passes = std::exp(-tau * length);
  // As from outside, but from y on.
  const double once = albedo * double(henyey_greenstein(0, 0.4f)) * 3 * std::exp(-tau * (1 - z)) * (1 - passes);
  const DistantLight sun{{0, 0, 1}, {3, 3, 3}, 0};
  const Vec3 from{0.07, y, z};
  for (const Body& b : bodies(one)) {
    CAPTURE(b.mesh);
    VolumeItem v = b.alike(tau);
    v.scattering.phase = PhaseKind::henyey_greenstein, v.scattering.anisotropy = 0.4;
    // White matter in even light.
    const Mean lit = seen(world_of(scene_of({v}), {}, even_light), from, {0, 1, 0}, 200);
    CHECK(std::abs(lit.value + lit.passed - 1) <= 4 * lit.error + 1e-5);
    CHECK(lit.passed == Approx(passes).epsilon(1e-4));
    v.scattering.albedo = 0;
    CHECK(seen(world_of(scene_of({v}), {sun}, even_light), from, {0, 1, 0}, 10).value == 0);
    v.scattering.albedo = albedo, v.scattering.light = VolumeLighting::single;
    const Mean got = seen(world_of(scene_of({v}), {sun}, {}), from, {0, 1, 0}, 500);
    CHECK(std::abs(got.value - once) <= 4 * got.error + 1e-4 * once);
    // Light that it gives off itself, in pictures by both renderers.
    v.color = one_color({0.5, 0.5, 0.5}), v.scattering.light = VolumeLighting::emission;
    const Scene scene = scene_of({v});
    const Projection view = perspective_view(2, 2, 1000, from, from + Vec3{0, 1, 0}, {0, 0, 1});
    Context context;
    LightOptions options;
    options.paths = 4;
    TraceReport report;
    const Frame traced = trace_scene(scene, prepare_scene(scene, context), view, options, report, context), cast = draw(scene, view);
    for (const Frame* f : {&traced, &cast})
      for (size_t p = 0; p < 4; ++p) {
        CHECK(std::abs(double(f->rgba[4 * p + 3]) - (1 - passes)) < 1.0 / 512);
        CHECK(std::abs(double(f->rgba[4 * p]) - 0.5 * (1 - passes)) < 1.0 / 512);
      }
  }
}
