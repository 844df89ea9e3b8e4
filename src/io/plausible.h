// SPDX-License-Identifier: Apache-2.0
// How much memory a file may require: a few hundred bytes can name terabytes, and compressed ones unpack to a thousand times their size.
#pragma once
#include <cstdint>
#include <string>

namespace sg {

/// Bytes that the numbers of a file of that size may fill without a word of the user: 256 MiB, and 100 times the file. A larger limit given
/// with --memory (set_memory_limit()) applies instead.
uint64_t plausible_memory(uint64_t file_bytes);

/// Throws Error(data) naming `path` when `need` bytes are more than plausible_memory(file_bytes): it says how much is needed and how to
/// allow it. To be asked before memory is.
void check_plausible(uint64_t need, uint64_t file_bytes, const std::string& path);
/// The same for count * size bytes; a product beyond 2^64 is not plausible.
void check_plausible(uint64_t count, uint64_t size, uint64_t file_bytes, const std::string& path);

}  // namespace sg
