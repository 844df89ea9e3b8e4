// SPDX-License-Identifier: Apache-2.0
#include "render/volume/shade.h"

namespace sg::volume {

namespace {

float clamped(float u, float top) { return std::max(0.0f, std::min(u, top)); }

/// Mean of the corners that have a value, weighted as usual; NaN when the nearest has none. Only f32 holds NaN.
float sample_around_nan(const Voxels& voxels, float x, float y, float z) {
  const float* data = reinterpret_cast<const float*>(voxels.array.raw());
  const float place[3] = {x, y, z};
  size_t cell[3];
  float f[3];
  for (size_t a = 0; a < 3; ++a) {
    const float u = clamped(place[a], float(voxels.dims[a] - 1));
    cell[a] = std::min(size_t(u), voxels.dims[a] - 2), f[a] = u - float(cell[a]);
  }
  float sum = 0, weights = 0;
  for (int corner = 0; corner < 8; ++corner) {
    size_t at[3];
    float weight = 1;
    bool closest = true;
    for (int a = 0; a < 3; ++a) {
      const bool upper = corner >> a & 1;
      at[a] = cell[a] + upper, weight *= upper ? f[a] : 1 - f[a], closest = closest && upper == (f[a] >= 0.5f);
    }
    const float value = data[at[0] + voxels.dims[0] * (at[1] + voxels.dims[1] * at[2])];
    if (value == value) sum += weight * value, weights += weight;
    else if (closest) return value;
  }
  return weights > 0 ? sum / weights : NAN;
}

}  // namespace

void finish_values(const Volume& v, Run& run) {
  if (v.nearest)
    for (int n = 0; n < run_length; ++n) run.ux[n] = std::floor(run.ux[n] + 0.5f), run.uy[n] = std::floor(run.uy[n] + 0.5f), run.uz[n] = std::floor(run.uz[n] + 0.5f);
  v.sample(v.voxels, run.ux, run.uy, run.uz, run.value);
  if (v.dual)
    for (int n = 0; n < run_length; ++n)
      if (run.value[n] != run.value[n]) run.value[n] = sample_around_nan(v.voxels, run.ux[n], run.uy[n], run.uz[n]);
  if (!v.hidden.empty())
    for (int n = 0; n < run_length; ++n) {
      const auto cell = [&](float u, size_t a) { return std::min(size_t(clamped(u, float(v.voxels.dims[a] - 1))), v.voxels.dims[a] - 2); };
      const size_t id = cell(run.ux[n], 0) + (v.voxels.dims[0] - 1) * (cell(run.uy[n], 1) + (v.voxels.dims[1] - 1) * cell(run.uz[n], 2));
      if (v.hidden[id]) run.value[n] = NAN;
    }
}

void detail::shifted(const Volume& v, int axis, const float* u, const double* q, int count, float* below, float* above, float* apart) {
  const float top = float(v.voxels.dims[size_t(axis)] - 1);
  if (v.affine) {
    for (int m = 0; m < run_length; ++m) {
      const float here = clamped(u[m], top);
      below[m] = std::max(here - 1, 0.0f), above[m] = std::min(here + 1, top);
      apart[m] = above[m] - below[m];
    }
    return;
  }
  const std::vector<double>& c = v.coordinates[axis];
  for (int m = 0; m < run_length; ++m) {
    const double here = std::clamp(q[m < count ? m : 0], c.front(), c.back()), cell = v.cell_length(axis, here);
    const double lo = std::max(here - cell, c.front()), hi = std::min(here + cell, c.back());
    below[m] = v.u(axis, lo), above[m] = v.u(axis, hi), apart[m] = float(hi - lo);
  }
}

void detail::differences(const Volume& v, const float* const u[3], const float* centre, int axis, const float* below, const float* above, const float* apart, int count, float* out, float* per_cell) {
  alignas(64) float lo[run_length], hi[run_length];
  const float* place[3] = {u[0], u[1], u[2]};
  place[axis] = below;
  v.sample(v.voxels, place[0], place[1], place[2], lo);
  place[axis] = above;
  v.sample(v.voxels, place[0], place[1], place[2], hi);
  for (int m = 0; m < count; ++m) {
    float length = apart[m];
    if (lo[m] != lo[m]) lo[m] = centre[m], length *= 0.5f;
    if (hi[m] != hi[m]) hi[m] = centre[m], length *= 0.5f;
    const float d = hi[m] - lo[m];
    out[m] = length > 0 ? d / length : 0;
    per_cell[m] += 0.25f * d * d;
  }
}

void shade(const Volume& v, const LitRay& lit, const Gradients& g, int count, Shading& out) {
  // A gradient in q becomes one in the world by the transpose of world -> q.
  float m[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) m[i][j] = float(v.to_q.m[j][i]);
  const Material& material = lit.material;
  const float per_scale = 1 / v.gradient_scale;
  for (int n = 0; n < count; ++n) {
    const Vec3f normal{m[0][0] * g.x[n] + m[0][1] * g.y[n] + m[0][2] * g.z[n], m[1][0] * g.x[n] + m[1][1] * g.y[n] + m[1][2] * g.z[n],
                       m[2][0] * g.x[n] + m[2][1] * g.y[n] + m[2][2] * g.z[n]};
    const float square = dot(normal, normal);
    const float surface = std::min(1.0f, g.per_cell[n] * per_scale);  // how far this is a surface: flat regions keep their colour
    if (!(square > 0) || !(square < 1e30f) || !(surface > 0)) {
      out.diffuse[n] = 1, out.specular[n] = 0;
      continue;
    }
    const float side = (dot(normal, lit.direction) > 0 ? -1.0f : 1.0f) / std::sqrt(square);
    float diffuse = 0, specular = 0;
    for (const LitRay::One& l : lit.lights) {
      const float d = side * dot(normal, l.light);
      if (!(d > 0)) continue;
      diffuse += l.intensity * d;
      float h = std::max(0.0f, side * dot(normal, l.half));
      for (int i = 0; i < 5; ++i) h *= h;  // the material's default power, 32
      specular += l.intensity * h;
    }
    out.diffuse[n] = 1 + surface * (material.ambient + material.diffuse * diffuse - 1);
    out.specular[n] = surface * material.specular * specular;
  }
}

}  // namespace sg::volume
