// SPDX-License-Identifier: Apache-2.0
// The two loops of image-space LIC over whole planes: which neighbours belong together, and noise along lines. No fused multiply-add.
#include "render/raster/lic/surface_lic.h"

#include <algorithm>

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/raster/lic/lic_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "base/simd/vector-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;
using DI = hn::RebindToSigned<DF>;
using DU = hn::RebindToUnsigned<DF>;
using F = hn::Vec<DF>;
using I = hn::Vec<DI>;
using U = hn::Vec<DU>;
using M = hn::Mask<DF>;

void run_connect(LicPlanes& p, float slack, bool parallel, int first, int last) {
  const DF d;
  const DU du;
  const size_t lanes = hn::Lanes(d);
  for (int y = first; y < last; ++y) {
    // The last vector of a row ends with it: some pixels are done twice, with the same result.
    const size_t row = p.at(0, y), width = size_t(p.width);
    for (size_t x = 0; x < width; x += lanes) {
      const size_t i = row + std::min(x, width - lanes);
      const U item = hn::LoadU(du, p.item.data() + i);
      const F w = hn::LoadU(d, p.w.data() + i), wx = hn::LoadU(d, p.wx.data() + i), wy = hn::LoadU(d, p.wy.data() + i);
      const F free = parallel ? set(d, slack) : w * slack;
      // A bit for each neighbour whose depth goes on from here in either's plane, of the same item.
      U bits = set(du, 0);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const size_t j = i + size_t(dy) * p.stride + size_t(dx);
          const F fx = set(d, float(dx)), fy = set(d, float(dy));
          const F jump = hn::LoadU(d, p.w.data() + j) - w, own = wx * fx + wy * fy,
                  other = hn::LoadU(d, p.wx.data() + j) * fx + hn::LoadU(d, p.wy.data() + j) * fy;
          const M inside = (jump >= min(own, other) - free) & (jump <= max(own, other) + free);
          const auto same = rebind(du, inside) & (item == hn::LoadU(du, p.item.data() + j));
          bits = bits | only(same, set(du, 1u << neighbor_bit(dx, dy)));
        }
      bits = only(item != 0, bits);
      const U word = hn::LoadU(du, p.word.data() + i) & 0xFFFFFF00u;
      hn::StoreU(word | bits, du, p.word.data() + i);
    }
  }
}

/// The way from a pixel to one side: where it is, how it came, and what it has gathered.
struct Way {
  F x, y, dx, dy, bx, by, sum;  // b: at the step before
  I ix, iy, at, word, steps;
  M active;
};

HWY_INLINE void step_on(const ConvolveJob& job, F unit, F weight, Way& w) {
  const DF d;
  const DI di;
  const I one = set(di, 1), two = set(di, 2), nothing = set(di, 0);
  const F half = set(d, 0.5f), more = set(d, 1.5f);
  const M turned = w.dx * w.bx + w.dy * w.by < 0;
  w.x = w.x + select(turned, w.dx, w.dx * more - w.bx * half);
  w.y = w.y + select(turned, w.dy, w.dy * more - w.by * half);
  const I jx = convert(di, w.x), jy = convert(di, w.y);  // positive while active
  const I ox = jx - w.ix, oy = jy - w.iy, apart = oy + oy + oy + ox;
  const auto near = (abs(ox) < two) & (abs(oy) < two);
  // The bit of that neighbour, moved to the lowest place.
  const I bit = (apart + 4 + hn::VecFromMask(di, apart > nothing)) & 15;
  const auto open = ((hn::Shr(w.word, bit) & one) != nothing) | (apart == nothing);
  w.active = w.active & rebind(d, near & open);
  const auto go = rebind(di, w.active);
  w.at = select(go, jy * job.stride + jx, w.at), w.ix = jx, w.iy = jy;
  w.word = hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.word), w.at);
  w.bx = w.dx, w.by = w.dy;
  w.dx = convert(d, shift_right<20>(w.word)) * unit;
  w.dy = convert(d, shift_right<20>(shift_left<12>(w.word))) * unit;
  w.sum = w.sum + only(w.active, hn::GatherIndex(d, job.noise, w.at) * weight);
  w.steps = w.steps - hn::VecFromMask(di, go);
  // A place without direction is the end.
  w.active = w.active & rebind(d, (w.word & ~0xFF) != nothing);
}

