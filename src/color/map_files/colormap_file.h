// SPDX-License-Identifier: Apache-2.0
// Colour maps from files: GMT .cpt, ParaView and niivue JSON, and ColorBrewer's CSS rules.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "color/colormap.h"

namespace sg {

/// A map of a file with the file's other data about it.
struct FileColormap {
  Colormap map;
  size_t entries = 0;                        ///< slices, control points or colours that the file lists
  std::string space;                         ///< between control points: "RGB", "HSV", "CMYK", "Lab", "Diverging"
  double lo = 0, hi = 1;                     ///< positions of the first and last colour in the file
  std::optional<double> range_lo, range_hi;  ///< values that the file was made for (RANGE, min and max)
  std::optional<double> hinge;               ///< a position that belongs to the value 0
  bool hard_hinge = false;                   ///< each side of the hinge is stretched for itself
  std::optional<Vec3f> below, above, nan;    ///< sRGB
  std::vector<double> labels;                ///< categorical: the value of each colour, empty when they have none
  std::vector<std::string> label_names;      ///< categorical: text per colour, or empty
};

/// Whether the name of a map means a file: "FILE.cpt", "FILE.json:NAME", "FILE.css:NAME", each perhaps with "_r".
bool names_colormap_file(std::string_view name);

/// All maps of a file, in its order. Throws Error(data) with the line for what is not a colour map.
std::vector<FileColormap> read_colormaps(const std::string& path);

/// "FILE" (of one map) or "FILE:NAME"; "_r" behind it is the reverse. map.name is all of `name`. Throws Error(usage) with the names
/// for a file of several maps.
FileColormap find_file_colormap(std::string_view name);

/// The map for values from `lo` to `hi`, with the hinge at the value 0 and each side stretched for itself.
Colormap hinged(const FileColormap& file, double lo, double hi);

}  // namespace sg
