// SPDX-License-Identifier: Apache-2.0
// The statements of one chunk of an OBJ file. Chunks are parsed independently; references that depend on what precedes the chunk (negative
// indices, groups, materials) are kept relative and resolved when all chunks are known.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

enum class ObjCell : uint8_t { vertex, line, polygon };  ///< p, l, f

/// Index of a corner: absolute ones count from 0; `obj_relative` + k means k from the chunk's first element (k may be negative).
inline constexpr int32_t obj_none = INT32_MIN;
inline constexpr int32_t obj_relative = INT32_MIN / 2;
inline constexpr int32_t obj_relative_below = INT32_MIN / 4;

struct ObjCells {
  std::vector<uint32_t> lengths;  ///< corners of each cell
  std::vector<int32_t> v, t, n;   ///< corners; t and n are empty when no corner of the chunk has any
};

/// A "g" or "usemtl" statement and how many cells of each kind precede it in the chunk.
struct ObjMark {
  bool material = false;
  std::string_view name;
  std::array<size_t, 3> cells{};
};

struct ObjChunk {
  std::vector<float> xyz, tcoords, normals;  ///< 3, 2 and 3 per element
  std::vector<float> colors;                 ///< 3 per vertex, NaN = none; empty when no vertex of the chunk has any
  ObjCells cells[3];                         ///< by ObjCell
  std::vector<ObjMark> marks;
  std::vector<std::string_view> libraries;  ///< of "mtllib"
};

/// Parses text[begin, end), whole lines. Throws Error(data) naming `where` and the line.
void parse_obj_chunk(std::string_view text, size_t begin, size_t end, const std::string& where, ObjChunk& out);

/// Line of the k-th cell of a kind in text[begin, end), for messages.
size_t obj_cell_line(std::string_view text, size_t begin, size_t end, ObjCell kind, size_t k);

}  // namespace sg
