// SPDX-License-Identifier: Apache-2.0
// The colour scales of a page, each once.
#pragma once
#include <string>
#include <vector>

#include "color/color_scale.h"
#include "pipeline/offline/pack/arrays.h"

namespace sg::offline {

class ScaleStore {
 public:
  explicit ScaleStore(ArrayStore& arrays) : arrays_(arrays) {}
  /// Number of the scale. {"kind","lo","hi","threshold","clamp","labels","size","colors","below","above","nan"}: colours of even positions
  /// from 0 to 1 as sRGB in 16 bits, and those beyond as linear RGBA.
  uint64_t add(const ColorScale& scale);
  Json description() const { return Json(scales_); }

 private:
  ArrayStore& arrays_;
  std::vector<Json> scales_;
  std::vector<std::string> texts_;
};

}  // namespace sg::offline
