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

using DU = hn::RebindToUnsigned<DF>;
using U = hn::Vec<DU>;

HWY_INLINE F largest(V3 a) { return hn::Max(hn::Max(hn::Abs(a.x), hn::Abs(a.y)), hn::Abs(a.z)); }

/// A unit vector, or zero for none. Sizes from 1e-30 to 1e30 are brought near 1 before they are squared.
HWY_INLINE V3 unit(V3 a) {
  const DF d;
  const F one = hn::Set(d, 1.0f), most = largest(a);
  const M good = hn::And(hn::Gt(most, hn::Set(d, 1e-37f)), hn::Lt(most, hn::Set(d, 3e37f)));  // false for NaN
  const V3 b = a * (one / hn::IfThenElse(good, most, one));
  const F scale = hn::IfThenElseZero(good, one / hn::Sqrt(hn::Max(dot3(b, b), one)));
  const auto part = [&](F v) { return hn::IfThenElseZero(good, v * scale); };
  return {part(b.x), part(b.y), part(b.z)};
}

HWY_INLINE F hashed(U h) {  // bits mixed so that each input bit reaches each output bit, then -1/2 to 1/2
  const DF d;
  const DI di;
  const DU du;
  h = (h ^ hn::ShiftRight<16>(h)) * hn::Set(du, 0x85EBCA6Bu);
  h = (h ^ hn::ShiftRight<13>(h)) * hn::Set(du, 0xC2B2AE35u);
  h = h ^ hn::ShiftRight<16>(h);
  return hn::ConvertTo(d, hn::BitCast(di, hn::ShiftRight<8>(h))) * hn::Set(d, 0x1p-24f) - hn::Set(d, 0.5f);
}

/// Noise of a place: one number per square of the two axes along which the face lies, of a size between two powers of two. The squares are
/// turned, for fields that run along an axis.
HWY_INLINE F noise(V3 p, V3 normal, F footprint, uint32_t seed) {
  const DF d;
  const DI di;
  const DU du;
  const F ax = hn::Abs(normal.x), ay = hn::Abs(normal.y), az = hn::Abs(normal.z);
  const M along_x = hn::And(hn::Gt(ax, ay), hn::Gt(ax, az)), along_y = hn::AndNot(along_x, hn::Gt(ay, az));
  const F a = hn::IfThenElse(along_x, p.y, p.x), b = hn::IfThenElse(hn::Or(along_x, along_y), p.z, p.y);
  const F cosine = hn::Set(d, noise_turn[0]), sine = hn::Set(d, noise_turn[1]), u = a * cosine - b * sine, v = a * sine + b * cosine;
  const U axis = hn::BitCast(du, hn::IfThenElseZero(hn::RebindMask(di, along_x), hn::Set(di, 0x2545F491)) +
                                     hn::IfThenElseZero(hn::RebindMask(di, along_y), hn::Set(di, 0x6C8E9CF5)));
  const I bits = hn::BitCast(di, footprint);
  const I exponent = hn::And(bits, hn::Set(di, 0x7F800000));
  const F size = hn::BitCast(d, exponent);
  const F f = hn::BitCast(d, hn::Or(hn::And(bits, hn::Set(di, 0x007FFFFF)), hn::Set(di, 0x3F800000))) - hn::Set(d, 1.0f);
  const auto level = [&](F cell, I number) {
    const F limit = hn::Set(d, 1e9f), offset = hn::Set(d, 0.3819660f);  // faces on a round coordinate are not on a border
    const auto place = [&](F q) {
      return hn::BitCast(du, hn::ConvertTo(di, hn::Floor(hn::Max(hn::Min(q / cell + offset, limit), hn::Neg(limit)))));
    };
    return hashed((place(u) * hn::Set(du, 0x9E3779B1u)) ^ (place(v) * hn::Set(du, 0x632BE5ABu) + hn::Set(du, seed * 0x7FEB352Du)) ^ axis ^
                  (hn::BitCast(du, number) * hn::Set(du, 0x165667B1u)));
  };
  const F fine = level(size, hn::ShiftRight<23>(exponent)), coarse = level(size + size, hn::ShiftRight<23>(exponent) + hn::Set(di, 1));
  const F one = hn::Set(d, 1.0f), rest = one - f;
  return (fine * rest + coarse * f) / hn::Sqrt(rest * rest + f * f);  // the variance stays
}

