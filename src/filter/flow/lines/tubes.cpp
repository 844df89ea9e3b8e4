// SPDX-License-Identifier: Apache-2.0
#include "filter/flow/lines/tubes.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/parallel.h"
#include "data/field_ops.h"
#include "filter/flow/lines/line_frames.h"
#include "filter/mesh/surface.h"

namespace sg {

void describe(Schema& s, TubesParams& p) {
  s("radius", p.radius, "Radius of the tubes; default: a 300th of the lines' diagonal, less for crowded lines.").unit("length").positive();
  s("radius_field", p.radius_field, "Point field that scales the radius, from 1 to 'ratio' times.").takes(fields::on_points);
  s("ratio", p.ratio, "Largest over smallest radius, with radius_field.").range(1, 1e6);
  s("sides", p.sides, "Number of points around the tube.").range(3, 1000);
  s("caps", p.caps, "Close the ends.");
}

void describe(Schema& s, RibbonsParams& p) {
  s("width", p.width, "Width of the ribbons; default: a 75th of the lines' diagonal, less for crowded lines.").unit("length").positive();
  s("width_field", p.width_field, "Point field that scales the width, from 1 to 'ratio' times.").takes(fields::on_points);
  s("ratio", p.ratio, "Largest over smallest width, with width_field.").range(1, 1e6);
  s("rotation", p.rotation, "Point field of angles by which ribbons turn about their line; default: 'rotation', if there is one.")
      .takes(fields::point_scalars)
      .unit("rad");
  s("normal", p.normal, "Direction that the ribbons face at their start; default: any.");
}

namespace {

// A body about lines while it is built: which point of the lines each new point belongs to, and which line each new cell.
struct Body {
  std::vector<float> xyz, normals;
  std::vector<uint32_t> point_of, cell_of;
  std::vector<int64_t> corners, offsets{0};

