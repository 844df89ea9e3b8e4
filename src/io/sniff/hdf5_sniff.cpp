// SPDX-License-Identifier: Apache-2.0
// HDF5 containers by their signature; what they hold is for the readers (plug-in hdf5) to see.
#include "io/formats.h"

#include <cstring>
#include <string_view>

namespace sg {

bool sniff_hdf5(std::span<const std::byte> head) {
  constexpr unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
  // Behind a user block of 512, 1024, ... bytes, or at the start.
  for (size_t at = 0; at + sizeof signature <= head.size(); at = at ? 2 * at : 512)
    if (std::memcmp(head.data() + at, signature, sizeof signature) == 0) return true;
  return false;
}

// The names of a file's top groups stand near its head, among them that of MINC's.
bool sniff_minc_2(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  return sniff_hdf5(head) && text.find("minc-2.0") != text.npos;
}

}  // namespace sg
