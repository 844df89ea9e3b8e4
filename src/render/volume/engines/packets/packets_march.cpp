// SPDX-License-Identifier: Apache-2.0
// Emission and absorption along packets of rays. Every lane has its own place on its own ray: a lane in empty bricks leaps, the
// others do not wait for it. What is to be lit is queued, so that gradients are taken of full vectors only.
#include <array>
#include <memory>

#include "base/vector_targets.h"
#include "render/volume/engines/packets/cache_rows.h"
#include "render/volume/engines/packets/packet_rays.h"

// The build compiles this file once for each type of samples (cmake/packets.cmake).
#ifndef SG_SAMPLES
#define SG_SAMPLES float
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/volume/engines/packets/packets_march.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "render/volume/engines/packets/packet_leaps-inl.h"
#include "render/volume/engines/packets/packet_shading-inl.h"
#include "render/volume/engines/packets/packets-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::volume::HWY_NAMESPACE {

/// Samples between two looks at the bricks.
constexpr int samples_per_look = 4;
/// Samples half an edge apart or more are lit by twos; those of a look together when they take less than the first share of the light,
/// those of several looks when they take less than the second.
constexpr float faint = 1.0f / 32, faintest = 1.0f / 256;
/// Prefetch distance in samples: of the next turn or the one after it.
constexpr float prefetch_distance = 48;

/// Transfer::index, times four: where the entry's numbers begin.
template <class D, class T>
struct Entries {
  Float<D> first, per_axis, count, last;
  Int<D> below_count, above, of_nan;
  bool spanned;         ///< no values are beyond the ends
  Int<D> drawn_eights;  ///< Transfer::drawn_eights

  HWY_INLINE explicit Entries(const Volume& v) : spanned(v.spanned) {
    const D d;
    const IntTag<D> di;
    drawn_eights = hn::LoadU(di, reinterpret_cast<const int32_t*>(v.transfer[0].drawn_eights().data()));
    const LinearTable t = v.transfer[0].linear_table();
    first = set(d, t.first), per_axis = set(d, t.per_axis), count = set(d, float(t.count)), last = set(d, float(t.count - 1));
    below_count = set(di, t.count - 1), above = set(di, t.count + 1), of_nan = set(di, t.count + 2);
  }
  HWY_INLINE Int<D> at(Float<D> value) const {
    const D d;
    const auto zero = set(d, 0);
    const auto place = (value - first) * per_axis;
    if (spanned) {
      auto e = to_int(d, min(max(place, zero), last)) + 1;
      if constexpr (std::is_same_v<T, float>) e = select(is_nan(value), of_nan, e);
      return shift_left<2>(e);
    }
    auto e = min(to_int(d, max(min(place, count), zero)), below_count) + 1;
    e = select(place > count, above, e);
    e = only(place >= zero, e);
    e = select(value == value, e, of_nan);
    return shift_left<2>(e);
  }
  /// False where none of these entries draws anything, as far as can be told at once.
  HWY_INLINE bool may_draw([[maybe_unused]] Int<D> entry, Mask<D> which) const {
    if constexpr (lanes_of<D> == 16) {
      const IntTag<D> di;
      const auto word = shift_right<10>(entry) & 15, bit = shift_right<5>(entry) & 31;
      const auto words = hn::TableLookupLanes(drawn_eights, hn::IndicesFromVec(di, word));
      return any(rebind(di, which) & hn::TestBit(hn::Shr(words, bit), set(di, 1)));
    }
    return any(which);
  }
};

/// What waits for its light: samples that follow each other are lit together, where the middle of what they take lies; but not samples
/// before and after a turn of the value, where surfaces begin to show their other side.
template <class D>
struct Due {
  static constexpr int parts = 7;
  Float<D> r, g, b, taken, moment, value, rise;
  HWY_INLINE Due() { r = g = b = taken = moment = value = rise = set(D(), 0); }
  HWY_INLINE Mask<D> turns(Float<D> next) {
    const auto after = next - value;
    const auto turned = (after * rise < 0) & (taken > 0);
    value = next, rise = after;
    return turned;
  }
  HWY_INLINE void drop(Mask<D> which) {
    for (Float<D>* v : {&r, &g, &b, &taken, &moment}) *v = only(!which, *v);
  }
  HWY_INLINE void load(const float from[parts][most_lanes]) {
    size_t i = 0;
    for (Float<D>* v : {&r, &g, &b, &taken, &moment, &value, &rise}) *v = hn::Load(D(), from[i++]);
  }
  HWY_INLINE void store(float to[parts][most_lanes]) const {
    size_t i = 0;
    for (const Float<D>* v : {&r, &g, &b, &taken, &moment, &value, &rise}) hn::Store(*v, D(), to[i++]);
  }
};

