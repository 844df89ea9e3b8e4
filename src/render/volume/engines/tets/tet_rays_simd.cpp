// SPDX-License-Identifier: Apache-2.0
// The walk of 16 rays through tetrahedra, and what they gather (no fused multiply-add: the same bits everywhere).
#include <optional>

#include "base/vector_targets.h"
#include "render/volume/engines/tets/project.h"
#include "render/volume/sources/cells/tet_walk.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/tets/tet_rays_simd.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/tets/tet_light-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

struct Corner {
  F x, y, z, f;
  I id;
};

/// Where two products were equal: as TetWalk decides it.
HWY_NOINLINE HWY_ATTR M decide(F ax, F ay, F bx, F by, M found, M unsure) {
  const D d;
  const DI di;
  alignas(64) float a[2][TetPacket::lanes], b[2][TetPacket::lanes];
  alignas(64) int32_t yes[TetPacket::lanes], ask[TetPacket::lanes];
  hn::Store(ax, d, a[0]), hn::Store(ay, d, a[1]), hn::Store(bx, d, b[0]), hn::Store(by, d, b[1]);
  hn::Store(hn::VecFromMask(di, to_int(found)), di, yes), hn::Store(hn::VecFromMask(di, to_int(unsure)), di, ask);
  for (size_t i = 0; i < hn::Lanes(d); ++i)
    if (ask[i]) yes[i] = turns_left(double(a[0][i]), double(a[1][i]), double(b[0][i]), double(b[1][i])) ? -1 : 0;
  return to_float(hn::MaskFromVec(hn::Load(di, yes)));
}

HWY_ATTR inline M left(const Corner& a, const Corner& b) {
  const F p = a.x * b.y, q = a.y * b.x;
  const M equal = p == q, found = p > q;
  if (none(equal)) return found;
  return decide(a.x, a.y, b.x, b.y, found, equal);
}

/// Shares so small of the products that they are differences of are mostly rounding: the plane of a face is as good as along the line.
constexpr float edge_on = 1.0f / 4096;

/// Weights of corners without a share of rounding.
HWY_NOINLINE HWY_ATTR void weigh_exactly(const F x[3], const F y[3], M which, F weight[3]) {
  const D d;
  const DI di;
  alignas(64) float at[2][3][TetPacket::lanes], w[3][TetPacket::lanes];
  alignas(64) int32_t ask[TetPacket::lanes];
  for (int k = 0; k < 3; ++k) hn::Store(x[k], d, at[0][k]), hn::Store(y[k], d, at[1][k]), hn::Store(weight[k], d, w[k]);
  hn::Store(hn::VecFromMask(di, to_int(which)), di, ask);
  for (size_t i = 0; i < hn::Lanes(d); ++i)
    if (ask[i]) {
      // Products of floats are exact in double, so their difference is rounded once.
      double v[3][2], share[3];
      for (int k = 0; k < 3; ++k) v[k][0] = double(at[0][k][i]), v[k][1] = double(at[1][k][i]);
      weights_in_face(v, share);
      for (int k = 0; k < 3; ++k) w[k][i] = float(share[k]);
    }
  for (int k = 0; k < 3; ++k) weight[k] = hn::Load(d, w[k]);
}

HWY_ATTR inline Corner chosen(M yes, const Corner& a, const Corner& b) {
  return {select(yes, a.x, b.x), select(yes, a.y, b.y), select(yes, a.z, b.z), select(yes, a.f, b.f), select(to_int(yes), a.id, b.id)};
}

