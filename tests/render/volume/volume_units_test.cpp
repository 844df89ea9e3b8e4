// SPDX-License-Identifier: Apache-2.0
// Physical units: a field in other units of value and of length gives the same picture.
#include <cstring>

#include "index/locator_meshes.h"
#include "render/volume/sources/bricks/bricked_support.h"
#include "render/volume/sources/cells/volume_amr_support.h"
#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double field_at(Vec3 p) { return 0.6 * std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) + 0.4 * std::sin(4 * p.z + p.x * p.y); }

/// AMR grids of points or of cells, tetrahedra with a field of cells, bricks of 32^3 samples and coarser ones.
DatasetPtr other_dataset(const std::string& kind, double value, double length, ElementType type) {
  if (kind == "bricked") {
    const double h = 2.0 / 32;  // a power of two
    const auto at = [&](double i, double j, double k) { return double(float(field_at(Vec3{i, j, k} * h - Vec3{1, 1, 1}))) * value; };
    return make_volume({34, 33, 33}, 2, at, {}, Vec3{-1, -1, -1} * length, Vec3{h, h, h} * length).dataset;
  }
  const Association on = kind == "AMR" ? Association::point : Association::cell;
  const bool amr = kind != "tetrahedra with a field of cells";
  const auto field = [&](Vec3 p) { return field_at(p); };
  const DatasetPtr near = amr ? with_amr_field(amr_small(), field, on) : with_field(cube(CellType::tetra, 4), field, true);
  DatasetParts parts = near->parts();
  const Array& narrow = near->fields().require("f", on).array;
  std::vector<double> f;
  for (size_t i = 0; i < narrow.count(); ++i) f.push_back(narrow.get(i) * value);
  parts.fields = {};
  parts.fields.add({"f", on, Array::from_vector(f).converted(type), "", Role::scalars});
  if (auto* grid = std::get_if<AmrGrid>(&parts.mesh)) {
    grid->origin = grid->origin * length;
    for (AmrGrid::Level& l : grid->levels) l.spacing = l.spacing * length;
  } else {
    Points& points = std::get<UnstructuredMesh>(parts.mesh).points;
    std::vector<double> xyz;
    for (size_t i = 0; i < points.count(); ++i)
      for (int a = 0; a < 3; ++a) xyz.push_back((2 * points.at(i)[a] - 1) * length);
    points.xyz = Array::from_vector(xyz, 3);
  }
  return make_dataset(std::move(parts));
}

/// The field on 7^3 points over [-1, 1]^3, in units of so much.
DatasetPtr dataset(const std::string& kind, double value, double length, ElementType type) {
  if (kind != "uniform" && kind != "rectilinear" && kind != "curvilinear" && kind != "tetrahedra")
    return other_dataset(kind, value, length, type);
  const size_t n = 7;
  std::vector<double> f, xyz, axis;
  for (size_t i = 0; i < n; ++i) axis.push_back((2 * double(i) / double(n - 1) - 1));
  if (kind == "rectilinear") axis[2] = -0.25, axis[4] = 0.4375;
  for (size_t k = 0; k < n; ++k)
    for (size_t j = 0; j < n; ++j)
      for (size_t i = 0; i < n; ++i) {
        const Vec3 p{axis[i], axis[j], axis[k]};
        f.push_back(double(float(field_at(p))) * value);
        for (int a = 0; a < 3; ++a) xyz.push_back(double(float(p[a])) * length);
      }
  FieldSet fields;
  fields.add({"f", Association::point, Array::from_vector(f).converted(type), "", Role::scalars});
  if (kind == "uniform") {
    UniformGrid g;
    g.dims = {n, n, n}, g.origin = Vec3{-1, -1, -1} * length, g.spacing = Vec3{1, 1, 1} * (length * 0.34375);
    return make_dataset(g, fields);
  }
  for (double& x : axis) x *= length;
  if (kind == "rectilinear") {
    RectilinearGrid g;
    g.x = g.y = g.z = Array::from_vector(axis);
    return make_dataset(g, fields);
  }
  const Array points = Array::from_vector(xyz, 3);
  if (kind == "curvilinear") {
    CurvilinearGrid g;
    g.dims = {n, n, n}, g.points.xyz = points;
    return make_dataset(g, fields);
  }
  // Five tetrahedra a cube, alternately turned.
  UnstructuredMesh m;
  m.points.xyz = points, m.single_type = CellType::tetra;
  std::vector<int64_t> ids;
  for (size_t k = 0; k + 1 < n; ++k)
    for (size_t j = 0; j + 1 < n; ++j)
      for (size_t i = 0; i + 1 < n; ++i) {
        const auto id = [&](int c) { return int64_t(i + (c & 1) + n * (j + (c >> 1 & 1) + n * (k + (c >> 2)))); };
        const int flip = int(i + j + k) % 2;
        const int tets[5][4] = {{0, 1, 2, 4}, {3, 1, 7, 2}, {5, 1, 4, 7}, {6, 2, 7, 4}, {1, 2, 4, 7}};
        for (const auto& t : tets)
          for (int c : t) ids.push_back(id(c ^ flip));
      }
  m.cells.connectivity = Array::from_vector(ids), m.cells.fixed = 4;
  return make_dataset(m, fields);
}

