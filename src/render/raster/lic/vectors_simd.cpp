// SPDX-License-Identifier: Apache-2.0
// Where the ray of a pixel meets its triangle, and how the field runs there on the picture: one pixel per vector lane. No fused
// multiply-add and no libm: every target gives the same bits.
#include "render/raster/lic/surface_lic.h"

#include "base/vector_targets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/raster/lic/vectors_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/shade/light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::raster::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using DU = hn::RebindToUnsigned<DF>;
using U = hn::Vec<DU>;

HWY_INLINE F largest(V3 a) { return max(max(abs(a.x), abs(a.y)), abs(a.z)); }

/// A unit vector, or zero for none. Sizes from 1e-30 to 1e30 are brought near 1 before they are squared.
HWY_INLINE V3 unit(V3 a) {
  const DF d;
  const F one = set(d, 1.0f), most = largest(a);
  const M good = (most > 1e-37f) & (most < 3e37f);  // false for NaN
  const V3 b = a * (one / select(good, most, one));
  const F scale = only(good, one / sqrt(max(dot3(b, b), one)));
  const auto part = [&](F v) { return only(good, v * scale); };
  return {part(b.x), part(b.y), part(b.z)};
}

HWY_INLINE F hashed(U h) {  // bits mixed so that each input bit reaches each output bit, then -1/2 to 1/2
  const DF d;
  const DI di;
  h = (h ^ shift_right<16>(h)) * 0x85EBCA6Bu;
  h = (h ^ shift_right<13>(h)) * 0xC2B2AE35u;
  h = h ^ shift_right<16>(h);
  return convert(d, bit_cast(di, shift_right<8>(h))) * 0x1p-24f - set(d, 0.5f);
}

/// Noise of a place: one number per square of the two axes along which the face lies, of a size between two powers of two. The squares are
/// turned, for fields that run along an axis.
HWY_INLINE F noise(V3 p, V3 normal, F footprint, uint32_t seed) {
  const DF d;
  const DI di;
  const DU du;
  const F ax = abs(normal.x), ay = abs(normal.y), az = abs(normal.z);
  const M along_x = (ax > ay) & (ax > az), along_y = (ay > az) & !along_x;
  const F a = select(along_x, p.y, p.x), b = select(along_x | along_y, p.z, p.y);
  const F cosine = set(d, noise_turn[0]), sine = set(d, noise_turn[1]), u = a * cosine - b * sine, v = a * sine + b * cosine;
  const U axis = bit_cast(du, only(along_x, set(di, 0x2545F491)) + only(along_y, set(di, 0x6C8E9CF5)));
  const I bits = bit_cast(di, footprint);
  const I exponent = bits & 0x7F800000;
  const F size = bit_cast(d, exponent);
  const F f = bit_cast(d, (bits & 0x007FFFFF) | 0x3F800000) - 1.0f;
  const auto level = [&](F cell, I number) {
    const F limit = set(d, 1e9f), offset = set(d, 0.3819660f);  // faces on a round coordinate are not on a border
    const auto place = [&](F q) { return bit_cast(du, convert(di, floor(max(min(q / cell + offset, limit), -limit)))); };
    return hashed((place(u) * 0x9E3779B1u) ^ (place(v) * 0x632BE5ABu + seed * 0x7FEB352Du) ^ axis ^ (bit_cast(du, number) * 0x165667B1u));
  };
  const F fine = level(size, shift_right<23>(exponent)), coarse = level(size + size, shift_right<23>(exponent) + 1);
  const F one = set(d, 1.0f), rest = one - f;
  return (fine * rest + coarse * f) / sqrt(rest * rest + f * f);  // the variance stays
}

