// SPDX-License-Identifier: Apache-2.0
// Where slabs come from: files and datasets.
#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "io/formats.h"
#include "io/write_losses.h"
#include "io/zarr/zarr.h"

namespace sg {

namespace {

const Field& chosen_field(const Dataset& d, const ReadOptions& options, const std::string& path, Context& context) {
  if (!d.as<UniformGrid>())
    fail_usage(fmt::format("a {} mesh cannot be written as Zarr", d.kind()), path,
               "a Zarr image holds a uniform grid, so resample it first: -f 'resample ...'");
  const bool named = options.fields.size() == 1;
  const Field* chosen = named ? d.fields().find(options.fields[0], Association::point) : d.fields().active(0);
  if (chosen && chosen->association != Association::point) chosen = nullptr;
  for (const Field& f : d.fields())
    if (f.association == Association::point && !chosen) chosen = &f;
  if (!chosen) fail_usage("there is no point field to write", path, "a Zarr image holds point values of a grid; -f cell_to_point converts");
  WriteLosses losses(path, "one Zarr image (--fields chooses a field)");
  if (!named) losses.keeps_only(d, *chosen, true);
  losses.tell(context);
  return *chosen;
}

SlabSource described(const Dataset& d, const Field& f) {
  SlabSource s;
  s.grid = *d.as<UniformGrid>();
  s.type = f.array.type(), s.components = f.components();
  s.field = f.name, s.unit = f.unit, s.role = f.role;
  for (const auto& [key, value] : d.notes()) {
    if (key == "length unit") s.length_unit = value;
    if (key == "title") s.title = value;
  }
  return s;
}

}  // namespace

SlabSource slabs_of_dataset(const DatasetPtr& dataset, const std::string& path, Context& context) {
  const Field& f = chosen_field(*dataset, {}, path, context);
  SlabSource s = described(*dataset, f);
  s.slab = [dataset, array = f.array, slice = s.grid.dims[0] * s.grid.dims[1]](size_t first, size_t count) {
    return array.slice(first * slice, (first + count) * slice);
  };
  return s;
}

SlabSource slabs_of_file(const std::string& path, const ReadOptions& options, Context& context) {
  if (!(find_format(path, options).honours & honours_region))
    return slabs_of_dataset(single_dataset(read_data(path, options, context), path), path, context);
  ReadOptions look = options;
  look.header_only = true;
  const DatasetPtr header = single_dataset(read_data(path, look, context), path);
  const Field& f = chosen_field(*header, options, path, context);
  SlabSource s = described(*header, f);
  ReadOptions part = options;
  part.fields = {f.name};
  // What was chosen of the file counts in its own samples.
  const LatticeRegion outer = options.region;
  s.slab = [=, dims = s.grid.dims, &context](size_t first, size_t count) {
    ReadOptions one = part;
    one.region.stride = outer.stride;
    for (size_t a = 0; a < 3; ++a) one.region.lo[a] = outer.lo[a], one.region.hi[a] = outer.lo[a] + (dims[a] - 1) * outer.stride[a];
    one.region.lo[2] = outer.lo[2] + first * outer.stride[2], one.region.hi[2] = outer.lo[2] + (first + count - 1) * outer.stride[2];
    const DatasetPtr d = single_dataset(read_data(path, one, context), path);
    return d->fields().require(part.fields[0], Association::point).array;
  };
  return s;
}

void write_zarr(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  ZarrOptions o;
  o.chunk = size_t(options.chunk);
  if (options.compression.value_or(Compression::none) != Compression::none) o.compression = word_of(*options.compression);
  write_zarr_slabs(path, slabs_of_dataset(single_dataset(data, "writing Zarr"), path, context), o, context);
}

}  // namespace sg
