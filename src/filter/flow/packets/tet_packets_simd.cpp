// SPDX-License-Identifier: Apache-2.0
// Packets in linear tetrahedra. Each lane has its tetrahedron as affine maps (barycentric coordinates of a place, velocity of those); all
// lanes are tested at once, and those whose place lies outside walk on, one face at a time.
#include "filter/flow/packets/packets.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/flow/packets/tet_packets_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "filter/flow/packets/packet_tracer-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::packets::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

template <class T>
class TetMesh {
 public:
  using Real = T;
  using DR = hn::CappedTag<T, N>;
  using DI = hn::RebindToSigned<DR>;
  using Int = hn::TFromD<DI>;
  using Lanes3 = T[3][N];
  explicit TetMesh(const TetInput& t) : t_(t) {}

  void start(size_t l, const TetItem& item) {
    for (int a = 0; a < 3; ++a) x_[a][l] = T(item.x[a]), rest_[a][l] = T(item.x[a] - double(x_[a][l]));
    open(l, item.cell);
  }
  bool velocity(size_t l, T* v) {
    T r[3];
    for (int k = 0; k < 3; ++k) {
      r[k] = 0;
      for (int a = 0; a < 3; ++a) r[k] += rows_[3 * k + a][l] * ((x_[a][l] - a_[a][l]) + rest_[a][l]);
    }
    for (int a = 0; a < 3; ++a) {
      v[a] = v0_[a][l];
      for (int k = 0; k < 3; ++k) v[a] += slopes_[3 * k + a][l] * r[k];
    }
    return std::isfinite(v[0] + v[1] + v[2]);
  }
  HWY_INLINE void look(const Lanes3& move, size_t active, Lanes3& v, Int* ok) {
    const DR d;
    const DI di;
    // The place as a pair of numbers: what the first cannot hold is in the second (Knuth's sum).
    for (int a = 0; a < 3; ++a)
      for (size_t l = 0; l < N; l += hn::Lanes(d)) {
        const auto x = hn::Load(d, &x_[a][l]), s = hn::Load(d, &rest_[a][l]) + hn::Load(d, &move[a][l]);
        const auto to = x + s, back = to - x;
        const auto lost = x - (to - back) + (s - back);
        hn::Store(to, d, &to_x_[a][l]), hn::Store(lost, d, &to_rest_[a][l]);
      }
    for (size_t l = 0; l < N; ++l) ok[l] = l < active ? -1 : 0;
    for (int round = 0; round < 256; ++round) {
      const auto edge = set(d, round < 64 ? edge_ : T(-1e-3));
      for (size_t l = 0; l < N; l += hn::Lanes(d)) {
        hn::Vec<DR> p[3];
        for (int a = 0; a < 3; ++a) p[a] = hn::Load(d, &to_x_[a][l]) - hn::Load(d, &a_[a][l]) + hn::Load(d, &to_rest_[a][l]);
        auto left = set(d, T(1)), least = left;
        for (int k = 0; k < 3; ++k) {
          auto r = hn::Load(d, &rows_[3 * k][l]) * p[0];
          r = r + hn::Load(d, &rows_[3 * k + 1][l]) * p[1];
          r = r + hn::Load(d, &rows_[3 * k + 2][l]) * p[2];
          hn::Store(r, d, &r_[k + 1][l]);
          left = left - r, least = min(least, r);
        }
        hn::Store(left, d, &r_[0][l]);
        least = min(least, left);
        // NaN, of a flat cell, is not inside. A lane that is out stays so.
        const auto inside = (least >= edge) & (left == left);
        const auto walks = (hn::Load(di, ok + l) != 0) & !rebind(di, inside);
        hn::Store(only(walks, set(di, 1)), di, walks_ + l);
      }
      size_t list[N], n = 0;
      for (size_t l = 0; l < active; ++l)
        if (walks_[l]) list[n++] = l;
      if (n == 0) break;
      walk(list, n, ok);
    }
    for (size_t l = 0; l < N; l += hn::Lanes(d)) {
      auto sum = set(d, 0);
      for (int a = 0; a < 3; ++a) {
        auto u = hn::Load(d, &v0_[a][l]);
        for (int k = 0; k < 3; ++k) u = u + hn::Load(d, &slopes_[3 * k + a][l]) * hn::Load(d, &r_[k + 1][l]);
        hn::Store(u, d, &v[a][l]);
        sum = sum + u;
      }
      const auto finite = abs(sum) < T(3e38);
      hn::Store(hn::Load(di, ok + l) & only(finite, set(di, -1)), di, ok + l);
    }
  }
  void go(size_t l) {
    for (int a = 0; a < 3; ++a) x_[a][l] = to_x_[a][l], rest_[a][l] = to_rest_[a][l];
  }
  void copy(size_t to, size_t from) {
    for (int a = 0; a < 3; ++a) x_[a][to] = x_[a][from], rest_[a][to] = rest_[a][from], a_[a][to] = a_[a][from], v0_[a][to] = v0_[a][from];
    for (int k = 0; k < 9; ++k) rows_[k][to] = rows_[k][from], slopes_[k][to] = slopes_[k][from];
    cell_[to] = cell_[from], box_[to] = box_[from];
  }
  void x(size_t l, T* out) const {
    for (int a = 0; a < 3; ++a) out[a] = x_[a][l];
  }
  T cell(size_t l) const { return std::cbrt(box_[l]); }

