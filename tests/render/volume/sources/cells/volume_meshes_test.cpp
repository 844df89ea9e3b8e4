// SPDX-License-Identifier: Apache-2.0
// One linear field on every kind of mesh: every ray function gives the same picture, which is the analytic one.
#include "color/colormap.h"
#include "data/cells/point_positions.h"
#include "index/locator_meshes.h"
#include "render/volume/sources/bricks/bricked_support.h"
#include "render/volume/volume_support.h"
#include "volume_cells_support.h"

using namespace sg;
using namespace sg::test;

namespace {

const Vec3 slope{1, 0.8, -0.6};
double field(Vec3 p) { return 4 + dot(slope, p); }
constexpr double level = 4.3, lo = 1.6, hi = 6.4;

struct Carried {
  std::string name;
  std::vector<DatasetPtr> parts;
  double error = 1.0 / 512;  ///< that it may have, of full scale
};

DatasetPtr lattice(UniformGrid g) { return grid(std::move(g), field); }

DatasetPtr rectilinear() {
  RectilinearGrid g;
  const std::vector<double> at[3] = {{-1, -0.7, 0.2, 0.3, 1}, {-1, 0.1, 1}, {-1, -0.9, -0.5, 0.6, 0.8, 1}};
  std::vector<double> v;
  g.x = Array::from_vector(at[0]), g.y = Array::from_vector(at[1]), g.z = Array::from_vector(at[2]);
  for (double z : at[2])
    for (double y : at[1])
      for (double x : at[0]) v.push_back(field({x, y, z}));
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(v).converted(ElementType::f32), "", Role::scalars});
  return make_dataset(g, fields);
}

Vec3 bent_box(Vec3 p) { return bent(p) * 2.0 - Vec3(1, 1, 1); }
Vec3 straight_box(Vec3 p) { return p * 2.0 - Vec3(1, 1, 1); }

DatasetPtr curvilinear() {
  CurvilinearGrid g;
  constexpr size_t n = 5;
  g.dims = {n, n, n};
  std::vector<double> xyz;
  for (size_t i = 0; i < n * n * n; ++i) {
    const Vec3 p = bent_box(Vec3(double(i % n), double(i / n % n), double(i / n / n)) / double(n - 1));
    xyz.insert(xyz.end(), {p.x, p.y, p.z});
  }
  g.points.xyz = Array::from_vector(std::move(xyz), 3);
  DatasetParts parts;
  parts.mesh = std::move(g);
  return with_field(std::move(parts), field);
}

DatasetPtr refined() {
  DatasetParts parts = amr()->parts();
  const Array xyz = point_positions(amr()->mesh());
  std::vector<float> v;
  for (size_t i = 0; i < xyz.count(); ++i) v.push_back(float(field({xyz.get(i, 0), xyz.get(i, 1), xyz.get(i, 2)})));
  parts.fields.add({"f", Association::point, Array::from_vector(v), "", Role::scalars});
  return make_dataset(std::move(parts));
}

const std::vector<Carried>& meshes() {
  static const std::vector<Carried> all = [] {
    std::vector<Carried> m;
    m.push_back({"uniform", {lattice(cube(5, -1, 1))}});
    m.push_back({"rectilinear", {rectilinear()}});
    m.push_back({"curvilinear", {curvilinear()}});
    for (CellType kind : all_kinds()) {
      const bool curved =
          kind == CellType::quadratic_tetra || kind == CellType::triquadratic_hexahedron || kind == CellType::lagrange_hexahedron;
      const bool flat = kind == CellType::voxel || kind == CellType::polyhedron;  // boxes; flat faces
      m.push_back({std::string(cell_type_info(kind).name),
                   {with_field(cube(kind, 3, flat ? straight_box : bent_box), field)},
                   curved ? 1.0 / 128 : 1.0 / 512});
    }
    m.push_back({"amr", {refined()}});
    UniformGrid left = cube(5, -1, 1), right = left;
    left.dims[0] = 2, right.dims[0] = 4, right.origin.x = -0.5;
    m.push_back({"two blocks", {lattice(left), lattice(right)}});
    // Blocks of other kinds, given from far to near.
    const auto half = [](Vec3 p) { return Vec3(bent(p).x - 1, 2 * bent(p).y - 1, 2 * bent(p).z - 1); };
    UniformGrid positive = cube(5, -1, 1);
    positive.dims[0] = 3, positive.origin.x = 0;
    m.push_back({"blocks of two kinds", {with_field(cube(CellType::tetra, 3, half), field), lattice(positive)}});
    const MadeVolume bricks =
        make_volume({9, 9, 9}, 1, [](double i, double j, double k) { return field(Vec3(i, j, k) * 0.25 - Vec3(1, 1, 1)); }, {},
                    {-1, -1, -1}, {0.25, 0.25, 0.25});
    m.push_back({"bricks", {bricks.dataset}});
    return m;
  }();
  return all;
}

