// SPDX-License-Identifier: Apache-2.0
// A packet on its way from cell to cell: every lane has its own place on its own ray, leaps over what draws nothing and crosses the rest.
#if defined(SG_PACKET_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_PACKET_WALK_INL_H
#undef SG_PACKET_WALK_INL_H
#else
#define SG_PACKET_WALK_INL_H
#endif

#include "render/volume/engines/packets/packet_cells-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Cells are told by their lowest samples; -1 and last + 1 are the halves beyond the outermost samples.
template <class D, class Cells>
class CellWalk {
 protected:
  using F = Float<D>;
  using I = Int<D>;
  using M = Mask<D>;

  template <class Plan>
  HWY_INLINE CellWalk(const Plan& plan, const RayPacket& rays)
      : plan_(plan), v_(plan.volume), cells_(plan, rays), bricks_(brick_bytes(plan)), rays_(rays) {
    const D d;
    for (int a = 0; a < 3; ++a) {
      still_[a] = cells_.along[a] == 0, up_[a] = cells_.along[a] > 0;
      per_along_[a] = only(!still_[a], 1.0f / cells_.along[a]);
    }
    octant_ = set(IntTag<D>(), 0);
    if (bricks_.up)
      for (size_t a = 0; a < 3; ++a) octant_ = octant_ + only(up_[a], set(IntTag<D>(), (*bricks_.up)[a]));
    end_ = hn::Load(d, rays.length), cells_.sum.pass = hn::Load(d, rays.before);
  }

  /// How the bricks that the lanes are in are passed, a code of Passages each.
  struct Passage {
    I code;
    HWY_INLINE M empty() const { return rebind(D(), code < int(Passages::drawn)); }
    HWY_INLINE M bent() const { return rebind(D(), code == int(Bends::unbounded)); }
  };
  HWY_INLINE I brick_of(int a, I cell) const { return shift_right<FineBricks::shift>(within(a, cell)); }
  /// Of cells of the lattice.
  HWY_INLINE I brick_id(I x, I y, I z) const {
    const IntTag<D> di;
    const auto& dims = v_.fine().dims;
    const I row = set(di, int(dims[0])), layer = set(di, int(dims[0] * dims[1]));
    constexpr int shift = FineBricks::shift;
    return shift_right<shift>(x) + (shift_right<shift>(y) * row + shift_right<shift>(z) * layer);
  }
  HWY_INLINE Passage passage(const I cell[3]) const {
    return passage(brick_id(within(0, cell[0]), within(1, cell[1]), within(2, cell[2])));
  }
  HWY_INLINE Passage passage(I id) const {
    const D d;
    const IntTag<D> di;
    const I byte = set(di, 255), unbounded = set(di, int(Bends::unbounded));
    if (!bricks_.bytes) return {unbounded};
    const I found = gather_words(d, bricks_.bytes, id + octant_, cells_.source.loads) & byte;
    if (bricks_.codes) return {found};
    return {select(found > 0, found, unbounded)};
  }

  HWY_INLINE I cell_at(int a, F t) const { return cells_.axes.cell_at(a, mul_add(cells_.along[a], t, cells_.start[a])); }

  /// Empty-space leaping: takes lanes out of the cube of bricks around them that draw nothing. They arrive in the cell beyond the side
  /// through which they leave, told by the side itself, not by rounding.
  HWY_INLINE void leap(const Passage& from, M leaping, I cell[3], F& t) const {
    const IntTag<D> di;
    const I one = set(di, 1), zero = set(di, 0);
    const I* last_cell = cells_.source.last_cell;
    // The sides ahead, and the first of them that the ray meets.
    F leave = end_, at[3];
    I side[3];
    hn::Mask<IntTag<D>> open[3];
    for (int a = 0; a < 3; ++a) {
      const I reach = select(up_[a], from.code, one - from.code);
      side[a] = shift_left<FineBricks::shift>(brick_of(a, cell[a]) + reach);
      // Beyond the outermost bricks there is nothing else.
      open[a] = rebind(di, still_[a]) | ((side[a] < one) | (side[a] > last_cell[a]));
      at[a] = select(open[a], HUGE_VALF, when_at(a, side[a], t));
      leave = min(leave, at[a]);
    }
    // The cells there: exact along the axis that is crossed, by the place along the others.
    const auto moving = rebind(di, leaping);
    for (int a = 0; a < 3; ++a) {
      const auto up = rebind(di, up_[a]), still = rebind(di, still_[a]);
      const auto through = rebind(di, at[a] <= leave);
      const I beyond = side[a] - select(up, zero, one);
      // Inside the cube along the other axes, and never back.
      const I here = cell_at(a, leave);
      const I forth = select(up, max(cell[a], min(here, beyond - one)), min(cell[a], max(here, beyond + one)));
      const I within = select(open[a], select(still, cell[a], here), forth);
      cell[a] = select(moving, select(through, beyond, within), cell[a]);
    }
    t = select(leaping, leave, t);
  }