void run(const VectorJob& job, VectorBatch& b) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  const size_t lanes = hn::Lanes(d), n = b.n;
  const F zero = set(d, 0), one = set(d, 1.0f), inverse = set(d, 1.0f / v.scale);
  const V3 right = set3(v.right), up = set3(v.up), forward = set3(v.forward);
  for (size_t j = n; j % lanes; ++j) b.x[j] = b.x[n - 1], b.y[j] = b.y[n - 1], b.triangle[j] = b.triangle[n - 1];
  for (size_t i = 0; i < n; i += lanes) {
    // Where the ray meets the triangle.
    const F X = (convert(d, hn::Load(di, b.x + i)) + (0.5f - v.center_x)) * inverse;
    const F Y = ((v.center_y - 0.5f) - convert(d, hn::Load(di, b.y + i))) * inverse;
    const V3 side = right * X + up * Y, none{zero, zero, zero};
    const V3 ray = v.parallel ? forward : forward + side, start = v.parallel ? side : none;
    const I triangle = hn::Load(di, reinterpret_cast<const int32_t*>(b.triangle + i)), at = triangle + triangle + triangle;
    I point[3];
    for (int k = 0; k < 3; ++k) point[k] = hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.triangles) + k, at);
    const V3 a = gather3(job.xyz, point[0]), e1 = gather3(job.xyz, point[1]) - a, e2 = gather3(job.xyz, point[2]) - a;
    const V3 ra = (a - set3(v.hi)) - set3(v.lo), t0 = start - ra;
    const V3 p = cross3(ray, e2), q = cross3(t0, e1);
    const F inverse_det = one / dot3(e1, p);
    F s = dot3(t0, p) * inverse_det, t = dot3(ray, q) * inverse_det;
    const M good = (abs(s) < 1e30f) & (abs(t) < 1e30f);
    s = select(good, max(s, zero), 1.0f / 3), t = select(good, max(t, zero), 1.0f / 3);
    const F sum = max(s + t, one);
    s = s / sum, t = t / sum;
    const F r = max(one - s - t, zero);
    const V3 along = e1 * s + e2 * t;
    const F z = dot3(ra, forward) + dot3(along, forward);

    // The field's tangential part, on the picture.
    V3 f;
    if (job.per_cell) {
      const I cell =
          job.cells ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.cells), triangle) : triangle + int32_t(job.first_cell);
      f = gather3(job.vectors, cell);
    } else {
      f = gather3(job.vectors, point[0]) * r + gather3(job.vectors, point[1]) * s + gather3(job.vectors, point[2]) * t;
    }
    const F size = largest(f);
    const V3 normal = unit(cross3(e1, e2)), way = unit(f), tangent = way - normal * dot3(way, normal);
    const F tz = v.parallel ? zero : dot3(tangent, forward);
    const F dx = dot3(tangent, right) - X * tz, dy = Y * tz - dot3(tangent, up), length2 = dx * dx + dy * dy;
    const M moves = (size > job.least) & (dot3(tangent, tangent) > 1e-6f) & (length2 > 1e-10f);
    const F to_unit = 2047.0f / sqrt(select(moves, length2, one));
    const I ix = only(moves, nearest_int(dx * to_unit)), iy = only(moves, nearest_int(dy * to_unit));
    hn::Store(shift_left<20>(ix) | shift_left<8>(iy & 0xFFF), di, reinterpret_cast<int32_t*>(b.word + i));

    // Depth, and how it changes from pixel to pixel in the triangle's plane.
    const F nx = dot3(normal, right), ny = dot3(normal, up), nz = dot3(normal, forward);
    const F w = v.parallel ? z : one / z;
    const F slope = v.parallel ? inverse / -nz : w * inverse / (nx * X + ny * Y + nz);
    const F most = (v.parallel ? one : w) * (8.0f / v.scale);
    const auto limited = [&](F g) { return select(abs(g) < most, g, copy_sign(most, g)); };
    hn::Store(w, d, b.w + i), hn::Store(limited(nx * slope), d, b.wx + i), hn::Store(limited(-(ny * slope)), d, b.wy + i);
    const F footprint = (v.parallel ? one : z) * (noise_square * job.grain / v.scale);
    hn::Store(noise(a + along, normal, footprint, job.seed), d, b.noise + i);
  }
}

}  // namespace sg::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::raster {

HWY_EXPORT(run);

void pixel_vectors(const VectorJob& job, VectorBatch& batch) {
  if (batch.n > 0) HWY_DYNAMIC_DISPATCH(run)(job, batch);
}

}  // namespace sg::raster
#endif
