// SPDX-License-Identifier: Apache-2.0
// The header of a PLY file, and the decoding of its elements (ASCII, little and big endian) into columns.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/file/file.h"
#include "data/array.h"

namespace sg {

struct PlyProperty {
  std::string name;
  ElementType type = ElementType::f32;  ///< of the value, or of the list's entries
  bool list = false;
  ElementType count_type = ElementType::u8;

  // Where the values go: the place of row 0 and the bytes from row to row; null = not wanted. Only for scalars.
  std::byte* out = nullptr;
  size_t out_stride = 0;
  ElementType out_type = ElementType::f32;
};

/// The lists of one property, as ids of 32 bits: row r has the entries [offsets[r], offsets[r+1]), or `fixed` each.
struct PlyLists {
  Array ids, offsets;
  int fixed = 0;
};

struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;
  int wanted_list = -1;  ///< property whose lists are kept
  PlyLists lists;        ///< filled by decode_ply

  int find(std::string_view property) const {
    for (size_t i = 0; i < properties.size(); ++i)
      if (properties[i].name == property) return int(i);
    return -1;
  }
};

struct PlyHeader {
  std::string path;
  enum class Encoding { ascii, little, big } encoding = Encoding::ascii;
  std::vector<PlyElement> elements;
  std::vector<std::pair<std::string, std::string>> notes;
  size_t body = 0;  ///< byte behind the header
};

/// Throws Error(data) that names the line.
PlyHeader parse_ply_header(const MappedFile& file);

/// Throws Error(data) when the file is too short for the promised counts: to be called before columns are allocated.
void check_ply_counts(const MappedFile& file, const PlyHeader& header);

/// Reads all elements up to the last one of which something is wanted, in parallel: values go to PlyProperty::out, lists to
/// PlyElement::lists. ASCII rows are lines. Throws Error(data) for text that is not a number, and for files that end too early.
void decode_ply(const MappedFile& file, PlyHeader& header, Context& context);

}  // namespace sg
