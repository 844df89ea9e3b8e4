// SPDX-License-Identifier: Apache-2.0
// What kind of scanner made a volume, as its file states it.
#pragma once
#include "data/dataset.h"

namespace sg {

enum class Modality {
  unstated,
  ct,     ///< Hounsfield units, or numbers that are shifted against them
  other,  ///< MR, PET, ultrasound ...
};

/// From the note "modality" in DICOM's or MetaImage's words ("CT", "MET_MOD_MR"), or a field in Hounsfield units.
Modality modality_of(const Dataset& data, const Field& field);

/// The values that are to be told apart on a screen, as the notes "WindowCenter" and "WindowWidth" of DICOM say (the first, of several);
/// empty where they do not.
Range stated_window(const Dataset& data);

}  // namespace sg