struct Way {
  const char* name;
  void (*set)(VolumeItem& item);
};
const Way ways[] = {
    {"within the tolerance", [](VolumeItem&) {}},
    {"lit", [](VolumeItem& v) { v.shaded = true; }},
    {"lit, in fixed steps", [](VolumeItem& v) { v.shaded = true, v.sampling.step = 0.0625; }},
    {"in fixed steps", [](VolumeItem& v) { v.sampling.step = 0.0625; }},
    {"maximum", [](VolumeItem& v) { v.mode = RayFunction::maximum; }},
    {"minimum", [](VolumeItem& v) { v.mode = RayFunction::minimum; }},
    {"average", [](VolumeItem& v) { v.mode = RayFunction::average; }},
    {"sum", [](VolumeItem& v) { v.mode = RayFunction::sum; }},
    {"length", [](VolumeItem& v) { v.mode = RayFunction::accumulate, v.levels = {0.25}; }},
    {"fourier sum", [](VolumeItem& v) { v.method = VolumeMethod::fourier, v.mode = RayFunction::sum; }},
    {"fourier average", [](VolumeItem& v) { v.method = VolumeMethod::fourier, v.mode = RayFunction::average; }},
    {"two volumes", [](VolumeItem& v) { v.shaded = true; }},
    {"isosurface",
     [](VolumeItem& v) {
       v.mode = RayFunction::isosurface, v.levels = {0.125, 0.5}, v.shaded = true;
     }},
    {"first hit", [](VolumeItem& v) { v.mode = RayFunction::first_hit, v.levels = {0.25}, v.shaded = true; }},
    {"distance", [](VolumeItem& v) { v.mode = RayFunction::distance, v.levels = {0.25}; }},
    {"by the gradient",
     [](VolumeItem& v) {
       v.detail.second = SecondAxis::gradient, v.detail.second_factor.points = {{0.5, 0}, {2, 1}};
     }},
    {"by widgets of all shapes",
     [](VolumeItem& v) {
       using Shape = TransferWidget::Shape;
       v.detail.second = SecondAxis::gradient;
       v.detail.widgets = {painted({{-0.5, 0.25}, {0.25, 1}, {0.5, 0.5}}, 0.25, 0.25, 0.75, {1, 0, 0}),
                           {Shape::ellipse, -0.25, 0.75, 0.5, 1.5, 0.5, {-1, -1, -1}},
                           {Shape::triangle, -0.75, -0.25, 0, 1, 0.5, {0, 0, 1}},
                           {Shape::rectangle, 0.5, 1, 0, 1, 0.25, {0, 1, 0}}};
     }},
    {"log colours", [](VolumeItem& v) { v.color.kind = ScaleKind::log, v.color.lo = 0.03125, v.color.hi = 1; }},
    {"splats", [](VolumeItem& v) { v.method = VolumeMethod::splat; }},
    {"slices", [](VolumeItem& v) { v.method = VolumeMethod::slices, v.shaded = true; }},
    {"shear_warp", [](VolumeItem& v) { v.method = VolumeMethod::shear_warp; }},
    {"projected cells", [](VolumeItem& v) { v.method = VolumeMethod::cells; }},
    {"shadows", [](VolumeItem& v) { v.shaded = true, v.light.shadows = 1; }},
};

/// Splats, slices and sheared slices are of uniform grids.
bool can_draw(const std::string& kind, const Way& way) {
  VolumeItem v;
  way.set(v);
  // A field of cells has no gradient where it is drawn; bricks are drawn by rays.
  if (v.detail.second != SecondAxis::none && kind.find("cells") != std::string::npos) return false;
  if (v.mode == RayFunction::isosurface && kind == "tetrahedra with a field of cells") return false;  // none
  if (kind == "bricked") return v.method == VolumeMethod::ray;
  return kind == "uniform" || v.method == VolumeMethod::ray || v.method == VolumeMethod::cells;
}

