// SPDX-License-Identifier: Apache-2.0
// The headers of NIfTI-1 (348 bytes), NIfTI-2 (540 bytes) and Analyze 7.5 (348 bytes without a magic), in either byte order.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "data/patient/patient_frame.h"

namespace sg {

struct NiftiHeader {
  int version = 1;          ///< 0 = Analyze 7.5, 1, 2
  bool single_file = true;  ///< header and numbers in one file
  bool big_endian = false;
  std::array<size_t, 7> dims{1, 1, 1, 1, 1, 1, 1};  ///< x y z t and more, 1 where not given
  int stored_dims = 0;                              ///< dim[0]
  int datatype = 0;
  int orient = 0;                     ///< Analyze: in which plane slices were stored
  std::array<int, 3> origin_voxel{};  ///< Analyze: the voxel at the origin, counted from 1, as SPM keeps it
  std::array<double, 8> pixdim{};
  size_t data_begin = 0;
  double slope = 0, intercept = 0;
  int qform_code = 0, sform_code = 0;
  double quatern[3]{}, qoffset[3]{}, srow[3][4]{};
  int intent = 0, units = 0;
  double time_offset = 0;
  std::string intent_name, description;
};

/// Whether the bytes begin a header (strict: size, magic or a sane Analyze shape).
bool is_nifti_header(std::span<const std::byte> head);
/// Throws Error(data) naming `where` and the byte.
NiftiHeader parse_nifti_header(std::span<const std::byte> bytes, const std::string& where);
/// NIfTI's world: +x right, +y anterior, +z superior.
inline constexpr std::string_view nifti_space = "right-anterior-superior";
inline constexpr PatientAxes nifti_axes{{-1, -1, 1}};

/// Grid of the first three axes in the patient frame: from the sform where its code is > 0, else the qform; Analyze's by its plane of
/// slices; else spacing alone, in no known frame. A sheared sform keeps its columns, so that voxel (i,j,k) lies where the matrix puts it.
/// Adds notes to `out`: space, which form, units, description.
UniformGrid nifti_grid(const NiftiHeader& h, const std::string& where, DatasetParts& out);

/// How numbers are stored: element type and numbers per voxel (complex 2, RGB 3, RGBA 4).
struct NiftiType {
  ElementType type = ElementType::u8;
  int components = 1;
  bool colors = false;
};
NiftiType nifti_type(const NiftiHeader& h, const std::string& where);

}  // namespace sg