/// A packet on its way. The packets of a tile take turns, so that the voxels between two depths are met by all of them while they
/// are near in the cache.
template <class D, class T, bool shaded>
class March {
  using F = Float<D>;

  /// The samples between two looks at the bricks: the cells they lie in.
  struct Look {
    alignas(64) int32_t corner[samples_per_look][most_lanes];
    alignas(64) float fraction[samples_per_look][3][most_lanes];

    /// The field at all of them, for as many lanes at a time as the tag of `source` has.
    template <class Part>
    HWY_INLINE void values(const Source<Part, T>& source, float to[samples_per_look][most_lanes]) const {
      const Part part;
      for (int n = 0; n < lanes_of<D>; n += lanes_of<Part>)
        for (int k = 0; k < samples_per_look; ++k)
          hn::Store(source.value(corner[k] + n, hn::Load(part, fraction[k][0] + n), hn::Load(part, fraction[k][1] + n),
                                 hn::Load(part, fraction[k][2] + n)),
                    part, to[k] + n);
    }
  };

 public:
  RayPacket rays;
  PacketResult result;

  HWY_INLINE void start(const MarchingPlan& plan) {
    const D d;
    // Places go one way, so all lie inside when the first and the last do. Rays without whole steps stand in the first sample.
    const F steps = hn::Load(d, rays.steps), zero = set(d, 0);
    const auto none = steps == zero;
    inside_ = true;
    for (size_t a = 0; a < 3; ++a) {
      const F first = only(!none, hn::Load(d, rays.first[a])), by = hn::Load(d, rays.by[a]);
      const F last = mul_add(steps - 1.0f, by, first);
      const F top = set(d, float(plan.volume.voxels.dims[a] - 1));
      const auto good = (first >= zero) & (first < top) & ((last >= zero) & (last < top));
      inside_ = inside_ && all(good | none);
      hn::Store(first, d, rays.first[a]);
    }
    for (int a = 0; a < 3; ++a) hn::Store(1.0f / hn::Load(d, rays.by[a]), d, per_by_[a]);
    // Nothing is gathered yet.
    hn::Store(hn::Load(d, rays.before), d, result.transmittance), hn::Store(set(d, -1.0f), d, seen_half_);
    hn::Store(set(d, 0), d, result.r), hn::Store(set(d, 0), d, result.g), hn::Store(set(d, 0), d, result.b);
    if constexpr (shaded) queue_.start(plan, rays), Due<D>().store(due_);
    // Over what is empty where the rays enter.
    Lanes<D> lanes(rays, per_by_, set(d, 0));
    const Source<D, T> source(plan.volume.voxels);
    const Space<D> space(plan);
    if (skips(plan)) {
      Nearby<D> nearby;
      nearby.find(source, space, lanes);
      leap(space, nearby, lanes, lanes.s < lanes.end);
    }
    hn::Store(lanes.s, d, next_);
    constexpr int lanes_here = lanes_of<D>;
    crowded_ = std::is_same_v<T, float> && lanes_here > 4 && source.loads && crowded(plan.volume.voxels, rays, packet_width<D>, lanes_here);
  }

