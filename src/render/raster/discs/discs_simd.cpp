// SPDX-License-Identifier: Apache-2.0
// Discs to visibility keys, one small disc per vector lane. No fused multiply-add: every target gives the same bits.
#include <cmath>
#include <cstring>

#include "base/vector_targets.h"
#include "render/raster/discs/discs.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/raster/discs/discs_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/shade/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

constexpr int32_t small_disc = 12;                     // pixels wide and high; larger ones are drawn one by one
constexpr uint32_t most_points = 0x7FFFFFFFu / 3 - 1;  // whose coordinates a lane's offset reaches

using simd::HWY_NAMESPACE::set;
HWY_INLINE F set(float x) { return set(DF(), x); }
HWY_INLINE F along(const F* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// A vector of discs on the picture.
struct Lanes {
  F x, y, z, n[3];            // the eye's coordinates and the normal in them
  F radius2, plane, nearest;  // no point of the disc is less deep than that
  M tiny;                     // shows in the pixel at its centre, as deep as that
  bool within;                // all lie between the near and the far plane
  I x0, x1, y0, y1;           // pixels; empty when there is nothing to draw
};

// What a vector of discs has in memory.
struct Stored {
  F p[3], n[3], r;
};
HWY_INLINE Stored stored(const DiscJob& job, I point) {
  const DF d;
  const I at = point + (point + point);
  Stored s;
  for (int c = 0; c < 3; ++c) s.p[c] = hn::GatherIndex(d, job.xyz + c, at), s.n[c] = hn::GatherIndex(d, job.normals + c, at);
  s.r = hn::GatherIndex(d, job.radius, point);
  return s;
}
HWY_INLINE Stored stored_from(const DiscJob& job, size_t first) {
  const DF d;
  Stored s;
  hn::LoadInterleaved3(d, job.xyz + 3 * first, s.p[0], s.p[1], s.p[2]);
  hn::LoadInterleaved3(d, job.normals + 3 * first, s.n[0], s.n[1], s.n[2]);
  s.r = hn::LoadU(d, job.radius + first);
  return s;
}

HWY_INLINE Lanes place(const DiscJob& job, const Stored& s, I valid) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  F p[3];
  for (int c = 0; c < 3; ++c) p[c] = (s.p[c] - v.hi[c]) - v.lo[c];
  Lanes l;
  l.x = along(p, v.right), l.y = along(p, v.up), l.z = along(p, v.forward);
  l.n[0] = along(s.n, v.right), l.n[1] = along(s.n, v.up), l.n[2] = along(s.n, v.forward);
  const F r = s.r, scale = v.parallel ? set(v.scale) : v.scale / l.z;
  const F cx = v.center_x + scale * l.x, cy = v.center_y - scale * l.y, reach = r * scale;
  M good = (l.z > v.near_plane) & (l.z < v.far_plane) & (r > 0);
  good = good & ((abs(cx) < 1e6f) & (abs(cy) < 1e6f));
  good = good & hn::MaskFromVec(bit_cast(d, valid));
  l.tiny = reach < 0.7f;
  l.within = all((l.z - r > v.near_plane) & (l.z + r < v.far_plane));
  // A disc spans r sqrt(1 - n^2) along each axis; on the picture, what the box of these spans covers, a little more for rounding.
  auto span = [&](F n) { return r * sqrt(max(1.0001f - n * n, 0)); };
  const F span_x = span(l.n[0]), span_y = span(l.n[1]), span_z = span(l.n[2]), margin = set(0.01f);
  F near_scale = scale, far_scale = scale;
  M beside = hn::FirstN(d, 0);  // reaches the eye's plane, or nearly
  if (!v.parallel) {
    near_scale = v.scale / max(l.z - span_z, r), far_scale = v.scale / (l.z + span_z);
    beside = !(l.z > 2 * r);
  }
  auto most = [&](F q) { return max(q * near_scale, q * far_scale) + margin; };
  auto least = [&](F q) { return min(q * near_scale, q * far_scale) - margin; };
  const F grown = reach * 4;
  const F low_x = select(beside, cx - grown, v.center_x + least(l.x - span_x)),
          high_x = select(beside, cx + grown, v.center_x + most(l.x + span_x)),
          low_y = select(beside, cy - grown, v.center_y - most(l.y + span_y)),
          high_y = select(beside, cy + grown, v.center_y - least(l.y - span_y));
  const F most_x = set(float(v.width - 1)), most_y = set(float(v.height - 1)), half = set(0.5f), zero = set(0);
  const F left = select(l.tiny, floor(cx), ceil(low_x - half)), right = floor(high_x - half);
  const F top = select(l.tiny, floor(cy), ceil(low_y - half)), bottom = floor(high_y - half);
  // Tiny ones off the picture stay off it.
  const F x0 = select(l.tiny, left, max(left, zero)), x1 = select(l.tiny, left, min(right, most_x));
  const F y0 = select(l.tiny, top, max(top, zero)), y1 = select(l.tiny, top, min(bottom, most_y));
  good = good & ((x0 >= zero) & (x1 <= most_x) & ((y0 >= zero) & (y1 <= most_y)));
  auto pixel = [&](F value, float otherwise) { return convert(di, select(good, value, otherwise)); };
  l.x0 = pixel(x0, 1), l.x1 = pixel(x1, 0), l.y0 = pixel(y0, 1), l.y1 = pixel(y1, 0);
  l.plane = l.n[0] * l.x + l.n[1] * l.y + l.n[2] * l.z;
  l.radius2 = r * r;
  l.nearest = l.z - r * 1.001f;
  return l;
}

