// SPDX-License-Identifier: Apache-2.0
// One point per cut lattice edge: position, normal, and where it lies between which samples.
#include <bit>
#include <cmath>
#include <type_traits>

#include "base/nearest_whole.h"
#include "base/parallel.h"
#include "filter/scalar/contour/lattice/contour_vertices.h"

namespace sg::contouring {

namespace {

template <class T>
struct Maker {
  const VertexJob& job;
  const LatticeFrame& frame;
  const T* f;

  Vec3 scale, first, step;  // axis-parallel uniform grids: half the inverse spacing, the first point, the spacing
  bool plain = false;

  Maker(const VertexJob& j, const T* samples) : job(j), frame(j.frame), f(samples) {
    const Mat3& m = frame.to_world;
    plain = frame.axes == 3 && frame.view.mode == LatticeView::Mode::affine && m.m[0][1] == 0 && m.m[0][2] == 0 && m.m[1][0] == 0 &&
            m.m[1][2] == 0 && m.m[2][0] == 0 && m.m[2][1] == 0;
    if (!plain) return;
    scale = Vec3(m.m[0][0], m.m[1][1], m.m[2][2]) * 0.5;
    first = frame.view.origin - job.origin;
    step = {frame.view.step[0].x, frame.view.step[1].y, frame.view.step[2].z};
  }

  Vec3 gradient(size_t p, const size_t at[3]) const {
    Vec3 d;
    for (int l = 0; l < 3; ++l) {
      const AxisStencil& s = frame.stencil[l][at[l]];
      const T* q = f + p;
      d[l] = s.w[0] * double(q[s.o[0]]) + s.w[1] * double(q[s.o[1]]) + s.w[2] * double(q[s.o[2]]);
    }
    const Mat3 m = frame.view.mode == LatticeView::Mode::listed ? frame.metric(p, at) : frame.to_world;
    const Vec3 g = m * d;
    if (std::isfinite(dot(g, g))) [[likely]]
      return g;
    for (int l = 0; l < 3; ++l) d[l] = careful_derivative(frame.stencil[l][at[l]], p, [&](size_t i) { return double(f[i]); });
    return m * d;
  }

  template <int axis>
  void edge(size_t v, size_t i, size_t j, size_t k) const {
    const size_t p = frame.id(i, j, k), q = p + size_t(frame.stride[axis]);
    const double va = double(f[p]), vb = double(f[q]);
    const double t = crossing(job.value, va, vb);
    if (job.points) job.points[v] = {uint32_t(p), uint32_t(q), float(t)};
    const size_t a[3] = {i, j, k}, b[3] = {i + (axis == 0), j + (axis == 1), k + (axis == 2)};
    Vec3 x;
    if (plain) {
      x = first + step * Vec3(double(i) + (axis == 0 ? t : 0.0), double(j) + (axis == 1 ? t : 0.0), double(k) + (axis == 2 ? t : 0.0));
    } else {
      const Vec3 from = frame.position(i, j, k) - job.origin, to = frame.position(b[0], b[1], b[2]) - job.origin;
      x = from + (to - from) * t;
    }
    job.xyz[3 * v] = float(x.x), job.xyz[3 * v + 1] = float(x.y), job.xyz[3 * v + 2] = float(x.z);
    if (!job.normals) return;
    set_normal(v, gradient(p, a) * (1 - t) + gradient(q, b) * t);
  }

  void set_normal(size_t v, Vec3 g) const {
    const double square = dot(g, g);
    const Vec3 n = square > 0 && std::isfinite(square) ? g * (-1 / std::sqrt(square)) : Vec3();
    job.normals[3 * v] = float(n.x), job.normals[3 * v + 1] = float(n.y), job.normals[3 * v + 2] = float(n.z);
  }

