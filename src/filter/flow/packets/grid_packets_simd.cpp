// SPDX-License-Identifier: Apache-2.0
// Packets in f32 grids, worked out in numbers T. Which cell and how far in it is worked out for all lanes at once; the eight corners of a
// lane are loaded as four rows of two points and reduced along y, z and x in vectors of four.
#include "filter/flow/packets/packets.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/packets/grid_packets_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "filter/flow/packets/packet_tracer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::packets::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

template <class T>
class GridMesh {
 public:
  using Real = T;
  using DR = hn::CappedTag<T, N>;
  using DI = hn::RebindToSigned<DR>;
  using Int = hn::TFromD<DI>;
  using Lanes3 = T[3][N];
  explicit GridMesh(const GridInput& g) : g_(g) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) to_grid_[a][b] = T(g.to_grid[a][b]), to_world_[a][b] = T(g.to_world[a][b]);
  }

  void start(size_t l, const GridItem& item) {
    for (int a = 0; a < 3; ++a) i_[a][l] = Int(item.cell[a]), f_[a][l] = T(item.f[a]);
  }
  bool velocity(size_t l, T* v) {
    HWY_ALIGN T out[4];
    interpolate(base(i_, l), f_[0][l], f_[1][l], f_[2][l], out);
    for (int a = 0; a < 3; ++a) v[a] = out[a];
    return std::isfinite(v[0] + v[1] + v[2]);
  }
  HWY_INLINE void look(const Lanes3& move, size_t active, Lanes3& v, Int* ok) {
    const DR d;
    const DI di;
    for (size_t l = 0; l < N; l += hn::Lanes(d)) {
      auto good = set(di, 0) == 0;
      auto at = set(di, 0);
      for (int a = 0; a < 3; ++a) {
        auto q = to_grid_[a][0] * hn::Load(d, &move[0][l]);
        q = q + to_grid_[a][1] * hn::Load(d, &move[1][l]);
        q = q + to_grid_[a][2] * hn::Load(d, &move[2][l]);
        q = q + hn::Load(d, &f_[a][l]);
        const auto sane = abs(q) < T(1e9);  // no NaN either
        q = only(sane, q);
        const auto whole = floor(q);
        auto part = q - whole;
        auto i = hn::Load(di, &i_[a][l]) + convert(di, whole);
        // The last plane of points belongs to the last cell.
        const auto cells = set(di, Int(g_.cells[a])), last = set(di, Int(g_.cells[a] - 1));
        const auto end = (i == cells) & rebind(di, part == 0);
        i = select(end, last, i);
        part = select(end, T(1), part);
        good = good & (rebind(di, sane) & ((i > -1) & (i < cells)));
        i = min(max(i, 0), last);
        hn::Store(i, di, &to_i_[a][l]);
        hn::Store(part, d, &to_f_[a][l]);
        at = at + i * Int(g_.stride[a]);
      }
      hn::Store(at, di, &base_[l]);
      hn::Store(only(good, set(di, -1)), di, ok + l);
    }
    HWY_ALIGN T out[N][4];
    for (size_t l = 0; l < active; ++l) interpolate(g_.v + base_[l], to_f_[0][l], to_f_[1][l], to_f_[2][l], out[l]);
    for (size_t l = active; l < N; ++l) std::fill_n(out[l], 4, T(0));
    for (size_t l = 0; l < N; l += hn::Lanes(d)) {
      hn::Vec<DR> x, y, z, rest;
      hn::LoadInterleaved4(d, out[l], x, y, z, rest);
      hn::Store(x, d, &v[0][l]), hn::Store(y, d, &v[1][l]), hn::Store(z, d, &v[2][l]);
      const auto sum = x + y + z;
      const auto finite = abs(sum) < T(3e38);
      hn::Store(hn::Load(di, ok + l) & only(finite, set(di, -1)), di, ok + l);
    }
  }
  void go(size_t l) {
    for (int a = 0; a < 3; ++a) i_[a][l] = to_i_[a][l], f_[a][l] = to_f_[a][l];
  }
  void copy(size_t to, size_t from) {
    for (int a = 0; a < 3; ++a) i_[a][to] = i_[a][from], f_[a][to] = f_[a][from];
  }
  void x(size_t l, T* out) const {
    const T q[3] = {T(i_[0][l]) + f_[0][l], T(i_[1][l]) + f_[1][l], T(i_[2][l]) + f_[2][l]};
    for (int a = 0; a < 3; ++a) out[a] = to_world_[a][0] * q[0] + to_world_[a][1] * q[1] + to_world_[a][2] * q[2];
  }
  T cell(size_t) const { return T(g_.length); }

 private:
  using D4 = hn::CappedTag<float, 4>;
  const float* base(const Int (&i)[3][N], size_t l) const {
    return g_.v + i[0][l] * g_.stride[0] + i[1][l] * g_.stride[1] + i[2][l] * g_.stride[2];
  }
  // Two neighbours along x are six numbers in a row: x0 y0 z0 x1 and z0 x1 y1 z1, so that nothing behind the last point is read.
