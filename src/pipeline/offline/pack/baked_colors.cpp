// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/baked_colors.h"

#include <cmath>
#include <vector>

#include "render/shade/picture_color.h"

namespace sg::offline {

namespace {

/// Half the mean length of the edges at each point, in the picture.
std::vector<double> reach_of(const raster::PlacedPicture& picture, const raster::TriangleSet& triangles) {
  std::vector<double> sum(triangles.positions.count());
  std::vector<int> edges(sum.size());
  const float* uv = picture.uv();
  for (size_t t = 0; t < triangles.count; ++t)
    for (size_t k = 0; k < 3; ++k) {
      const uint32_t a = triangles.indices()[3 * t + k], b = triangles.indices()[3 * t + (k + 1) % 3];
      const double edge =
          std::hypot(double(uv[2 * size_t(a)]) - double(uv[2 * size_t(b)]), double(uv[2 * size_t(a) + 1]) - double(uv[2 * size_t(b) + 1]));
      for (const uint32_t p : {a, b}) sum[p] += edge, ++edges[p];
    }
  for (size_t p = 0; p < sum.size(); ++p) sum[p] = edges[p] ? sum[p] / (2 * edges[p]) : 0;
  return sum;
}

}  // namespace

raster::ColorSource baked_colors(const raster::PreparedItem& item) {
  using Kind = raster::ColorSource::Kind;
  raster::ColorSource color = item.color;
  if (!item.pictures || color.kind == Kind::scalar || color.per_cell) return color;
  const raster::PictureSet& pictures = *item.pictures;
  if (!pictures.color && color.kind == Kind::constant) {
    color.constant = under_picture(pictures, {}, color.constant);
    return color;
  }
  const size_t points = item.triangles.positions.count();
  const std::vector<double> reach = pictures.color ? reach_of(*pictures.color, item.triangles) : std::vector<double>();
  float* out = nullptr;
  const Array baked = Array::make<float>(points, 4, &out);
  for (size_t p = 0; p < points; ++p) {
    Vec4f own = color.constant;
    if (color.kind == Kind::direct)
      for (size_t k = 0; k < 4; ++k) own[int(k)] = color.data()[4 * p + k];
    TexturePlace place;
    if (pictures.color) {
      const float* uv = pictures.color->uv() + 2 * p;
      place = {{double(uv[0]), double(uv[1])}, {reach[p], 0}, {0, reach[p]}};
    }
    const Vec4f seen = under_picture(pictures, place, own);
    for (size_t k = 0; k < 4; ++k) out[4 * p + k] = seen[int(k)];
  }
  color.kind = Kind::direct, color.values = baked, color.scale = nullptr, color.table.clear();
  return color;
}

}  // namespace sg::offline
