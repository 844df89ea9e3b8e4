// SPDX-License-Identifier: Apache-2.0
// Stands in for the readers until they exist; delete this file then. Weak, so that it never hides a real one for long.
#include "io/formats.h"

namespace sg {

#define SG_STUB __attribute__((weak))
SG_STUB bool sniff_vtk_legacy(std::span<const std::byte>) { return false; }
SG_STUB bool sniff_vtk_xml(std::span<const std::byte>) { return false; }
SG_STUB bool sniff_nrrd(std::span<const std::byte>) { return false; }
SG_STUB bool sniff_metaimage(std::span<const std::byte>) { return false; }
SG_STUB bool sniff_ply(std::span<const std::byte>) { return false; }
#define SG_STUB_READER(name) \
  SG_STUB Data name(const std::string& path, const ReadOptions&, Context&) { fail_data("no reader in this test program", path); }
SG_STUB_READER(read_vtk_legacy)
SG_STUB_READER(read_vtk_xml)
SG_STUB_READER(read_nrrd)
SG_STUB_READER(read_metaimage)
SG_STUB_READER(read_raw)
SG_STUB_READER(read_ply)
SG_STUB_READER(read_stl)
SG_STUB_READER(read_obj)
#define SG_STUB_WRITER(name)                                                               \
  SG_STUB void name(const std::string& path, const Data&, const WriteOptions&, Context&) { \
    fail_data("no writer in this test program", path);                                     \
  }
SG_STUB_WRITER(write_vtk_xml)
SG_STUB_WRITER(write_nrrd)
SG_STUB_WRITER(write_ply)
SG_STUB_WRITER(write_stl)
SG_STUB_WRITER(write_obj)

}  // namespace sg
