// SPDX-License-Identifier: Apache-2.0
// Physical units: a field in other units of value and of length gives the same picture.
#include <cstring>

#include "volume_support.h"

using namespace sg;
using namespace sg::test;

namespace {

double field_at(Vec3 p) { return 0.6 * std::sin(3 * p.x + 1) * std::cos(2.5 * p.y) + 0.4 * std::sin(4 * p.z + p.x * p.y); }

/// The field on 7^3 points over [-1, 1]^3, in units of so much.
DatasetPtr dataset(const std::string& kind, double value, double length, ElementType type) {
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
    {"sum", [](VolumeItem& v) { v.mode = RayFunction::sum; }},
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
  const bool lengths = v.mode == RayFunction::distance;
  const double shown = lengths ? length : v.mode == RayFunction::sum ? value * length : value;
  v.color.lo *= shown, v.color.hi *= shown;
  for (Vec2& p : v.opacity.points) p.x *= shown;
  for (double& l : v.levels) l *= value;
  for (Vec2& p : v.detail.second_factor.points)
    if (v.detail.second == SecondAxis::gradient) p.x *= value / length;
  v.unit_distance *= length, v.sampling.step *= length;
  const Projection view = [&] {
    Projection p = perspective_view(12, 12, 14, {1.9, 1.4, 2.6}, {0, 0, 0});
    p.eye = p.eye * length, p.near_plane *= length, p.far_plane *= length;
    return p;
  }();
  return draw(scene_of({v}), view);
}

bool same_colors(const Frame& a, const Frame& b) { return std::memcmp(a.rgba.data(), b.rgba.data(), a.rgba.size() * sizeof(float)) == 0; }
double covered(const Frame& f) {
  double sum = 0;
  for (size_t i = 3; i < f.rgba.size(); i += 4) sum += double(f.rgba[i]);
  return sum / double(f.rgba.size() / 4);
}

}  // namespace

TEST_CASE("volume units: values and lengths times powers of two give the same bytes, on every mesh and in every way") {
  for (const char* kind : {"uniform", "rectilinear", "curvilinear", "tetrahedra"})
    for (const Way& way : ways) {
      if (!can_draw(kind, way)) continue;
      const Frame truth = picture(kind, way, 1, 1, ElementType::f32);
      INFO(std::string(kind), ", ", std::string(way.name));
      CHECK(covered(truth) > 0.05);
      // 2^-43 is about 1e-13, 2^70 a kiloparsec in centimetres.
      for (const double value : {0x1p-43, 0x1p-10, 0x1p52, 0x1p-100, 0x1p100})
        CHECK_MESSAGE(same_colors(picture(kind, way, value, 1, ElementType::f32), truth), "values times ", value);
      for (const double length : {0x1p70, 0x1p7, 0x1p-66})
        CHECK_MESSAGE(same_colors(picture(kind, way, 1, length, ElementType::f32), truth), "lengths times ", length);
      CHECK_MESSAGE(same_colors(picture(kind, way, 0x1p-30, 0x1p60, ElementType::f32), truth), "both");
      const Frame wide = picture(kind, way, 1, 1, ElementType::f64);
      for (const double value : {0x1p-600, 0x1p500})
        CHECK_MESSAGE(same_colors(picture(kind, way, value, 1, ElementType::f64), wide), "wide values times ", value);
    }
}

TEST_CASE("volume units: a field in any unit looks the same") {
  for (const char* kind : {"uniform", "rectilinear", "curvilinear", "tetrahedra"})
    for (const Way& way : ways) {
      if (!can_draw(kind, way)) continue;
      INFO(std::string(kind), ", ", std::string(way.name));
      const Frame truth = picture(kind, way, 1, 1, ElementType::f64);
      for (const double unit : {1e-13, 1.602e-19, 1e-30, 1e15, 3.7e21}) {
        CHECK_MESSAGE(largest_difference(picture(kind, way, unit, 1, ElementType::f64), truth) < 0.002f, "values times ", unit);
        CHECK_MESSAGE(largest_difference(picture(kind, way, 1, unit, ElementType::f64), truth) < 0.002f, "lengths times ", unit);
        CHECK_MESSAGE(largest_difference(picture(kind, way, unit, 1 / unit, ElementType::f64), truth) < 0.002f, "gradients times ",
                      unit * unit);
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