  int64_t add(Vec3 x, Vec3 normal, uint32_t of) {
    xyz.insert(xyz.end(), {float(x.x), float(x.y), float(x.z)});
    normals.insert(normals.end(), {float(normal.x), float(normal.y), float(normal.z)});
    point_of.push_back(of);
    return int64_t(point_of.size() - 1);
  }
  void polygon(std::initializer_list<int64_t> ids, uint32_t cell) {
    corners.insert(corners.end(), ids);
    offsets.push_back(int64_t(corners.size())), cell_of.push_back(cell);
  }
};

// Bodies of chunks of lines, one behind the other, with the fields of the lines.
DatasetPtr assemble(const DatasetPtr& lines, std::vector<Body>& parts) {
  Body all;
  for (Body& p : parts) {
    const auto first = int64_t(all.point_of.size());
    const int64_t before = all.offsets.back();
    all.xyz.insert(all.xyz.end(), p.xyz.begin(), p.xyz.end());
    all.normals.insert(all.normals.end(), p.normals.begin(), p.normals.end());
    all.point_of.insert(all.point_of.end(), p.point_of.begin(), p.point_of.end());
    all.cell_of.insert(all.cell_of.end(), p.cell_of.begin(), p.cell_of.end());
    for (const int64_t c : p.corners) all.corners.push_back(first + c);
    for (size_t k = 1; k < p.offsets.size(); ++k) all.offsets.push_back(before + p.offsets[k]);
    p = {};
  }
  SurfaceMesh mesh;
  mesh.points.origin = lines->as<SurfaceMesh>()->points.origin;
  mesh.points.xyz = Array::from_vector(std::move(all.xyz), 3);
  mesh.polygons.connectivity = Array::from_vector(std::move(all.corners));
  mesh.polygons.offsets = Array::from_vector(std::move(all.offsets));
  DatasetParts out{std::move(mesh), {}, {}, {}, lines->notes(), lines->time()};
  carry_gathered(out.fields, lines->fields(), Association::point, all.point_of, Association::point);
  carry_gathered(out.fields, lines->fields(), Association::cell, all.cell_of, Association::cell);
  carry_whole(out.fields, lines->fields());
  out.fields.add({"Normals", Association::point, Array::from_vector(std::move(all.normals), 3), "", Role::normals});
  return make_dataset(std::move(out));
}

// The lines of any mesh; throws when there are none.
DatasetPtr lines_of(const DatasetPtr& in, const char* who, Context& context) {
  const DatasetPtr surface = surface_of(in, context);
  if (surface->as<SurfaceMesh>()->lines.size() == 0)
    fail_usage(fmt::format("the mesh ({}) has no lines", in->kind()), who, "make lines with streamlines, isolines or feature_edges");
  return surface;
}

// Sizes along the lines: `least`, or from it to ratio times it by a field.
struct Sizes {
  double least, ratio;
  Array values;
  Range range;
  double at(uint32_t point) const {
    if (values.empty() || !(range.hi > range.lo)) return least;
    const double v = values.view<double>()[point];
    if (!std::isfinite(v)) return least;
    return least * (1 + (ratio - 1) * (v - range.lo) / (range.hi - range.lo));
  }
};

// The share of the diagonal, but no more than lets bodies `across` times as wide as the result cover the shadow of the lines' box once:
// single ones can still be distinguished. Not less than a fifth of the share.
double width_for(const Dataset& d, double share, double across) {
  const Vec3 e = d.bounds().size();
  const double shadow = (e.x * e.y + e.y * e.z + e.z * e.x) * (std::min({e.x, e.y, e.z}) > 1e-6 * d.bounds().diagonal() ? 0.5 : 1.0);
  double all = 0;
  const SurfaceMesh& mesh = *d.as<SurfaceMesh>();
  for (const LinePath& path : line_paths(d))
    for (size_t i = 1; i < path.points.size(); ++i) all += length(mesh.points.at(path.points[i]) - mesh.points.at(path.points[i - 1]));
  const double most = d.bounds().diagonal() * share;
  return all > 0 && shadow > 0 ? std::clamp(shadow / (across * all), 0.2 * most, most) : most;
}

Sizes sizes_of(const Dataset& d, const std::optional<double>& asked, double share, double across, const FieldName& name, double ratio) {
  Sizes s{asked ? *asked : width_for(d, share, across), ratio, {}, {}};
  if (name.empty()) return s;
  const Field& f = d.fields().require(name.name);
  if (f.association != Association::point) fail_usage(fmt::format("field '{}' is not a point field", f.name), "lines", "cell_to_point");
  s.values = scalar_of(f, f.components() > 1 ? -1 : 0, ElementType::f64);
  s.range = d.range(f);
  return s;
}

// Frames of one line, relative to the mesh's origin.
void frames_of(const SurfaceMesh& mesh, const LinePath& path, Vec3 first, std::vector<Vec3>& at, std::vector<LineFrame>& frames) {
  at.clear();
  for (const uint32_t p : path.points) at.push_back(mesh.points.at(p) - mesh.points.origin);
  make_frames(at, path.closed, first, frames);
}

constexpr size_t lines_per_chunk = 16;

template <class Make>
DatasetPtr bodies(const DatasetPtr& lines, Context& context, Make&& make) {
  const std::vector<LinePath> paths = line_paths(*lines);
  std::vector<Body> parts((paths.size() + lines_per_chunk - 1) / lines_per_chunk);
  parallel_for(
      paths.size(), lines_per_chunk,
      [&](size_t begin, size_t end) {
        std::vector<Vec3> at;
        std::vector<LineFrame> frames;
        for (size_t i = begin; i < end; ++i) make(paths[i], at, frames, parts[begin / lines_per_chunk]);
      },
      &context);
  return assemble(lines, parts);
}

}  // namespace

DatasetPtr tubes(const DatasetPtr& in, const TubesParams& p, Context& context) {
  const DatasetPtr lines = lines_of(in, "tubes", context);
  const SurfaceMesh& mesh = *lines->as<SurfaceMesh>();
  const Sizes sizes = sizes_of(*lines, p.radius, 1.0 / 300, 2, p.radius_field, p.ratio);
  const int n = p.sides;
  std::vector<Vec2> circle;
  for (int k = 0; k < n; ++k) {
    const double a = 2 * 3.14159265358979323846 * k / n;
    circle.push_back({std::cos(a), std::sin(a)});
  }
  return bodies(lines, context, [&](const LinePath& path, std::vector<Vec3>& at, std::vector<LineFrame>& frames, Body& body) {
    frames_of(mesh, path, {}, at, frames);
    const size_t rings = frames.size();
    const auto ring = [&](size_t i, std::optional<Vec3> normal) {
      const LineFrame& f = frames[i];
      const double r = sizes.at(path.points[i]);
      int64_t first = 0;
      for (int k = 0; k < n; ++k) {
        const Vec3 out = f.normal * circle[size_t(k)].x + f.binormal * circle[size_t(k)].y;
        const int64_t id = body.add(f.at + out * r, normal.value_or(out), path.points[i]);
        if (k == 0) first = id;
      }
      return first;
    };
    std::vector<int64_t> first(rings);
    for (size_t i = 0; i < rings; ++i) first[i] = ring(i, {});
    for (size_t i = 0; i + 1 < rings + size_t(path.closed); ++i) {
      const int64_t a = first[i], b = first[(i + 1) % rings];
      for (int k = 0; k < n; ++k) {
        const int m = (k + 1) % n;
        body.polygon({a + k, a + m, b + m, b + k}, path.cell);
      }
    }
    if (!p.caps || path.closed) return;
    for (const bool front : {true, false}) {
      const size_t i = front ? 0 : rings - 1;
      const int64_t a = ring(i, front ? -frames[i].tangent : frames[i].tangent);
      for (int k = 0; k < n; ++k) body.corners.push_back(a + (front ? n - 1 - k : k));
      body.offsets.push_back(int64_t(body.corners.size())), body.cell_of.push_back(path.cell);
    }
  });
}

DatasetPtr ribbons(const DatasetPtr& in, const RibbonsParams& p, Context& context) {
  const DatasetPtr lines = lines_of(in, "ribbons", context);
  const SurfaceMesh& mesh = *lines->as<SurfaceMesh>();
  const Sizes sizes = sizes_of(*lines, p.width, 1.0 / 75, 0.7, p.width_field, p.ratio);
  Array angles;
  const Field* turning =
      p.rotation.empty() ? lines->fields().find("rotation", Association::point) : &lines->fields().require(p.rotation.name);
  if (turning) {
    if (turning->association != Association::point || turning->components() != 1)
      fail_usage(fmt::format("field '{}' is not a point field of angles", turning->name), "ribbons");
    angles = scalar_of(*turning, 0, ElementType::f64);
  }
  return bodies(lines, context, [&](const LinePath& path, std::vector<Vec3>& at, std::vector<LineFrame>& frames, Body& body) {
    frames_of(mesh, path, p.normal.value_or(Vec3()), at, frames);
    const size_t rungs = frames.size();
    for (size_t i = 0; i < rungs; ++i) {
      const LineFrame& f = frames[i];
      double angle = angles.empty() ? 0 : angles.view<double>()[path.points[i]];
      if (!std::isfinite(angle)) angle = 0;
      const Vec3 facing = f.normal * std::cos(angle) + f.binormal * std::sin(angle), side = cross(facing, f.tangent);
      const double half = sizes.at(path.points[i]) / 2;
      body.add(f.at - side * half, facing, path.points[i]);
      body.add(f.at + side * half, facing, path.points[i]);
    }
    const int64_t first = int64_t(body.point_of.size() - 2 * rungs);
    for (size_t i = 0; i + 1 < rungs + size_t(path.closed); ++i) {
      const int64_t a = first + int64_t(2 * i), b = first + int64_t(2 * ((i + 1) % rungs));
      body.polygon({a, a + 1, b + 1, b}, path.cell);
    }
  });
}

}  // namespace sg
