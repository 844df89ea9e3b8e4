// SPDX-License-Identifier: Apache-2.0
// The way of a ray, or of a packet of rays, through a wide tree. For files that are compiled once for each target and have included
// Highway. Which boxes are met, and in which order, is the same for every width of vectors.
#if defined(SG_TRACE_WIDE_BVH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_TRACE_WIDE_BVH_INL
#undef SG_TRACE_WIDE_BVH_INL
#else
#define SG_TRACE_WIDE_BVH_INL
#endif
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <utility>

#include "base/simd/vector-inl.h"
#include "render/trace/tree/wide_bvh.h"

HWY_BEFORE_NAMESPACE();
namespace sg::trace::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
using namespace simd::HWY_NAMESPACE;

using D8 = hn::CappedTag<float, wide>;
using F8 = hn::Vec<D8>;
constexpr int lanes8 = int(hn::MaxLanes(D8()));

/// One bit a lane.
template <class M>
HWY_INLINE uint32_t bits_of(D8 d, M m) {
  uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, plain(m), bytes);
  return bytes[0] & ((1u << lanes8) - 1);
}

HWY_INLINE void prefetch_lines(const void* p, int lines) {
  for (int i = 0; i < lines; ++i) __builtin_prefetch(static_cast<const char*>(p) + 64 * i);
}

/// Where children lie in memory: nodes, and what is looked at of a leaf. One way for both, as a branch would often be foretold wrong.
class Children {
 public:
  template <class Leaf>
  HWY_INLINE Children(const WideNode* nodes, const Leaf* leaves)
      : from_{reinterpret_cast<const char*>(nodes), reinterpret_cast<const char*>(leaves)}, bytes_{sizeof(WideNode), sizeof(Leaf)} {}
  HWY_INLINE void prefetch(uint32_t child) const {
    const size_t kind = child >> 31;
    prefetch_lines(from_[kind] + bytes_[kind] * (child & ~leaf_bit), 5);
  }

 private:
  const char* from_[2];
  size_t bytes_[2];
};

/// The boxes of a node against rays that start and point within some bounds (BoxRay; of one ray the bounds are one number): one bit for
/// each that some ray may meet by t_max, and where, at the least.
template <bool many>
struct NodeRay {
  float near_origin[3], far_origin[3], near_inverse[3], far_inverse[3];
  size_t near_side[3], far_side[3];  // where they stand in a node

  HWY_INLINE explicit NodeRay(const BoxRay& r) {
    for (int a = 0; a < 3; ++a) {
      near_origin[a] = far_origin[a] = r.origin[a];
      near_inverse[a] = r.near_inverse[a], far_inverse[a] = r.far_inverse[a];
      near_side[a] = size_t(2 * a + r.backwards[a]) * wide, far_side[a] = size_t(2 * a + !r.backwards[a]) * wide;
    }
  }
  /// Takes in another one of the same signs: a box that it meets is met.
  HWY_INLINE void widen(const BoxRay& r) {
    for (int a = 0; a < 3; ++a) {
      auto smaller = [](float& to, float v) { to = v < to ? v : to; };
      auto larger = [](float& to, float v) { to = v > to ? v : to; };
      if (r.backwards[a]) {
        smaller(near_origin[a], r.origin[a]), larger(far_origin[a], r.origin[a]);
        larger(near_inverse[a], r.near_inverse[a]), smaller(far_inverse[a], r.far_inverse[a]);
      } else {
        larger(near_origin[a], r.origin[a]), smaller(far_origin[a], r.origin[a]);
        smaller(near_inverse[a], r.near_inverse[a]), larger(far_inverse[a], r.far_inverse[a]);
      }
    }
  }
  HWY_INLINE uint32_t meet(const WideNode& n, float t_max, float* near_out) const {
    const D8 d;
    uint32_t bits = 0;
    for (int i = 0; i < wide; i += lanes8) {
      F8 near = set(d, 0), far = set(d, t_max);
      for (int a = 0; a < 3; ++a) {
        near = max((hn::Load(d, &n.side[0][0] + near_side[a] + i) - near_origin[a]) * near_inverse[a], near);
        // Of one ray both origins are the same number, which then needs one register.
        far = min((hn::Load(d, &n.side[0][0] + far_side[a] + i) - (many ? far_origin : near_origin)[a]) * far_inverse[a], far);
      }
      hn::Store(near, d, near_out + i);
      bits |= bits_of(d, near <= far) << i;
    }
    return bits;
  }
  HWY_INLINE uint32_t meet(const WideNode& n, float t_max) const {
    HWY_ALIGN float near[wide];
    return meet(n, t_max, near);
  }
};

/// How far a ray has come, near ones first: where it is, and what waits, the nearest last.
class Way {
 public:
  HWY_INLINE bool at_leaf() const { return at_ & leaf_bit; }
  HWY_INLINE uint32_t leaf() const { return at_ & ~leaf_bit; }
  /// On to the nearest child of the node that may be met by t_max, the others wait; false where there is none.
  template <class Bounds>
  HWY_INLINE bool enter(const WideNode* nodes, const Bounds& ray, float t_max, const Children& children) {
    const WideNode& n = nodes[at_];
    HWY_ALIGN float near[wide];
    uint32_t bits = ray.meet(n, t_max, near);
    if (bits == 0) return false;
    const auto entry = [&] {
      const int i = std::countr_zero(bits);
      bits &= bits - 1;
      children.prefetch(n.child[i]);
      return uint64_t(std::bit_cast<uint32_t>(near[i])) << 32 | n.child[i];
    };
    uint64_t nearest = entry();
    for (const size_t base = top_; bits; ++top_) {
      const uint64_t e = entry(), farther = std::max(e, nearest);
      nearest = std::min(e, nearest);
      size_t k = top_;
      for (; k > base && waiting_[k - 1] < farther; --k) waiting_[k] = waiting_[k - 1];
      waiting_[k] = farther;
    }
    at_ = uint32_t(nearest);
    return true;
  }
  /// On to what waits; false where nothing may be met by t_max any more.
  HWY_INLINE bool next(float t_max) {
    do {
      if (top_ == 0) return false;
      --top_;
    } while (std::bit_cast<float>(uint32_t(waiting_[top_] >> 32)) > t_max);
    at_ = uint32_t(waiting_[top_]);
    return true;
  }

