// SPDX-License-Identifier: Apache-2.0
// Private to the library: the parameters of writing, declared like those of an operation.
#pragma once
#include "base/schema/schema.h"
#include "io/io.h"

namespace sightglass {

struct WriteParams {
  std::string encoding = "appended", compression = "none";
  bool ascii = false;
  int pieces = 1, chunk = 64;
};

inline void describe(sg::Schema& s, WriteParams& p) {
  s("encoding", p.encoding, "VTK XML: how numbers are written.").choices({"ascii", "base64", "appended"});
  s("compression", p.compression, "VTK XML, NRRD, Zarr.").choices({"none", "zlib", "lz4", "lzma", "gzip", "zstd"});
  s("ascii", p.ascii, "STL and PLY as text.");
  s("pieces", p.pieces, "Parallel VTK XML and .vtm: into so many files each mesh is cut.").range(1, 100000);
  s("chunk", p.chunk, "Zarr: samples along each axis of a chunk.").range(8, 512);
}

inline sg::WriteOptions write_options(const WriteParams& p) {
  sg::WriteOptions o;
  o.encoding = p.encoding, o.compression = p.compression, o.binary = !p.ascii, o.pieces = p.pieces, o.chunk = p.chunk;
  return o;
}

}  // namespace sightglass
