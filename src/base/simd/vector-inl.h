// SPDX-License-Identifier: Apache-2.0
// The language in which kernels are written: Highway's vectors with operators and short names, and plain numbers where one is meant for
// every lane. Each name is one operation of Highway, so that a formula shows which IEEE operations are done and in which order; nothing is
// fused except mul_add and its relatives. Loads, stores, gathers and rare operations keep their Highway names. For files that are compiled
// once for each target and have included Highway; a kernel's namespace says `using namespace simd::HWY_NAMESPACE;`.
#if defined(SG_BASE_VECTOR_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SG_BASE_VECTOR_INL_H
#undef SG_BASE_VECTOR_INL_H
#else
#define SG_BASE_VECTOR_INL_H
#endif

#include <type_traits>
#include <utility>

#include "base/simd/arithmetic-inl.h"

HWY_BEFORE_NAMESPACE();
namespace sg::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// One lane each for a tag D of floats or doubles, and its masks.
template <class D>
using Float = hn::Vec<D>;
template <class D>
using Int = hn::Vec<hn::RebindToSigned<D>>;
template <class D>
using Mask = hn::Mask<D>;

/// The tag of a mask; Highway currently provides it only for vectors.
template <class M>
struct TagOfMask;
#if HWY_TARGET == HWY_SCALAR
template <class T>
struct TagOfMask<hn::Mask1<T>> {
  using Tag = hn::Simd<T, 1, 0>;
};
#else
template <class T, size_t N>
struct TagOfMask<hn::Mask128<T, N>> {
  using Tag = hn::Simd<T, N, 0>;
};
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
template <class T>
struct TagOfMask<hn::Mask256<T>> {
  using Tag = hn::Full256<T>;
};
#endif
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX3
template <class T>
struct TagOfMask<hn::Mask512<T>> {
  using Tag = hn::Full512<T>;
};
#endif

/// A mask that is to be negated: `a & !b` is one instruction, not two.
template <class M>
struct Negated {
  M mask;
  HWY_INLINE operator M() const { return hn::Not(mask); }
};

template <class V>
concept IsVector = requires {
  typename V::PrivateT;
}
&&std::is_same_v<V, hn::Vec<hn::DFromV<V>>>;
template <class M>
concept IsMask = requires {
  typename TagOfMask<M>::Tag;
};
template <class V>
concept IsNumber = std::is_arithmetic_v<V>;

template <IsMask M>
HWY_INLINE M plain(M m) {
  return m;
}
template <IsMask M>
HWY_INLINE M plain(Negated<M> m) {
  return m;
}

/// The type of two masks, of which either may be negated.
template <class A, class B>
requires std::is_same_v<decltype(plain(std::declval<A>())), decltype(plain(std::declval<B>()))>
using MaskOf = decltype(plain(std::declval<A>()));

// Masks.
template <IsMask M>
HWY_INLINE Negated<M> operator!(M m) {
  return {m};
}
template <IsMask M>
HWY_INLINE M operator!(Negated<M> m) {
  return m.mask;
}
template <IsMask M>
HWY_INLINE M operator&(M a, M b) {
  return hn::And(a, b);
}
template <IsMask M>
HWY_INLINE M operator&(M a, Negated<M> b) {
  return hn::AndNot(b.mask, a);
}
template <IsMask M>
HWY_INLINE M operator&(Negated<M> a, M b) {
  return hn::AndNot(a.mask, b);
}
template <class A, class B, class M = MaskOf<A, B>>
HWY_INLINE M operator|(A a, B b) {
  return hn::Or(plain(a), plain(b));
}
template <class A, class B, class M = MaskOf<A, B>>
HWY_INLINE M operator^(A a, B b) {
  return hn::Xor(plain(a), plain(b));
}
template <class M>
HWY_INLINE bool none(M m) {
  const auto mask = plain(m);
  return hn::AllFalse(typename TagOfMask<std::remove_const_t<decltype(mask)>>::Tag(), mask);
}
template <class M>
HWY_INLINE bool any(M m) {
  return !none(m);
}
template <class M>
HWY_INLINE bool all(M m) {
  const auto mask = plain(m);
  return hn::AllTrue(typename TagOfMask<std::remove_const_t<decltype(mask)>>::Tag(), mask);
}
/// A mask for vectors of another type with lanes of the same size.
template <class D, class M>
HWY_INLINE hn::Mask<D> rebind(D d, M m) {
  return hn::RebindMask(d, plain(m));
}

/// The same number in every lane.
template <class D>
HWY_INLINE hn::Vec<D> set(D d, hn::TFromD<D> x) {
  return hn::Set(d, x);
}
template <class V>
HWY_INLINE V spread(V v) {
  return v;
}
template <class V, IsNumber T>
HWY_INLINE V spread(T x) {
  return hn::Set(hn::DFromV<V>(), hn::TFromV<V>(x));
}