#if HWY_TARGET == HWY_SCALAR
  void interpolate(const float* p, float fx, float fy, float fz, float* HWY_RESTRICT out) const {
    const auto blend = [](float a, float b, float t) { return a + t * (b - a); };
    const ptrdiff_t dy = g_.stride[1], dz = g_.stride[2];
    const auto plane = [&](const float* q) { return blend(blend(q[0], q[dy], fy), blend(q[dz], q[dz + dy], fy), fz); };
    for (int c = 0; c < 3; ++c) out[c] = blend(plane(p + c), plane(p + 3 + c), fx);
  }
#elif HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
  // As below, both points of a row in one vector; a masked load reads six numbers and no more.
  template <class V>
  static HWY_INLINE V blend(V a, V b, V t) {
    return a + t * (b - a);
  }
  HWY_INLINE void interpolate(const float* p, float fx, float fy, float fz, float* HWY_RESTRICT out) const {
    const hn::CappedTag<float, 8> d;
    const D4 half;
    alignas(32) static constexpr int32_t second[8] = {3, 4, 5, 5, 3, 4, 5, 5};
    const ptrdiff_t dy = g_.stride[1], dz = g_.stride[2];
    const auto six = hn::FirstN(d, 6);
    const auto y = set(d, fy);
    const auto low = blend(hn::MaskedLoad(six, d, p), hn::MaskedLoad(six, d, p + dy), y);
    const auto high = blend(hn::MaskedLoad(six, d, p + dz), hn::MaskedLoad(six, d, p + dz + dy), y);
    const auto row = blend(low, high, set(d, fz));
    const auto next = hn::TableLookupLanes(row, hn::SetTableIndices(d, second));
    hn::Store(blend(hn::LowerHalf(half, row), hn::LowerHalf(half, next), set(half, fx)), half, out);
  }
#else
  static HWY_INLINE hn::Vec<D4> blend(hn::Vec<D4> a, hn::Vec<D4> b, hn::Vec<D4> t) { return a + t * (b - a); }
  HWY_INLINE void interpolate(const float* p, float fx, float fy, float fz, float* HWY_RESTRICT out) const {
    const D4 d;
    const ptrdiff_t dy = g_.stride[1], dz = g_.stride[2];
    const auto y = set(d, fy), z = set(d, fz);
    const auto a = blend(blend(hn::LoadU(d, p), hn::LoadU(d, p + dy), y), blend(hn::LoadU(d, p + dz), hn::LoadU(d, p + dz + dy), y), z);
    const float* q = p + 2;
    const auto b = blend(blend(hn::LoadU(d, q), hn::LoadU(d, q + dy), y), blend(hn::LoadU(d, q + dz), hn::LoadU(d, q + dz + dy), y), z);
    hn::Store(blend(a, hn::Shuffle0321(b), set(d, fx)), d, out);
  }
#endif

  // In f64.
#if HWY_TARGET == HWY_AVX3
  HWY_INLINE void interpolate(const float* p, double fx, double fy, double fz, double* HWY_RESTRICT out) const {
    const hn::CappedTag<double, 8> d;
    const hn::CappedTag<double, 4> half;
    const hn::Rebind<float, decltype(d)> df;
    alignas(64) static constexpr int64_t second[8] = {3, 4, 5, 5, 3, 4, 5, 5};
    const ptrdiff_t dy = g_.stride[1], dz = g_.stride[2];
    const auto six = hn::FirstN(df, 6);
    const auto load = [&](const float* q) HWY_ATTR { return hn::PromoteTo(d, hn::MaskedLoad(six, df, q)); };
    const auto y = set(d, fy);
    const auto low = blend(load(p), load(p + dy), y), high = blend(load(p + dz), load(p + dz + dy), y);
    const auto row = blend(low, high, set(d, fz));
    const auto next = hn::TableLookupLanes(row, hn::SetTableIndices(d, second));
    hn::Store(blend(hn::LowerHalf(half, row), hn::LowerHalf(half, next), set(half, fx)), half, out);
  }
#else
  void interpolate(const float* p, double fx, double fy, double fz, double* HWY_RESTRICT out) const {
    const auto mix = [](double a, double b, double t) { return a + t * (b - a); };
    const ptrdiff_t dy = g_.stride[1], dz = g_.stride[2];
    const auto plane = [&](const float* q) {
      return mix(mix(double(q[0]), double(q[dy]), fy), mix(double(q[dz]), double(q[dz + dy]), fy), fz);
    };
    for (int c = 0; c < 3; ++c) out[c] = mix(plane(p + c), plane(p + 3 + c), fx);
    out[3] = 0;
  }
#endif

  const GridInput g_;
  T to_grid_[3][3], to_world_[3][3];
  HWY_ALIGN Int i_[3][N] = {}, to_i_[3][N] = {}, base_[N] = {};
  HWY_ALIGN Lanes3 f_ = {}, to_f_ = {};
};

void grid(const GridInput& input, const TraceOptions& options, float sign, std::span<const GridItem> items, Lines& out) {
  const auto run = [&](auto mesh) {
    Tracer<decltype(mesh)> tracer(mesh, options, sign, out);
    tracer.run(items);
  };
  if (in_f64(options)) run(GridMesh<double>(input));
  else run(GridMesh<float>(input));
}

}  // namespace sg::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::packets {
HWY_EXPORT(grid);
void trace_grid(const GridInput& input, const TraceOptions& options, float sign, std::span<const GridItem> items, Lines& out) {
  HWY_DYNAMIC_DISPATCH(grid)(input, options, sign, items, out);
}
}  // namespace sg::packets
#endif
