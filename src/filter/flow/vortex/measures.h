// SPDX-License-Identifier: Apache-2.0
// vortex_measures: measures of where and how a flow rotates, from its velocity gradient J = S + W (strain and spin).
#pragma once
#include <array>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// See VortexMeasures.
enum class VortexMeasure {
  vorticity,
  vorticity_magnitude,
  q,
  lambda2,
  delta,
  swirling_strength,
  helicity,
  normalized_helicity,
  strain,
  divergence,
  okubo_weiss,
  kinematic_vorticity
};
constexpr auto enum_words(VortexMeasure) {
  using enum VortexMeasure;
  return std::array{Word{"vorticity", vorticity},
                    Word{"vorticity_magnitude", vorticity_magnitude},
                    Word{"q", q},
                    Word{"lambda2", lambda2},
                    Word{"delta", delta},
                    Word{"swirling_strength", swirling_strength},
                    Word{"helicity", helicity},
                    Word{"normalized_helicity", normalized_helicity},
                    Word{"strain", strain},
                    Word{"divergence", divergence},
                    Word{"okubo_weiss", okubo_weiss},
                    Word{"kinematic_vorticity", kinematic_vorticity}};
}

struct VortexMeasuresParams {
  FieldName field;
  std::vector<VortexMeasure> measures{VortexMeasure::vorticity, VortexMeasure::q, VortexMeasure::lambda2, VortexMeasure::swirling_strength,
                                      VortexMeasure::helicity};
};
void describe(Schema& s, VortexMeasuresParams& p);

/// All of them at one place; 1/time each unless stated otherwise.
struct VortexMeasures {
  Vec3 vorticity;              ///< curl u
  double vorticity_magnitude;  ///< |curl u|
  double q;                    ///< (|W|^2 - |S|^2)/2, > 0 in a vortex (Hunt, Wray, Moin 1988), 1/time^2
  double lambda2;              ///< middle eigenvalue of S^2 + W^2, < 0 in a vortex (Jeong, Hussain 1995), 1/time^2; 2D: -q
  double delta;                ///< discriminant of J's eigenvalues, > 0 where two are complex (Chong, Perry, Cantwell 1990), 1/time^6
  double swirling_strength;    ///< imaginary part of the complex eigenvalues (Zhou et al. 1999); 0 where there are none
  double helicity;             ///< u . curl u, length/time^2
  double normalized_helicity;  ///< cosine of the angle between u and curl u (Levy, Degani, Seginer 1990), no unit
  double strain;               ///< sqrt(2 S:S), the shear rate
  double divergence;           ///< trace of J
  double okubo_weiss;  ///< in the plane of x and y: normal^2 + shear^2 - vorticity^2, < 0 in a vortex (Okubo 1970, Weiss 1991), 1/time^2
  double kinematic_vorticity;  ///< |W|/|S| (Truesdell 1954), no unit
};
/// `j` is m[i][k] = d u_i / d x_k.
VortexMeasures vortex_measures_of(const Mat3& j, Vec3 u);

/// The input with a field for each word of `measures`, where the velocity lies (point or cell field), from the derivatives of the
/// operation gradient: second order on grids and smooth meshes, exact for linear flows. Two components: the flow has no third one. NaN
/// velocities have NaN measures. Throws Error(usage) for unknown words and fields.
DatasetPtr vortex_measures(const DatasetPtr& in, const VortexMeasuresParams& p, Context& context);

/// Derivatives of a velocity field where it lies, rows first, 9 numbers a place, f64.
Array velocity_gradients(const DatasetPtr& in, const Field& velocity, Context& context);

}  // namespace sg
