// SPDX-License-Identifier: Apache-2.0
// The parts of an EnSight Gold geometry file as meshes, and how their nodes and elements are counted by the variables.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"
#include "io/ensight/stream.h"

namespace sg::ensight {

/// The cells of one element type, in the order of the file.
struct Section {
  std::string type;  ///< "tria3", "g_hexa8", ...
  size_t first = 0, count = 0;
};

struct Part {
  int number = 0;
  std::string name;
  DatasetParts data;
  bool structured = false;
  size_t points = 0, cells = 0;
  std::vector<Section> sections;  ///< none for structured parts
};

struct Geometry {
  std::vector<Part> parts;
  std::string description;
};

/// From the begin of a geometry file or of a step in it. Throws Error(data).
Geometry read_geometry(Stream& s, Context& context);

/// Whether a line names an element type ("tria3", "g_tria3 partial").
bool is_element_type(std::string_view line);

/// Three arrays as one of three components.
Array interleaved(const Array& x, const Array& y, const Array& z);

}  // namespace sg::ensight
