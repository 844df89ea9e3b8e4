// SPDX-License-Identifier: Apache-2.0
// Analytic scalar fields on a uniform grid.
#pragma once
#include "simulate/analytic_grid.h"

namespace sg {

/// The test signal of Marschner and Lobb 1994, nearly all of it just below the Nyquist frequency of a 40^3 grid on [-1,1]^3:
/// (1 - sin(pi z/2) + alpha (1 + rho(sqrt(x^2+y^2)))) / (2 (1+alpha)), rho(r) = cos(2 pi fm cos(pi r/2)). Values in [0,1].
struct MarschnerLobbParams {
  GridParams grid{.size = 40, .dims = {}, .bounds = {}, .type = FieldType::f32};
  double frequency = 6;
  double alpha = 0.25;
};
void describe(Schema& s, MarschnerLobbParams& p);
DatasetPtr marschner_lobb(const MarschnerLobbParams& p, Context& context);

/// Tangle cube x^4-5x^2 + y^4-5y^2 + z^4-5z^2 + c on [-3,3]^3; its zero surface has genus 5 for c = 11.8.
struct TangleParams {
  GridParams grid;
  double constant = 11.8;
};
void describe(Schema& s, TangleParams& p);
DatasetPtr tangle(const TangleParams& p, Context& context);

/// sin(kx)cos(ky) + sin(ky)cos(kz) + sin(kz)cos(kx) with k = 2 pi/period; an eigenfunction of the Laplacian: lap f = -2 k^2 f.
struct GyroidParams {
  GridParams grid;
  double period = 1;
};
void describe(Schema& s, GyroidParams& p);
DatasetPtr gyroid(const GyroidParams& p, Context& context);

/// Signed distance to a sphere, negative inside.
struct SphereParams {
  GridParams grid;
  Vec3 center{0, 0, 0};
  double radius = 1;
};
void describe(Schema& s, SphereParams& p);
DatasetPtr sphere(const SphereParams& p, Context& context);

/// Signed distance to a torus about the z axis, negative inside.
struct TorusParams {
  GridParams grid;
  Vec3 center{0, 0, 0};
  double major_radius = 1, minor_radius = 0.4;
};
void describe(Schema& s, TorusParams& p);
DatasetPtr torus(const TorusParams& p, Context& context);

/// Probability density |psi|^2 of the hydrogen orbital n, l, m in Bohr radii, and "wave function": the real orbital (m > 0 cosine,
/// m < 0 sine of |m| times the azimuth), normalised so that the density integrates to 1. Griffiths, Quantum Mechanics, ch. 4.
struct HydrogenParams {
  GridParams grid;
  int n = 3, l = 2, m = 0;
};
void describe(Schema& s, HydrogenParams& p);
/// Throws Error(usage) unless 0 <= l < n and |m| <= l.
DatasetPtr hydrogen(const HydrogenParams& p, Context& context);
/// The real orbital at a point.
double hydrogen_orbital(int n, int l, int m, Vec3 position);

}  // namespace sg