Projection view() {
  Camera c;
  c.position = {2.6, 1.9, 3.4}, c.target = {0, 0, 0};
  c.view_angle = 34, c.near_plane = 0.01, c.far_plane = 20;
  return make_projection(c, 15, 13);
}

struct Case {
  std::string name;
  VolumeItem item;
  std::function<Vec4(double f0, double slope, double length)> truth;  ///< premultiplied; null = that of the uniform grid
  double error = 0;                                                   ///< stated by the function itself
};

/// The integral of emission and absorption by many small steps.
Vec4 composited(const VolumeItem& item, double f0, double g, double length, double factor = 1) {
  double sum = 0, pass = 1;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double v = f0 + g * length * (i + 0.5) / n;
    const double alpha = 1 - std::pow(1 - factor * item.opacity.at(v), length / n / item.unit_distance);
    sum += pass * alpha * (v - item.color.lo) / (item.color.hi - item.color.lo), pass *= 1 - alpha;
  }
  return {sum, sum, sum, 1 - pass};
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const char* name, RayFunction mode, auto truth, double from = lo, double to = hi) -> VolumeItem& {
    VolumeItem v = item(nullptr, grey(from, to), {{{from, 1}}});
    v.mode = mode, v.levels = {level};
    all.push_back({name, v, nullptr});
    all.back().truth = [=](double f0, double g, double length) {
      const double value = truth(f0, g, length);
      if (value != value) return Vec4{0, 0, 0, 0};
      const double c = (value - from) / (to - from);
      return Vec4{c, c, c, 1};
    };
    return all.back().item;
  };
  add("maximum", RayFunction::maximum, [](double f0, double g, double l) { return std::max(f0, f0 + g * l); });
  add("minimum", RayFunction::minimum, [](double f0, double g, double l) { return std::min(f0, f0 + g * l); });
  add("average", RayFunction::average, [](double f0, double g, double l) { return f0 + 0.5 * g * l; });
  add(
      "sum", RayFunction::sum, [](double f0, double g, double l) { return l * (f0 + 0.5 * g * l); }, 0, 16);
  const auto reached = [](double f0, double g, double l) {  // length up to the level
    if (f0 >= level) return 0.0;
    const double t = g > 0 ? (level - f0) / g : HUGE_VAL;
    return t <= l ? t : double(NAN);
  };
  add("first hit", RayFunction::first_hit, [=](double f0, double g, double l) { return f0 + g * reached(f0, g, l); });
  add("distance", RayFunction::distance, reached, 0, 3);
  add(
      "accumulate", RayFunction::accumulate,
      [](double f0, double g, double l) {
        const double end = f0 + g * l;
        if (f0 >= level && end >= level) return l;
        if (f0 < level && end < level) return double(NAN);
        const double t = (level - f0) / g;
        return f0 >= level ? t : l - t;
      },
      0, 3);
  VolumeItem& iso = add("isosurface", RayFunction::isosurface, [](double, double, double) { return 0.0; });
  iso.levels = {3, 4, 5.2};
  iso.opacity.points = {{2, 0.2}, {6, 0.8}};
  all.back().truth = [levels = iso.levels, curve = iso.opacity](double f0, double g, double l) {
    std::vector<double> met;
    for (double v : levels)
      if ((v - f0) / g > 0 && (v - f0) / g < l) met.push_back(v);
    if (g < 0) std::reverse(met.begin(), met.end());
    double sum = 0, pass = 1;
    for (double v : met) sum += pass * curve.at(v) * (v - lo) / (hi - lo), pass *= 1 - curve.at(v);
    return Vec4{sum, sum, sum, 1 - pass};
  };

  const VolumeItem levels = iso;  // adding to the list moves them
  VolumeItem fog = item(nullptr, grey(lo, hi), {{{2, 0}, {3, 0.2}, {3.1, 0}, {4.6, 0}, {4.7, 0.7}, {5, 0.4}, {6, 0.6}}});
  fog.unit_distance = 0.5;
  all.push_back({"composite", fog, [=](double f0, double g, double l) { return composited(fog, f0, g, l); }});
  VolumeItem lit = fog;
  lit.shaded = true;
  all.push_back({"composite, lit", lit, nullptr});
  VolumeItem by_gradient = fog;
  by_gradient.detail.second = SecondAxis::gradient, by_gradient.detail.second_factor.points = {{0, 0}, {2, 1}};
  const double factor = length(slope) / 2;
  all.push_back({"composite, gradient", by_gradient, [=](double f0, double g, double l) { return composited(fog, f0, g, l, factor); }});
  VolumeItem mida = fog;
  mida.mode = RayFunction::maximum_difference, mida.opacity.points = {{2, 0}, {6, 0.6}};
  all.push_back({"maximum difference", mida, nullptr, 1.0 / 128});  // in steps of a quarter of an edge
  VolumeItem surfaces = levels;
  surfaces.shaded = true;
  all.push_back({"isosurface, lit", surfaces, nullptr});
  VolumeItem hit = all[4].item;
  hit.shaded = true;
  all.push_back({"first hit, lit", hit, nullptr});
  VolumeItem steps = fog;
  steps.sampling.step = 0.01, steps.sampling.classify = VolumeClassify::integrated;
  all.push_back({"steps, integrated", steps, [=](double f0, double g, double l) { return composited(fog, f0, g, l); }});
  return all;
}