  /// Goes on until no ray has samples before `until`; false when all are through.
  HWY_INLINE bool go(const MarchingPlan& plan, float until) {
    const D d;
    const Volume& v = plan.volume;
    const Source<D, T> source(v.voxels);
    const Source<hn::CappedTag<float, 4>, T> by_fours(v.voxels);
    const Space<D> space(plan);
    const Transfer& transfer = v.transfer[0];
    const Entries<D, T> entries(v);
    const auto* steps = reinterpret_cast<const float*>(transfer.steps());
    const bool skip = skips(plan);
    // Who asks for shorter steps wants to see each of them lit.
    [[maybe_unused]] const bool together = v.step > 0.4 * v.edge;
    const F stop = set(d, plan.stop_below), one = set(d, 1.0f), half = set(d, 0.5f);

    Lanes<D> lanes(rays, per_by_, hn::Load(d, next_));
    F r = hn::Load(d, result.r), g = hn::Load(d, result.g), b = hn::Load(d, result.b);
    F pass = hn::Load(d, result.transmittance), seen_half = hn::Load(d, seen_half_);
    const F horizon = min(until, lanes.end);
    // Values wait for nothing but their samples: the places are known already. The bricks of the next samples are asked for before them,
    // and leaps do not wait for the light that these samples take.
    F first = lanes.s;
    Look look;
    look_ahead(source, lanes, look);
    [[maybe_unused]] Due<D> due;
    if constexpr (shaded) due.load(due_);
    while (true) {
      const auto bright = pass >= stop;
      if (none((first < horizon) & bright)) break;
      // Values of this look, then what is empty beyond it and the cells of the next.
      lanes.s = first + float(samples_per_look);
      Nearby<D> nearby;
      if (skip) nearby.find(source, space, lanes);
      alignas(64) float values[samples_per_look][most_lanes];
      if (crowded_) look.values(by_fours, values);
      else look.values(source, values);
      if (skip) leap(space, nearby, lanes, (lanes.s < lanes.end) & bright);
      look_ahead(source, lanes, look);
      // Compositing, front to back.
      for (int k = 0; k < samples_per_look; ++k) {
        const F s = first + float(k), value = hn::Load(d, values[k]);
        const auto entry = entries.at(value);
        const auto active = (s < lanes.end) & (pass >= stop);
        if constexpr (shaded) {
          const auto turned = due.turns(value);
          if (any(turned)) push(plan, due, turned);
        }
        if (entries.may_draw(entry, active)) {
          const auto [r_g, b_pass] = gather_quad(d, steps, entry, source.loads);
          seen_half = select(active & (pass >= half), s, seen_half);
          const F weight = only(active, pass);
          const F wr = weight * r_g.a, wg = weight * r_g.b, wb = weight * b_pass.a;
          if constexpr (shaded) {
            const F taken = weight * (one - b_pass.b);
            due.r = due.r + wr, due.g = due.g + wg, due.b = due.b + wb;
            due.taken = due.taken + taken, due.moment = mul_add(taken, s, due.moment);
          } else {
            r = r + wr, g = g + wg, b = b + wb;
          }
          pass = select(active, pass * b_pass.b, pass);
        }
        // Light for what has gathered.
        if constexpr (shaded) {
          if (k % 2 == 1 || !together) {
            const float enough = !together ? 0 : k + 1 < samples_per_look ? faint : faintest;
            const auto ready = due.taken > enough;
            if (any(ready)) push(plan, due, ready);
          }
        }
      }
      first = lanes.s;
    }
    hn::Store(first, d, next_);
    if constexpr (shaded) due.store(due_);
    else hn::Store(r, d, result.r), hn::Store(g, d, result.g), hn::Store(b, d, result.b);
    hn::Store(pass, d, result.transmittance), hn::Store(seen_half, d, seen_half_);
    return any((first < lanes.end) & (pass >= stop));
  }

  /// The last step has what length is left.
  HWY_INLINE void finish(const MarchingPlan& plan) {
    const D d;
    const Volume& v = plan.volume;
    const Source<D, T> source(v.voxels);
    const Transfer& transfer = v.transfer[0];
    const Entries<D, T> entries(v);
    F pass = hn::Load(d, result.transmittance);
    alignas(64) float before[most_lanes];
    hn::Store(pass, d, before);
    const F rest = hn::Load(d, rays.rest);
    const auto last = (rest > 0) & (pass >= plan.stop_below);
    if (any(last)) {
      const F x = hn::Load(d, rays.last[0]), y = hn::Load(d, rays.last[1]), z = hn::Load(d, rays.last[2]);
      const F value = source.value(source.place(0, x), source.place(1, y), source.place(2, z));
      const auto entry = entries.at(value);
      const auto* media = reinterpret_cast<const float*>(&transfer.medium(0));
      const auto [r_g, b_density] = gather_quad(d, media, entry, source.loads);
      const auto drawn = last & (b_density.b > 0);
      if (any(drawn)) {
        const F alpha = shading::HWY_NAMESPACE::absorbed(b_density.b * rest);
        const F weight = only(drawn, pass * alpha);
        const F wr = weight * r_g.a, wg = weight * r_g.b, wb = weight * b_density.a;
        if constexpr (shaded) {
          queue_.push(plan, rays, result, drawn, set(d, -1.0f), wr, wg, wb, weight);
        } else {
          hn::Store(hn::Load(d, result.r) + wr, d, result.r), hn::Store(hn::Load(d, result.g) + wg, d, result.g);
          hn::Store(hn::Load(d, result.b) + wb, d, result.b);
        }
        pass = select(drawn, pass * (1.0f - alpha), pass);
        hn::Store(pass, d, result.transmittance);
      }
    }
    // What still waits for its light.
    if constexpr (shaded) {
      Due<D> due;
      due.load(due_);
      const auto waiting = due.taken > 0;
      if (any(waiting)) push(plan, due, waiting);
      queue_.finish(plan, rays, result);
    }
    // Where half of the light was gone.
    for (size_t n = 0; n < hn::Lanes(d); ++n) {
      result.surface[n] = -1;
      if (before[n] < 0.5f) result.surface[n] = rays.enter[n] + (double(seen_half_[n]) + 0.5) * v.step;
      else if (result.transmittance[n] < 0.5f) result.surface[n] = rays.leave[n] - 0.5 * double(rays.rest[n]);
    }
  }

 private:
  static bool skips(const MarchingPlan& plan) { return plan.skip_empty && plan.volume.any_empty; }

