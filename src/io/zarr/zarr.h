// SPDX-License-Identifier: Apache-2.0
// Writing OME-Zarr (NGFF 0.4, Zarr 2) slab by slab: the volume is never in memory as a whole.
#pragma once
#include <functional>
#include <string>

#include "base/context.h"
#include "data/dataset.h"
#include "io/io.h"

namespace sg {

/// A field on a uniform grid that gives some slices at a time, in order.
struct SlabSource {
  UniformGrid grid;
  ElementType type = ElementType::f32;
  int components = 1;
  std::string field, unit, length_unit, title;
  Role role = Role::scalars;
  /// Packed tuples of slices first .. first+count-1. Called with growing `first`, without gaps.
  std::function<Array(size_t first, size_t count)> slab;
  size_t best_slab = 0;  ///< slices that are cheap to make at once; 0 = any number
};

struct ZarrOptions {
  size_t chunk = 64;                ///< samples along each axis
  std::string compression = "lz4";  ///< lz4, zstd, zlib or none
};

/// Writes chunks of all levels while the slabs come in, with the extremes of each 64^3 cells, into a temporary folder next to `path`, which
/// is renamed at the end. Level n+1 holds the means of 2x2x2 samples of level n (of those that are not NaN; labels: the most frequent, the
/// lowest of several); an axis is halved while it has more than 32 samples, until all have at most `chunk`. A folder `path` that is a Zarr
/// folder is replaced; anything else of that name is an Error(usage). Keeps about 2.5 slabs of `chunk` slices in memory: chunks are thinner
/// when context.memory_limit requires it. Throws Error(data) for a full disk.
void write_zarr_slabs(const std::string& path, const SlabSource& source, const ZarrOptions& options, Context& context);

namespace zarr {
/// A step of a series in one folder, whose first axis is time.
struct SeriesStep {
  size_t step = 0;
  double first = 0, interval = 1;  ///< the time of step 0, and between two
  std::string recipe;              ///< see StepsPlan
};
/// Writes the chunks of a step into the folder, which has those before it, and then says that they are there.
void write_step(const std::string& path, const SlabSource& source, const ZarrOptions& options, const SeriesStep& step, Context& context);
}  // namespace zarr

/// The field of a file as slabs: read part by part where the format can, else whole. One field: options.fields, or the active one. Throws
/// Error(usage) for what is not a uniform grid.
SlabSource slabs_of_file(const std::string& path, const ReadOptions& options, Context& context);
/// The same of a dataset in memory.
SlabSource slabs_of_dataset(const DatasetPtr& dataset, const std::string& path, Context& context);

}  // namespace sg
