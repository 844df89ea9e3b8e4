// SPDX-License-Identifier: Apache-2.0
// Surfaces with vectors on them, for the tests of textures.
#pragma once
#include <functional>

#include "render/prepare/prepared.h"
#include "render/raster/lic/textures.h"
#include "render/raster/raster_support.h"
#include "render/scene_support.h"

namespace sg::test {

/// A square grid of n x n quads in the plane z over [-a, a]^2 with point vectors "v".
inline DatasetPtr sheet(int n, double a, double z, const std::function<Vec3(Vec3)>& v) {
  std::vector<float> xyz, vectors;
  std::vector<int32_t> t;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Vec3 p{a * (2.0 * i / n - 1), a * (2.0 * j / n - 1), z}, q = v(p);
      for (int c = 0; c < 3; ++c) xyz.push_back(float(p[c])), vectors.push_back(float(q[c]));
      if (i == n || j == n) continue;
      const int k = j * (n + 1) + i;
      for (int q : {k, k + 1, k + n + 2, k, k + n + 2, k + n + 1}) t.push_back(q);
    }
  FieldSet f;
  f.add({"v", Association::point, Array::from_vector(std::move(vectors), 3), "", Role::vectors});
  return surface(std::move(xyz), std::move(t), std::move(f));
}

inline SurfaceItem textured(DatasetPtr data, int steps = 20, double step = 0.5, LicKernel kernel = LicKernel::hann) {
  SurfaceItem s = item(std::move(data), {0.7f, 0.7f, 0.7f}, false);
  s.lic.emplace();
  s.lic->field = "v", s.lic->steps = steps, s.lic->step = step, s.lic->kernel = kernel;
  return s;
}

/// The planes of everything opaque.
inline raster::LicPlanes planes(const Scene& scene, const Camera& camera, int w, int h) {
  Context context;
  const auto t = texture_scene(*prepare_scene(scene, context), make_projection(camera, w, h), context);
  REQUIRE(t);
  return t->layers[0];
}

/// Correlation of the values of pixels (x, y) and (x + dx, y + dy), at least `margin` from the picture's border.
inline double correlation(const raster::LicPlanes& p, int dx, int dy, int margin) {
  double ab = 0, aa = 0, bb = 0;
  for (int y = margin; y < p.height - margin; ++y)
    for (int x = margin; x < p.width - margin; ++x) {
      const double a = double(p.value[p.at(x, y)]), b = double(p.value[p.at(x + dx, y + dy)]);
      ab += a * b, aa += a * a, bb += b * b;
    }
  return ab / std::sqrt(aa * bb);
}

}  // namespace sg::test