HWY_INLINE int32_t largest(I a) { return hn::GetLane(hn::MaxOfLanes(DI(), a)); }

// All discs' pixels at the same place in their boxes at once.
template <bool parallel>
HWY_INLINE void draw_lanes(const DiscJob& job, const Lanes& l, uint32_t primitive, M wanted) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  const I wide = l.x1 - l.x0, high = l.y1 - l.y0, zero = set(di, 0);
  const auto some = !((zero > wide) | (zero > high)) & hn::MaskFromVec(bit_cast(di, hn::VecFromMask(d, wanted)));
  if (none(some)) return;
  const int32_t columns = largest(only(some, wide)), rows = largest(only(some, high));
  const F inverse = set(1 / v.scale);
  const auto* depths = reinterpret_cast<const int32_t*>(job.keys);
  for (int32_t row = 0; row <= rows; ++row) {
    const I y = l.y0 + row;
    const F dy = (v.center_y - convert(d, y) - 0.5f) * inverse;
    const auto in_row = some & !(y > l.y1);
    for (int32_t column = 0; column <= columns; ++column) {
      const I x = l.x0 + column;
      const auto in_box = in_row & !(x > l.x1);
      // What is there already. Another thread may bring something nearer meanwhile, never something further.
      const I at = only(in_box, y * v.width + x);
      const F there = bit_cast(d, hn::GatherIndex(di, depths + 1, at + at));
      M hit = (l.nearest <= there) & hn::MaskFromVec(bit_cast(d, hn::VecFromMask(di, in_box)));
      if (none(hit)) continue;
      // Where the ray of the pixel meets the plane of the disc.
      const F dx = (convert(d, x) + 0.5f - v.center_x) * inverse;
      F qx, qy, z;
      if constexpr (parallel) {
        qx = dx, qy = dy, z = (l.plane - l.n[0] * dx - l.n[1] * dy) / l.n[2];
      } else {
        z = l.plane / (l.n[0] * dx + l.n[1] * dy + l.n[2]);
        qx = dx * z, qy = dy * z;
      }
      // Within the radius, between the planes, nearer than what is there.
      const F ox = qx - l.x, oy = qy - l.y, oz = z - l.z;
      hit = hit & ((ox * ox + oy * oy + oz * oz <= l.radius2) | l.tiny);
      z = select(l.tiny, l.z, z);
      if (!l.within) hit = hit & ((z > v.near_plane) & (z < v.far_plane));
      hit = hit & (z <= there);
      if (none(hit)) continue;
      // Lane by lane: two may have the same pixel.
      HWY_ALIGN float depth[hn::MaxLanes(DF())];
      HWY_ALIGN int32_t slot[hn::MaxLanes(DI())];
      hn::Store(z, d, depth), hn::Store(at, di, slot);
      uint8_t bytes[8] = {};
      hn::StoreMaskBits(d, hit, bytes);
      uint64_t bits;
      std::memcpy(&bits, bytes, 8);
      for (; bits; bits &= bits - 1) {
        const auto lane = uint32_t(hwy::Num0BitsBelowLS1Bit_Nonzero64(bits));
        keep_nearer(job.keys + slot[lane], depth_key(depth[lane], primitive + lane));
      }
    }
  }
}

