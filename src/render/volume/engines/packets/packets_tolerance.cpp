// SPDX-License-Identifier: Apache-2.0
// The integral within a tolerance along packets of rays: rays/integrate.cpp for a uniform grid, one ray per vector lane. Every lane has
// its own place: it leaps over what draws nothing, strides where the field is as good as straight, and crosses the other cells one by one.
#include "render/volume/engines/packets/packet_rays.h"

#include <bit>

#include "base/vector_targets.h"

// The build compiles this file once for each type of samples (cmake/packets.cmake).
#ifndef SG_SAMPLES
#define SG_SAMPLES float
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/packets_tolerance.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/packet_cast-inl.h"
#include "render/volume/engines/packets/packet_lit_strides-inl.h"
#include "render/volume/engines/packets/packet_strides-inl.h"
#include "render/volume/engines/packets/packet_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Strides in cell lengths. Two go at once, and Bends look a brick around: those from here on up to half a brick, those around the middle
/// up to a whole one. Where they would have to be shorter than the last, cells are crossed instead.
constexpr float half_brick = 2, longest_stride = 4, shortest_stride = 1.0f / 8;
/// The first. Rays along an axis begin at a face of cells, of the box or of a brick after a leap. The value kinks at faces, and two strides
/// take it for a parabola: with a face in their middle, as of a first stride of 1, its mean is off by a twelfth of the kink, five times
/// what is counted. With strides of 5/4 the faces at 1 and 2 count a thirtieth each, with opposite signs.
constexpr float first_stride = 1.25f;
/// Shares of the tolerance: to start with, over the whole length, and over all light that is taken. The rest is for the end of the ray,
/// the tables, and the cells that are crossed.
constexpr float share_at_first = 0.2f, share_of_length = 0.2f, share_of_light = 0.5f;
/// Below it lit volumes are crossed cell by cell: how light goes along a stride is estimated from three places, to some thousandths.
constexpr double least_lit_tolerance = 1.0 / 1024;
/// What the light between the ends of the first strides of a ray may be off, of which nothing else is known.
constexpr float first_error = 0.005f;
/// Optical depth of two strides from which on their front is looked at, not their middle.
constexpr float deep_pair = 6;
/// Radians by which the gradient may turn over two strides, told by Bends.
constexpr float most_turned = 4;
/// So much of that a gradient leaves its straight line by, near the edge of a surface: there it may turn over and back.
constexpr float share_astray = 1.0f / 16;
/// So much of how scattered light bends over two strides counts as what a parabola gets wrong.
constexpr float share_bent = 1.0f / 4;
/// Of what is left so much may go for one stride.
constexpr float share_at_once = 1.0f / 3;
/// The next stride over this one is so much of what the error would allow, within these bounds. A stride that is refused costs a whole
/// turn, so they grow slowly.
constexpr float safety = 0.55f, least_growth = 0.5f, most_growth = 1.4f, most_growth_in_the_dark = 1.2f;
constexpr float least_if_refused = 0.4f, most_if_refused = 0.7f;

template <class D, class T, bool shaded>
class StridingPacket : CellWalk<D, PacketCells<D, T, shaded, EvenAxes<D>>> {
  using Walk = CellWalk<D, PacketCells<D, T, shaded, EvenAxes<D>>>;
  using typename Walk::Passage, typename Walk::F, typename Walk::I, typename Walk::M;
  using Walk::brick_id, Walk::cell_at, Walk::cross, Walk::leap, Walk::passage, Walk::store;
  using Walk::plan_, Walk::cells_, Walk::end_;

 public:
  HWY_INLINE StridingPacket(const StridingPlan& plan, const RayPacket& rays)
      : Walk(plan, rays), tables_(plan.tables), sums_{tables_ ? &tables_->sums : nullptr, cells_.source.loads} {
    const D d;
    F square = set(d, 0);
    for (int a = 0; a < 3; ++a) square = mul_add(cells_.along[a], cells_.along[a], square);
    speed_ = sqrt(square);
    per_speed_ = 1.0f / max(speed_, 1e-30f);
    reserve_ = set(d, share_at_first * float(plan.budget.tolerance));
    stride_ = set(d, first_stride);
    if (tables_) here_ = sums_.at(set(d, 0));
    lit_ = hn::MaskFromVec(set(d, 0));
    here_lit_ = LitPlace<D>::none();
    strides_ = !shaded || plan.budget.tolerance >= least_lit_tolerance;
    per_scale_ = set(d, plan.volume.shade_plan.per_scale * (2 / most_turned));
  }

