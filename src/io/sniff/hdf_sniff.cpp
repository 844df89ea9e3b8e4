// SPDX-License-Identifier: Apache-2.0
// How the files of the netCDF and CGNS plug-ins begin. HDF5 is the shell of both: extensions distinguish them.
#include "io/formats.h"

#include <cstring>

namespace sg {

namespace {

bool begins(std::span<const std::byte> head, std::string_view with) {
  return head.size() >= with.size() && std::memcmp(head.data(), with.data(), with.size()) == 0;
}
bool is_hdf5(std::span<const std::byte> head) { return begins(head, "\x89HDF\r\n\x1a\n"); }

}  // namespace

bool sniff_netcdf(std::span<const std::byte> head) {
  if (is_hdf5(head)) return true;
  if (!begins(head, "CDF") || head.size() < 32) return false;
  const auto version = int(head[3]);
  return version == 1 || version == 2 || version == 5;
}

bool sniff_cgns(std::span<const std::byte> head) {
  if (is_hdf5(head)) return true;
  if (head.size() < 64 || !begins(head.subspan(4), "ADF Database Version")) return false;
  // "@(#)", with the high bits set or not
  for (size_t i = 0; i < 4; ++i)
    if ((head[i] & std::byte{127}) != std::byte("@(#)"[i])) return false;
  return true;
}

}  // namespace sg
