// SPDX-License-Identifier: Apache-2.0
// What engineers ask of a stress tensor: principal stresses, equivalent stresses, the traction on a cut.
#pragma once
#include "filter/tensor/tensor_field.h"

namespace sg {

enum class StressMeasure { von_mises, tresca, mean, max_shear, principal, directions };
constexpr auto enum_words(StressMeasure) {
  using enum StressMeasure;
  return std::array{Word{"von_mises", von_mises}, Word{"tresca", tresca},       Word{"mean", mean},
                    Word{"max_shear", max_shear}, Word{"principal", principal}, Word{"directions", directions}};
}

struct StressMeasuresParams {
  TensorSource tensors;
  std::vector<StressMeasure> measures = {StressMeasure::von_mises, StressMeasure::tresca, StressMeasure::mean, StressMeasure::principal};
};
void describe(Schema& s, StressMeasuresParams& p);

/// Adds the fields "von Mises stress" (sqrt(3/2) |deviator|), "Tresca stress" (s1 - s3), "mean stress" (trace / 3), "maximum shear stress"
/// ((s1 - s3) / 2), "principal stress 1" to "3" in descending order (tension is positive) and, with `directions`, "principal direction 1"
/// to "3" (unit, largest component positive). 2D tensors are plane stress: the third principal stress is 0 and takes its place in the
/// order.
DatasetPtr stress_measures(const DatasetPtr& in, const StressMeasuresParams& p, Context& ctx);

struct TractionParams {
  TensorSource tensors;
  std::optional<Vec3> normal;
};
void describe(Schema& s, TractionParams& p);

/// Adds the traction t = sigma n on surfaces with normal n: the vector "traction", the scalar "normal traction" (n . t, tension positive),
/// the vector "shear traction" (t - (n . t) n) and its length "shear stress". n is `normal` everywhere when given (any mesh); else the
/// field with role normals where the tensors lie, else the normals of the polygons of a surface (points: means weighted by angles, turned
/// to agree with the neighbours). Throws Error(usage) for a zero normal, for solids without `normal` (slice first), and for point clouds
/// without normals.
DatasetPtr traction(const DatasetPtr& in, const TractionParams& p, Context& ctx);

}  // namespace sg