  HWY_INLINE void run(PacketResult& result) {
    const D d;
    const IntTag<D> di;
    const F stop = set(d, plan_.budget.stop_below);
    // Cells -1 and n-1 are the halves beyond the outermost samples; where a lane has strode, the nearest cells inside.
    F t = set(d, 0);
    I cell[3];
    for (int a = 0; a < 3; ++a) cell[a] = cell_at(a, t);
    M strode = hn::MaskFromVec(set(d, 0));
    M known = hn::MaskFromVec(set(d, 0));  // the lanes for which here_ is the place t
    const auto on = [&]() HWY_ATTR { return (t < end_) & (cells_.sum.pass >= stop); };
    const auto find_cells = [&](M which) HWY_ATTR {
      const auto unsure = rebind(di, which & strode);
      for (int a = 0; a < 3; ++a) cell[a] = select(unsure, cell_at(a, t), cell[a]);
      strode = strode & !which, known = known & !which, lit_ = lit_ & !which;
      if constexpr (shaded) path_.forget(which);
    };
    Passage here = passage(cell);
    for (M going = on(); any(going); going = on()) {
      turns_ += hn::CountTrue(d, going);
      const M leaping = going & here.empty();
      if (any(leaping)) {
        find_cells(leaping);
        leap(here, leaping, cell, t);
        here = passage(cell);
        going = on(), going = going & !here.empty();
      }
      const M cellwise = !strides_ ? t == t : (stride_ < shortest_stride) | here.bent();
      const M crossing = going & cellwise, striding = going & !cellwise;
      if (any(striding)) {
        const M fresh = striding & !known;
        if (any(fresh)) renew(t, fresh), known = known | fresh;
        // A lane that was refused stays in its cell, which rounding may tell otherwise.
        strode = strode | stride_on(t, cell, here, striding);
      }
      if (any(crossing)) {
        find_cells(crossing);
        cross(crossing, cell, t);
        here = passage(cell);
        stride_ = select(crossing, max(stride_, 2 * shortest_stride), stride_);
      }
    }
    store(result);
  }
  /// How often a lane went on.
  uint64_t turns() const { return turns_; }

 private:
  HWY_INLINE void places_at(F t, Place<D> p[3]) const {
    for (int a = 0; a < 3; ++a) p[a] = cells_.source.place(a, mul_add(cells_.along[a], t, cells_.start[a]));
  }
  HWY_INLINE F value_at(const Place<D> p[3]) const { return cells_.source.value(p[0], p[1], p[2]); }
  HWY_INLINE F value_at(F t) const {
    Place<D> p[3];
    places_at(t, p);
    return value_at(p);
  }

  HWY_INLINE void renew(F t, M which) { take(sums_.at(value_at(t)), which); }
  HWY_INLINE void take(const typename SumLanes<D>::Place& p, M which) {
    const IntTag<D> di;
    here_.value = select(which, p.value, here_.value), here_.sigma_t = select(which, p.sigma_t, here_.sigma_t);
    here_.slope = select(which, p.slope, here_.slope);
    here_.beyond = select(which, p.beyond, here_.beyond), here_.kinks = select(which, p.kinks, here_.kinks);
    const auto whole = rebind(di, which);
    here_.node = select(whole, p.node, here_.node), here_.sum = select(whole, p.sum, here_.sum);
  }

  /// How the field bends along two strides.
  HWY_INLINE I bends_around(const Passage& here, const Place<D> between[3], M longer) const {
    const D d;
    if (none(longer)) return here.code;
    const I id = brick_id(between[0].cell, between[1].cell, between[2].cell);
    const I there = gather_words(d, tables_->passages.bends->codes.data(), id, cells_.source.loads) & 255;
    return select(longer, there, here.code);
  }