  void inner_point(size_t v, const InnerPoint& point) const {
    const size_t p = point.base, at[3] = {p % frame.dims[0], p / frame.dims[0] % frame.dims[1], p / frame.dims[0] / frame.dims[1]};
    Vec3 x, g;
    for (int c = 0; c < 8; ++c) {
      double weight = 1;
      size_t corner[3];
      for (int a = 0; a < 3; ++a) {
        const double t = double(point.at[a]);
        weight *= c >> a & 1 ? t : 1 - t;
        corner[a] = at[a] + size_t(c >> a & 1);
      }
      x += (frame.position(corner[0], corner[1], corner[2]) - job.origin) * weight;
      if (job.normals) g += gradient(frame.id(corner[0], corner[1], corner[2]), corner) * weight;
    }
    job.xyz[3 * v] = float(x.x), job.xyz[3 * v + 1] = float(x.y), job.xyz[3 * v + 2] = float(x.z);
    if (job.normals) set_normal(v, g);
  }

  void edge(size_t v, size_t i, size_t j, size_t k, int axis) const {
    if (axis == 0) edge<0>(v, i, j, k);
    else if (axis == 1) edge<1>(v, i, j, k);
    else edge<2>(v, i, j, k);
  }

  void row(size_t j, size_t k) const {
    const size_t r = j + frame.dims[1] * k;
    size_t v = job.rows[r].vertex;
    for (int axis = 0; axis < frame.axes; ++axis) {
      if (job.rows[r].cut[axis] == 0) continue;
      for (size_t w = 0; w < job.words; ++w)
        for (uint64_t m = cut_edges(job, axis, r, w); m; m &= m - 1) edge(v++, 64 * w + size_t(std::countr_zero(m)), j, k, axis);
    }
  }
};

template <class T>
void run(const VertexJob& job) {
  const size_t nx = job.frame.dims[0], ny = job.frame.dims[1], grain = std::max<size_t>(1, 512 / job.words);
  const Maker<T> maker(job, job.samples.view<T>().data);
  const PlainVertices plain{job, maker.first, maker.step, maker.scale, &maker, [](const void* m, size_t v, size_t p, int axis) {
                              const auto& all = *static_cast<const Maker<T>*>(m);
                              const auto& n = all.frame.dims;
                              all.edge(v, p % n[0], p / n[0] % n[1], p / n[0] / n[1], axis);
                            }};
  const bool together = maker.plain && (grain + 3 * ny) * nx < size_t(INT32_MAX);
  parallel_for(
      job.rows.size(), grain,
      [&](size_t begin, size_t end) {
        if (together) return make_plain_vertices(plain, begin, end);
        for (size_t r = begin; r < end; ++r) maker.row(r % ny, r / ny);
      },
      &job.context);
  parallel_for(
      job.inner.size(), 1024,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) maker.inner_point(job.inner_first + i, job.inner[i]);
      },
      &job.context);
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

void interpolate_inner(const Array& a, const Piece& piece, std::byte* out) {
  dispatch(a, [&](auto v) {
    using T = std::remove_cvref_t<decltype(v[0])>;
    T* to = reinterpret_cast<T*>(out);
    const size_t n = size_t(v.components);
    parallel_for(piece.inner.count, 4096, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const InnerPoint& point = piece.inner.data[i];
        for (size_t c = 0; c < n; ++c) {
          double sum = 0;
          for (int corner = 0; corner < 8; ++corner) {
            double weight = 1;
            ptrdiff_t p = ptrdiff_t(point.base);
            for (int axis = 0; axis < 3; ++axis) {
              const bool far = corner >> axis & 1;
              weight *= far ? double(point.at[axis]) : 1 - double(point.at[axis]);
              if (far) p += piece.stride[size_t(axis)];
            }
            if (piece.inner_corners.count) p = ptrdiff_t(piece.inner_corners.data[i][size_t(corner)]);
            sum += weight * double(v(size_t(p), int(c)));
          }
          if constexpr (std::is_floating_point_v<T>) to[i * n + c] = T(sum);
          else to[i * n + c] = nearest_whole<T>(sum);
        }
      }
    });
  });
}

}  // namespace sg::contouring
