// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/zarr_halve.h"

#include <cmath>

#include "base/parallel.h"

namespace sg::zarr {

namespace {

template <class T>
T mean_of(const T* v, int n) {
  if constexpr (std::is_floating_point_v<T>) {
    using Sum = double;
    Sum sum = 0;
    int counted = 0;
    for (int i = 0; i < n; ++i)
      if (v[i] == v[i]) sum += Sum(v[i]), ++counted;
    return counted ? T(sum / counted) : v[0];
  } else if constexpr (sizeof(T) < 8) {
    int64_t sum = 0;
    for (int i = 0; i < n; ++i) sum += int64_t(v[i]);
    const int64_t twice = 2 * sum + n;  // floor(sum/n + 1/2), also below zero
    return T(twice >= 0 ? twice / (2 * n) : -((-twice + 2 * n - 1) / (2 * n)));
  } else {
    long double sum = 0;
    for (int i = 0; i < n; ++i) sum += (long double)(v[i]);
    return T(std::floor(sum / n + 0.5L));
  }
}

template <class T>
T most_frequent(const T* v, int n) {
  T best = v[0];
  int most = 0;
  for (int i = 0; i < n; ++i) {
    int count = 0;
    for (int k = 0; k < n; ++k) count += v[k] == v[i];
    if (count > most || (count == most && v[i] < best)) best = v[i], most = count;
  }
  return best;
}

// Two rows of two slices, the plain case, without a list of what to average.
void mean_rows(const float* a, const float* b, const float* c, const float* d, float* out, size_t n) {
  for (size_t i = 0; i < n; ++i) {
    const size_t x = 2 * i;
    out[i] = float(((double(a[x]) + double(a[x + 1])) + (double(b[x]) + double(b[x + 1])) +
                    ((double(c[x]) + double(c[x + 1])) + (double(d[x]) + double(d[x + 1])))) *
                   0.125);
  }
}

template <class T>
void halve_typed(const Samples& s, const T* in, std::array<size_t, 3> dims, std::array<bool, 3> halved, T* out) {
  std::array<size_t, 3> to = dims;
  for (size_t a = 0; a < 3; ++a)
    if (halved[a]) to[a] = (dims[a] + 1) / 2;
  const auto nc = size_t(s.components);
  parallel_for(to[1] * to[2], 4, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t j = row % to[1], k = row / to[1];
      const size_t j0 = halved[1] ? 2 * j : j, k0 = halved[2] ? 2 * k : k;
      const size_t nj = halved[1] && j0 + 1 < dims[1] ? 2 : 1, nk = halved[2] && k0 + 1 < dims[2] ? 2 : 1;
      const auto line = [&](size_t y, size_t z) { return in + (z * dims[1] + y) * dims[0] * nc; };
      T* to_row = out + row * to[0] * nc;
      size_t i = 0;
      if constexpr (std::is_same_v<T, float>)
        if (nc == 1 && !s.labels && halved[0] && nj == 2 && nk == 2) {
          i = dims[0] / 2;
          mean_rows(line(j0, k0), line(j0 + 1, k0), line(j0, k0 + 1), line(j0 + 1, k0 + 1), to_row, i);
          for (size_t x = 0; x < i; ++x)  // a NaN among them: the mean of the others
            if (to_row[x] != to_row[x]) {
              T v[8];
              int n = 0;
              for (size_t z = 0; z < 2; ++z)
                for (size_t y = 0; y < 2; ++y) v[n++] = line(j0 + y, k0 + z)[2 * x], v[n++] = line(j0 + y, k0 + z)[2 * x + 1];
              to_row[x] = mean_of(v, n);
            }
        }
      for (; i < to[0]; ++i) {
        const size_t i0 = halved[0] ? 2 * i : i, ni = halved[0] && i0 + 1 < dims[0] ? 2 : 1;
        for (size_t c = 0; c < nc; ++c) {
          T v[8];
          int n = 0;
          for (size_t z = 0; z < nk; ++z)
            for (size_t y = 0; y < nj; ++y)
              for (size_t x = 0; x < ni; ++x) v[n++] = line(j0 + y, k0 + z)[(i0 + x) * nc + c];
          to_row[i * nc + c] = s.labels ? most_frequent(v, n) : mean_of(v, n);
        }
      }
    }
  });
}

}  // namespace

void halve(const Samples& s, const std::byte* in, std::array<size_t, 3> dims, std::array<bool, 3> halved, std::byte* out) {
  std::byte* unused = nullptr;
  dispatch(Array::make_raw(s.type, 0, 1, &unused), [&](auto view) {  // an empty array of the type chooses the kernel
    using T = std::remove_cv_t<std::remove_reference_t<decltype(view[0])>>;
    halve_typed<T>(s, reinterpret_cast<const T*>(in), dims, halved, reinterpret_cast<T*>(out));
  });
}

}  // namespace sg::zarr