  /// Two strides from t on, if their errors are allowed. Returns which lanes have moved, to which cell. How that is passed is looked up
  /// before anything else: the next turn depends on it.
  HWY_INLINE M stride_on(F& t, I cell[3], Passage& here, M striding) {
    const D d;
    const IntTag<D> di;
    const F half = set(d, 0.5f);
    // Lengths: two equal strides; the last pair ends with the ray.
    const F world = min(stride_ * per_speed_, half * (end_ - t));
    const F cells = world * speed_;
    const M ends = end_ - t <= 2.0f * (stride_ * per_speed_);
    const F t1 = t + world, t2 = select(ends, end_, t1 + world);
    // Cells at the end and in the middle, and the bound on the bend of the field between.
    Place<D> there[3];
    places_at(t2, there);
    const I cell2[3] = {there[0].cell, there[1].cell, there[2].cell};
    const Passage next_passage = passage(brick_id(cell2[0], cell2[1], cell2[2]));
    Place<D> between[3];
    places_at(t1, between);
    const M longer_pair = cells > half_brick;
    const I bend_code = bends_around(here, between, longer_pair);
    const F bend = bit_cast(d, shift_left<21>(bend_code) + ((127 + Bends::least) << 23)) * tables_->passages.bends->range;
    // Where most lanes are lit already the slopes are found together with the values.
    const bool lit_ahead = shaded && 2 * hn::CountTrue(d, striding & lit_) > hn::Lanes(d);
    const F value1 = value_at(between);
    Slope<D> slope2;
    if (lit_ahead) slopes_of_most(cells_.source, there, striding, slope2);
    const auto p1 = sums_.at(value1), p2 = sums_.at(lit_ahead ? slope2.value : value_at(there));
    const Strides<D> s = strides<shaded>(sums_, *plan_.medium, float(plan_.budget.tolerance), here_, p1, p2, world, cells, bend);
    // Error estimate, and what is allowed: a share by length, one by light, and of what earlier strides left over.
    const F zero = set(d, 0), one = set(d, 1.0f), tolerance = set(d, float(plan_.budget.tolerance));
    const F pass = cells_.sum.pass, taken = pass * min(one, s.depth);
    const M unbounded = rebind(d, bend_code == int(Bends::unbounded));
    F error = select(unbounded, 1e30f, pass * s.error);
    const F own = tolerance * mul_add(world, float(2 * share_of_length / plan_.budget.length), taken * share_of_light);
    const F allowed = mul_add(reserve_, share_at_once, own);
    const M seen = striding & (error <= allowed) & (s.depth > zero);
    const bool any_seen = any(seen);
    LitPlace<D> lit2;
    StrideLight<D> light;
    [[maybe_unused]] F told = zero;
    // Light at the end, and its error where it is taken as straight between the ends.
    if constexpr (shaded)
      if (any_seen) {
        lit2 = light_ends(t, t2, lit_ahead ? &slope2 : nullptr, seen);
        told = path_.swerve(here_lit_, lit2, t2 - t);
        const F swerve = path_.recent(told), change = bend * cells * per_scale_, aside = share_astray * change;
        light = StrideLight<D>::straight(cells_.lighting, here_lit_, lit2, swerve);
        const auto over = (here_lit_.sides ^ lit2.sides) == cells_.lighting.turned_over();
        const M turned = seen & rebind(d, over);
        if (any(turned)) {
          const F sigma_t[3] = {here_.sigma_t, p1.sigma_t, p2.sigma_t};
          light.take(StrideLight<D>::turned_over(cells_.lighting, here_lit_, lit2, sigma_t, s.depth, swerve), turned);
        }
        // The middle only where the ends do not do.
        const F unknown = select(path_.known(), zero, first_error);
        const M unsure = (mul_add(taken, light.error + unknown, error) > allowed) | grazing(here_lit_.surface, lit2.surface, aside);
        const M rough = seen & unsure & !turned;
        if (any(rough)) {
          // Of a deep pair the front is seen: how light goes on there its middle does not tell.
          const M fronts = rough & (s.depth > deep_pair);
          const F extinctions[3] = {here_.sigma_t, p1.sigma_t, p2.sigma_t};
          const F sight = select(fronts, cells_.way_of_depth(extinctions, one / max(s.depth, one)), half);
          const LitPlace<D> lit1 = lit_at(select(fronts, mul_add(sight, t2 - t, t), t1), rough);
          light.take(StrideLight<D>::curved(cells_.lighting, here_lit_, lit1, lit2, s.depth, aside), rough);
          if (any(fronts)) light.take(StrideLight<D>::front(here_lit_, lit1, lit2, sight, s.depth, aside), fronts);
        }
        // Three places tell little where the gradient may turn right round in between.
        const F gradient = max(here_lit_.surface.weight, lit2.surface.weight);
        const M astray = change > gradient;
        light.error = max(light.error, only(astray, one));
        error = error + only(seen, taken * light.error);
        // What the front of an uneven pair hides of the change of light.
        const F uneven = pass * s.uneven * apart(here_lit_.light, lit2.light);
        error = error + only(seen & !turned, uneven);
      }
    if constexpr (!shaded)
      if (any_seen && cells_.scattered.any()) {
        const F first = cells_.scattered_at(t), middle = cells_.scattered_at(t1), last = cells_.scattered_at(t2);
        light.diffuse = Parabola<D>::through(first, middle, last);
        // Colours are wrong by as much more as they are lit; between its three places the light leaves the parabola by a share of how it
        // bends.
        const F most = max(one, max(first, max(middle, last)));
        const F bent = mul_add(taken, abs(light.diffuse.c) * share_bent, error * most);
        error = select(seen, mul_add(pass * s.uneven, abs(last - first), bent), error);
      }
    // Accepted: both strides as one segment.
    const M good = striding & (error <= allowed);
    reserve_ = select(good, reserve_ + own - error, reserve_);
    if (any_seen) {
      const M drawn = seen & good;
      F lightening = zero;
      if constexpr (shaded) lightening = 2.0f * (abs(light.diffuse.b) + abs(light.specular.b));
      else if (cells_.scattered.any()) lightening = 2.0f * abs(light.diffuse.b);
      cells_.may_hide(s.change, lightening, lightening);
      const F extinctions[3] = {here_.sigma_t, p1.sigma_t, p2.sigma_t};
      cells_.segment(drawn, t, world + world, s.depth, extinctions, here_.value, p2.value, s.value, half * (one + s.middle), nullptr,
                     [&](F at, F share, const auto& spread, F& red, F& green, F& blue) HWY_ATTR {
                       if constexpr (shaded) {
                         const F x = at + at - one, variance = s.variance * spread.narrower;
                         const F factor = light.diffuse.mean(x, variance), flash = light.specular.mean(x, variance) * share;
                         F* colors[3] = {&red, &green, &blue};
                         for (F* c : colors) *c = mul_add(*c, factor, flash);
                         // Colours and light that change together.
                         if (spread.any_change) {
                           const F both = half * variance * light.diffuse.slope(x);
                           for (int c = 0; c < 3; ++c) *colors[c] = mul_add(spread.change[c], both, *colors[c]);
                         }
                       } else if (cells_.scattered.any()) {
                         const F factor = light.diffuse.mean(at + at - one, s.variance);
                         for (F* c : {&red, &green, &blue}) *c = *c * factor;
                       }
                     });
      if constexpr (shaded) path_.go(here_lit_, lit2, t2 - t, told, speed_, drawn), here_lit_.take(lit2, drawn);
    }
    if constexpr (shaded) {
      lit_ = (lit_ & !good) | (seen & good);
      path_.forget(good & !lit_);
    }
    take(p2, good);
    const F next_error = select(good, mul_add(pass, s.ahead, error), error);
    // Length of the next stride: times safety sqrt(allowed / error), within bounds.
    const F product = max(allowed * next_error, 1e-36f);
    const F factor = only(error == error, safety * allowed * about_one_by_sqrt(d, product));
    const F most = select(s.depth > zero, set(d, most_growth), most_growth_in_the_dark);
    const F longer = max(least_growth, min(factor, most));
    const F shorter = max(least_if_refused, min(factor, most_if_refused));
    F next = min(stride_ * select(good, longer, shorter), longest_stride);
    // Cells are crossed where strides of about the shortest were refused.
    next = select(stride_ < 2 * shortest_stride, next, max(next, shortest_stride));
    stride_ = select(striding, next, stride_);
    // On to the end.
    const M moved = good & (t2 > t);
    t = select(moved, t2, t);
    const auto to = rebind(di, moved);
    for (int a = 0; a < 3; ++a) cell[a] = select(to, cell2[a], cell[a]);
    here.code = select(to, next_passage.code, here.code);
    return moved;
  }

