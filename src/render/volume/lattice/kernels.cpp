// SPDX-License-Identifier: Apache-2.0
// The scalar reference of the kernels, and the way for volumes beyond 32-bit offsets.
#include "render/volume/lattice/kernels.h"

#include <algorithm>
#include <cmath>

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
  alignas(64) float below[run_length], above[run_length], lo[run_length], hi[run_length], apart[run_length];
  float* result[3] = {out.x, out.y, out.z};
  std::fill(out.per_cell, out.per_cell + run_length, 0.0f);
  for (int a = 0; a < 3; ++a) {
    const float top = float(voxels.dims[size_t(a)] - 1);
    for (int n = 0; n < run_length; ++n) {
      const float here = clamped(u[a][n], top);
      below[n] = std::max(here - 1, 0.0f), above[n] = std::min(here + 1, top), apart[n] = above[n] - below[n];
    }
    const float* place[3] = {u[0], u[1], u[2]};
    place[a] = below;
    sample<T>(voxels, place[0], place[1], place[2], lo);
    place[a] = above;
    sample<T>(voxels, place[0], place[1], place[2], hi);
    for (int n = 0; n < run_length; ++n) {
      float length = apart[n];
      if (lo[n] != lo[n]) lo[n] = centre[n], length *= 0.5f;
      if (hi[n] != hi[n]) hi[n] = centre[n], length *= 0.5f;
      const float d = hi[n] - lo[n];
      result[a][n] = d / length;
      out.per_cell[n] += 0.25f * d * d;
    }
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
    default: fail_internal("a volume's samples were not narrowed");
  }
}

}  // namespace sg::volume
