// SPDX-License-Identifier: Apache-2.0
// DetailTable: a transfer function over the value and the length of its gradient as plain arrays, for vector code.
#pragma once
#include <vector>

#include "render/volume/rays/integrate.h"
#include "scene/items/volume_item.h"

namespace sg::volume {

struct DetailTable {
  /// Straight lines from each point to the next, and as at the ends beyond them.
  struct Curve {
    std::vector<float> x, y, slope;
    Curve(const OpacityCurve& curve, double base);
  };
  struct Range {
    float lo, hi;
  };

  /// `base`: value = stored + base.
  DetailTable(const VolumeItem& item, const Detail& detail, double base);
  /// Is the medium opacity over the value times a factor over the gradient, of few points?
  static bool fits(const VolumeItem& item, const Detail& detail);

  Curve opacity, factor;        ///< over the stored value, and over the gradient (world)
  std::vector<Range> drawn;     ///< of values, ascending; nothing is drawn outside of them
  float narrow, narrow_second;  ///< of the TransferFunction, as the edges
  std::vector<TransferFunction::Edge> edges, second_edges;
  float per_unit, most_sigma_t;  ///< sigma_t = -ln(1 - opacity) * per_unit, at most most_sigma_t
};

}  // namespace sg::volume
