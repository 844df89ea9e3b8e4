// SPDX-License-Identifier: Apache-2.0
#include "data/fields/texture_coordinates.h"

namespace sg {

Array turned_round(const Array& coordinates) {
  float* out = nullptr;
  const Array from = coordinates.converted(ElementType::f32);
  Array to = Array::make<float>(from.count(), 2, &out);
  const auto v = from.view<float>();
  for (size_t i = 0; i < v.count; ++i) out[2 * i] = v(i, 0), out[2 * i + 1] = 1 - v(i, 1);
  return to;
}

}  // namespace sg
