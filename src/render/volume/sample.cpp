// SPDX-License-Identifier: Apache-2.0
// Trilinear sampling, scalar: the reference for sample_simd.cpp, and the way for volumes beyond 32-bit offsets.
#include "render/volume/volume_internal.h"

namespace sg::volume {

namespace {

float mixed(float a, float b, float f) { return a + f * (b - a); }

// x first, then y, then z; each a + f (b - a).
template <class T>
void sample(const Voxels& voxels, const float* ux, const float* uy, const float* uz, float* values) {
  const T* data = reinterpret_cast<const T*>(voxels.array.raw());
  const size_t nx = voxels.dims[0], ny = voxels.dims[1], nz = voxels.dims[2], row = nx, layer = nx * ny;
  const float top_x = float(nx - 1), top_y = float(ny - 1), top_z = float(nz - 1);
  for (int n = 0; n < run_length; ++n) {
    const float x = std::max(0.0f, std::min(ux[n], top_x)), y = std::max(0.0f, std::min(uy[n], top_y)), z = std::max(0.0f, std::min(uz[n], top_z));
    const size_t i = std::min(size_t(x), nx - 2), j = std::min(size_t(y), ny - 2), k = std::min(size_t(z), nz - 2);
    const float fx = x - float(i), fy = y - float(j), fz = z - float(k);
    const T* p = data + i + row * j + layer * k;
    const T *p01 = p + row, *p10 = p + layer, *p11 = p + layer + row;
    const float v00 = mixed(float(p[0]), float(p[1]), fx), v01 = mixed(float(p01[0]), float(p01[1]), fx);
    const float v10 = mixed(float(p10[0]), float(p10[1]), fx), v11 = mixed(float(p11[0]), float(p11[1]), fx);
    values[n] = mixed(mixed(v00, v01, fy), mixed(v10, v11, fy), fz);
  }
}

}  // namespace

SampleRun scalar_sampler(const Voxels& voxels) {
  switch (voxels.array.type()) {
    case ElementType::u8: return sample<uint8_t>;
    case ElementType::i8: return sample<int8_t>;
    case ElementType::u16: return sample<uint16_t>;
    case ElementType::i16: return sample<int16_t>;
    case ElementType::f32: return sample<float>;
    default: fail_internal("a volume's samples were not narrowed");
  }
}

}  // namespace sg::volume
