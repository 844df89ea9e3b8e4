// SPDX-License-Identifier: Apache-2.0
// MINC 1 volumes: medical images in classic netCDF (io/minc).
#pragma once
#include "base/context.h"
#include "io/io.h"
#include "io/plugins/netcdf/nc_file.h"

namespace sg::nc {

bool is_minc(const NcFile& file);
/// As minc::read_volume() gives it.
Data read_minc(const NcFile& file, const ReadOptions& options, Context& context);
std::vector<double> minc_times(const NcFile& file);

}  // namespace sg::nc
