// SPDX-License-Identifier: Apache-2.0
#include "pipeline/offline/pack/scales.h"

#include <algorithm>
#include <cmath>

#include "image/image.h"
#include "pipeline/offline/pack/json_text.h"

namespace sg::offline {

uint64_t ScaleStore::add(const ColorScale& s) {
  const ColorTable table = color_table(s);
  std::vector<uint16_t> colors;
  for (const Vec4f& c : table.linear)
    for (int k = 0; k < 3; ++k) colors.push_back(uint16_t(std::lround(65535 * std::clamp(srgb_encode(c[k]), 0.0f, 1.0f))));
  const double threshold = s.linear_threshold > 0 ? s.linear_threshold : 1e-3 * std::max({std::abs(s.lo), std::abs(s.hi), 1e-300});
  Json scale(Json::Members{{"kind", text(word_of(s.kind))},
                           {"lo", number(s.lo)},
                           {"hi", number(s.hi)},
                           {"threshold", number(threshold)},
                           {"clamp", Json(s.clamp)},
                           {"labels", numbers(s.labels)},
                           {"size", Json(uint64_t(table.linear.size()))},
                           {"colors", Json(arrays_.add(colors, 3))},
                           {"below", numbers(table.below)},
                           {"above", numbers(table.above)},
                           {"nan", numbers(table.nan)}});
  const std::string as_text = scale.dump();
  const auto at = std::find(texts_.begin(), texts_.end(), as_text);
  if (at != texts_.end()) return uint64_t(at - texts_.begin());
  scales_.push_back(std::move(scale)), texts_.push_back(as_text);
  return scales_.size() - 1;
}

}  // namespace sg::offline
