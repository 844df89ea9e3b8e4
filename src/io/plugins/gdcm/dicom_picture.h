// SPDX-License-Identifier: Apache-2.0
// One DICOM file: geometry and number format from its header, and its frames.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/vec.h"
#include "data/array.h"

namespace sg {

struct DicomPicture {
  std::string path, series, description;
  size_t rows = 0, columns = 0, frames = 1;
  int samples = 1, planar = 0, bits_allocated = 16, bits_stored = 16, high_bit = 15;
  bool is_signed = false, big_endian = false, decode = false;  ///< decode: packed, or colours that need a change: GDCM's work
  std::string photometric;
  double slope = 1, intercept = 0;
  bool has_orientation = false, has_spacing = false;
  Vec3 x{1, 0, 0}, y{0, 1, 0};  ///< directions of columns and rows
  double spacing_x = 1, spacing_y = 1;
  double slice_distance = 0;    ///< given spacing between slices (or their thickness); 0 = not
  std::vector<Vec3> positions;  ///< one per frame, one for all, or none
  double instance = 0;
  size_t pixels_begin = 0, pixels_bytes = 0;
  std::vector<std::pair<std::string, std::string>> notes;  ///< nothing that names a patient

  int components() const { return photometric == "PALETTE COLOR" ? 3 : samples; }
  size_t numbers_per_frame() const { return rows * columns * size_t(components()); }
};

/// Reads the header; false when the file holds no picture. Throws Error(data) for a damaged one, or sizes that the file cannot back.
bool read_dicom_header(const std::string& path, DicomPicture& picture);

/// What frames become: the stored type, widened where slope and intercept require it.
ElementType dicom_type(const DicomPicture& picture, bool as_float);

/// Writes frames [first, first + count) as `type` to out, colours together, slope and intercept applied. Only pictures that need
/// decoding go through GDCM.
void read_dicom_frames(const DicomPicture& picture, size_t first, size_t count, ElementType type, std::byte* out);

}  // namespace sg
