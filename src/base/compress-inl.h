// SPDX-License-Identifier: Apache-2.0
// Chosen lanes, written one after the other; included once per target, after highway.h.
#include <cstddef>

#if defined(SG_COMPRESS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_COMPRESS_INL_H
#undef SG_COMPRESS_INL_H
#else
#define SG_COMPRESS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace sg::HWY_NAMESPACE {

/// hwy's CompressStore by way of a register: Zen 4 takes a hundred cycles for the instruction that compresses into memory.
/// Writes a whole vector, of which the lanes of the mask come first. Returns how many those are.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE size_t compress_store(D d, V v, hwy::HWY_NAMESPACE::Mask<D> which, hwy::HWY_NAMESPACE::TFromD<D>* to) {
  hwy::HWY_NAMESPACE::StoreU(hwy::HWY_NAMESPACE::Compress(v, which), d, to);
  return hwy::HWY_NAMESPACE::CountTrue(d, which);
}

}  // namespace sg::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
