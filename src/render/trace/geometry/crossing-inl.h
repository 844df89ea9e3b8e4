// SPDX-License-Identifier: Apache-2.0
// The test of triangle_test.h for a vector of triangles, or of rays. For files that are compiled once for each target and have included
// Highway.
#if defined(SG_TRACE_CROSSING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_TRACE_CROSSING_INL
#undef SG_TRACE_CROSSING_INL
#else
#define SG_TRACE_CROSSING_INL
#endif
#include "render/trace/geometry/triangle_test.h"
#include "render/trace/geometry/triangles.h"
#include "render/trace/tree/wide_bvh-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {

/// Lanes of numbers for a test of triangle_test.h.
template <class D>
struct Crossing {
  Float<D> wa, wb, wc, za, zb, zc, det;
  Mask<D> met;  ///< by the line, not yet by where on it

  /// az: along kz from the origin; the others sheared.
  HWY_INLINE Crossing(Float<D> ax, Float<D> ay, Float<D> az, Float<D> bx, Float<D> by, Float<D> bz, Float<D> cx, Float<D> cy, Float<D> cz,
                      Float<D> sz) {
    wa = cx * by - cy * bx, wb = ax * cy - ay * cx, wc = bx * ay - by * ax;
    const auto over = (wa >= 0) & (wb >= 0) & (wc >= 0), under = (wa <= 0) & (wb <= 0) & (wc <= 0);
    met = over | under;
    if (none(met)) return;
    det = (wa + wb) + wc;
    za = az * sz, zb = bz * sz, zc = cz * sz;
    met = met & (det != 0) & !((za <= 0) & (zb <= 0) & (zc <= 0));
  }
  HWY_INLINE Mask<D> in_front() const { return (za > 0) & (zb > 0) & (zc > 0); }
  HWY_INLINE Float<D> distance() const { return ((wa * za + wb * zb) + wc * zc) / det; }
  HWY_INLINE Float<D> farthest() const { return max(max(za, zb), zc); }
};

HWY_INLINE Vec3f corner_of(const TriangleBlock& b, int c, int place) {
  return {b.corner[c][0][place], b.corner[c][1][place], b.corner[c][2][place]};
}

HWY_INLINE float exact(const ShearedRay& r, const TriangleBlock& b, int place, float farthest) {
  return exact_distance(r, corner_of(b, 0, place), corner_of(b, 1, place), corner_of(b, 2, place), farthest);
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
