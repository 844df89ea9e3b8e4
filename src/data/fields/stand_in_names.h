// SPDX-License-Identifier: Apache-2.0
// Names that readers give to the values of files which name none.
#pragma once
#include <algorithm>
#include <array>
#include <string_view>

namespace sg {

/// Is it a name of the format, as VTK's readers of it give it, and tells nothing of the values?
inline bool is_stand_in_name(std::string_view name) {
  constexpr std::array<std::string_view, 7> names{"DICOMImage", "ImageFile", "ImageScalars", "MetaImage", "NIFTI", "SLCImage", "Scalars_"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace sg
