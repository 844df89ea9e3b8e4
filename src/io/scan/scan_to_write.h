// SPDX-License-Identifier: Apache-2.0
// What the writers of scanners' formats take of a dataset: a uniform grid in the file's frame, and one field at its points.
#pragma once
#include <string>
#include <string_view>

#include "data/patient/patient_frame.h"
#include "io/write_losses.h"

namespace sg {

/// What a format makes of several numbers at a point when it is read.
enum class Several {
  numbers,           ///< they keep no axes
  three_are_vectors  ///< ... but three numbers of more than a byte are vectors along the file's axes
};

struct ScanToWrite {
  DatasetPtr data;
  UniformGrid grid;  ///< in the frame of the file
  Field field;       ///< vectors measured along the axes of that frame

  bool is_colors() const {
    return field.array.type() == ElementType::u8 && field.role == Role::colors && (field.components() == 3 || field.components() == 4);
  }
  /// The value of a note; "" where there is none. Keys in any case.
  std::string note(std::string_view key) const;
  /// DICOM's word for the scanner ("CT", "MR", ...); "" where the data do not say.
  std::string modality() const;
};

/// Positions of no stated frame are taken as the patient's: read again they are the same numbers. Throws Error(usage) for other meshes, for
/// several datasets, and where there is no field at the points.
ScanToWrite scan_to_write(const Data& data, const std::string& path, std::string_view format, const PatientAxes& file_axes, Several several,
                          bool keeps_unit, WriteLosses& losses);

}  // namespace sg
