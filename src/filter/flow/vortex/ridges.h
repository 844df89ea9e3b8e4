// SPDX-License-Identifier: Apache-2.0
// ridges: lines (in the plane) or surfaces (in space) along the crests of a field.
#pragma once
#include <optional>

#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

enum class RidgeKind { ridges, valleys };
constexpr auto enum_words(RidgeKind) {
  using enum RidgeKind;
  return std::array{Word{"ridges", ridges}, Word{"valleys", valleys}};
}

struct RidgesParams {
  FieldName field;
  RidgeKind kind = RidgeKind::ridges;
  std::optional<double> limit;
  double smooth = 2;
  double strength = 0.02;
  double min_length = 0.02;
};
void describe(Schema& s, RidgesParams& p);

/// Height ridges (Eberly 1996): where the gradient g has no part along the eigenvector of the smallest eigenvalue of the Hessian H, and
/// that eigenvalue is negative: a maximum across the crest. They are the zeros of det(g, Hg, H^2 g) (in the plane: of g x Hg), contoured
/// and then sorted by those conditions (Peikert, Sadlo 2008), so no eigenvector needs a sign. At a peak or pass, where the zeros of the
/// other directions cross, a surface may have a gap of a cell; lines are joined over three. Derivatives are those of the operations
/// gradient and hessian; noisy fields should be smoothed first (gaussian_smooth). kind=valleys: of -f.
///
/// 2D meshes in a plane: poly-lines; 3D: triangles. Point fields of the input and "ridge strength" (minus that eigenvalue). Left out: where
/// the field is below `limit` (valleys: above), weaker than `strength` of the strongest, connected pieces smaller across than
/// min_length. Throws Error(usage) for vectors, curved surfaces and meshes of lines or points.
DatasetPtr ridges(const DatasetPtr& in, const RidgesParams& p, Context& context);

}  // namespace sg
