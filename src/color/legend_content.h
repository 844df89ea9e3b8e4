// SPDX-License-Identifier: Apache-2.0
// Legend: what a legend shows: a colour scale and, for volumes, how much each value hides.
#pragma once
#include <optional>
#include <utility>

#include "color/transfer_function.h"

namespace sg {

/// The opacity of a volume over what it depends on.
struct VolumeLegend {
  OpacityCurve opacity;
  TransferDetail detail;
  ColorScale value;          ///< axis of `opacity`: that of the bar, or with detail.color_by_second another one
  std::string second_title;  ///< name of the second axis, for plane pictures
};

/// A colour scale is a legend without opacity.
struct Legend : ColorScale {
  Legend() = default;
  Legend(ColorScale scale) : ColorScale(std::move(scale)) {}
  Legend(ColorScale scale, VolumeLegend v) : ColorScale(std::move(scale)), volume(std::move(v)) {}
  std::optional<VolumeLegend> volume;
};

}  // namespace sg
