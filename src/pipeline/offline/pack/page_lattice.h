// SPDX-License-Identifier: Apache-2.0
// A volume's samples on an even lattice, as floats, with fewer of them where they have to be.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "base/context.h"
#include "scene/items/volume_item.h"

namespace sg::offline {

struct PageLattice {
  std::array<size_t, 3> dims{};     ///< of `values`
  std::array<size_t, 3> samples{};  ///< that there were; u = index of a sample: 0 to samples - 1
  std::vector<float> values;        ///< value - base; NaN where there is none
  double base = 0;
  bool cells = false;           ///< samples are the middles of cells, which reach half a sample further
  std::vector<uint8_t> hidden;  ///< per cell between values, 1: nothing is drawn; empty: all are
  Mat3 to_u;                    ///< u = to_u * (world - origin)
  Vec3 origin;
  Vec3 lo, hi;       ///< box in u
  double edge = 1;   ///< world length of the smallest cell edge of the data
  double unit = 1;   ///< world length to which opacity refers
  Range range;       ///< of all the data
  std::string note;  ///< what was sampled, where the data are no even lattice
};

/// `share`: of the samples along each axis; below 1 values are means over the parts of the box that they stand for.
PageLattice page_lattice(const VolumeItem& item, double share, Context& context);

/// Means over boxes: values of `to` evenly spread samples along each axis from those of `from`. NaN takes no part; where less than half of
/// a box has values there is none. Those of labels are the sample in the middle.
std::vector<float> box_means(const std::vector<float>& values, std::array<size_t, 3> from, std::array<size_t, 3> to, bool labels);

}  // namespace sg::offline
