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

/// An element type. Node order is that of our cells but for bar3, whose middle node is the second.
struct Element {
  std::string_view name;
  CellType type;
  int nodes;  ///< -1 nsided, -2 nfaced
};
/// The type that a line names ("tria3", "g_tria3 partial"); null for other lines.
const Element* find_element(std::string_view line);

/// How a file states the numbers of its nodes or elements in the line "node id given": off, given, assign or ignore.
std::string stated_ids(Stream& s, const std::string& what);

struct Part {
  int number = 0;
  std::string name;
  DatasetParts data;
  bool structured = false;
  size_t points = 0, cells = 0;
  std::vector<Section> sections;  ///< none for structured parts
  std::vector<int64_t> nodes;     ///< EnSight 6, unstructured: the file's node of each point
};

struct Geometry {
  std::vector<Part> parts;
  std::string description;
  size_t nodes = 0;  ///< EnSight 6: of all unstructured parts together
};

/// From the begin of a geometry file or of a step in it. Throws Error(data).
Geometry read_geometry(Stream& s, Context& context);

/// Three arrays as one of three components.
Array interleaved(const Array& x, const Array& y, const Array& z);

}  // namespace sg::ensight
