// SPDX-License-Identifier: Apache-2.0
// What the axes of a dataset measure, where its file says so: the notes "x axis", "y axis" and "z axis".
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "data/dataset.h"

namespace sg {

struct AxisNote {
  std::string name, unit;
  std::string positive;  ///< "up", "down" or not stated
  bool in_degrees() const { return unit.starts_with("degree"); }
  /// Do values grow downwards? Pressures do, and depths, where nothing else is stated.
  bool down() const;
  /// "depth [m]", "longitude [degrees east]".
  std::string title() const;
};

/// Adds the note of an axis (0 to 2): "depth, m, positive down".
void note_axis(std::vector<std::pair<std::string, std::string>>& notes, int axis, const AxisNote& note);

/// The unit of all three axes: the note "length unit", or that of the patient frame, mm. "" where none is known.
std::string length_unit(const Dataset& data);

/// What the note of an axis says; nothing where there is none.
std::optional<AxisNote> axis_note(const Dataset& data, int axis);

}  // namespace sg
