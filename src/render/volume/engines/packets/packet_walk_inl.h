// SPDX-License-Identifier: Apache-2.0
// A packet on its way from cell to cell: every lane has its own place on its own ray, leaps over what draws nothing and crosses the rest.
#if defined(SG_PACKET_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_WALK_INL_H
#undef SG_PACKET_WALK_INL_H
#else
#define SG_PACKET_WALK_INL_H
#endif

#include "render/volume/engines/packets/packet_cells_inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Cells are told by their lowest samples; -1 and last + 1 are the halves beyond the outermost samples.
template <class D, class Cells>
class CellWalk {
 protected:
  using F = hn::Vec<D>;
  using I = Int<D>;
  using M = hn::Mask<D>;

  HWY_INLINE CellWalk(const PacketPlan& plan, const RayPacket& rays) : plan_(plan), v_(plan.volume), cells_(plan, rays), rays_(rays) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      still_[a] = hn::Eq(cells_.along[a], hn::Zero(d)), up_[a] = hn::Gt(cells_.along[a], hn::Zero(d));
      per_along_[a] = hn::IfThenElseZero(hn::Not(still_[a]), hn::Div(hn::Set(d, 1.0f), cells_.along[a]));
    }
    octant_ = hn::Zero(IntTag<D>());
    if (const auto* up = plan.passages ? &plan.passages->up : plan.ahead ? &plan.ahead->up : nullptr)
      for (size_t a = 0; a < 3; ++a)
        octant_ = hn::Add(octant_, hn::IfThenElseZero(hn::RebindMask(IntTag<D>(), up_[a]), hn::Set(IntTag<D>(), (*up)[a])));
    end_ = hn::Load(d, rays.length), cells_.sum.pass = hn::Load(d, rays.before);
  }

  /// How the bricks that the lanes are in are passed, a code of Passages each.
  struct Passage {
    I code;
    HWY_INLINE M empty() const { return hn::RebindMask(D(), hn::Lt(code, hn::Set(IntTag<D>(), int(Passages::drawn)))); }
    HWY_INLINE M bent() const { return hn::RebindMask(D(), hn::Eq(code, hn::Set(IntTag<D>(), int(Bends::unbounded)))); }
  };
  HWY_INLINE I brick_of(int a, I cell) const { return hn::ShiftRight<FineBricks::shift>(within(a, cell)); }
  /// Of cells of the lattice.
  HWY_INLINE I brick_id(I x, I y, I z) const {
    const IntTag<D> di;
    const auto& dims = v_.fine().dims;
    const I row = hn::Set(di, int(dims[0])), layer = hn::Set(di, int(dims[0] * dims[1]));
    constexpr int shift = FineBricks::shift;
    return hn::Add(hn::ShiftRight<shift>(x), hn::Add(hn::Mul(hn::ShiftRight<shift>(y), row), hn::Mul(hn::ShiftRight<shift>(z), layer)));
  }
  HWY_INLINE Passage passage(const I cell[3]) const {
    return passage(brick_id(within(0, cell[0]), within(1, cell[1]), within(2, cell[2])));
  }
  HWY_INLINE Passage passage(I id) const {
    const D d;
    const IntTag<D> di;
    const I byte = hn::Set(di, 255), unbounded = hn::Set(di, int(Bends::unbounded));
    const I place = hn::Add(id, octant_);
    if (plan_.passages) return {hn::And(gather_words(d, plan_.passages->codes.data(), place, cells_.source.loads), byte)};
    if (!plan_.knobs.skip_empty || !v_.any_empty) return {unbounded};
    const uint8_t* distance = plan_.ahead ? plan_.ahead->bricks.data() : v_.distance.data();
    const I free = hn::And(gather_words(d, distance, place, cells_.source.loads), byte);
    return {hn::IfThenElse(hn::Gt(free, hn::Zero(di)), free, unbounded)};
  }

  HWY_INLINE I cell_at(int a, F t) const { return cells_.axes.cell_at(a, mul_add(cells_.along[a], t, cells_.start[a])); }

  /// Takes lanes out of the cube of bricks nearer than what is drawn.
  HWY_INLINE void leap(const Passage& from, M leaping, I cell[3], F& t) const {
    const D d;
    const IntTag<D> di;
    const I one = hn::Set(di, 1), zero = hn::Zero(di);
    const I* last_cell = cells_.source.last_cell;
    F leave = end_, at[3];
    I side[3];
    hn::Mask<IntTag<D>> open[3];
    for (int a = 0; a < 3; ++a) {
      const I reach = hn::IfThenElse(hn::RebindMask(di, up_[a]), from.code, hn::Sub(one, from.code));
      side[a] = hn::ShiftLeft<FineBricks::shift>(hn::Add(brick_of(a, cell[a]), reach));
      // Beyond the outermost bricks there is nothing else.
      open[a] = hn::Or(hn::RebindMask(di, still_[a]), hn::Or(hn::Lt(side[a], one), hn::Gt(side[a], last_cell[a])));
      at[a] = hn::IfThenElse(hn::RebindMask(d, open[a]), hn::Set(d, HUGE_VALF), when_at(a, side[a], t));
      leave = hn::Min(leave, at[a]);
    }
    const auto moving = hn::RebindMask(di, leaping);
    for (int a = 0; a < 3; ++a) {
      const auto up = hn::RebindMask(di, up_[a]), still = hn::RebindMask(di, still_[a]);
      const auto through = hn::RebindMask(di, hn::Le(at[a], leave));
      const I beyond = hn::Sub(side[a], hn::IfThenElse(up, zero, one));
      // Inside the cube along the other axes, and never back.
      const I here = cell_at(a, leave);
      const I forth =
          hn::IfThenElse(up, hn::Max(cell[a], hn::Min(here, hn::Sub(beyond, one))), hn::Min(cell[a], hn::Max(here, hn::Add(beyond, one))));
      const I within = hn::IfThenElse(open[a], hn::IfThenElse(still, cell[a], here), forth);
      cell[a] = hn::IfThenElse(moving, hn::IfThenElse(through, beyond, within), cell[a]);
    }
    t = hn::IfThenElse(leaping, leave, t);
  }

  /// Takes lanes through their cells.
  HWY_INLINE void cross(M crossing, I cell[3], F& t) {
    const D d;
    const IntTag<D> di;
    const I one = hn::Set(di, 1), zero = hn::Zero(di);
    F leave = end_, at[3];
    I inside[3], beyond[3];
    for (int a = 0; a < 3; ++a) {
      const auto up = hn::RebindMask(di, up_[a]);
      inside[a] = hn::Min(hn::Max(cell[a], zero), cells_.source.last_cell[a]);
      beyond[a] = hn::Add(cell[a], hn::IfThenElse(up, one, hn::Neg(one)));
      at[a] = hn::IfThenElse(still_[a], hn::Set(d, HUGE_VALF), when_at(a, hn::Max(cell[a], beyond[a]), t));
      leave = hn::Min(leave, at[a]);
    }
    const M look = hn::And(crossing, hn::Gt(leave, t));
    if (!hn::AllFalse(d, look)) cells_.cross(inside, t, leave, look);
    for (int a = 0; a < 3; ++a) cell[a] = hn::IfThenElse(hn::RebindMask(di, hn::And(crossing, hn::Le(at[a], leave))), beyond[a], cell[a]);
    t = hn::IfThenElse(crossing, leave, t);
  }

  HWY_INLINE void store(PacketResult& result) const {
    const D d;
    const Gathering<D>& sum = cells_.sum;
    alignas(64) float half_at[most_lanes];
    hn::Store(sum.r, d, result.r), hn::Store(sum.g, d, result.g), hn::Store(sum.b, d, result.b);
    hn::Store(sum.pass, d, result.transmittance), hn::Store(sum.half_at, d, half_at);
    for (size_t n = 0; n < hn::Lanes(d); ++n) result.surface[n] = half_at[n] >= 0 ? rays_.enter[n] + double(half_at[n]) : -1;
  }

  const PacketPlan& plan_;
  const Volume& v_;
  Cells cells_;
  F end_;
  M still_[3], up_[3];
  I octant_;  // where the codes of the octants that rays go to begin

 private:
  HWY_INLINE I within(int a, I cell) const { return hn::Min(hn::Max(cell, hn::Zero(IntTag<D>())), cells_.source.last_cell[a]); }
  /// When, from t on, a ray meets that side.
  HWY_INLINE F when_at(int a, I side, F t) const {
    return hn::Max(hn::Mul(hn::Sub(cells_.axes.sample(a, side), cells_.start[a]), per_along_[a]), t);
  }

  const RayPacket& rays_;
  F per_along_[3];
};

/// Crosses all cells that draw something, none in strides.
template <class D, class Cells>
class CellByCell : CellWalk<D, Cells> {
  using Walk = CellWalk<D, Cells>;
  using typename Walk::F, typename Walk::I, typename Walk::M;

 public:
  HWY_INLINE CellByCell(const PacketPlan& plan, const RayPacket& rays) : Walk(plan, rays) {}

  HWY_INLINE void run(PacketResult& result) {
    const D d;
    const F stop = hn::Set(d, this->plan_.budget.stop_below);
    F t = hn::Zero(d);
    I cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = this->cell_at(a, t);
    while (true) {
      const M going = hn::And(hn::Lt(t, this->end_), hn::Ge(this->cells_.sum.pass, stop));
      if (hn::AllFalse(d, going)) break;
      const auto here = this->passage(cell);
      const M leaping = hn::And(going, here.empty()), crossing = hn::AndNot(leaping, going);
      if (!hn::AllFalse(d, leaping)) this->leap(here, leaping, cell, t);
      if (!hn::AllFalse(d, crossing)) this->cross(crossing, cell, t);
    }
    this->store(result);
  }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