/// The lanes from `lane` on, as many as a vector has.
HWY_ATTR void walk_lanes(const TetTables& tables, TetPacket& p, size_t lane) {
  const D d;
  const DI di;
  const F zero = set(d, 0), one = set(d, 1.0f);
  const F x0 = hn::Load(d, p.x0 + lane), y0 = hn::Load(d, p.y0 + lane), dx = hn::Load(d, p.dx + lane), dy = hn::Load(d, p.dy + lane);
  const F length = hn::Load(d, p.length + lane), limit = hn::Load(d, p.limit + lane);
  F done = hn::Load(d, p.done + lane), half = hn::Load(d, p.half + lane);
  I tet = hn::Load(di, p.tet + lane), end_tet = set(di, -1), end_gone = set(di, 0);
  Colors sum{hn::Load(d, p.r + lane), hn::Load(d, p.g + lane), hn::Load(d, p.b + lane), hn::Load(d, p.pass + lane)};
  const auto* links = reinterpret_cast<const int32_t*>(tables.links);
  const TetMedium& medium = *tables.medium;

  const auto corner = [&](I id) HWY_ATTR {
    const I at = shift_left<2>(id);
    const F z = hn::GatherIndex(d, tables.eye + 2, at);
    return Corner{hn::GatherIndex(d, tables.eye, at) - x0 - dx * z, hn::GatherIndex(d, tables.eye + 1, at) - y0 - dy * z, z,
                  hn::GatherIndex(d, tables.eye + 3, at), id};
  };
  F weight[3];  // of a, b, c where the line crosses their face
  const auto cross_at = [&](const Corner& a, const Corner& b, const Corner& c, M which, F& f) HWY_ATTR {
    const F pa = b.x * c.y, qa = b.y * c.x, pb = c.x * a.y, qb = c.y * a.x;
    const F pc = a.x * b.y, qc = a.y * b.x;
    const F wa = max(pa - qa, zero), wb = max(pb - qb, zero), wc = max(pc - qc, zero);
    const F all = wa + wb + wc;
    // No product p is below its q: the largest one by size is one of these.
    const F size = max(max(max(pa, pb), pc), -min(min(qa, qb), qc));
    const F least = set(d, 1e-37f);
    const M unsure = which & (all <= size * edge_on + least);
    const F per = one / max(all, least);
    weight[0] = wa * per, weight[1] = wb * per, weight[2] = wc * per;
    if (any(unsure)) {
      const F x[3] = {a.x, b.x, c.x}, y[3] = {a.y, b.y, c.y};
      weigh_exactly(x, y, unsure, weight);
    }
    f = weight[0] * a.f + weight[1] * b.f + weight[2] * c.f;
    return weight[0] * a.z + weight[1] * b.z + weight[2] * c.z;
  };
  const Slice slice{medium};
  // The surface at the face in front, in the lanes that have asked for it.
  const TetLight* light = tables.light;
  std::optional<Lighting> lighting;
  if (light) lighting.emplace(*light, p, lane);
  Surface before;
  M known_before = one < zero;

  Corner a = corner(hn::Load(di, p.id[0] + lane)), b = corner(hn::Load(di, p.id[1] + lane)), c = corner(hn::Load(di, p.id[2] + lane));
  M on = !to_float(tet < 0);
  F f, z = cross_at(a, b, c, on, f);
  while (any(on)) {
    const I entered[3] = {a.id, b.id, c.id};
    const F enter_weight[3] = {weight[0], weight[1], weight[2]}, enter = z;
    // The fourth corner, and the one that is left behind for it.
    const I link = only(to_int(on), shift_left<2>(tet) + tet);
    const I known = a.id ^ b.id ^ c.id;
    const I fourth = select(to_int(on), hn::GatherIndex(di, links, link) ^ known, a.id);
    const Corner e = corner(fourth);
    const M la = left(e, a), lb = left(e, b), lc = left(e, c);
    const M no_c = la & !lb, no_b = lc & !la & !no_c;
    const I gone = select(to_int(no_c), c.id, select(to_int(no_b), b.id, a.id));
    const auto less = [&](I id) HWY_ATTR { return hn::VecFromMask(di, id < gone); };
    const I rank = -(less(a.id) + less(b.id) + (less(c.id) + less(e.id)));
    const I next = hn::GatherIndex(di, links + 1, link + rank);
    c = chosen(no_c, e, c), b = chosen(no_b, e, b), a = chosen(no_c | no_b, a, e);
    F f1;
    const F z1 = cross_at(a, b, c, on, f1);

    // What lies between, cut to what is not drawn yet and not hidden.
    const F from = max(z, done), to = min(z1, limit);
    const M some = on & (to > from);
    F g0 = f, g1 = f1;
    if (tables.cell_values) {
      const I index = only(to_int(on), tet);
      g0 = g1 = hn::GatherIndex(d, tables.cell_values,
                                tables.cells ? hn::GatherIndex(di, reinterpret_cast<const int32_t*>(tables.cells), index) : index);
    } else if (!all((!some) | ((from == z) & (to == z1)))) {
      const F per = (f1 - f) / select(some, z1 - z, one);
      g0 = select(from == z, f, f + (from - z) * per);
      g1 = select(to == z1, f1, f + (to - z) * per);
    }
    const I slice0 = slice(g0), slice1 = slice(g1);
    const M lit = some & slice.lit(slice0, slice1);
    if (any(lit)) {
      // Emission, absorption and light between the two faces.
      if (light) {
        // In front of the first segment of a row it is not known yet.
        if (!all(known_before | !lit)) before = chosen(known_before, before, lighting->on_face(entered, enter_weight));
        const I leaving[3] = {a.id, b.id, c.id};
        const Surface back = lighting->on_face(leaving, weight);
        LitWay way{before, back, g0, g1, (to - from) * length};
        const M cut = lit & ((from != enter) | (to != z1));
        if (any(cut)) {
          const F per = one / select(some, z1 - enter, one);
          way.first = chosen(cut, lighting->between(before, back, (from - enter) * per), before);
          way.last = chosen(cut, lighting->between(before, back, (to - enter) * per), back);
        }
        gather_lit(medium, *lighting, way, slice, lit, tables.stop_below, sum);
        before = back;
      } else {
        gather(medium, g0, g1, (to - from) * length, slice0, slice1, slice, lit, sum);
      }
      const M now = lit & (sum.pass < 0.5f) & is_nan(half);
      half = select(now, to, half);
    }
    known_before = lit;
    done = select(some, to, done);
    z = z1, f = f1;

    // On to the next tetrahedron, or out of the mesh.
    const M left_mesh = on & to_float(next < 0);
    end_tet = select(to_int(left_mesh), tet, end_tet), end_gone = select(to_int(left_mesh), gone, end_gone);
    tet = next;
    on = on & !left_mesh & ((done < limit) & (sum.pass >= tables.stop_below));
  }
  hn::Store(done, d, p.done + lane), hn::Store(half, d, p.half + lane);
  hn::Store(end_tet, di, p.last + lane), hn::Store(end_gone, di, p.gone + lane);
  hn::Store(sum.r, d, p.r + lane), hn::Store(sum.g, d, p.g + lane), hn::Store(sum.b, d, p.b + lane), hn::Store(sum.pass, d, p.pass + lane);
}

