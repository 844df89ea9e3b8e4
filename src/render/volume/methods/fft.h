// SPDX-License-Identifier: Apache-2.0
// Fast Fourier transforms of 2^a 3^b 5^c points: of numbers, or of several series at once in a vector type.
#pragma once
#include <cstddef>
#include <vector>

namespace sg::volume {

/// The least even 2^a 3^b 5^c that is at least n.
size_t fft_size(size_t n);
/// cos and sin of 2 pi turns, from arithmetic alone: the same bits on every machine, right to 1e-16.
void cos_sin_turns(double turns, double& cos, double& sin);

/// S: float or double. X[k] = sum of x[n] exp(-2 pi i k n / size), not scaled.
template <class S>
class Fft {
 public:
  /// Throws an internal Error for other factors than 2, 3 and 5.
  explicit Fft(size_t size);
  size_t size() const { return size_; }

  /// In place, with a work space of the same size. T: S or a vector of S. The inverse (not scaled): change re and im about.
  template <class T>
  void transform(T* re, T* im, T* work_re, T* work_im) const;

 private:
  template <class T>
  void stage(int radix, size_t m, size_t stride, const T* re, const T* im, T* out_re, T* out_im) const;

  size_t size_;
  std::vector<int> radices_;
  std::vector<S> cos_, sin_;  // of -2 pi t / size
};

/// Stockham's scheme: stages that sort as they go, out of place.
template <class S>
template <class T>
void Fft<S>::transform(T* re, T* im, T* work_re, T* work_im) const {
  T *from_re = re, *from_im = im, *to_re = work_re, *to_im = work_im;
  size_t length = size_, stride = 1;
  for (const int radix : radices_) {
    const size_t m = length / size_t(radix);
    stage(radix, m, stride, from_re, from_im, to_re, to_im);
    T* t = from_re;
    from_re = to_re, to_re = t, t = from_im, from_im = to_im, to_im = t;
    length = m, stride *= size_t(radix);
  }
  if (from_re == re) return;
  for (size_t i = 0; i < size_; ++i) re[i] = work_re[i], im[i] = work_im[i];
}

namespace detail {

template <class T>
struct Complex {
  T re, im;
  friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  template <class S>
  friend Complex scaled(Complex a, S s) {
    return {a.re * s, a.im * s};
  }
  /// times -i
  friend Complex turned(Complex a) { return {a.im, -a.re}; }
};

template <class S, class T>
void butterfly(int radix, const Complex<T>* a, Complex<T>* b) {
  switch (radix) {
    case 2: b[0] = a[0] + a[1], b[1] = a[0] - a[1]; return;
    case 4: {
      const auto s = a[0] + a[2], d = a[0] - a[2], t = a[1] + a[3], e = turned(a[1] - a[3]);
      b[0] = s + t, b[1] = d + e, b[2] = s - t, b[3] = d - e;
      return;
    }
    case 3: {
      constexpr S half = S(0.5), root = S(0.866025403784438646763723170752936183);
      const auto s = a[1] + a[2], middle = a[0] - scaled(s, half), side = turned(scaled(a[1] - a[2], root));
      b[0] = a[0] + s, b[1] = middle + side, b[2] = middle - side;
      return;
    }
    default: {
      constexpr S c1 = S(0.309016994374947424102293417182819059), c2 = S(-0.809016994374947424102293417182819059);
      constexpr S s1 = S(0.951056516295153572116439333379382143), s2 = S(0.587785252292473129168705954639072769);
      const auto p = a[1] + a[4], q = a[2] + a[3], m = a[1] - a[4], n = a[2] - a[3];
      const auto u = a[0] + scaled(p, c1) + scaled(q, c2), v = a[0] + scaled(p, c2) + scaled(q, c1);
      const auto x = turned(scaled(m, s1) + scaled(n, s2)), y = turned(scaled(m, s2) - scaled(n, s1));
      b[0] = a[0] + p + q, b[1] = u + x, b[2] = v + y, b[3] = v - y, b[4] = u - x;
    }
  }
}

}  // namespace detail

template <class S>
template <class T>
void Fft<S>::stage(int radix, size_t m, size_t stride, const T* re, const T* im, T* out_re, T* out_im) const {
  const size_t r = size_t(radix);
  detail::Complex<T> a[5], b[5];
  for (size_t p = 0; p < m; ++p) {
    S c[5], s[5];
    for (size_t k = 1; k < r; ++k) c[k] = cos_[p * k * stride % size_], s[k] = sin_[p * k * stride % size_];
    for (size_t q = 0; q < stride; ++q) {
      for (size_t j = 0; j < r; ++j) a[j] = {re[q + stride * (p + m * j)], im[q + stride * (p + m * j)]};
      detail::butterfly<S>(radix, a, b);
      T *to_re = out_re + q + stride * r * p, *to_im = out_im + q + stride * r * p;
      to_re[0] = b[0].re, to_im[0] = b[0].im;
      for (size_t k = 1; k < r; ++k) {
        to_re[stride * k] = b[k].re * c[k] - b[k].im * s[k];
        to_im[stride * k] = b[k].re * s[k] + b[k].im * c[k];
      }
    }
  }
}

}  // namespace sg::volume
