// SPDX-License-Identifier: Apache-2.0
// Which fields a transform changes, and how.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "filter/tensor/tensor_order.h"

namespace sg {

/// How a field follows x' = M x.
enum class FieldLaw : uint8_t {
  none,             ///< stays: scalars, colours, texture coordinates, ids
  vector,           ///< v' = M v: velocities, displacements
  normal,           ///< n' = M^-T n, made unit
  gradient,         ///< g' = M^-T g: gradients of scalars
  axial,            ///< w' = M w sign(det M) / |det M|^(1/3): curls of vectors, exact for turns, mirrors and equal scales
  tensor,           ///< T' = M T M^T: stress, diffusion
  vector_gradient,  ///< G' = M G M^-1: rows are components, columns directions
  hessian           ///< H' = M^-T H M^-1
};

struct FieldLawParams {
  bool unmarked = true;
  std::vector<std::string> turn, keep, gradients, axial;
  std::optional<TensorOrder> order;  ///< of the components of tensors, as TensorSource has it
};

/// The law of a field of `d`. Marked as normals, vectors or tensors: by that, and the names "gradient(", "hessian(", "curl(" and
/// "vorticity", as operations here give them. Unmarked (when allowed): fields of 3 floats are vectors unless their name suggests colours or
/// texture coordinates, of 9 and 6 floats tensors, of 2 floats on meshes in a plane of equal z vectors. Named in the lists: by that. Fields
/// of the whole stay.
FieldLaw field_law(const Dataset& d, const Field& f, const FieldLawParams& p);

/// The fields of `d` that change under the linear map, changed; vectors and tensors of the plane become solid ones when they leave it.
/// Integers become f32 (above 16 bits f64). A note names the unmarked ones. Throws Error(usage) for unknown names in the lists and
/// sizes that fit no law.
void transform_fields(const Dataset& d, const Mat3& linear, const FieldLawParams& p, FieldSet& out, Context& ctx);

}  // namespace sg