HWY_ATTR void walk(const TetTables& tables, TetPacket& packet) {
  for (size_t lane = 0; lane < size_t(TetPacket::lanes); lane += hn::Lanes(D())) walk_lanes(tables, packet, lane);
}

HWY_ATTR void put(const TetMedium& medium, SegmentPacket& p) {
  const D d;
  const Slice slice{medium};
  for (size_t lane = 0; lane < size_t(SegmentPacket::lanes); lane += hn::Lanes(d)) {
    const F length = hn::Load(d, p.length + lane), f0 = hn::Load(d, p.front + lane), f1 = hn::Load(d, p.back + lane);
    const I slice0 = slice(f0), slice1 = slice(f1);
    const M lit = (length > 0) & slice.lit(slice0, slice1);
    if (none(lit)) continue;
    Colors sum{hn::Load(d, p.r + lane), hn::Load(d, p.g + lane), hn::Load(d, p.b + lane), hn::Load(d, p.pass + lane)};
    gather(medium, f0, f1, length, slice0, slice1, slice, lit, sum);
    hn::Store(sum.r, d, p.r + lane), hn::Store(sum.g, d, p.g + lane), hn::Store(sum.b, d, p.b + lane),
        hn::Store(sum.pass, d, p.pass + lane);
  }
}