void disc_range(const DiscJob& job, size_t begin, size_t end) {
  const DF d;
  const DI di;
  const size_t lanes = hn::Lanes(d);
  for (size_t i = begin; i < end; i += lanes) {
    const size_t n = std::min(lanes, end - i);
    // The discs of the lanes: neighbours in memory, or by number; the last one again where fewer are left.
    Stored s;
    if (!job.points && n == lanes) {
      s = stored_from(job, i);
    } else {
      HWY_ALIGN uint32_t point[hn::MaxLanes(DF())];
      uint32_t last = 0;
      for (size_t l = 0; l < lanes; ++l) {
        const size_t disc = i + std::min(l, n - 1);
        point[l] = job.points ? job.points[disc] : uint32_t(disc);
        last = std::max(last, point[l]);
      }
      if (last > most_points) {
        draw_discs_one_by_one(job, i, i + n);
        continue;
      }
      s = stored(job, hn::Load(di, reinterpret_cast<const int32_t*>(point)));
    }
    const Lanes l = place(job, s, hn::VecFromMask(di, hn::FirstN(di, n)));
    // Small ones by vectors, large ones one by one.
    const I limit = set(di, small_disc);
    const auto large = (l.x1 - l.x0 > limit) | (l.y1 - l.y0 > limit);
    const M is_large = hn::MaskFromVec(bit_cast(d, hn::VecFromMask(di, large)));
    if (job.view.parallel) draw_lanes<true>(job, l, job.first_primitive + uint32_t(i), !is_large);
    else draw_lanes<false>(job, l, job.first_primitive + uint32_t(i), !is_large);
    if (HWY_LIKELY(none(large))) continue;
    uint8_t bytes[8] = {};
    hn::StoreMaskBits(d, is_large, bytes);
    for (size_t lane = 0; lane < n; ++lane)
      if (bytes[lane / 8] >> (lane % 8) & 1) draw_discs_one_by_one(job, i + lane, i + lane + 1);
  }
}

// Light of the discs that pixels show: see DiscLight.
void disc_light(const DiscLight& job, ShadeBatch& b) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  const Material& m = job.material;
  const size_t lanes = hn::Lanes(d);
  const F zero = set(0), one = set(1);
  const shading::HWY_NAMESPACE::Power power(m.power);
  for (size_t i = b.n; i % lanes != 0; ++i) b.triangle[i] = b.triangle[b.n - 1], b.pixel[i] = b.pixel[b.n - 1];
  for (size_t i = 0; i < b.n; i += lanes) {
    const I disc = hn::LoadU(di, reinterpret_cast<const int32_t*>(b.triangle + i));
    const I point = job.points ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.points), disc) : disc,
            at = point + (point + point);
    const I pixel = hn::LoadU(di, reinterpret_cast<const int32_t*>(b.pixel + i));
    // Normal, and the direction to the viewer.
    F n[3], view[3];
    for (int c = 0; c < 3; ++c) n[c] = hn::GatherIndex(d, job.normals + c, at), view[c] = set(-v.forward[c]);
    if (!v.parallel) {
      const F x = convert(d, b.tile_x + (pixel & (tile_size - 1)));
      const F y = convert(d, b.tile_y + shift_right<6>(pixel));
      static_assert(tile_size == 64);
      const F dx = (x + 0.5f - v.center_x) / v.scale, dy = (v.center_y - y - 0.5f) / v.scale;
      for (int c = 0; c < 3; ++c) view[c] = view[c] - v.right[c] * dx - v.up[c] * dy;
      const F size = one / sqrt(view[0] * view[0] + view[1] * view[1] + view[2] * view[2]);
      for (int c = 0; c < 3; ++c) view[c] = view[c] * size;
    }
    // The side that is seen.
    F facing = n[0] * view[0] + n[1] * view[1] + n[2] * view[2];
    const M away = facing < zero;
    for (int c = 0; c < 3; ++c) n[c] = select(away, -n[c], n[c]);
    facing = abs(facing);
    // Blinn and Phong's model.
    F diffuse = zero, specular = zero;
    for (const Lamp& lamp : job.lights) {
      const Vec3f direction(lamp.direction);
      const float to[3] = {direction.x, direction.y, direction.z};
      const F n_l = along(n, to), intensity = set(lamp.intensity);
      const auto terms = shading::HWY_NAMESPACE::lamp_terms(n_l, cosine_to_half(n_l, facing, along(view, to)), power);
      diffuse = diffuse + terms.diffuse * intensity, specular = specular + terms.specular * intensity;
    }
    hn::StoreU(m.lit ? set(m.ambient) + m.diffuse * diffuse : one, d, b.light + i);
    hn::StoreU(m.lit ? m.specular * specular : zero, d, b.gloss + i);
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {
HWY_EXPORT(disc_range);
HWY_EXPORT(disc_light);
void light_discs(const DiscLight& job, ShadeBatch& batch) { HWY_DYNAMIC_DISPATCH(disc_light)(job, batch); }
bool last_is_nearer(const DiscJob& job, size_t count) {
  if (count == 0) return false;
  const auto depth = [&](size_t i) { return to_eye(job.view, job.xyz + 3 * (job.points ? size_t(job.points[i]) : i)).z; };
  float first = 0, last = 0;
  for (size_t k = 0; k < 8; ++k) first += depth(count * k / 32), last += depth(count - 1 - count * k / 32);
  return last < first;
}
void draw_discs(const DiscJob& job, size_t begin, size_t end) {
  if (int64_t(job.view.width) * job.view.height >= int64_t(1) << 30) return draw_discs_one_by_one(job, begin, end);
  HWY_DYNAMIC_DISPATCH(disc_range)(job, begin, end);
}
}  // namespace sg::raster
#endif
