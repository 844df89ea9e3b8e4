// SPDX-License-Identifier: Apache-2.0
#include "filter/surface/texture_coordinates.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include "data/field_ops.h"
#include "filter/surface/polygons.h"

namespace sg {

void describe(Schema& s, TextureCoordinatesParams& p) {
  s("map", p.map,
    "How the surface is laid into the picture: flat on a plane, rolled around a cylinder or a sphere, or each polygon on the side of a box "
    "that it faces.");
  s("axis", p.axis,
    "Axis across the plane, or that of the cylinder and sphere; auto: that along which the data is thinnest, for round ones z.");
  s("size", p.size, "Length in the data that the picture covers once; 0: the whole data. Angles always go around once.").at_least(0);
}

namespace {

using namespace surface;

class Mapping {
 public:
  Mapping(const Box3& box, const TextureCoordinatesParams& p) : map_(p.map), middle_(box.center()), lo_(box.lo) {
    const Vec3 size = box.size();
    axis_ = 2;
    if (p.axis != TextureAxis::automatic) axis_ = p.axis == TextureAxis::x ? 0 : p.axis == TextureAxis::y ? 1 : 2;
    else if (p.map == TextureMap::plane) axis_ = size.z <= size.x && size.z <= size.y ? 2 : size.y <= size.x ? 1 : 0;
    for (int a = 0; a < 3; ++a) unit_[a] = p.size > 0 ? p.size : size[a] > 0 ? size[a] : 1;
  }

  bool round() const { return map_ == TextureMap::cylinder || map_ == TextureMap::sphere; }
  /// Axis of a polygon with this normal, for boxes.
  int axis_of(Vec3 normal) const {
    if (map_ != TextureMap::box) return axis_;
    const Vec3 n{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    return n.z >= n.x && n.z >= n.y ? 2 : n.y >= n.x ? 1 : 0;
  }
  /// NaN for u on the axis, where it is any.
  Vec2 at(Vec3 p, int axis) const {
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;  // upright and not mirrored, seen from the front, the right or above
    if (!round()) return {(p[a] - lo_[a]) / unit_[a], (p[b] - lo_[b]) / unit_[b]};
    const int first = (axis + 1) % 3, second = (axis + 2) % 3;
    const Vec3 d = p - middle_;
    const double around = std::hypot(d[first], d[second]), far = std::hypot(around, d[axis]);
    Vec2 uv{0.5 + std::atan2(d[second], d[first]) / (2 * std::numbers::pi), 0};
    uv.y = map_ == TextureMap::cylinder ? (p[axis] - lo_[axis]) / unit_[axis] : 0.5 + std::atan2(d[axis], around) / std::numbers::pi;
    if (!(around > 1e-9 * far)) uv.x = std::nan("");
    return uv;
  }

 private:
  TextureMap map_;
  Vec3 middle_, lo_;
  double unit_[3]{1, 1, 1};
  int axis_ = 2;
};

/// The angles of a polygon's corners on one turn, and those of corners on the axis between the others.
void unroll(std::vector<Vec2>& corners) {
  double first = std::nan(""), sum = 0;
  int known = 0;
  for (Vec2& c : corners) {
    if (std::isnan(c.x)) continue;
    if (std::isnan(first)) first = c.x;
    else c.x -= std::nearbyint(c.x - first);
    sum += c.x, ++known;
  }
  // Above 0, where the first turn begins.
  const double least = std::transform_reduce(
      corners.begin(), corners.end(), HUGE_VAL, [](double a, double b) { return std::min(a, b); },
      [](Vec2 c) { return std::isnan(c.x) ? HUGE_VAL : c.x; });
  const double back = known ? std::floor(least) : 0;
  for (Vec2& c : corners) c.x = (std::isnan(c.x) ? (known ? sum / known : 0.5) : c.x) - back;
}

}  // namespace

DatasetPtr texture_coordinates(const DatasetPtr& in, const TextureCoordinatesParams& p, Context& ctx) {
  const DatasetPtr s = polygon_surface(in, "texture_coordinates", ctx);
  SurfaceMesh mesh = *s->as<SurfaceMesh>();
  const std::vector<Vec3> at = positions(mesh.points);
  const Mapping mapping(s->bounds(), p);
  const CellsView polygons = cells_view(mesh.polygons);
  const std::vector<Vec3> normal = vector_areas(polygons, at);

  // The first place of a point is its own; for each other one it is doubled.
  std::vector<Vec2> uv(at.size());
  std::vector<uint8_t> placed(at.size(), 0);
  std::vector<int64_t> source(at.size());
  std::iota(source.begin(), source.end(), 0);
  std::vector<uint32_t> ids;
  std::map<std::tuple<int64_t, double, double>, uint32_t> doubled;
  std::vector<Vec2> corners;
  for (size_t c = 0; c < polygons.count; ++c) {
    corners.clear();
    const int axis = mapping.axis_of(normal[c]);
    for (size_t k = polygons.begin(c); k < polygons.end(c); ++k) corners.push_back(mapping.at(at[size_t(polygons.connectivity[k])], axis));
    if (mapping.round()) unroll(corners);
    for (size_t k = polygons.begin(c), i = 0; k < polygons.end(c); ++k, ++i) {
      const int64_t point = polygons.connectivity[k];
      const Vec2 place = corners[i];
      if (!placed[size_t(point)]) placed[size_t(point)] = 1, uv[size_t(point)] = place;
      const Vec2 own = uv[size_t(point)];
      if (own == place || !(place.x == place.x && place.y == place.y)) {
        ids.push_back(uint32_t(point));
        continue;
      }
      const auto [entry, added] = doubled.try_emplace({point, place.x, place.y}, uint32_t(source.size()));
      if (added) source.push_back(point), uv.push_back(place);
      ids.push_back(entry->second);
    }
  }
  for (size_t i = 0; i < at.size(); ++i)  // of lines and vertices
    if (!placed[i]) {
      uv[i] = mapping.at(at[i], mapping.axis_of({}));
      if (std::isnan(uv[i].x)) uv[i].x = 0.5;
    }
  float* to = nullptr;
  Array values = Array::make<float>(uv.size(), 2, &to);
  for (size_t i = 0; i < uv.size(); ++i) to[2 * i] = float(uv[i].x), to[2 * i + 1] = float(uv[i].y);

  DatasetParts out;
  if (source.size() > at.size()) {
    mesh.points = gather_points(mesh.points, source);
    mesh.polygons.connectivity = id_array(ids);
    carry_gathered(out.fields, s->fields(), Association::point, std::span<const int64_t>(source), Association::point);
    for (const Field& f : s->fields())
      if (f.association != Association::point) out.fields.add(f);
    if (!s->point_ghost().empty()) out.point_ghost = gather(s->point_ghost(), std::span<const int64_t>(source));
  } else {
    out.fields = s->fields(), out.point_ghost = s->point_ghost();
  }
  std::vector<std::string> others;  // the new ones count
  for (const Field& f : out.fields)
    if (f.role == Role::tcoords && f.association == Association::point) others.push_back(f.name);
  for (const std::string& name : others) {
    Field f = out.fields.require(name, Association::point);
    f.role = Role::none;
    out.fields.add(std::move(f));
  }
  out.fields.add({"texture coordinates", Association::point, std::move(values), "", Role::tcoords});
  out.mesh = std::move(mesh);
  out.notes = s->notes();
  out.time = s->time();
  return make_dataset(std::move(out));
}

}  // namespace sg
