// SPDX-License-Identifier: Apache-2.0
#include "filter/mesh/select/crop.h"

#include <fmt/core.h>

#include "base/error.h"
#include "data/lattice_crop.h"

namespace sg {

DatasetPtr crop(const DatasetPtr& in, const CropParams& p, Context&) {
  std::array<size_t, 3> lo{0, 0, 0}, hi{SIZE_MAX, SIZE_MAX, SIZE_MAX}, stride{1, 1, 1};
  if (!p.region.empty() && p.region.size() != 6)
    fail_usage(fmt::format("needs six numbers, not {}", p.region.size()), "crop region", "write e.g. 0,99,0,99,20,40");
  if (!p.stride.empty() && p.stride.size() != 1 && p.stride.size() != 3)
    fail_usage(fmt::format("needs one or three numbers, not {}", p.stride.size()), "crop stride", "write e.g. 2 or 2,2,1");
  for (size_t a = 0; a < 3; ++a) {
    if (!p.region.empty()) lo[a] = size_t(p.region[2 * a]), hi[a] = size_t(p.region[2 * a + 1]);
    if (!p.stride.empty()) stride[a] = size_t(p.stride[p.stride.size() == 3 ? a : 0]);
  }
  return crop_lattice(*in, lo, hi, stride);
}

}  // namespace sg
