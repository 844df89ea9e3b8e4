// SPDX-License-Identifier: Apache-2.0
// MINC volumes, whatever holds them: MINC 1 is classic netCDF, MINC 2 HDF5, with the same words for dimensions, scaling and the world.
// Source: the MINC 1 and MINC 2 file formats of the Montreal Neurological Institute.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "io/io.h"

namespace sg::minc {

inline constexpr const char* spaces[] = {"xspace", "yspace", "zspace"};

/// What a file says of one of its dimensions.
struct Dimension {
  std::string name;
  size_t length = 0;
  std::optional<double> start, step;
  std::optional<Vec3> cosines;
  bool irregular = false;  ///< positions are listed one by one
};

/// A volume as its file describes it.
struct Volume {
  std::string path, image = "image";  ///< the file, and the name of the numbers in it, for messages
  std::vector<Dimension> dims;        ///< of the image, slowest first
  std::vector<Dimension> others;      ///< directions of space that the image lacks: one slice lies at their start
  ElementType type = ElementType::f32;
  std::optional<double> valid_min, valid_max;  ///< range of the stored numbers; open = that of the type
  std::vector<double> min, max;  ///< real values of that range, one for each entry of the first scaled_dims dimensions, or none
  size_t scaled_dims = 0;
  std::string unit, modality;                              ///< modality: DICOM's word
  std::vector<std::pair<std::string, std::string>> notes;  ///< history and the like
  /// Numbers as stored, `count` from `start` along each dimension.
  std::function<Array(const std::vector<size_t>& start, const std::vector<size_t>& count)> read;
};

/// What stored numbers of a type reach from and to where a file does not say it; 0 to 1 for those that are not whole.
std::pair<double, double> type_range(ElementType t);

/// DICOM's word for MINC's ("MRI__" is MR, "PET__" PT); "" for none.
std::string modality_word(const std::string& minc);
/// MINC's word for DICOM's; "" where it has none.
std::string minc_modality(const std::string& dicom);

/// A uniform grid in the patient frame (directions and step signs kept). Field "image": real values (min and max of each slice applied),
/// components along a vector_dimension; of the stored type where they are the stored numbers. Field "ImageScalars": those, where they
/// differ. Throws Error(data) naming the file for other dimensions, and for directions that span no volume.
DatasetPtr read_volume(const Volume& volume, const ReadOptions& options, Context& context);
/// Times of the steps; empty without a time dimension.
std::vector<double> times_of(const Volume& volume);

}  // namespace sg::minc
