// SPDX-License-Identifier: Apache-2.0
// The jobs of deferred shading, and the reference of its vector code.
#include "render/shade/shade.h"

#include <cmath>

#include "render/shade/blinn_phong.h"

namespace sg::raster {

ShadeJob shade_job(const PreparedItem& item, const EyeView& view, const std::vector<Lamp>& lights) {
  ShadeJob j{};
  const TriangleSet& t = item.triangles;
  j.view = view, j.xyz = t.xyz(), j.triangles = t.indices();
  j.normals = item.normals.normals.empty() ? nullptr : reinterpret_cast<const float*>(item.normals.normals.raw());
  j.corners = item.normals.corners.empty() ? t.indices() : reinterpret_cast<const uint32_t*>(item.normals.corners.raw());
  j.color = &item.color, j.cells = t.cell_list(), j.first_cell = t.first_cell;
  j.material = item.material, j.lights = lights;
  return j;
}

void shade_reference(const ShadeJob& job, ShadeBatch& b) {
  const EyeView& v = job.view;
  auto point = [](const float* base, uint32_t i) { return Vec3(base[3 * size_t(i)], base[3 * size_t(i) + 1], base[3 * size_t(i) + 2]); };
  auto three = [](const float* a) { return Vec3(a[0], a[1], a[2]); };
  for (size_t i = 0; i < b.n; ++i) {
    const uint32_t triangle = b.triangle[i], *t = job.triangles + 3 * size_t(triangle), *c = job.corners + 3 * size_t(triangle);
    const double x = (double(b.tile_x) + b.pixel[i] % tile_size + 0.5 - v.center_x) / v.scale,
                 y = (v.center_y - (double(b.tile_y) + b.pixel[i] / tile_size + 0.5)) / v.scale;
    const Vec3 eye = three(v.hi) + three(v.lo), side = three(v.right) * x + three(v.up) * y, forward = three(v.forward);
    const Vec3 ray = v.parallel ? forward : forward + side, start = v.parallel ? eye + side : eye;
    const Vec3 p0 = point(job.xyz, t[0]), p1 = point(job.xyz, t[1]), p2 = point(job.xyz, t[2]);
    // Where the ray meets the plane, then areas.
    const Vec3 plane = cross(p1 - p0, p2 - p0);
    const double s = dot(p0 - start, plane) / dot(ray, plane), area = dot(plane, plane);
    const Vec3 hit = start + ray * s;
    double w[3] = {dot(cross(p1 - hit, p2 - hit), plane) / area, dot(cross(p2 - hit, p0 - hit), plane) / area,
                   dot(cross(p0 - hit, p1 - hit), plane) / area};
    double sum = 0;
    for (double& k : w) k = std::isfinite(k) ? std::max(k, 0.0) : 1.0 / 3, sum += k;
    for (double& k : w) k /= sum;
    b.depth[i] = float(dot(p0 * w[0] + p1 * w[1] + p2 * w[2] - eye, forward));

    const Vec3 view = normalize(-ray);
    Vec3 face = normalize(plane);
    if (dot(face, view) < 0) face = -face;
    Vec3 n = face;
    if (job.normals) n = normalize(point(job.normals, c[0]) * w[0] + point(job.normals, c[1]) * w[1] + point(job.normals, c[2]) * w[2]);
    if (dot(n, face) < 0) n = -n;
    light_point(job.material, job.lights, Vec3f(n), Vec3f(view), b.light[i], b.gloss[i]);

    const ColorSource& color = *job.color;
    Vec4f rgba = color.constant;
    const size_t cell = job.cells ? job.cells[triangle] : job.first_cell + triangle;
    const float* values = color.kind == ColorSource::Kind::constant ? nullptr : color.data();
    const int nearest = w[2] > std::max(w[0], w[1]) ? 2 : w[1] > w[0] ? 1 : 0;
    auto value = [&](int stride, int k) {
      auto at = [&](size_t j) { return double(values[j * size_t(stride) + size_t(k)]); };
      if (color.per_cell) return at(cell);
      if (color.nearest) return at(t[nearest]);
      const double v[3] = {at(t[0]), at(t[1]), at(t[2])}, between = v[0] * w[0] + v[1] * w[1] + v[2] * w[2];
      if (between != between) return between;
      // Rounding must not push it across an end of the scale that the corners lie on.
      return std::clamp(between, std::min({v[0], v[1], v[2]}), std::max({v[0], v[1], v[2]}));
    };
    if (color.kind == ColorSource::Kind::scalar) rgba = color.of(float(value(1, 0)));
    if (color.kind == ColorSource::Kind::direct)
      for (int k = 0; k < 4; ++k) rgba[k] = float(value(4, k));
    for (int k = 0; k < 4; ++k) b.rgba[k][i] = rgba[k];
  }
}

}  // namespace sg::raster
