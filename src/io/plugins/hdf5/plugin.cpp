// SPDX-License-Identifier: Apache-2.0
// What the plug-in offers.
#include "io/plugin.h"

#include "base/parallel.h"
#include "io/plugins/hdf5/enzo.h"
#include "io/plugins/hdf5/minc/minc_2.h"
#include "io/plugins/hdf5/vtkhdf/vtkhdf.h"
#include "io/reading_budget.h"

namespace {

sg::PluginArray read_array(const std::string& path, const sg::PluginSelection& wanted, sg::Context&) {
  const sg::h5::Turn turn;
  const sg::h5::File file(path);
  const sg::h5::Dataset set(file, wanted.dataset.starts_with('/') ? wanted.dataset : "/" + wanted.dataset);
  const auto& d = set.dims();
  sg::PluginArray out;
  if (wanted.count.empty()) {
    out.dims.assign(d.begin(), d.end());
    out.values = set.read();
    return out;
  }
  const std::vector<uint64_t> start(wanted.start.begin(), wanted.start.end()), count(wanted.count.begin(), wanted.count.end()),
      stride(wanted.stride.begin(), wanted.stride.end());
  out.dims = wanted.count;
  out.values = set.read_block(start, count, stride);
  return out;
}

// The program's own budget does not see the arrays of a plug-in.
sg::Data read_vtkhdf(const std::string& path, const sg::ReadOptions& options, sg::Context& context) {
  sg::ReadingBudget budget(path, true);
  return sg::read_vtkhdf(path, options, context);
}
sg::Data read_enzo(const std::string& path, const sg::ReadOptions& options, sg::Context& context) {
  sg::ReadingBudget budget(path, true);
  return sg::read_enzo(path, options, context);
}
sg::Data read_minc(const std::string& path, const sg::ReadOptions& options, sg::Context& context) {
  sg::ReadingBudget budget(path, true);
  const sg::h5::Turn turn;
  return sg::minc::read_minc_2(sg::h5::File(path), options, context);
}
std::vector<double> times_of_minc(const std::string& path, const sg::ReadOptions&, sg::Context&) {
  const sg::h5::Turn turn;
  return sg::minc::minc_2_times(sg::h5::File(path));
}

}  // namespace

SG_PLUGIN_FORMATS({"vtkhdf", read_vtkhdf, sg::write_vtkhdf, sg::times_of_vtkhdf, nullptr, nullptr, sg::vtkhdf::write_steps},
                  {"enzo", read_enzo, nullptr, sg::times_of_enzo}, {"minc", read_minc, sg::minc::write_minc_2, times_of_minc},
                  {"array", nullptr, nullptr, nullptr, read_array})
