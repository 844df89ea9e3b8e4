// SPDX-License-Identifier: Apache-2.0
// Chunks of a dataset packed on all threads: the library would pack them one after the other.
#pragma once
#include <hdf5.h>

#include <vector>

#include "base/context.h"

namespace sg::h5 {

/// Writes all chunks of a new dataset whose filters are shuffle and deflate, in that order. `values` are its numbers as they are to
/// be stored, the last dimension fastest. False when the library refuses a chunk. The bytes do not depend on the number of threads.
bool write_packed(hid_t set, const std::byte* values, const std::vector<hsize_t>& dims, const std::vector<hsize_t>& chunk,
                  size_t element_size, int level, const Context& context);

}  // namespace sg::h5