  HWY_INLINE void push(const MarchingPlan& plan, Due<D>& due, Mask<D> which) {
    queue_.push(plan, rays, result, which, due.moment / due.taken, due.r, due.g, due.b, due.taken);
    due.drop(which);
  }

  /// Notes where the lanes' next samples are, and asks for later ones.
  HWY_INLINE void look_ahead(const Source<D, T>& source, const Lanes<D>& lanes, Look& look) const {
    const D d;
    const IntTag<D> di;
    const F final_sample = max(0, lanes.end - 1.0f);
    for (int k = 0; k < samples_per_look; ++k) {
      const F s = min(lanes.s + float(k), final_sample);
      Place<D> at[3];
      for (int a = 0; a < 3; ++a) at[a] = inside_ ? source.inner_place(lanes.u(a, s)) : source.place(a, lanes.u(a, s));
      hn::Store(source.offset(at[0].cell, at[1].cell, at[2].cell), di, look.corner[k]);
      for (int a = 0; a < 3; ++a) hn::Store(at[a].fraction, d, look.fraction[k][a]);
    }
    if (lanes_of<D> >= 8 && inside_) {
      alignas(64) int32_t corner[most_lanes];
      const F s = min(lanes.s + prefetch_distance, final_sample);
      hn::Store(source.offset(to_int(d, lanes.u(0, s)), to_int(d, lanes.u(1, s)), to_int(d, lanes.u(2, s))), di, corner);
      for (int n = 0; n < lanes_of<D>; ++n) __builtin_prefetch(source.data + corner[n], 0, 3);
    }
  }

  alignas(64) float per_by_[3][most_lanes], seen_half_[most_lanes];
  alignas(64) float next_[most_lanes];  ///< the number of the next sample
  alignas(64) float due_[shaded ? Due<D>::parts : 1][most_lanes];
  bool crowded_;  ///< are samples fetched for four rays at a time?
  bool inside_;   ///< are all samples of whole steps in cells, none beyond the outermost samples?
  struct None {};
  std::conditional_t<shaded, ShadeQueue<D, T>, None> queue_;
};

constexpr int group = 16;               ///< pixels across of the packets that take turns
constexpr float samples_per_turn = 96;  ///< fewer are better where nothing is empty, more where rays leap

template <class D, class T, bool shaded>
HWY_NOINLINE void march_all(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  using Packet = March<D, T, shaded>;
  constexpr int lanes = lanes_of<D>, width = packet_width<D>, height = lanes / width;
  constexpr size_t most = size_t(group / width) * size_t(group / height);
  const auto packets = std::make_unique_for_overwrite<Packet[]>(most);
  std::array<Packet*, most> turn;
  for (int top = y0; top < y1; top += group)
    for (int left = x0; left < x1; left += group) {
      size_t count = 0;
      for (int y = top; y < std::min(top + group, y1); y += height)
        for (int x = left; x < std::min(left + group, x1); x += width)
          if (set_up<D>(plan, x, y, x1, y1, frame, packets[count].rays)) packets[count].start(plan), turn[count] = &packets[count], ++count;
      size_t going = count;
      for (float until = samples_per_turn; going > 0; until += samples_per_turn) {
        size_t on = 0;
        for (size_t i = 0; i < going; ++i)
          if (turn[i]->go(plan, until)) turn[on++] = turn[i];
        going = on;
      }
      for (size_t i = 0; i < count; ++i) {
        packets[i].finish(plan);
        put(plan.volume, plan.part, packets[i].rays, packets[i].result, lanes, frame);
      }
    }
}

namespace {

void march_in_packets(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  (plan.volume.shaded ? march_all<hn::CappedTag<float, most_lanes>, SG_SAMPLES, true>
                      : march_all<hn::CappedTag<float, most_lanes>, SG_SAMPLES, false>)(plan, x0, y0, x1, y1, frame);
}

#if HWY_ONCE
void march_singly(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  (plan.volume.shaded ? march_all<hn::CappedTag<float, 1>, SG_SAMPLES, true>
                      : march_all<hn::CappedTag<float, 1>, SG_SAMPLES, false>)(plan, x0, y0, x1, y1, frame);
}
#endif

}  // namespace

}  // namespace sg::volume::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sg::volume {

HWY_EXPORT(march_in_packets);

template <class T>
void march_tile(const MarchingPlan& plan, int x0, int y0, int x1, int y1, Frame& frame) {
  if (plan.simd) return HWY_DYNAMIC_DISPATCH(march_in_packets)(plan, x0, y0, x1, y1, frame);
  return HWY_STATIC_DISPATCH(march_singly)(plan, x0, y0, x1, y1, frame);
}
template void march_tile<SG_SAMPLES>(const MarchingPlan&, int, int, int, int, Frame&);

}  // namespace sg::volume
#endif