// A vector and a number. Of two vectors the operators are Highway's own.
#define SG_VECTOR_AND_NUMBER(op)                                            \
  template <IsVector V>                                                     \
  HWY_INLINE auto operator op(V a, std::type_identity_t<hn::TFromV<V>> b) { \
    return a op hn::Set(hn::DFromV<V>(), b);                                \
  }                                                                         \
  template <IsVector V>                                                     \
  HWY_INLINE auto operator op(std::type_identity_t<hn::TFromV<V>> a, V b) { \
    return hn::Set(hn::DFromV<V>(), a) op b;                                \
  }
SG_VECTOR_AND_NUMBER(+)
SG_VECTOR_AND_NUMBER(-)
SG_VECTOR_AND_NUMBER(*)
SG_VECTOR_AND_NUMBER(/)
SG_VECTOR_AND_NUMBER(&)
SG_VECTOR_AND_NUMBER(|)
SG_VECTOR_AND_NUMBER(^)
SG_VECTOR_AND_NUMBER(<)
SG_VECTOR_AND_NUMBER(>)
SG_VECTOR_AND_NUMBER(<=)
SG_VECTOR_AND_NUMBER(>=)
SG_VECTOR_AND_NUMBER(==)
SG_VECTOR_AND_NUMBER(!=)
#undef SG_VECTOR_AND_NUMBER

template <IsVector V>
HWY_INLINE V operator-(V v) {
  return hn::Neg(v);
}

/// The vector type of operands of which some may be numbers.
template <class... Operands>
struct VectorAmong;
template <class V, class... Rest>
struct VectorAmong<V, Rest...> : VectorAmong<Rest...> {};
template <IsVector V, class... Rest>
struct VectorAmong<V, Rest...> {
  using Type = V;
};
template <class... Operands>
using VectorOf = typename VectorAmong<Operands...>::Type;

/// NaN gives the second operand, as the instructions of x86 do.
template <class A, class B, class V = VectorOf<A, B>>
HWY_INLINE V min(A a, B b) {
  return hn::Min(spread<V>(a), spread<V>(b));
}
template <class A, class B, class V = VectorOf<A, B>>
HWY_INLINE V max(A a, B b) {
  return hn::Max(spread<V>(a), spread<V>(b));
}
/// a where the mask holds, else b. Here and below the mask may be that of another type with lanes of the same size.
template <class M, class A, class B, class V = VectorOf<A, B>>
HWY_INLINE V select(M m, A a, B b) {
  return hn::IfThenElse(rebind(hn::DFromV<V>(), m), spread<V>(a), spread<V>(b));
}
/// v where the mask holds, else 0.
template <class M, IsVector V>
HWY_INLINE V only(M m, V v) {
  return hn::IfThenElseZero(rebind(hn::DFromV<V>(), m), v);
}
template <class A, class B, class C, class V = VectorOf<A, B, C>>
requires(!std::is_same_v<A, B> || !std::is_same_v<B, C>) HWY_INLINE V mul_add(A a, B b, C c) {
  return mul_add(spread<V>(a), spread<V>(b), spread<V>(c));
}
template <class A, class B, class C, class V = VectorOf<A, B, C>>
requires(!std::is_same_v<A, B> || !std::is_same_v<B, C>) HWY_INLINE V neg_mul_add(A a, B b, C c) {
  return neg_mul_add(spread<V>(a), spread<V>(b), spread<V>(c));
}
template <class A, class B, class C, class V = VectorOf<A, B, C>>
requires(!std::is_same_v<A, B> || !std::is_same_v<B, C>) HWY_INLINE V mul_sub(A a, B b, C c) {
  return mul_sub(spread<V>(a), spread<V>(b), spread<V>(c));
}

template <IsVector V>
HWY_INLINE V abs(V v) {
  return hn::Abs(v);
}
/// The magnitude of the first with the sign of the second.
template <IsVector V>
HWY_INLINE V copy_sign(V magnitude, V sign) {
  return hn::CopySign(magnitude, sign);
}
template <IsVector V>
HWY_INLINE V sqrt(V v) {
  return hn::Sqrt(v);
}
template <IsVector V>
HWY_INLINE V floor(V v) {
  return hn::Floor(v);
}
template <IsVector V>
HWY_INLINE V ceil(V v) {
  return hn::Ceil(v);
}
template <IsVector V>
HWY_INLINE auto is_nan(V v) {
  return hn::IsNaN(v);
}
/// The nearest whole numbers, ties to even.
template <IsVector V>
HWY_INLINE auto nearest_int(V v) {
  return hn::NearestInt(v);
}
/// Numbers of another type: hn::ConvertTo.
template <class D, IsVector V>
HWY_INLINE hn::Vec<D> convert(D d, V v) {
  return hn::ConvertTo(d, v);
}
/// The same bits as another type.
template <class D, IsVector V>
HWY_INLINE hn::Vec<D> bit_cast(D d, V v) {
  return hn::BitCast(d, v);
}
template <int bits, IsVector V>
HWY_INLINE V shift_left(V v) {
  return hn::ShiftLeft<bits>(v);
}
template <int bits, IsVector V>
HWY_INLINE V shift_right(V v) {
  return hn::ShiftRight<bits>(v);
}

}  // namespace sg::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
