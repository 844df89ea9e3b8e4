// SPDX-License-Identifier: Apache-2.0
#include "render/raster/discs/discs.h"
#include "render/shade/blinn_phong.h"

#include <algorithm>
#include <cmath>

namespace sg::raster {

namespace {

float along(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

void draw_discs_one_by_one(const DiscJob& job, size_t begin, size_t end) {
  const EyeView& v = job.view;
  for (size_t i = begin; i < end; ++i) {
    const size_t p = job.points ? job.points[i] : i;
    const EyePoint e = to_eye(v, job.xyz + 3 * p);
    const float r = job.radius[p];
    if (!(e.z > v.near_plane) || !(e.z < v.far_plane) || !(r > 0)) continue;
    const float scale = v.parallel ? v.scale : v.scale / e.z;
    const float cx = v.center_x + scale * e.x, cy = v.center_y - scale * e.y, reach = r * scale;
    if (!(cx > -1e6f && cx < 1e6f && cy > -1e6f && cy < 1e6f)) continue;
    const auto primitive = job.first_primitive + uint32_t(i);
    auto put = [&](int x, int y, float z) {
      if (z > v.near_plane && z < v.far_plane) keep_nearer(&job.keys[size_t(y) * size_t(v.width) + size_t(x)], depth_key(z, primitive));
    };
    if (reach < 0.7f) {
      const int x = int(std::floor(cx)), y = int(std::floor(cy));
      if (x >= 0 && y >= 0 && x < v.width && y < v.height) put(x, y, e.z);
      continue;
    }
    const float* m = job.normals + 3 * p;
    const float n[3] = {along(m, v.right), along(m, v.up), along(m, v.forward)};
    // A disc that leans towards the viewer reaches further on the picture than its radius at the centre's depth.
    const float grown = v.parallel || !(e.z > 2 * r) ? reach * (v.parallel ? 1.0f : 4.0f) : reach * e.z / (e.z - r);
    const int x0 = int(std::max(std::ceil(cx - grown - 0.5f), 0.0f)), x1 = int(std::min(std::floor(cx + grown - 0.5f), float(v.width - 1)));
    const int y0 = int(std::max(std::ceil(cy - grown - 0.5f), 0.0f)),
              y1 = int(std::min(std::floor(cy + grown - 0.5f), float(v.height - 1)));
    const float plane = n[0] * e.x + n[1] * e.y + n[2] * e.z, inverse = 1 / v.scale, r2 = r * r;
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const float dx = (float(x) + 0.5f - v.center_x) * inverse, dy = (v.center_y - float(y) - 0.5f) * inverse;
        float qx, qy, z;
        if (v.parallel) {
          qx = dx, qy = dy, z = (plane - n[0] * dx - n[1] * dy) / n[2];
        } else {
          z = plane / (n[0] * dx + n[1] * dy + n[2]);
          qx = dx * z, qy = dy * z;
        }
        const float ox = qx - e.x, oy = qy - e.y, oz = z - e.z;
        if (ox * ox + oy * oy + oz * oz <= r2) put(x, y, z);
      }
  }
}

namespace {

void light_one(const PreparedItem& item, const EyeView& v, const std::vector<Lamp>& lights, ShadeBatch& b, size_t i) {
  const float* normals = reinterpret_cast<const float*>(item.disc_normals.raw());
  const size_t p = item.points ? (*item.points)[b.triangle[i]] : b.triangle[i];
  const int x = b.tile_x + int(b.pixel[i]) % tile_size, y = b.tile_y + int(b.pixel[i]) / tile_size;
  Vec3f view(-v.forward[0], -v.forward[1], -v.forward[2]);
  if (!v.parallel) {
    const float dx = (float(x) + 0.5f - v.center_x) / v.scale, dy = (v.center_y - float(y) - 0.5f) / v.scale;
    view = normalize(view - Vec3f(v.right[0], v.right[1], v.right[2]) * dx - Vec3f(v.up[0], v.up[1], v.up[2]) * dy);
  }
  Vec3f n(normals[3 * p], normals[3 * p + 1], normals[3 * p + 2]);
  if (dot(n, view) < 0) n = -n;
  light_point(item.material, lights, n, view, b.light[i], b.gloss[i]);
}

}  // namespace

void shade_discs(const PreparedItem& item, const EyeView& v, const std::vector<Lamp>& lights, const uint64_t* keys, ShadeBatch& b) {
  if (b.n == 0) return;
  const Material& m = item.material;
  const ColorSource& color = item.color;
  if (item.positions.count() < size_t(INT32_MAX) / 3) {
    light_discs({v, m, lights, item.points ? item.points->data() : nullptr, reinterpret_cast<const float*>(item.disc_normals.raw())}, b);
  } else {
    for (size_t i = 0; i < b.n; ++i) light_one(item, v, lights, b, i);
  }
  for (size_t i = 0; i < b.n; ++i) {
    const int x = b.tile_x + int(b.pixel[i]) % tile_size, y = b.tile_y + int(b.pixel[i]) / tile_size;
    b.depth[i] = key_depth(keys[size_t(y) * size_t(v.width) + size_t(x)]);
  }
  if (color.kind == ColorSource::Kind::constant) {
    for (size_t k = 0; k < 4; ++k) std::fill_n(b.rgba[k], b.n, color.constant[int(k)]);
    return;
  }
  for (size_t i = 0; i < b.n; ++i) {
    const size_t p = item.points ? (*item.points)[b.triangle[i]] : b.triangle[i];
    Vec4f rgba;
    if (color.kind == ColorSource::Kind::scalar) rgba = color.of(color.data()[p]);
    else
      for (int k = 0; k < 4; ++k) rgba[k] = color.data()[4 * p + size_t(k)];
    for (int k = 0; k < 4; ++k) b.rgba[k][i] = rgba[k];
  }
}

}  // namespace sg::raster
