// SPDX-License-Identifier: Apache-2.0
// MINC 1 volumes (medical images in classic netCDF). Source: the MINC 1 file format of the Montreal Neurological Institute.
#pragma once
#include "base/context.h"
#include "io/io.h"
#include "io/plugins/netcdf/nc_file.h"

namespace sg::nc {

bool is_minc(const NcFile& file);
/// A uniform grid in world coordinates (directions and step signs kept). Field "image": real values (image-min and image-max of
/// each slice applied), components along a vector_dimension. Field "ImageScalars": the numbers as stored, where they differ.
Data read_minc(const NcFile& file, const ReadOptions& options, Context& context);

}  // namespace sg::nc
