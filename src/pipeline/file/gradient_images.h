// SPDX-License-Identifier: Apache-2.0
// All volumes of a series side by side: what tensor_fit starts from.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct GradientImagesParams {
  std::string path;
  FieldName field;
};
inline void describe(Schema& s, GradientImagesParams& p) {
  s("path", p.path, "File with a series of volumes, e.g. a 4D NIfTI image.").unit("file");
  s("field", p.field, "Field of one component; default: the active scalar.").takes(fields::scalars);
}

/// The mesh of the first step with one field "images" that has a component per step, in the field's own element type, and the fields of the
/// whole (bval, bvec of a NIfTI image). Reads step by step. Throws Error(usage) without path, for collections, for a field of several
/// components, Error(data) when a step has another size.
DatasetPtr gradient_images(const GradientImagesParams& p, Context& ctx);

}  // namespace sg
