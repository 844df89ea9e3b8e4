// SPDX-License-Identifier: Apache-2.0
// ENZO hierarchies are text that begins with the first grid; the reader is in the plug-in hdf5.
#include "base/text/text.h"
#include "io/formats.h"

namespace sg {

bool sniff_enzo(std::span<const std::byte> head) {
  std::string_view text = trim({reinterpret_cast<const char*>(head.data()), head.size()});
  if (!text.starts_with("Grid")) return false;
  const std::string_view line = text.substr(0, text.find('\n'));
  const size_t equal = line.find('=');
  return equal != line.npos && trim(line.substr(0, equal)) == "Grid" && trim(line.substr(equal + 1)) == "1" &&
         text.find("GridRank") != text.npos;
}

}  // namespace sg