/// The same scene in other units.
Frame picture(const std::string& kind, const Way& way, double value, double length, ElementType type) {
  ColorScale color = [] {
    ColorScale s;
    s.map = find_colormap("sight"), s.lo = -1, s.hi = 1;
    return s;
  }();
  VolumeItem v = item(dataset(kind, value, length, type), color, OpacityCurve{{{-1, 0}, {-0.125, 0}, {0.75, 0.75}}});
  v.unit_distance = 0.25, v.sampling.step = 0;
  way.set(v);
  if (kind.find("cells") != std::string::npos) v.association = Association::cell;
  const bool lengths = v.mode == RayFunction::distance || v.mode == RayFunction::accumulate;
  const double shown = lengths ? length : v.mode == RayFunction::sum ? value * length : value;
  v.color.lo *= shown, v.color.hi *= shown;
  for (Vec2& p : v.opacity.points) p.x *= shown;
  for (double& l : v.levels) l *= value;
  for (Vec2& p : v.detail.second_factor.points)
    if (v.detail.second == SecondAxis::gradient) p.x *= value / length;
  for (TransferWidget& w : v.detail.widgets) {
    w.lo *= value, w.hi *= value, w.second_lo *= value / length, w.second_hi *= value / length;
    w.radius *= value, w.second_radius *= value / length;
    for (Vec2& p : w.line) p.x *= value, p.y *= value / length;
  }
  v.unit_distance *= length, v.sampling.step *= length;
  const Projection view = [&] {
    const bool parallel = v.method == VolumeMethod::fourier;
    Projection p = parallel ? parallel_view(8, 8, 4, {-1.9, -1.4, -2.6}) : perspective_view(8, 8, 9.3, {1.9, 1.4, 2.6}, {0, 0, 0});
    p.eye = p.eye * length, p.near_plane *= length, p.far_plane *= length;
    if (parallel) p.scale /= length;
    return p;
  }();
  if (std::string(way.name) != "two volumes") return draw(scene_of({v}), view);
  // The other one in units of its own.
  VolumeItem other = v;
  other.data = dataset(kind, 0.25, length, ElementType::f32);
  other.color.lo = -0.25, other.color.hi = 0.25, other.opacity.points = {{-0.25, 0.5}, {-0.1875, 0.25}, {0, 0}};
  return draw(scene_of({v, other}), view);
}

const char* const dataset_kinds[] = {"uniform", "rectilinear",       "curvilinear", "tetrahedra", "tetrahedra with a field of cells",
                                     "AMR",     "AMR grid of cells", "bricked"};
/// Some are tried in every unit, the others in a few.
bool often(const std::string& kind) { return kind == "uniform" || kind == "tetrahedra"; }

bool same_colors(const Frame& a, const Frame& b) { return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0; }
double covered(const Frame& f) {
  double sum = 0;
  for (size_t i = 3; i < f.rgba.size(); i += 4) sum += double(f.rgba[i]);
  return sum / double(f.rgba.size() / 4);
}

}  // namespace

TEST_CASE("volume units: values and lengths times powers of two give the same bytes, on every mesh and in every way") {
  for (const std::string kind : dataset_kinds)
    for (const Way& way : ways) {
      if (!can_draw(kind, way)) continue;
      const Frame truth = picture(kind, way, 1, 1, ElementType::f32);
      INFO(kind, ", ", std::string(way.name));
      CHECK(covered(truth) > 0.05);
      // 2^-43 is about 1e-13, 2^70 a kiloparsec in centimetres.
      for (const double value : often(kind) ? std::vector{0x1p-43, 0x1p-10, 0x1p52, 0x1p-100, 0x1p100} : std::vector{0x1p-43, 0x1p100})
        CHECK_MESSAGE(same_colors(picture(kind, way, value, 1, ElementType::f32), truth), "values times ", value);
      for (const double length : often(kind) ? std::vector{0x1p70, 0x1p7, 0x1p-66} : std::vector{0x1p70, 0x1p-66})
        CHECK_MESSAGE(same_colors(picture(kind, way, 1, length, ElementType::f32), truth), "lengths times ", length);
      CHECK_MESSAGE(same_colors(picture(kind, way, 0x1p-30, 0x1p60, ElementType::f32), truth), "both");
      if (kind == "bricked") continue;
      const Frame wide = picture(kind, way, 1, 1, ElementType::f64);
      for (const double value : often(kind) ? std::vector{0x1p-600, 0x1p500} : std::vector{0x1p-600})
        CHECK_MESSAGE(same_colors(picture(kind, way, value, 1, ElementType::f64), wide), "wide values times ", value);
    }
}

TEST_CASE("volume units: a field in any unit looks the same") {
  for (const std::string kind : dataset_kinds)
    for (const Way& way : ways) {
      if (!can_draw(kind, way)) continue;
      INFO(kind, ", ", std::string(way.name));
      const ElementType type = kind == "bricked" ? ElementType::f32 : ElementType::f64;
      const Frame truth = picture(kind, way, 1, 1, type);
      for (const double unit : often(kind) ? std::vector{1e-13, 1.602e-19, 1e-30, 1e15, 3.7e21} : std::vector{1e-13, 1e15}) {
        CHECK_MESSAGE(largest_difference(picture(kind, way, unit, 1, type), truth) < 0.002f, "values times ", unit);
        CHECK_MESSAGE(largest_difference(picture(kind, way, 1, unit, type), truth) < 0.002f, "lengths times ", unit);
        CHECK_MESSAGE(largest_difference(picture(kind, way, unit, 1 / unit, type), truth) < 0.002f, "gradients times ", unit * unit);
      }
    }
}

TEST_CASE("volume units: depth stays in world lengths, and surfaces before and behind the volume do") {
  const Way& way = ways[0];
  const Frame near = picture("uniform", way, 1, 1, ElementType::f32), far = picture("uniform", way, 1, 0x1p70, ElementType::f32);
  size_t seen = 0;
  for (size_t i = 0; i < near.depth.size(); ++i) {
    if (!(near.depth[i] < HUGE_VALF)) continue;
    ++seen;
    CHECK(double(far.depth[i]) == double(near.depth[i]) * 0x1p70);
  }
  CHECK(seen > 0);
}