Frame draw_mesh(const Case& c, const Carried& mesh, const Projection& p) {
  Scene scene;
  for (const DatasetPtr& d : mesh.parts) {
    VolumeItem part = c.item;
    part.data = d, part.group = mesh.parts.size() > 1 ? 1 : 0;
    scene.items.emplace_back(part);
  }
  return draw(scene, p);
}

}  // namespace

TEST_CASE("volume meshes: every ray function of a linear field is its analytic picture on every kind of mesh, within the tolerance") {
  const Projection p = view();
  for (const Case& c : cases()) {
    CAPTURE(c.name);
    const Frame uniform = draw_mesh(c, meshes()[0], p);
    for (const Carried& mesh : meshes()) {
      CAPTURE(mesh.name);
      const Frame frame = draw_mesh(c, mesh, p);
      double most = 0, seen = 0;
      for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
          const auto ray = p.ray(x + 0.5, y + 0.5);
          const auto [a, b] = chord((ray.origin + Vec3(1, 1, 1)) * 0.5, ray.direction * 0.5);
          if (b - a > 0 && b - a < 0.05) continue;  // a corner that some meshes round off
          const size_t at = 4 * (size_t(y) * size_t(p.width) + size_t(x));
          Vec4 truth{0, 0, 0, 0};
          if (!c.truth) truth = {uniform.rgba[at], uniform.rgba[at + 1], uniform.rgba[at + 2], uniform.rgba[at + 3]};
          else if (b > a) truth = c.truth(field(ray.origin + ray.direction * a), dot(slope, ray.direction), b - a);
          const double off[4] = {truth.x - double(frame.rgba[at]), truth.y - double(frame.rgba[at + 1]),
                                 truth.z - double(frame.rgba[at + 2]), truth.w - double(frame.rgba[at + 3])};
          for (double d : off) most = std::max(most, std::abs(d));
          seen += truth.w;
        }
      CHECK(seen > 10);
      CHECK(most < std::max(mesh.error, c.error));
    }
  }
}
