// SPDX-License-Identifier: Apache-2.0
// divergence, curl, hessian: operators on the derivatives of a field.
#pragma once
#include "filter/field/derivatives/gradient.h"

namespace sg {

struct DivergenceParams {
  FieldName field;
  std::string as;
};
inline void describe(Schema& s, DivergenceParams& p) {
  s("field", p.field, "Vector field; default: the active vectors.").takes(fields::vectors);
  s("as", p.as, "Name of the result; default: divergence(FIELD).");
}
/// The sum of d u_a / d x_a of a vector field, where the field lies. Second order on grids and smooth meshes, exact for linear fields.
DatasetPtr divergence(const DatasetPtr& in, const DivergenceParams& p, Context& ctx);

struct CurlParams {
  FieldName field;
  std::string as;
};
inline void describe(Schema& s, CurlParams& p) {
  s("field", p.field, "Vector field; default: the active vectors.").takes(fields::vectors);
  s("as", p.as, "Name of the result; default: curl(FIELD).");
}
/// Curl (vorticity) of a vector field: (dw/dy - dv/dz, du/dz - dw/dx, dv/dx - du/dy).
DatasetPtr curl(const DatasetPtr& in, const CurlParams& p, Context& ctx);

struct HessianParams {
  FieldName field;
  std::string as;
};
inline void describe(Schema& s, HessianParams& p) {
  s("field", p.field, "Scalar field; default: the active scalar.").takes(fields::scalars);
  s("as", p.as, "Name of the result; default: hessian(FIELD).");
}
/// The symmetric matrix of second derivatives of a scalar field, 9 numbers. Grids: the gradient of the gradient, across their borders the
/// bend of a cubic (with_border_derivatives), of second order; curvilinear ones of first order in the two outer layers. Other meshes: of
/// the fitted parabola, exact for quadratic fields, of second order where neighbours lie on both sides alike (inside smooth meshes of
/// hexahedra, wedges, tetrahedra), of first elsewhere, up to the border. Along lines and surfaces: the covariant one. What too few
/// neighbours leave undetermined is 0, and a warning says at how many points.
DatasetPtr hessian(const DatasetPtr& in, const HessianParams& p, Context& ctx);

}  // namespace sg
