// SPDX-License-Identifier: Apache-2.0
// Contents of a Gmsh file, before conversion to a mesh.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/text/mesh_text.h"

namespace sg::gmsh {

/// One $NodeData, $ElementData or $ElementNodeData section; its values are read on demand.
struct DataSection {
  enum Kind : uint8_t { node, element, element_node } kind;
  std::string name;
  std::optional<double> time;
  int64_t step = 0, components = 1, entries = 0;
  size_t begin = 0;  ///< of the values in the file
};

struct Entity {
  int32_t physical = 0, partition = 0, parent = 0;
};

struct MshFile {
  std::vector<int64_t> node_tags, element_tags;
  std::vector<double> xyz;
  std::vector<uint8_t> element_types;    ///< numbers of Gmsh
  std::vector<size_t> element_begin{0};  ///< elements + 1 places in ...
  std::vector<int64_t> element_nodes;    ///< ... tags of nodes, in Gmsh's order
  std::vector<int32_t> physical, entity, partition;
  bool partitioned = false;
  std::map<std::pair<int, int64_t>, Entity> entities;
  std::map<std::pair<int64_t, int64_t>, std::string> names;  ///< of physical groups by dimension and tag
  std::vector<DataSection> data;
};

/// Words of an ASCII file or numbers of a binary one.
class MshInput {
 public:
  MshInput(std::string_view bytes, const std::string& where) : text(bytes, where) {}
  int64_t integer(const char* what);  ///< binary: 4 bytes
  int64_t whole(const char* what);    ///< binary: 8 bytes
  double real(const char* what);      ///< binary: 8 bytes
  int64_t count(const char* what, size_t bytes_each, bool wide);
  std::string_view name();
  /// Behind the number that ends an ASCII header line of a binary section.
  void end_line();
  TextCursor text;
  bool binary = false, swapped = false;
  int version = 22;

 private:
  const char* raw(size_t bytes, const char* what);
};

/// Reads everything but the values of data sections. Throws Error(data).
MshFile parse_msh(MshInput& in);

}  // namespace sg::gmsh
