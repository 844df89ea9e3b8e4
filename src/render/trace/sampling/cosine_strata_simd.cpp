// SPDX-License-Identifier: Apache-2.0
// warp.h for all strata side by side, operation by operation.
#include "render/trace/sampling/cosine_strata.h"

#include "base/vector_targets.h"
#include "render/trace/sampling/warp.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/trace/sampling/cosine_strata_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using D = hn::CappedTag<float, cosine_strata_count>;
using F = hn::Vec<D>;

uint32_t strata(Vec2f in, const LocalFrame& frame, Vec3f above, Vec3f* directions) {
  constexpr int n = cosine_strata_count;
  constexpr float across = cosine_strata_across;
  HWY_ALIGN float column[n], row[n], out[3][n], side[n];
  for (int i = 0; i < n; ++i) column[i] = float(i % cosine_strata_across), row[i] = float(i / cosine_strata_across);
  const D d;
  for (int i = 0; i < n; i += int(hn::MaxLanes(d))) {
    // concentric_disc
    const F x = 2.f * ((hn::Load(d, column + i) + in.x) / across) - 1.f, y = 2.f * ((hn::Load(d, row + i) + in.y) / across) - 1.f;
    const auto wide = abs(x) > abs(y);
    const F r = select(wide, x, y), angle = (pi / 4) * (select(wide, y, x) / r), a = angle * angle;
    const F cosine = 1.f - a * (1 / 2.f - a * (1 / 24.f - a * (1 / 720.f - a * (1 / 40320.f))));
    const F sine = angle - angle * (a * (1 / 6.f - a * (1 / 120.f - a * (1 / 5040.f - a * (1 / 362880.f)))));
    const auto middle = r == 0.f;
    const F u = select(middle, set(d, 0), r * select(wide, cosine, sine)), v = select(middle, set(d, 0), r * select(wide, sine, cosine));
    // raised to the sphere, in the frame
    const F w = sqrt(max(1.f - u * u - v * v, 0.f));
    F to[3];
    for (int k = 0; k < 3; ++k) to[k] = (frame.x[k] * u + frame.y[k] * v) + frame.z[k] * w;
    const F length = sqrt((to[0] * to[0] + to[1] * to[1]) + to[2] * to[2]);
    for (int k = 0; k < 3; ++k) to[k] = to[k] / length, hn::Store(to[k], d, out[k] + i);
    hn::Store((to[0] * above.x + to[1] * above.y) + to[2] * above.z, d, side + i);
  }
  uint32_t bits = 0;
  for (int i = 0; i < n; ++i) directions[i] = {out[0][i], out[1][i], out[2][i]}, bits |= uint32_t(side[i] > 0) << i;
  return bits;
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::trace {

HWY_EXPORT(strata);

uint32_t cosine_strata(Vec2f in, const LocalFrame& frame, Vec3f above, Vec3f* directions) {
  return HWY_DYNAMIC_DISPATCH(strata)(in, frame, above, directions);
}

}  // namespace sg::trace
#endif
