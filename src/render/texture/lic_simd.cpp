// SPDX-License-Identifier: Apache-2.0
// The two loops of image-space LIC over whole planes: which neighbours belong together, and noise along lines. No fused multiply-add.
#include "render/texture/surface_lic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/texture/lic_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

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
      const F free = parallel ? hn::Set(d, slack) : w * hn::Set(d, slack);
      U bits = hn::Zero(du);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (dx == 0 && dy == 0) continue;
          const size_t j = i + size_t(dy) * p.stride + size_t(dx);
          const F fx = hn::Set(d, float(dx)), fy = hn::Set(d, float(dy));
          const F jump = hn::LoadU(d, p.w.data() + j) - w, own = wx * fx + wy * fy,
                  other = hn::LoadU(d, p.wx.data() + j) * fx + hn::LoadU(d, p.wy.data() + j) * fy;
          const M inside = hn::And(hn::Ge(jump, hn::Min(own, other) - free), hn::Le(jump, hn::Max(own, other) + free));
          const auto same = hn::And(hn::RebindMask(du, inside), hn::Eq(item, hn::LoadU(du, p.item.data() + j)));
          bits = hn::Or(bits, hn::IfThenElseZero(same, hn::Set(du, 1u << neighbor_bit(dx, dy))));
        }
      bits = hn::IfThenElseZero(hn::Ne(item, hn::Zero(du)), bits);
      const U word = hn::And(hn::LoadU(du, p.word.data() + i), hn::Set(du, 0xFFFFFF00u));
      hn::StoreU(hn::Or(word, bits), du, p.word.data() + i);
    }
  }
}

void run_convolve(const ConvolveJob& job, const int32_t* pixels, size_t n) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  const int32_t* words = reinterpret_cast<const int32_t*>(job.word);
  const LicWeights& kernel = *job.weights;
  const I stride = hn::Set(di, job.stride), one = hn::Set(di, 1), two = hn::Set(di, 2), nothing = hn::Zero(di);
  const F unit = hn::Set(d, job.step / 2047), half = hn::Set(d, 0.5f), more = hn::Set(d, 1.5f), zero = hn::Zero(d);
  HWY_ALIGN float out[hn::MaxLanes(d)];
  for (size_t first = 0; first < n; first += lanes) {
    const size_t count = std::min(lanes, n - first);
    HWY_ALIGN int32_t xs[hn::MaxLanes(di)], ys[hn::MaxLanes(di)], places[hn::MaxLanes(di)];
    for (size_t k = 0; k < lanes; ++k) {
      const int32_t place = places[k] = k < count ? pixels[first + k] : 0;  // 0: of the border, without direction
      ys[k] = place / job.stride, xs[k] = place - ys[k] * job.stride;
    }
    const I start = hn::Load(di, places), x0 = hn::Load(di, xs), y0 = hn::Load(di, ys);
    const I word0 = hn::GatherIndex(di, words, start);
    const F dx0 = hn::ConvertTo(d, hn::ShiftRight<20>(word0)) * unit,
            dy0 = hn::ConvertTo(d, hn::ShiftRight<20>(hn::ShiftLeft<12>(word0))) * unit;
    F sum = hn::GatherIndex(d, job.noise, start) * hn::Set(d, kernel.weight[size_t(kernel.steps)]);
    I reached[2];
    for (int way = 0; way < 2; ++way) {
      const F sign = hn::Set(d, way == 0 ? -1.0f : 1.0f);
      F x = hn::ConvertTo(d, x0) + half, y = hn::ConvertTo(d, y0) + half;
      F dx = dx0 * sign, dy = dy0 * sign, bx = dx, by = dy;  // b: at the step before
      I ix = x0, iy = y0, at = start, word = word0;
      auto active = hn::RebindMask(d, hn::Ne(hn::And(word0, hn::Set(di, ~0xFF)), nothing));
      I steps = nothing;
      for (int k = 1; k <= kernel.steps; ++k) {
        const M turned = hn::Lt(dx * bx + dy * by, zero);
        x = x + hn::IfThenElse(turned, dx, dx * more - bx * half), y = y + hn::IfThenElse(turned, dy, dy * more - by * half);
        const I jx = hn::ConvertTo(di, x), jy = hn::ConvertTo(di, y);  // positive while active
        const I ox = jx - ix, oy = jy - iy, apart = oy + oy + oy + ox;
        const auto near = hn::And(hn::Lt(hn::Abs(ox), two), hn::Lt(hn::Abs(oy), two));
        // The bit of that neighbour, moved to the lowest place.
        const I bit = hn::And(apart + hn::Set(di, 4) + hn::VecFromMask(di, hn::Gt(apart, nothing)), hn::Set(di, 15));
        const auto open = hn::Or(hn::Ne(hn::And(hn::Shr(word, bit), one), nothing), hn::Eq(apart, nothing));
        active = hn::And(active, hn::RebindMask(d, hn::And(near, open)));
        if (hn::AllFalse(d, active)) break;
        const auto go = hn::RebindMask(di, active);
        at = hn::IfThenElse(go, jy * stride + jx, at), ix = jx, iy = jy;
        word = hn::GatherIndex(di, words, at);
        bx = dx, by = dy;
        dx = hn::ConvertTo(d, hn::ShiftRight<20>(word)) * unit * sign,
        dy = hn::ConvertTo(d, hn::ShiftRight<20>(hn::ShiftLeft<12>(word))) * unit * sign;
        const F sample = hn::GatherIndex(d, job.noise, at) * hn::Set(d, kernel.weight[size_t(kernel.steps + (way == 0 ? -k : k))]);
        sum = sum + hn::IfThenElseZero(active, sample);
        steps = steps - hn::VecFromMask(di, go);
        // A place without direction is the end.
        active = hn::And(active, hn::RebindMask(d, hn::Ne(hn::And(word, hn::Set(di, ~0xFF)), nothing)));
      }
      reached[way] = steps;
    }
    const I entry = reached[0] * hn::Set(di, kernel.steps + 1) + reached[1];
    const F value = sum * hn::GatherIndex(d, kernel.factor.data(), entry);
    hn::Store(hn::IfThenElseZero(hn::RebindMask(d, hn::Ne(hn::And(word0, hn::Set(di, ~0xFF)), nothing)), value), d, out);
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
    float sum = job.noise[start] * kernel.weight[size_t(kernel.steps)];
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
        sum = sum + job.noise[at] * kernel.weight[size_t(kernel.steps + (way == 0 ? -k : k))];
        ++reached[way];
      }
    }
    job.value[start] = sum * kernel.factor[size_t(reached[0] * (kernel.steps + 1) + reached[1])];
  }
}

}  // namespace sg::raster
#endif
