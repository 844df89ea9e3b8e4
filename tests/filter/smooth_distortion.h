// SPDX-License-Identifier: Apache-2.0
// Smooth fields on smoothly distorted meshes, with their exact derivatives in space and along surfaces.
#pragma once
#include "filter/every_mesh.h"
#include "support/property.h"

namespace sg::test::distorted {

/// Symmetric second derivatives.
using Matrix = std::array<Vec3, 3>;

inline void add_outer(Matrix& m, double s, Vec3 a, Vec3 b) {
  for (int i = 0; i < 3; ++i) m[size_t(i)] += b * (s * a[i]);
}

/// sum of amplitude * sin(k.p + phase).
struct Waves {
  struct Wave {
    double amplitude;
    Vec3 k;
    double phase;
  };
  std::vector<Wave> waves;
  static Waves random(Random& r, int count, double amplitude, double k) {
    Waves w;
    for (int i = 0; i < count; ++i)
      w.waves.push_back({amplitude * r.in(0.5, 1) * (r.chance(0.5) ? 1 : -1), {r.in(-k, k), r.in(-k, k), r.in(-k, k)}, r.in(0, 6.3)});
    return w;
  }
  double value(Vec3 p) const {
    double s = 0;
    for (const Wave& w : waves) s += w.amplitude * std::sin(dot(w.k, p) + w.phase);
    return s;
  }
  Vec3 gradient(Vec3 p) const {
    Vec3 g;
    for (const Wave& w : waves) g += w.k * (w.amplitude * std::cos(dot(w.k, p) + w.phase));
    return g;
  }
  Matrix hessian(Vec3 p) const {
    Matrix h{};
    for (const Wave& w : waves) add_outer(h, -w.amplitude * std::sin(dot(w.k, p) + w.phase), w.k, w.k);
    return h;
  }
};

/// p to p + (waves of p) along each axis: one to one while the amplitudes times wave numbers stay below 1/3.
struct Distortion {
  Waves along[3];
  static Distortion random(Random& r, double amplitude) {
    Distortion d;
    for (Waves& w : d.along) w = Waves::random(r, 1, amplitude, 1.5);
    return d;
  }
  Vec3 operator()(Vec3 p) const { return p + Vec3(along[0].value(p), along[1].value(p), along[2].value(p)); }
  /// d X / d p_a and d2 X / d p_a d p_b.
  Vec3 tangent(Vec3 p, int a) const {
    Vec3 t(along[0].gradient(p)[a], along[1].gradient(p)[a], along[2].gradient(p)[a]);
    t[a] += 1;
    return t;
  }
  Vec3 bend(Vec3 p, int a, int b) const {
    Vec3 t;
    for (int i = 0; i < 3; ++i) t[i] = along[i].hessian(p)[size_t(a)][b];
    return t;
  }
};

inline Mat3 random_rotation(Random& r) {
  const double z = r.in(-1, 1), phi = r.in(0, 6.28318530718), angle = r.in(0, 6.28318530718), w = std::sqrt(1 - z * z);
  const Vec3 axis(w * std::cos(phi), w * std::sin(phi), z);
  Mat3 m;
  for (int k = 0; k < 3; ++k) {  // Rodrigues
    Vec3 e;
    e[k] = 1;
    const Vec3 q = e * std::cos(angle) + cross(axis, e) * std::sin(angle) + axis * (axis[k] * (1 - std::cos(angle)));
    for (int i = 0; i < 3; ++i) m.m[i][k] = q[i];
  }
  return m;
}

/// Derivatives along the surface that the distorted plane z = 0 is, at the image of p.
inline void along_surface(const Distortion& d, Vec3 p, Vec3& gradient, Matrix& hessian) {
  const Vec3 t[2] = {d.tangent(p, 0), d.tangent(p, 1)}, n = normalize(cross(t[0], t[1]));
  const double g00 = dot(t[0], t[0]), g01 = dot(t[0], t[1]), g11 = dot(t[1], t[1]), det = g00 * g11 - g01 * g01;
  const Vec3 dual[2] = {(t[0] * g11 - t[1] * g01) / det, (t[1] * g00 - t[0] * g01) / det};
  Matrix h{};
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      double s = dot(gradient, n) * dot(n, d.bend(p, a, b));
      for (int i = 0; i < 3; ++i) s += t[a][i] * dot(hessian[size_t(i)], t[b]);
      add_outer(h, s, dual[a], dual[b]);
    }
  hessian = h;
  gradient = gradient - n * dot(gradient, n);
}

/// Points moved, where the mesh lists its points; others stay. True when they were.
inline bool move_points(Mesh& mesh, const Distortion& d) {
  const auto move = [&](Points& points) { points = {at_points(mesh, d), {}}; };
  if (auto* u = std::get_if<UnstructuredMesh>(&mesh)) move(u->points);
  else if (auto* s = std::get_if<SurfaceMesh>(&mesh)) move(s->points);
  else if (auto* c = std::get_if<CurvilinearGrid>(&mesh)) move(c->points);
  else return false;
  return true;
}

}  // namespace sg::test::distorted
