// SPDX-License-Identifier: Apache-2.0
// The numbers of HDF5 datasets without the library's own reading, which trusts sizes in the file: contiguous numbers are taken from
// the mapped file, chunks are fetched as they are stored and unpacked here, checked and on all threads.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/file/file.h"

namespace sg::h5 {

struct Filter {
  H5Z_filter_t id = 0;
  unsigned element_size = 1;  ///< of shuffle
};

/// Where the numbers of a dataset lie, in a form that this can read.
struct Storage {
  std::vector<uint64_t> dims;
  size_t element_size = 1;
  bool big_endian = false;
  std::optional<uint64_t> at;         ///< contiguous: first byte in the file
  std::vector<uint64_t> chunk;        ///< chunked: dimensions of a chunk
  std::vector<Filter> filters;        ///< in the order of writing; deflate, shuffle and fletcher32 only
  std::function<std::string()> fill;  ///< one element as it would be stored, for chunks that were never written
  uint64_t file_size = 0;
};

/// count[a] indices from start[a] on, every stride[a]-th, to `out` in native byte order. The selection must lie in the dims.
/// Throws Error(data) naming `where` when the file does not hold it, or holds damaged chunks.
void read_storage(hid_t set, const Storage& storage, const MappedFile& file, const std::vector<uint64_t>& start,
                  const std::vector<uint64_t>& count, const std::vector<uint64_t>& stride, std::byte* out, const std::string& where);

}  // namespace sg::h5
