// SPDX-License-Identifier: Apache-2.0
// The light model of blinn_phong.h for vectors, for files that are compiled once for each target and have included Highway.
#if defined(SG_SHADE_BLINN_PHONG_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_SHADE_BLINN_PHONG_INL_H
#undef SG_SHADE_BLINN_PHONG_INL_H
#else
#define SG_SHADE_BLINN_PHONG_INL_H
#endif
#include "render/shade/blinn_phong.h"
#include "render/shade/exp-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::shading::HWY_NAMESPACE {

/// What a lamp of intensity 1 adds to the sums, and whether it reaches the side that is seen.
template <class F>
struct LampTerms {
  F diffuse, specular;
  hn::Mask<hn::DFromV<F>> reached;
};

/// From n.l and n.h.
template <class F>
HWY_INLINE LampTerms<F> lamp_terms(F n_l, F n_h, const Power& power) {
  const F zero = set(hn::DFromV<F>(), 0);
  const auto reached = n_l > zero;
  return {max(n_l, zero), only(reached, power(n_h)), reached};
}

}  // namespace sg::shading::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
