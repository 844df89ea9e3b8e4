// SPDX-License-Identifier: Apache-2.0
// MINC 2 volumes (medical images in HDF5): the image of full resolution is /minc-2.0/image/0/image, its dimensions are datasets in
// /minc-2.0/dimensions whose attributes tell the place (io/minc).
#pragma once
#include "base/context.h"
#include "io/io.h"
#include "io/plugins/hdf5/h5.h"

namespace sg::minc {

inline const std::string root = "/minc-2.0", image_path = root + "/image/0/image";

bool is_minc_2(const h5::File& file);
/// As read_volume() gives it. Throws Error(data) naming file and object for a file without an image, and for a damaged one.
Data read_minc_2(const h5::File& file, const ReadOptions& options, Context& context);
std::vector<double> minc_2_times(const h5::File& file);
/// Numbers as they are (64-bit integers as f64), one range for all, several components along a vector_dimension.
void write_minc_2(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

}  // namespace sg::minc