 private:
  // One face further, with all lanes' memory prefetched before the first waits for it.
  HWY_INLINE void walk(const size_t* list, size_t n, Int* ok) {
    int32_t next[N];
    for (size_t i = 0; i < n; ++i) {
      const size_t l = list[i];
      int worst = 0;
      for (int k = 1; k < 4; ++k)
        if (r_[k][l] < r_[worst][l]) worst = k;
      next[i] = r_[worst][l] < 0 && r_[0][l] == r_[0][l] ? t_.across[4 * size_t(cell_[l]) + size_t(worst)] : -1;
      if (next[i] >= 0) {
        const size_t at = 4 * size_t(next[i]);
        __builtin_prefetch(static_cast<const char*>(t_.ids) + at * (t_.wide_ids ? 8 : 4));
        __builtin_prefetch(t_.across + at);
      }
    }
    for (size_t i = 0; i < n; ++i) {
      if (next[i] < 0) continue;
      for (int k = 0; k < 4; ++k) {
        const size_t id = 3 * point(next[i], k);
        __builtin_prefetch(t_.points + id), __builtin_prefetch(t_.v + id);
      }
    }
    for (size_t i = 0; i < n; ++i) {
      const size_t l = list[i];
      if (next[i] >= 0) {
        open(l, next[i]);
        continue;
      }
      // At a border, or in a flat cell: whether there is a cell elsewhere
      const auto sum = [&](int a) { return double(to_x_[a][l]) + double(to_rest_[a][l]); };
      const int64_t c = t_.locate({sum(0), sum(1), sum(2)});
      ok[l] = c >= 0 && c != cell_[l] ? -1 : 0;
      if (ok[l]) open(l, int32_t(c));
    }
  }
  size_t point(int32_t cell, int k) const {
    const size_t at = 4 * size_t(cell) + size_t(k);
    return t_.wide_ids ? size_t(static_cast<const int64_t*>(t_.ids)[at]) : size_t(static_cast<const int32_t*>(t_.ids)[at]);
  }
  HWY_INLINE void open(size_t l, int32_t cell) {
    cell_[l] = cell;
    const float *p[4], *u[4];
    for (int k = 0; k < 4; ++k) {
      const size_t id = 3 * point(cell, k);
      p[k] = t_.points + id, u[k] = t_.v + id;
    }
    double e[3][3];
    for (int k = 0; k < 3; ++k)
      for (int a = 0; a < 3; ++a) e[k][a] = double(p[k + 1][a]) - double(p[0][a]);
    double row[3][3];
    for (int k = 0; k < 3; ++k) {
      const double *f = e[(k + 1) % 3], *g = e[(k + 2) % 3];
      for (int a = 0; a < 3; ++a) row[k][a] = f[(a + 1) % 3] * g[(a + 2) % 3] - f[(a + 2) % 3] * g[(a + 1) % 3];
    }
    const double scale = 1 / (e[0][0] * row[0][0] + e[0][1] * row[0][1] + e[0][2] * row[0][2]);
    T box = 1;
    for (int a = 0; a < 3; ++a) {
      a_[a][l] = p[0][a], v0_[a][l] = u[0][a];
      for (int k = 0; k < 3; ++k) rows_[3 * k + a][l] = T(row[k][a] * scale), slopes_[3 * k + a][l] = T(u[k + 1][a]) - T(u[0][a]);
      box *= T(std::max(std::max(p[0][a], p[1][a]), std::max(p[2][a], p[3][a]))) -
             T(std::min(std::min(p[0][a], p[1][a]), std::min(p[2][a], p[3][a])));
    }
    box_[l] = box;
  }

  const TetInput& t_;
  HWY_ALIGN Lanes3 x_ = {}, rest_ = {}, to_x_ = {}, to_rest_ = {}, a_ = {}, v0_ = {};
  // How far outside is inside still: what rounding amounts to.
  static constexpr T edge_ = sizeof(T) == 4 ? T(-2e-6) : T(-1e-9);
  HWY_ALIGN T rows_[9][N] = {}, slopes_[9][N] = {}, r_[4][N] = {};
  HWY_ALIGN Int walks_[N] = {};
  int32_t cell_[N] = {};
  T box_[N] = {};
};

void tets(const TetInput& input, const TraceOptions& options, float sign, std::span<const TetItem> items, Lines& out) {
  const auto run = [&](auto mesh) {
    Tracer<decltype(mesh)> tracer(mesh, options, sign, out);
    tracer.run(items);
  };
  if (in_f64(options)) run(TetMesh<double>(input));
  else run(TetMesh<float>(input));
}

}  // namespace sg::packets::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::packets {
HWY_EXPORT(tets);
void trace_tets(const TetInput& input, const TraceOptions& options, float sign, std::span<const TetItem> items, Lines& out) {
  HWY_DYNAMIC_DISPATCH(tets)(input, options, sign, items, out);
}
}  // namespace sg::packets
#endif