 private:
  uint32_t at_ = 0;
  size_t top_ = 0;
  // Where the box is entered in the upper half: t >= 0, whose bits are ordered like the numbers.
  uint64_t waiting_[WideBvh::stack_size];
};

/// Calls leaf(number), near ones first, for each leaf that may be met by t_max (read again after each call); it returns true to stop.
template <class Bounds, class Leaf>
HWY_INLINE void walk(const WideNode* nodes, const Bounds& ray, const float& t_max, const Children& children, Leaf&& leaf) {
  for (Way way;;) {
    if (!way.at_leaf()) {
      if (way.enter(nodes, ray, t_max, children)) continue;
    } else if (leaf(way.leaf())) {
      return;
    }
    if (!way.next(t_max)) return;
  }
}

/// The same in any order, for a limit that stays.
template <class Bounds, class Leaf>
HWY_INLINE void walk_any(const WideNode* nodes, const Bounds& ray, float t_max, const Children& children, Leaf&& leaf) {
  uint32_t stack[WideBvh::stack_size];
  size_t top = 0;
  for (uint32_t at = 0;;) {
    if (at & leaf_bit) {
      if (leaf(at & ~leaf_bit)) return;
    } else {
      const WideNode& n = nodes[at];
      for (uint32_t bits = ray.meet(n, t_max); bits; bits &= bits - 1) {
        const uint32_t child = n.child[std::countr_zero(bits)];
        children.prefetch(child);
        stack[top++] = child;
      }
    }
    if (top == 0) return;
    at = stack[--top];
  }
}

/// Which boxes of a node each of 64 rays meets, and which rays meet each box.
class RayBoxes {
 public:
  HWY_INLINE void clear() {
    for (int i = 0; i < 64; i += lanes) hn::Store(set(D(), 0), D(), boxes_ + i);
  }
  HWY_INLINE void put(int ray, uint32_t boxes) { boxes_[ray] = uint8_t(boxes); }
  HWY_INLINE uint64_t rays(int box) const {
    const auto bit = set(D(), uint8_t(1 << box));
    uint64_t rays = 0;
    for (int i = 0; i < 64; i += lanes) {
      uint8_t bits[8] = {};
      hn::StoreMaskBits(D(), hn::TestBit(hn::Load(D(), boxes_ + i), bit), bits);
      uint64_t word;
      std::memcpy(&word, bits, 8);
      rays |= word << i;
    }
    return rays;
  }

 private:
  using D = hn::CappedTag<uint8_t, 64>;
  static constexpr int lanes = int(hn::MaxLanes(D()));
  HWY_ALIGN uint8_t boxes_[64];
};

/// Up to 64 rays, bit i of `going` for each: meet(node, i) tells which boxes ray i meets, leaf(number, rays) which rays have been stopped
/// so far, of all. Leaves wait until there are some, so that they have come from memory when they are looked at.
template <class Meet, class Leaf>
HWY_INLINE void walk_together(const WideNode* nodes, uint64_t going, const Children& children, Meet&& meet, Leaf&& leaf) {
  struct Visit {
    uint64_t rays;
    uint32_t at;
  };
  constexpr int enough = 16;
  Visit stack[WideBvh::stack_size], waiting[enough + wide];
  size_t top = 0;
  int leaves = 0;
  RayBoxes met;
  for (Visit v{going, 0};;) {
    const WideNode& n = nodes[v.at];
    const auto put = [&](int box, uint64_t rays) {
      const uint32_t child = n.child[box];
      if (child & leaf_bit) {
        waiting[leaves++] = {rays, child & ~leaf_bit};
      } else {
        stack[top++] = {rays, child};
      }
      children.prefetch(child);
    };
    if (std::has_single_bit(v.rays)) {
      for (uint32_t bits = meet(n, std::countr_zero(v.rays)); bits; bits &= bits - 1) put(std::countr_zero(bits), v.rays);
    } else {
      met.clear();
      uint32_t by_any = 0;
      for (uint64_t rays = v.rays; rays; rays &= rays - 1) {
        const int i = std::countr_zero(rays);
        const uint32_t boxes = meet(n, i);
        by_any |= boxes, met.put(i, boxes);
      }
      for (; by_any; by_any &= by_any - 1) put(std::countr_zero(by_any), met.rays(std::countr_zero(by_any)));
    }
    for (;;) {
      if (leaves >= enough || top == 0) {
        for (int k = 0; k < leaves; ++k)
          if (const uint64_t here = waiting[k].rays & going) going &= ~leaf(waiting[k].at, here);
        leaves = 0;
      }
      if (top == 0) return;
      v = stack[--top];
      v.rays &= going;
      if (v.rays != 0) break;
    }
  }
}

}  // namespace sg::trace::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