void run(const VectorJob& job, VectorBatch& b) {
  const DF d;
  const DI di;
  const EyeView& v = job.view;
  const size_t lanes = hn::Lanes(d), n = b.n;
  const F zero = hn::Zero(d), one = hn::Set(d, 1.0f), inverse = hn::Set(d, 1.0f / v.scale);
  const V3 right = set3(v.right), up = set3(v.up), forward = set3(v.forward);
  for (size_t j = n; j % lanes; ++j) b.x[j] = b.x[n - 1], b.y[j] = b.y[n - 1], b.triangle[j] = b.triangle[n - 1];
  for (size_t i = 0; i < n; i += lanes) {
    // Where the ray meets the triangle.
    const F X = (hn::ConvertTo(d, hn::Load(di, b.x + i)) + hn::Set(d, 0.5f - v.center_x)) * inverse;
    const F Y = (hn::Set(d, v.center_y - 0.5f) - hn::ConvertTo(d, hn::Load(di, b.y + i))) * inverse;
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
    const M good = hn::And(hn::Lt(hn::Abs(s), hn::Set(d, 1e30f)), hn::Lt(hn::Abs(t), hn::Set(d, 1e30f)));
    s = hn::IfThenElse(good, hn::Max(s, zero), hn::Set(d, 1.0f / 3)), t = hn::IfThenElse(good, hn::Max(t, zero), hn::Set(d, 1.0f / 3));
    const F sum = hn::Max(s + t, one);
    s = s / sum, t = t / sum;
    const F r = hn::Max(one - s - t, zero);
    const V3 along = e1 * s + e2 * t;
    const F z = dot3(ra, forward) + dot3(along, forward);

    // The field's tangential part, on the picture.
    V3 f;
    if (job.per_cell) {
      const I cell = job.cells ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(job.cells), triangle)
                               : triangle + hn::Set(di, int32_t(job.first_cell));
      f = gather3(job.vectors, cell);
    } else {
      f = gather3(job.vectors, point[0]) * r + gather3(job.vectors, point[1]) * s + gather3(job.vectors, point[2]) * t;
    }
    const F size = largest(f);
    const V3 normal = unit(cross3(e1, e2)), way = unit(f), tangent = way - normal * dot3(way, normal);
    const F tz = v.parallel ? zero : dot3(tangent, forward);
    const F dx = dot3(tangent, right) - X * tz, dy = Y * tz - dot3(tangent, up), length2 = dx * dx + dy * dy;
    const M moves = hn::And(hn::And(hn::Gt(size, hn::Set(d, job.least)), hn::Gt(dot3(tangent, tangent), hn::Set(d, 1e-6f))),
                            hn::Gt(length2, hn::Set(d, 1e-10f)));
    const F to_unit = hn::Set(d, 2047.0f) / hn::Sqrt(hn::IfThenElse(moves, length2, one));
    const I ix = hn::IfThenElseZero(hn::RebindMask(di, moves), hn::NearestInt(dx * to_unit)),
            iy = hn::IfThenElseZero(hn::RebindMask(di, moves), hn::NearestInt(dy * to_unit));
    hn::Store(hn::Or(hn::ShiftLeft<20>(ix), hn::ShiftLeft<8>(hn::And(iy, hn::Set(di, 0xFFF)))), di, reinterpret_cast<int32_t*>(b.word + i));

    // Depth, and how it changes from pixel to pixel in the triangle's plane.
    const F nx = dot3(normal, right), ny = dot3(normal, up), nz = dot3(normal, forward);
    const F w = v.parallel ? z : one / z;
    const F slope = v.parallel ? inverse / hn::Neg(nz) : w * inverse / (nx * X + ny * Y + nz);
    const F most = (v.parallel ? one : w) * hn::Set(d, 8.0f / v.scale);
    const auto limited = [&](F g) { return hn::IfThenElse(hn::Lt(hn::Abs(g), most), g, hn::CopySign(most, g)); };
    hn::Store(w, d, b.w + i), hn::Store(limited(nx * slope), d, b.wx + i), hn::Store(limited(hn::Neg(ny * slope)), d, b.wy + i);
    const F footprint = (v.parallel ? one : z) * hn::Set(d, noise_square * job.grain / v.scale);
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
