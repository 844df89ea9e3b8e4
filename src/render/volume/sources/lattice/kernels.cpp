// SPDX-License-Identifier: Apache-2.0
// The scalar reference of the kernels, and the way for volumes beyond 32-bit offsets.
#include "render/volume/sources/lattice/kernels.h"

#include <algorithm>
#include <cmath>

#include "render/volume/sources/lattice/derivatives.h"

namespace sg::volume {

namespace {

float mixed(float a, float b, float f) { return a + f * (b - a); }

// x first, then y, then z; each a + f (b - a).
template <class T>
void sample(const Voxels& voxels, const float* ux, const float* uy, const float* uz, float* values) {
  const T* data = reinterpret_cast<const T*>(voxels.array.raw());
  const size_t nx = voxels.dims[0], ny = voxels.dims[1], nz = voxels.dims[2], row = nx, layer = nx * ny;
  for (int n = 0; n < run_length; ++n) {
    const float x = clamped(ux[n], float(nx - 1)), y = clamped(uy[n], float(ny - 1)), z = clamped(uz[n], float(nz - 1));
    const size_t i = std::min(size_t(x), nx - 2), j = std::min(size_t(y), ny - 2), k = std::min(size_t(z), nz - 2);
    const float fx = x - float(i), fy = y - float(j), fz = z - float(k);
    const T* p = data + i + row * j + layer * k;
    const T *p01 = p + row, *p10 = p + layer, *p11 = p + layer + row;
    const float v00 = mixed(float(p[0]), float(p[1]), fx), v01 = mixed(float(p01[0]), float(p01[1]), fx);
    const float v10 = mixed(float(p10[0]), float(p10[1]), fx), v11 = mixed(float(p11[0]), float(p11[1]), fx);
    values[n] = mixed(mixed(v00, v01, fy), mixed(v10, v11, fy), fz);
  }
}

template <class T>
void gradients(const Voxels& voxels, const float* const u[3], const float* centre, Gradients& out) {
  alignas(64) float at[run_length], place_lo[run_length], place_hi[run_length], lo[run_length], hi[run_length];
  float* result[3] = {out.x, out.y, out.z};
  std::fill(out.per_cell, out.per_cell + run_length, 0.0f);
  for (int a = 0; a < 3; ++a) {
    const float top = float(voxels.dims[size_t(a)] - 1);
    const float* place[3] = {u[0], u[1], u[2]};
    const auto sample_at = [&](const float* along, float* values) {
      place[a] = along;
      sample<T>(voxels, place[0], place[1], place[2], values);
    };
    bool outermost = false;
    for (int n = 0; n < run_length; ++n) {
      at[n] = clamped(u[a][n], top), place_lo[n] = std::max(at[n] - 1, 0.0f), place_hi[n] = std::min(at[n] + 1, top);
      outermost = outermost || at[n] < 1 || at[n] > top - 1;
    }
    sample_at(place_lo, lo), sample_at(place_hi, hi);
    for (int n = 0; n < run_length; ++n) {
      float length = place_hi[n] - place_lo[n];
      if (lo[n] != lo[n]) lo[n] = centre[n], length *= 0.5f;
      if (hi[n] != hi[n]) hi[n] = centre[n], length *= 0.5f;
      result[a][n] = (hi[n] - lo[n]) / length;
    }
    if (outermost) {
      // The three outermost layers, inwards.
      alignas(64) float layer[run_length], value[3][run_length];
      for (int i = 0; i < 3; ++i) {
        for (int n = 0; n < run_length; ++n) layer[n] = std::max(0.0f, at[n] < 1 ? std::min(float(i), top) : top - float(i));
        sample_at(layer, value[i]);
      }
      for (int n = 0; n < run_length; ++n) {
        const bool first = at[n] < 1;
        if (!first && !(at[n] > top - 1)) continue;
        const float over = first ? value[1][n] - value[0][n] : value[0][n] - value[1][n];
        float inner = 0.5f * (first ? value[2][n] - value[0][n] : value[0][n] - value[2][n]);
        if (!(inner == inner) || top < 2) inner = over;
        const float slope = mixed(border_slope(over, inner), inner, first ? at[n] : top - at[n]);
        if (slope == slope) result[a][n] = slope;
      }
    }
    for (int n = 0; n < run_length; ++n) out.per_cell[n] += result[a][n] * result[a][n];
  }
  for (float& c : out.per_cell) c = std::sqrt(c);
}

template <class T>
Kernels kernels_for() {
  return {sample<T>, gradients<T>};
}

}  // namespace

Kernels scalar_kernels(const Voxels& voxels) {
  switch (voxels.array.type()) {
    case ElementType::u8: return kernels_for<uint8_t>();
    case ElementType::i8: return kernels_for<int8_t>();
    case ElementType::u16: return kernels_for<uint16_t>();
    case ElementType::i16: return kernels_for<int16_t>();
    case ElementType::f32: return kernels_for<float>();
    default: fail_internal("the samples of a volume were not narrowed");
  }
}

}  // namespace sg::volume