  /// The light at places of the rays of `lighting`, where it is wanted. Out of line: it is long, and wanted from several sides.
  HWY_NOINLINE void lit_at(const Lighting<D>& lighting, const F u[3], M wanted, LitPlace<D>& out) const {
    out = LitPlace<D>::at(lighting, slopes_at(cells_.source, plan_.volume.voxels, u, wanted));
  }
  HWY_INLINE LitPlace<D> lit_at(F t, M wanted) const {
    F u[3];
    for (int a = 0; a < 3; ++a) u[a] = mul_add(cells_.along[a], t, cells_.start[a]);
    LitPlace<D> p;
    lit_at(cells_.lighting, u, wanted, p);
    return p;
  }

  /// The light at t2, whose slopes may be known, and at t for those lanes of `seen` that do not know it. Lanes that are not seen help: they
  /// look for others.
  HWY_INLINE LitPlace<D> light_ends(F t, F t2, const Slope<D>* slope2, M seen) {
    const D d;
    const IntTag<D> di;
    const M dark = seen & !lit_;
    lit_ = lit_ | seen;
    const bool any_dark = any(dark);
    if (slope2 || !any_dark || hn::CountTrue(d, dark) + hn::CountTrue(d, seen) > hn::Lanes(d)) {
      if (any_dark) here_lit_.take(lit_at(t, dark), dark);
      return slope2 ? LitPlace<D>::at(cells_.lighting, *slope2) : lit_at(t2, seen);
    }
    alignas(64) int32_t from[most_lanes], to[most_lanes];
    uint8_t bits[2][8] = {};
    hn::StoreMaskBits(d, dark, bits[0]), hn::StoreMaskBits(d, seen, bits[1]);
    uint32_t asking = uint32_t(bits[0][0]) | uint32_t(bits[0][1]) << 8, busy = uint32_t(bits[1][0]) | uint32_t(bits[1][1]) << 8;
    uint32_t wanted = busy;
    hn::Store(hn::Iota(di, 0), di, from), hn::Store(hn::Iota(di, 0), di, to);
    for (uint32_t free = ~busy; asking; asking &= asking - 1, free &= free - 1) {
      const int who = std::countr_zero(asking), helper = std::countr_zero(free);
      from[helper] = who, to[who] = helper, wanted |= 1u << helper;
    }
    const I order = hn::Load(di, from);
    const auto indices = hn::IndicesFromVec(d, order);
    F u[3];
    for (int a = 0; a < 3; ++a) {
      const F first = hn::TableLookupLanes(mul_add(cells_.along[a], t, cells_.start[a]), indices);
      u[a] = select(seen, mul_add(cells_.along[a], t2, cells_.start[a]), first);
    }
    const uint8_t wanted_bits[8] = {uint8_t(wanted), uint8_t(wanted >> 8)};
    LitPlace<D> found;
    lit_at(cells_.lighting.permuted(order), u, hn::LoadMaskBits(d, wanted_bits), found);
    here_lit_.take(found.permuted(hn::Load(di, to)), dark);
    return found;
  }

  const StrideTables* const tables_;
  const SumLanes<D> sums_;
  F speed_, per_speed_;  // speed: in cell lengths per world length
  F stride_, reserve_;
  bool strides_;
  F per_scale_;  // by which gradients are told from how they change over a stride
  typename SumLanes<D>::Place here_;
  LitPlace<D> here_lit_;
  GradientPath<D> path_;
  M lit_;  // the lanes for which it is the place where they are
  uint64_t turns_ = 0;
};

namespace {

void cast_in_packets(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<StridingPacket, hn::CappedTag<float, most_lanes>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void cast_singly(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  cast_as<StridingPacket, hn::CappedTag<float, 1>, SG_SAMPLES>(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(cast_in_packets);

template <class T>
void stride_tile(const StridingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.simd) return HWY_DYNAMIC_DISPATCH(cast_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(cast_singly)(plan, x0, y0, x1, y1, frame);
}
template void stride_tile<SG_SAMPLES>(const StridingPlan&, int, int, int, int, Frame&);

}  // namespace sg::volume
#endif