  /// Takes lanes through their cells and on to the next ones (3D DDA, Amanatides and Woo).
  HWY_INLINE void cross(M crossing, I cell[3], F& t) {
    const IntTag<D> di;
    const I one = set(di, 1), zero = set(di, 0);
    // Where the ray leaves: the nearest of the sides ahead.
    F leave = end_, at[3];
    I inside[3], beyond[3];
    for (int a = 0; a < 3; ++a) {
      const auto up = rebind(di, up_[a]);
      inside[a] = min(max(cell[a], zero), cells_.source.last_cell[a]);
      beyond[a] = cell[a] + select(up, one, -one);
      at[a] = select(still_[a], HUGE_VALF, when_at(a, max(cell[a], beyond[a]), t));
      leave = min(leave, at[a]);
    }
    // Integrate, then step along the axes that are crossed there.
    const M look = crossing & (leave > t);
    if (any(look)) cells_.cross(inside, t, leave, look);
    for (int a = 0; a < 3; ++a) cell[a] = select(crossing & (at[a] <= leave), beyond[a], cell[a]);
    t = select(crossing, leave, t);
  }

  HWY_INLINE void store(PacketResult& result) const {
    const D d;
    const Gathering<D>& sum = cells_.sum;
    alignas(64) float half_at[most_lanes];
    hn::Store(sum.r, d, result.r), hn::Store(sum.g, d, result.g), hn::Store(sum.b, d, result.b);
    hn::Store(sum.pass, d, result.transmittance), hn::Store(sum.half_at, d, half_at);
    for (size_t n = 0; n < hn::Lanes(d); ++n) result.surface[n] = half_at[n] >= 0 ? rays_.enter[n] + double(half_at[n]) : -1;
  }

  const IntegralPlan& plan_;
  const Volume& v_;
  Cells cells_;
  const BrickBytes bricks_;
  F end_;
  M still_[3], up_[3];
  I octant_;  // where the codes of the octants that rays go to begin

 private:
  HWY_INLINE I within(int a, I cell) const { return min(max(cell, 0), cells_.source.last_cell[a]); }
  /// When, from t on, a ray meets that side.
  HWY_INLINE F when_at(int a, I side, F t) const { return max((cells_.axes.sample(a, side) - cells_.start[a]) * per_along_[a], t); }

  const RayPacket& rays_;
  F per_along_[3];
};

/// Crosses all cells that draw something, none in strides.
template <class D, class Cells>
class CellByCell : CellWalk<D, Cells> {
  using Walk = CellWalk<D, Cells>;
  using typename Walk::F, typename Walk::I, typename Walk::M;

 public:
  template <class Plan>
  HWY_INLINE CellByCell(const Plan& plan, const RayPacket& rays) : Walk(plan, rays) {}

  HWY_INLINE void run(PacketResult& result) {
    const D d;
    const F stop = set(d, this->plan_.budget.stop_below);
    F t = set(d, 0);
    I cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = this->cell_at(a, t);
    while (true) {
      const M going = (t < this->end_) & (this->cells_.sum.pass >= stop);
      if (none(going)) break;
      const auto here = this->passage(cell);
      const M leaping = going & here.empty(), crossing = going & !leaping;
      if (any(leaping)) this->leap(here, leaping, cell, t);
      if (any(crossing)) this->cross(crossing, cell, t);
    }
    this->store(result);
  }
};

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
