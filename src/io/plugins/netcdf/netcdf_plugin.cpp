// SPDX-License-Identifier: Apache-2.0
// The netCDF plug-in: Exodus II, MINC 1 and CF grids are distinguished by what the file holds, whatever its name.
#ifdef SG_QUIET_HDF5
#include <hdf5.h>
#endif

#include <mutex>

#include "io/isolated/isolated.h"
#include "io/plugin.h"
#include "io/plugins/netcdf/cf.h"
#include "io/plugins/netcdf/exodus.h"
#include "io/plugins/netcdf/minc.h"

namespace sg::nc {

namespace {

// What every child would do first, a few milliseconds of it, is done once before any of them is started.
void warm_up() {
#ifdef SG_QUIET_HDF5
  static std::once_flag once;
  std::call_once(once, [] { H5open(); });
#endif
}

// The library, and the HDF5 below it, follow numbers of a damaged file wherever they lead: it works in a process of its own, so that this
// one has no state of it either.
Data read(const std::string& path, const ReadOptions& options, Context& context) {
  check_classic(path);  // ours, and without a process
  warm_up();
  return read_isolated(
      path,
      [&](Context& c) -> Data {
        const NcFile file(path);
        if (is_exodus(file)) return read_exodus(file, options, c);
        if (is_minc(file)) return read_minc(file, options, c);
        return read_cf(file, options, c);
      },
      context);
}

std::vector<double> times(const std::string& path, const ReadOptions&, Context& context) {
  check_classic(path);  // ours, and without a process
  warm_up();
  return times_isolated(
      path,
      [&](Context&) -> std::vector<double> {
        const NcFile file(path);
        if (is_exodus(file)) return exodus_times(file);
        if (is_minc(file)) return minc_times(file);
        return cf_times(file);
      },
      context);
}

}  // namespace

}  // namespace sg::nc

SG_PLUGIN_FORMATS({"netcdf", sg::nc::read, nullptr, sg::nc::times})
