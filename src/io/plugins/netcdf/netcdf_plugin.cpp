// SPDX-License-Identifier: Apache-2.0
// The netCDF plug-in: Exodus II, MINC 1 and CF grids are told apart by what the file holds, whatever its name.
#include <mutex>

#include "base/parallel.h"
#include "io/plugin.h"
#include "io/plugins/netcdf/cf.h"
#include "io/plugins/netcdf/exodus.h"
#include "io/plugins/netcdf/minc.h"

namespace sg::nc {

namespace {

std::mutex library_lock;  // the library is not safe for threads

Data read(const std::string& path, const ReadOptions& options, Context& context) {
  std::lock_guard lock(library_lock);
  const NcFile file(path);
  if (is_exodus(file)) return read_exodus(file, options, context);
  if (is_minc(file)) return read_minc(file, options, context);
  return read_cf(file, options, context);
}

std::vector<double> times(const std::string& path, const ReadOptions&, Context&) {
  std::lock_guard lock(library_lock);
  const NcFile file(path);
  if (is_exodus(file)) return exodus_times(file);
  if (is_minc(file)) return {};
  return cf_times(file);
}

}  // namespace

}  // namespace sg::nc

SG_PLUGIN_FORMATS({"netcdf", sg::nc::read, nullptr, sg::nc::times})
