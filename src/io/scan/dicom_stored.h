// SPDX-License-Identifier: Apache-2.0
// Values as DICOM stores them: whole numbers of 16 bits, from which slope and intercept make values again.
#pragma once
#include "data/array.h"
#include "data/field.h"

namespace sg {

struct DicomStored {
  Array numbers;  ///< u16
  int bits = 16;  ///< of each that are used, 9 at least
  double slope = 1, intercept = 0;
  bool exact = true;     ///< every value comes back as it was
  uint64_t missing = 0;  ///< NaN and infinite values: they become the nearest value of the range, NaN its lowest
};

/// Whole numbers stay as they are where 16 bits, or 16 bits above an intercept, hold them; else the range of the values is divided into
/// 65535 steps. Slope and intercept are the numbers that their decimal strings have. Throws Error(usage) for a range that is not finite.
DicomStored dicom_stored(const Array& values);

}  // namespace sg
