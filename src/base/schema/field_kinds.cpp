// SPDX-License-Identifier: Apache-2.0
#include "base/schema/field_kinds.h"

#include <fmt/core.h>

#include "base/text/text.h"

namespace sg {

bool is_automatic(const FieldName& field) { return field.name == "auto"; }

bool takes_components(const FieldKinds& k, int n) {
  const bool vector = n == 2 || n == 3, tensor = n == 3 || n == 4 || n == 6 || n == 7 || n == 9;
  if (n == 1) return k.scalars;
  return (vector && k.vectors) || (tensor && k.tensors) || k.others;
}

std::string field_kinds_text(const FieldKinds& k) {
  std::string of;
  const auto add = [&](bool is, const char* word) {
    if (is) of += (of.empty() ? "" : " or ") + std::string(word);
  };
  if (k.others) {
    of = k.scalars ? "any field" : "a field of several components";
  } else {
    add(k.scalars, "scalar"), add(k.vectors, "vector"), add(k.tensors, "tensor");
    std::string sizes = k.vectors && k.tensors ? "2, 3, 4, 6, 7 or 9" : k.vectors ? "2 or 3" : k.tensors ? "9, 7, 6, 4 or 3" : "";
    if (k.scalars) sizes = sizes.empty() ? "1 component" : "1, " + sizes;
    of = fmt::format("a {} field ({}{})", of, sizes, sizes.ends_with("component") ? "" : " components");
  }
  return fmt::format("{} of {}", of, k.points && k.cells ? "points or cells" : k.points ? "points" : "cells");
}

}  // namespace sg
