// SPDX-License-Identifier: Apache-2.0
// How to know the volumes that plug-ins read: DICOM ("gdcm"), OpenVDB ("openvdb").
#include <algorithm>
#include <cstring>

#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "io/formats.h"

namespace sg {

bool sniff_dicom(std::span<const std::byte> head) { return head.size() >= 132 && std::memcmp(head.data() + 128, "DICM", 4) == 0; }

bool sniff_vdb(std::span<const std::byte> head) {
  // The magic number as 64 bits, little endian: " BDV" and four zeros.
  return head.size() >= 12 && std::memcmp(head.data(), " BDV\0\0\0\0", 8) == 0;
}

bool sniff_dicom_folder(const std::string& path) {
  constexpr size_t most = 64;  // files looked into
  size_t looked = 0;
  for (const std::string& name : folder_entries(path)) {
    const std::string file = path + "/" + name;
    if (!is_plain_file(file)) continue;
    const std::string e = extension_of(name);
    if (e == "dcm" || e == "ima") return true;
    if (!e.empty() && e.find_first_not_of("0123456789") != std::string::npos) continue;
    if (++looked > most) return false;
    const MappedFile m(file);
    if (sniff_dicom({m.data(), std::min<size_t>(m.size(), 132)})) return true;
  }
  return false;
}

}  // namespace sg
