// SPDX-License-Identifier: Apache-2.0
// Small vectors, matrices and boxes, for host and device.
#pragma once
#include <cmath>
#include <limits>

#ifdef __CUDACC__
#define SG_HD __host__ __device__
#else
#define SG_HD
#endif

namespace sg {

template <class T>
struct Vec2T {
  T x{}, y{};
  SG_HD constexpr T& operator[](int i) { return i == 0 ? x : y; }
  SG_HD constexpr T operator[](int i) const { return i == 0 ? x : y; }
  SG_HD friend constexpr Vec2T operator+(Vec2T a, Vec2T b) { return {a.x + b.x, a.y + b.y}; }
  SG_HD friend constexpr Vec2T operator-(Vec2T a, Vec2T b) { return {a.x - b.x, a.y - b.y}; }
  SG_HD friend constexpr Vec2T operator*(Vec2T a, T s) { return {a.x * s, a.y * s}; }
  SG_HD friend constexpr bool operator==(Vec2T, Vec2T) = default;
};

template <class T>
struct Vec3T {
  T x{}, y{}, z{};
  SG_HD constexpr Vec3T() = default;
  SG_HD constexpr Vec3T(T a, T b, T c) : x(a), y(b), z(c) {}
  template <class U>
  SG_HD constexpr explicit Vec3T(const Vec3T<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}
  SG_HD constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  SG_HD constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  SG_HD friend constexpr Vec3T operator+(Vec3T a, Vec3T b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  SG_HD friend constexpr Vec3T operator-(Vec3T a, Vec3T b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  SG_HD friend constexpr Vec3T operator-(Vec3T a) { return {-a.x, -a.y, -a.z}; }
  SG_HD friend constexpr Vec3T operator*(Vec3T a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  SG_HD friend constexpr Vec3T operator*(T s, Vec3T a) { return a * s; }
  SG_HD friend constexpr Vec3T operator*(Vec3T a, Vec3T b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  SG_HD friend constexpr Vec3T operator/(Vec3T a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  SG_HD constexpr Vec3T& operator+=(Vec3T b) { return *this = *this + b; }
  SG_HD constexpr Vec3T& operator-=(Vec3T b) { return *this = *this - b; }
  SG_HD constexpr Vec3T& operator*=(T s) { return *this = *this * s; }
  SG_HD friend constexpr bool operator==(Vec3T, Vec3T) = default;
};

template <class T>
struct Vec4T {
  T x{}, y{}, z{}, w{};
  SG_HD constexpr T& operator[](int i) { return i == 0 ? x : i == 1 ? y : i == 2 ? z : w; }
  SG_HD constexpr T operator[](int i) const { return i == 0 ? x : i == 1 ? y : i == 2 ? z : w; }
  SG_HD friend constexpr Vec4T operator+(Vec4T a, Vec4T b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
  SG_HD friend constexpr Vec4T operator-(Vec4T a, Vec4T b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
  SG_HD friend constexpr Vec4T operator*(Vec4T a, T s) { return {a.x * s, a.y * s, a.z * s, a.w * s}; }
  SG_HD friend constexpr bool operator==(Vec4T, Vec4T) = default;
};

using Vec2 = Vec2T<double>;
using Vec3 = Vec3T<double>;
using Vec4 = Vec4T<double>;
using Vec2f = Vec2T<float>;
using Vec3f = Vec3T<float>;
using Vec4f = Vec4T<float>;
using Vec3i = Vec3T<long long>;

template <class T>
SG_HD constexpr T dot(Vec3T<T> a, Vec3T<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
SG_HD constexpr Vec3T<T> cross(Vec3T<T> a, Vec3T<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
SG_HD inline T length(Vec3T<T> a) {
  return std::sqrt(dot(a, a));
}
/// Unit vector along a; the zero vector stays zero.
template <class T>
SG_HD inline Vec3T<T> normalize(Vec3T<T> a) {
  const T l = length(a);
  return l > T(0) ? a / l : a;
}
template <class T>
SG_HD constexpr Vec3T<T> lerp(Vec3T<T> a, Vec3T<T> b, T t) {
  return a * (T(1) - t) + b * t;
}

/// 3x3 matrix, rows first: m[row][column].
struct Mat3 {
  double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  SG_HD friend constexpr Vec3 operator*(const Mat3& a, Vec3 v) {
    return {a.m[0][0] * v.x + a.m[0][1] * v.y + a.m[0][2] * v.z, a.m[1][0] * v.x + a.m[1][1] * v.y + a.m[1][2] * v.z,
            a.m[2][0] * v.x + a.m[2][1] * v.y + a.m[2][2] * v.z};
  }
  SG_HD friend constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
    Mat3 r;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
    return r;
  }
  SG_HD friend constexpr bool operator==(const Mat3&, const Mat3&) = default;
  SG_HD constexpr Vec3 column(int j) const { return {m[0][j], m[1][j], m[2][j]}; }
};
double determinant(const Mat3& a);
Mat3 transpose(const Mat3& a);
/// Throws an internal Error for a singular matrix.
Mat3 inverse(const Mat3& a);

/// 4x4 matrix, rows first, for column vectors: p' = M p.
struct Mat4 {
  double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  SG_HD friend constexpr Vec4 operator*(const Mat4& a, Vec4 v) {
    Vec4 r;
    for (int i = 0; i < 4; ++i) r[i] = a.m[i][0] * v.x + a.m[i][1] * v.y + a.m[i][2] * v.z + a.m[i][3] * v.w;
    return r;
  }
  SG_HD friend constexpr Mat4 operator*(const Mat4& a, const Mat4& b) {
    Mat4 r;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) r.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j] + a.m[i][3] * b.m[3][j];
    return r;
  }
  SG_HD friend constexpr bool operator==(const Mat4&, const Mat4&) = default;
};
Mat4 inverse(const Mat4& a);

/// Axis-aligned box; empty() until something is added. NaN coordinates are ignored.
struct Box3 {
  Vec3 lo{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec3 hi{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  SG_HD constexpr bool empty() const { return !(lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z); }
  SG_HD constexpr void add(Vec3 p) {
    for (int i = 0; i < 3; ++i) {
      if (p[i] < lo[i]) lo[i] = p[i];
      if (p[i] > hi[i]) hi[i] = p[i];
    }
  }
  SG_HD constexpr void add(const Box3& b) {
    if (!b.empty()) add(b.lo), add(b.hi);
  }
  /// The origin for an empty box; 0 along axes on which there is no middle, as it is infinite.
  SG_HD constexpr Vec3 center() const {
    Vec3 c = empty() ? Vec3() : (lo + hi) * 0.5;
    for (int i = 0; i < 3; ++i) c[i] = c[i] - c[i] == 0 ? c[i] : 0;
    return c;
  }
  SG_HD constexpr Vec3 size() const { return hi - lo; }
  double diagonal() const { return empty() ? 0.0 : length(size()); }
  SG_HD friend constexpr bool operator==(const Box3&, const Box3&) = default;
};

}  // namespace sg
