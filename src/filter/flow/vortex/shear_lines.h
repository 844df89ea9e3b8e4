// SPDX-License-Identifier: Apache-2.0
// shear_lines: lines along which a plane flow shears most in a finite time (Haller, Beron-Vera 2012).
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

/// Which of the two directions.
enum class ShearChoice { plus, minus, both };
constexpr auto enum_words(ShearChoice) {
  using enum ShearChoice;
  return std::array{Word{"plus", plus}, Word{"minus", minus}, Word{"both", both}};
}

struct ShearLinesParams {
  ShearChoice family = ShearChoice::both;
  int64_t count = 100;
  std::optional<double> max_length;
};
void describe(Schema& s, ShearLinesParams& p);

/// The two directions that a flow leaves unstretched (up to its change of area) while it shears what lies along them most:
/// eta+- = sqrt(sqrt l2/(sqrt l1 + sqrt l2)) xi1 +- sqrt(sqrt l1/(sqrt l1 + sqrt l2)) xi2, of the eigenvalues l1 <= l2 and eigenvectors of
/// the Cauchy-Green tensor. `in`: what the operation ftle made of a flow in the plane ("stretch", "stretch direction", "shrink
/// direction"). Closed ones bound coherent vortices; long open ones are jets. Lines have no sign; they are followed as the eigenvectors of
/// eta eta^T (see hyperstreamlines) from an even lattice of seeds. Poly-lines with the fields of the input and the cell field "family" (0
/// plus, 1 minus). Throws Error(usage) for other inputs.
DatasetPtr shear_lines(const DatasetPtr& in, const ShearLinesParams& p, Context& context);

}  // namespace sg