HWY_ATTR uint32_t cut(const ColumnTet& t, const float y[4], RowCut& out) {
  const D d;
  constexpr int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3}};
  uint32_t bits = 0;
  const float high = std::max(std::max(std::abs(y[0]), std::abs(y[1])), std::max(std::abs(y[2]), std::abs(y[3])));
  for (size_t lane = 0; lane < size_t(ColumnTet::lanes); lane += hn::Lanes(d)) {
    // Turns of the corners around the pixel, by pairs.
    Corner v[4];
    for (int k = 0; k < 4; ++k) v[k].x = hn::Load(d, t.x[k] + lane), v[k].y = set(d, y[k]);
    M left_of[4][4];
    F size[4][4];
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) {
        left_of[a][b] = left(v[a], v[b]);
        size[a][b] = abs(turn(v[a].x, v[a].y, v[b].x, v[b].y));
      }
    // No product is larger than those of the largest coordinates.
    const F wide = max(max(abs(v[0].x), abs(v[1].x)), max(abs(v[2].x), abs(v[3].x)));
    const F small = wide * (high * edge_on) + 1e-37f;
    // Faces that the line of the pixel crosses: the nearest and the farthest, by barycentric weights.
    F enter = set(d, 1e30f), leave = set(d, -1e30f), front = set(d, 0), back = set(d, 0);
    M met = enter < leave;
    for (const auto& [a, b, c] : faces) {
      const M ab = left_of[a][b], bc = left_of[b][c], ac = left_of[a][c];
      const M in = (ab & bc & !ac) | (ac & !(ab | bc));
      if (none(in)) continue;
      const F all = size[b][c] + size[a][c] + size[a][b];
      const F per = 1.0f / max(all, 1e-37f);
      F weight[3] = {size[b][c] * per, size[a][c] * per, size[a][b] * per};
      const M unsure = in & (all <= small);
      if (any(unsure)) {
        const F xs[3] = {v[a].x, v[b].x, v[c].x}, ys[3] = {v[a].y, v[b].y, v[c].y};
        weigh_exactly(xs, ys, unsure, weight);
      }
      const auto mix = [&](const float* q) HWY_ATTR { return weight[0] * q[a] + weight[1] * q[b] + weight[2] * q[c]; };
      const F z = mix(t.z), f = mix(t.f);
      const M nearer = in & (z < enter), farther = in & (z > leave);
      enter = select(nearer, z, enter), front = select(nearer, f, front);
      leave = select(farther, z, leave), back = select(farther, f, back);
      met = met | in;
    }
    if (none(met)) continue;
    hn::Store(enter, d, out.enter + lane), hn::Store(leave, d, out.leave + lane);
    hn::Store(front, d, out.front + lane), hn::Store(back, d, out.back + lane);
    uint8_t mask[8] = {};
    hn::StoreMaskBits(d, met, mask);
    bits |= (uint32_t(mask[0]) | uint32_t(mask[1]) << 8) << lane;
  }
  return bits;
}

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {
HWY_EXPORT(walk);
HWY_EXPORT(put);
HWY_EXPORT(cut);
void walk_tets(const TetTables& tables, TetPacket& packet) { HWY_DYNAMIC_DISPATCH(walk)(tables, packet); }
void put_segments(const TetMedium& medium, SegmentPacket& packet) { HWY_DYNAMIC_DISPATCH(put)(medium, packet); }
uint32_t cut_row(const ColumnTet& tet, const float y[4], RowCut& out) { return HWY_DYNAMIC_DISPATCH(cut)(tet, y, out); }
}  // namespace sg::volume
#endif