void run_convolve(const ConvolveJob& job, const int32_t* pixels, size_t n) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  const LicWeights& kernel = *job.weights;
  const float* weight = kernel.weight.data() + kernel.steps;
  const F unit = set(d, job.step / 2047), back_unit = -unit, half = set(d, 0.5f);
  HWY_ALIGN float out[hn::MaxLanes(d)];
  HWY_ALIGN int32_t xs[hn::MaxLanes(di)], ys[hn::MaxLanes(di)], places[hn::MaxLanes(di)];
  for (size_t first = 0; first < n; first += lanes) {
    const size_t count = std::min(lanes, n - first);
    for (size_t k = 0; k < lanes; ++k) {
      const int32_t place = places[k] = k < count ? pixels[first + k] : 0;  // 0: of the border, without direction
      ys[k] = place / job.stride, xs[k] = place - ys[k] * job.stride;
    }
    Way on;
    on.at = hn::Load(di, places), on.ix = hn::Load(di, xs), on.iy = hn::Load(di, ys);
    on.x = convert(d, on.ix) + half, on.y = convert(d, on.iy) + half;
    on.word = hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.word), on.at);
    on.bx = on.dx = convert(d, shift_right<20>(on.word)) * unit;
    on.by = on.dy = convert(d, shift_right<20>(shift_left<12>(on.word))) * unit;
    on.sum = set(d, 0), on.steps = set(di, 0);
    const M moving = on.active = rebind(d, (on.word & ~0xFF) != 0);
    const F own = hn::GatherIndex(d, job.noise, on.at) * weight[0];
    Way back = on;
    back.bx = back.dx = -on.dx, back.by = back.dy = -on.dy;
    // Both ways at once: what one waits for, the other computes.
    for (int k = 1; k <= kernel.steps && any(on.active | back.active); ++k) {
      step_on(job, unit, set(d, weight[k]), on);
      step_on(job, back_unit, set(d, weight[-k]), back);
    }
    const I entry = back.steps * (kernel.steps + 1) + on.steps;
    const F value = (own + back.sum + on.sum) * hn::GatherIndex(d, kernel.factor.data(), entry);
    hn::Store(only(moving, value), d, out);
    for (size_t k = 0; k < count; ++k) job.value[pixels[first + k]] = out[k];
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {

HWY_EXPORT(run_connect);
HWY_EXPORT(run_convolve);

namespace {
/// Of the depth: that of a step of half a pixel's size straight away from the viewer.
float connect_slack(const EyeView& v) { return 0.5f / v.scale; }
}  // namespace

void connect_pixels(LicPlanes& planes, const EyeView& view, int first, int last) {
  if (planes.width < 64) connect_pixels_reference(planes, view, first, last);  // narrower than the widest vectors
  else HWY_DYNAMIC_DISPATCH(run_connect)(planes, connect_slack(view), view.parallel, first, last);
}

void connect_pixels_reference(LicPlanes& p, const EyeView& view, int first, int last) {
  for (int y = first; y < last; ++y)
    for (int x = 0; x < p.width; ++x) {
      const size_t i = p.at(x, y);
      uint32_t bits = 0;
      const float free = view.parallel ? connect_slack(view) : p.w[i] * connect_slack(view);
      for (int dy = -1; dy <= 1 && p.item[i] > 0; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const size_t j = p.at(x + dx, y + dy);
          const float jump = p.w[j] - p.w[i], own = p.wx[i] * float(dx) + p.wy[i] * float(dy),
                      other = p.wx[j] * float(dx) + p.wy[j] * float(dy);
          if (p.item[j] == p.item[i] && jump >= std::min(own, other) - free && jump <= std::max(own, other) + free)
            bits |= 1u << neighbor_bit(dx, dy);
        }
      p.word[i] = (p.word[i] & 0xFFFFFF00u) | bits;
    }
}

void convolve(const ConvolveJob& job, const int32_t* pixels, size_t n) { HWY_DYNAMIC_DISPATCH(run_convolve)(job, pixels, n); }

void convolve_reference(const ConvolveJob& job, const int32_t* pixels, size_t n) {
  const LicWeights& kernel = *job.weights;
  const float unit = job.step / 2047;
  const auto part = [&](int32_t word, int shift) { return float(int32_t(uint32_t(word) << shift) >> 20) * unit; };
  for (size_t i = 0; i < n; ++i) {
    const int32_t start = pixels[i], word0 = int32_t(job.word[start]);
    job.value[start] = 0;
    if ((word0 & ~0xFF) == 0) continue;
    const float own = job.noise[start] * kernel.weight[size_t(kernel.steps)];
    float sums[2] = {0, 0};
    int reached[2] = {0, 0};
    for (int way = 0; way < 2; ++way) {
      const float sign = way == 0 ? -1.0f : 1.0f;
      int ix = start % job.stride, iy = start / job.stride;
      int32_t word = word0;
      float x = float(ix) + 0.5f, y = float(iy) + 0.5f, dx = part(word, 0) * sign, dy = part(word, 12) * sign, bx = dx, by = dy;
      for (int k = 1; k <= kernel.steps && (word & ~0xFF) != 0; ++k) {
        const bool turned = dx * bx + dy * by < 0;
        x = x + (turned ? dx : dx * 1.5f - bx * 0.5f), y = y + (turned ? dy : dy * 1.5f - by * 0.5f);
        const int jx = int(x), jy = int(y), ox = jx - ix, oy = jy - iy;
        if (std::abs(ox) > 1 || std::abs(oy) > 1) break;
        if ((ox != 0 || oy != 0) && !(word >> neighbor_bit(ox, oy) & 1)) break;
        const int at = jy * job.stride + jx;
        ix = jx, iy = jy, word = int32_t(job.word[at]), bx = dx, by = dy, dx = part(word, 0) * sign, dy = part(word, 12) * sign;
        sums[way] = sums[way] + job.noise[at] * kernel.weight[size_t(kernel.steps + (way == 0 ? -k : k))];
        ++reached[way];
      }
    }
    job.value[start] = (own + sums[0] + sums[1]) * kernel.factor[size_t(reached[0] * (kernel.steps + 1) + reached[1])];
  }
}

}  // namespace sg::raster
#endif
