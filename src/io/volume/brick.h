// SPDX-License-Identifier: Apache-2.0
// The numbers of a volume from one file or several: found, unpacked, put in this machine's byte order. Shared by NRRD,
// MetaImage and raw bricks. Raw numbers of one file that lie as we need them are mapped, not copied.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/file/file.h"
#include "data/array.h"
#include "io/volume/lattice_part.h"

namespace sg {

enum class BrickEncoding { raw, text, hex, gzip, zlib, bzip2 };

/// One file's share. `begin` is where its stored bytes begin; a `skip` of -1 means that the wanted bytes end where the
/// (unpacked) stream ends, -1-k that k bytes follow them.
struct BrickPart {
  MappedFile file;
  size_t begin = 0;
  int64_t skip = 0;
  size_t packed = 0;  ///< stored bytes; 0 = up to the end of the file
};

struct BrickLayout {
  ElementType type = ElementType::u8;
  size_t count = 0;
  int components = 1;
  BrickEncoding encoding = BrickEncoding::raw;
  bool big_endian = false;
};

/// `count` packed tuples, an equal share from each part. Throws Error(data) that says how many bytes are needed and how many there are.
Array load_brick(const BrickLayout& layout, const std::vector<BrickPart>& parts, Context& context);

/// The same for a part of a lattice that lies in the brick x fastest, l.count == product of part.dims: of raw numbers only the rows
/// that are wanted are touched, of a gzip or zlib stream no more than these are kept.
Array load_brick_part(const BrickLayout& layout, const LatticePart& part, const std::vector<BrickPart>& parts, Context& context);

/// Product of sizes; throws Error(data) naming `where` when it cannot be counted (more than 2^60) or a size is 0.
size_t checked_product(const std::vector<size_t>& sizes, const std::string& where);

/// The names that a pattern like "slice%03d.raw" makes for first, first+step, ... last. Throws Error(data) for a pattern
/// that holds anything but one %d (with an optional width), or for more than a million names.
std::vector<std::string> pattern_names(const std::string& pattern, int64_t first, int64_t last, int64_t step, const std::string& where);

}  // namespace sg
