// SPDX-License-Identifier: Apache-2.0
// Files in and out. A format is chosen by content first, by extension second; one file per format.
#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/context.h"
#include "data/dataset.h"

namespace sg {

struct ReadOptions {
  std::vector<std::string> fields;          ///< names to load; empty = all. Readers may skip the bytes of the others.
  bool header_only = false;                 ///< no field values needed: readers may leave fields out that cost reading
  std::array<size_t, 3> raw_dims{0, 0, 0};  ///< raw bricks: size, ...
  std::string raw_type;                     ///< ... element type ("u8", "f32", ...),
  bool raw_big_endian = false;              ///< ... byte order,
  size_t raw_header = 0;                    ///< ... bytes to skip,
  int raw_components = 1;                   ///< ... numbers per voxel,
  Vec3 raw_spacing{1, 1, 1};                ///< ... distance of voxels
};

struct WriteOptions {
  std::string encoding = "appended";  ///< VTK XML: ascii, base64, appended (raw)
  std::string compression = "none";   ///< VTK XML: none, zlib, lz4, lzma; NRRD: none, gzip
  bool binary = true;                 ///< STL, PLY
};

/// Reads any known file. Errors name the file, the byte or line, and what was expected.
Data read_data(const std::string& path, const ReadOptions& options, Context& context);
/// Writes by extension. Throws Error(usage) for an unknown extension or a mesh the format cannot hold.
void write_data(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

/// One format: what it is called, how to know it, how to read and write it. The table stands in formats.cpp.
struct Format {
  std::string_view name;
  std::string_view extensions;  ///< blank-separated, lower case
  /// Content test on the first bytes (up to 4 KiB; fewer when the file is shorter); null = extension only.
  bool (*sniff)(std::span<const std::byte> head);
  Data (*read)(const std::string& path, const ReadOptions&, Context&);
  void (*write)(const std::string& path, const Data&, const WriteOptions&, Context&);
};
std::span<const Format> formats();

}  // namespace sg
