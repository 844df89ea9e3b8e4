// SPDX-License-Identifier: Apache-2.0
// One point per cut lattice edge: position, normal, and where it lies between which samples.
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "filter/scalar/contour_parts.h"

namespace sg::contouring {

namespace {

template <class T>
struct Maker {
  const VertexJob& job;
  const LatticeFrame& frame;
  const T* f;

  Vec3 gradient(size_t p, const size_t at[3]) const {
    Vec3 d;
    for (int l = 0; l < 3; ++l) {
      const AxisStencil& s = frame.stencil[l][at[l]];
      const T* q = f + p;
      d[l] = s.w[0] * double(q[s.o[0]]) + s.w[1] * double(q[s.o[1]]) + s.w[2] * double(q[s.o[2]]);
    }
    const Mat3 m = frame.view.mode == LatticeView::Mode::listed ? frame.metric(p, at) : frame.to_world;
    const Vec3 g = m * d;
    if (std::isfinite(dot(g, g))) [[likely]] return g;
    for (int l = 0; l < 3; ++l) d[l] = careful_derivative(frame.stencil[l][at[l]], p, [&](size_t i) { return double(f[i]); });
    return m * d;
  }

  void edge(size_t v, size_t i, size_t j, size_t k, int axis) const {
    const size_t a[3] = {i, j, k}, b[3] = {i + (axis == 0), j + (axis == 1), k + (axis == 2)};
    const size_t p = frame.id(i, j, k), q = p + size_t(frame.stride[size_t(axis)]);
    const double t = crossing(job.value, double(f[p]), double(f[q]));
    job.points[v] = {uint32_t(p), uint32_t(q), float(t)};
    const Vec3 from = frame.position(i, j, k) - job.origin, to = frame.position(b[0], b[1], b[2]) - job.origin;
    const Vec3 x = from + (to - from) * t;
    for (int c = 0; c < 3; ++c) job.xyz[3 * v + size_t(c)] = float(x[c]);
    if (!job.normals) return;
    const Vec3 g = gradient(p, a) * (1 - t) + gradient(q, b) * t;
    const double size = length(g);
    const Vec3 n = size > 0 && std::isfinite(size) ? g * (-1 / size) : Vec3();
    for (int c = 0; c < 3; ++c) job.normals[3 * v + size_t(c)] = float(n[c]);
  }

  void row(size_t j, size_t k) const {
    const size_t r = j + frame.dims[1] * k;
    size_t v = job.rows[r].vertex;
    for (int axis = 0; axis < frame.axes; ++axis) {
      if (job.rows[r].cut[axis] == 0) continue;
      const uint64_t* cut = job.cut[axis].data() + r * job.words;
      for (size_t w = 0; w < job.words; ++w)
        for (uint64_t m = cut[w]; m; m &= m - 1) edge(v++, 64 * w + size_t(std::countr_zero(m)), j, k, axis);
    }
  }
};

template <class T>
void run(const VertexJob& job) {
  const size_t ny = job.frame.dims[1];
  const Maker<T> maker{job, job.frame, job.samples.view<T>().data};
  parallel_for(job.rows.size(), std::max<size_t>(1, 512 / job.words), [&](size_t begin, size_t end) {
    for (size_t r = begin; r < end; ++r) maker.row(r % ny, r / ny);
  }, &job.context);
}

}  // namespace

void make_vertices(const VertexJob& job) {
  switch (job.samples.type()) {
    case ElementType::u8: return run<uint8_t>(job);
    case ElementType::i8: return run<int8_t>(job);
    case ElementType::u16: return run<uint16_t>(job);
    case ElementType::i16: return run<int16_t>(job);
    case ElementType::f32: return run<float>(job);
    default: return run<double>(job);
  }
}

}  // namespace sg::contouring
