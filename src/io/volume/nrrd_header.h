// SPDX-License-Identifier: Apache-2.0
// The header of a NRRD file (magic NRRD0001 to NRRD0005), and which of its axes are space and which are components.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/file/file.h"
#include "data/mesh.h"
#include "io/volume/brick.h"

namespace sg {

struct NrrdAxis {
  size_t size = 0;
  double spacing = std::nan("");  ///< NaN: not given
  double min = std::nan(""), max = std::nan("");
  bool has_direction = false, no_direction = false;  ///< a vector / the word "none" in `space directions`
  Vec3 direction;
  std::string kind, centering, label, units;
  bool is_space = true;
};

/// Key of the key:=value line that holds the name of the field.
inline constexpr std::string_view nrrd_name_key = "field name";

struct NrrdHeader {
  std::string path;
  ElementType type = ElementType::u8;
  std::vector<NrrdAxis> axes;  ///< fastest first
  BrickEncoding encoding = BrickEncoding::raw;
  bool big_endian = false;
  int64_t byte_skip = 0;
  size_t line_skip = 0;
  bool has_origin = false;
  Vec3 origin;
  std::string space;       ///< "right-anterior-superior"; empty: not given
  Mat3 measurement_frame;  ///< its columns: where the axes lead along which vectors and tensors were measured, in that space
  std::string sample_units;
  std::string field_name;                                  ///< what our writer puts under nrrd_name_key
  std::vector<std::string> data_files;                     ///< empty: attached
  size_t subdim = 0;                                       ///< of the data files; 0: all axes but the last
  size_t data_begin = 0;                                   ///< attached: byte behind the header
  std::vector<std::pair<std::string, std::string>> notes;  ///< content, key:=value, comments, ...
};

/// Throws Error(data) that names the line.
NrrdHeader parse_nrrd_header(const MappedFile& file);

/// Decides NrrdAxis::is_space. An axis with a direction, or of kind domain or space, is space; one whose direction is "none" or
/// whose kind is another is components. Without either all axes are space, but the first one of bytes that look like a picture (3 or 4
/// first, at least 16 along the others) and the first one without a spacing where others have one. A time axis counts as space while no
/// more than three do. Of more than three space axes the first becomes components when it is short (at most 9, and shorter than the last),
/// else the last ones do.
void classify_axes(NrrdHeader& h);

/// Dims, spacing, direction and origin of the space axes; of a patient's in the patient frame.
UniformGrid nrrd_grid(const NrrdHeader& h);

}  // namespace sg
