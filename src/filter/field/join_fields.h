// SPDX-License-Identifier: Apache-2.0
// join_fields: the fields of several files or results on one mesh.
#pragma once
#include "base/context.h"
#include "base/schema/schema.h"
#include "data/dataset.h"

namespace sg {

struct JoinFieldsParams {
  std::vector<std::string> fields, names;
};
inline void describe(Schema& s, JoinFieldsParams& p) {
  s("fields", p.fields, "Fields to take from the further inputs; default: all.");
  s("names", p.names, "Their names in the result, in the order of 'fields'; default: their own.");
}

/// The first input with the fields of the others, whose meshes have the same kind, dimensions and numbers of points and cells; positions
/// are those of the first (a warning says if they differ). A field that the first has with the same values is left out; another field with
/// a name already in use gets the number of its input appended ("T_2"). What any of them hides is hidden. Collections: part by part. Throws
/// Error(usage) for meshes of another shape, and for fields that none of the further inputs has.
Data join_fields(const std::vector<Data>& inputs, const JoinFieldsParams& p, Context& context);

}  // namespace sg
