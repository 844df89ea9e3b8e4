// SPDX-License-Identifier: Apache-2.0
// Raw bricks: numbers without a header, described by the caller.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "io/formats.h"
#include "io/volume/brick.h"
#include "io/volume/raw_guess.h"

namespace sg {

namespace {

// Without a word from the caller: what the name and the length imply, reported as a warning.
ReadOptions described(const std::string& path, ReadOptions o, Context& context) {
  if (o.raw_dims[0] > 0) return o;
  const auto guess = guess_raw(MappedFile(path));
  if (!guess) fail_usage("the size of a raw brick is unknown", path, "give --dims NX,NY,NZ and --type, e.g. --dims 256,256,94 --type i16");
  o.raw_dims = guess->dims, o.raw_type = std::string(element_name(guess->type)), o.raw_big_endian = guess->big_endian;
  context.warn(fmt::format("{}: read as {}, judging by its name and length; override with --dims and --type", path, guess->text()));
  return o;
}

}  // namespace

Data read_raw(const std::string& path, const ReadOptions& given, Context& context) {
  const ReadOptions o = described(path, given, context);
  BrickLayout l;
  if (o.raw_type.empty()) fail_usage("the number type of a raw brick is unknown", path, "give --type u8, i16, u16, f32, ...");
  if (!parse_element_type(o.raw_type, l.type))
    fail_usage(fmt::format("unknown element type '{}'", o.raw_type), path, "supported: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
  if (o.raw_components < 1) fail_usage(fmt::format("{} components per voxel", o.raw_components), path, "give 1 or more");

  UniformGrid grid;
  for (size_t a = 0; a < 3; ++a) grid.dims[a] = std::max<size_t>(o.raw_dims[a], 1);
  grid.spacing = o.raw_spacing;
  l.count = checked_product({grid.dims[0], grid.dims[1], grid.dims[2]}, path);
  l.components = o.raw_components;
  l.big_endian = o.raw_big_endian;

  BrickPart file;
  file.file = MappedFile(path);
  file.begin = o.raw_header;
  uint64_t need = 0;
  const auto size = uint64_t(element_size(l.type));
  const std::string what = fmt::format("{}x{}x{} {}{}", grid.dims[0], grid.dims[1], grid.dims[2], element_name(l.type),
                                       l.components > 1 ? fmt::format(" x {}", l.components) : "");
  const uint64_t have = file.file.size() - std::min(file.file.size(), o.raw_header);
  if (!multiply(l.count, size * uint64_t(l.components), need) || need != have) {
    // A brick of a different size than stated nearly always means a wrong size or type: the message says what would fit.
    std::string hint = fmt::format("{} bytes are {} numbers of {}", have, have / size, element_name(l.type));
    if (have > need && need > 0) hint += fmt::format("; with a header of {} bytes it would fit", o.raw_header + (have - need));
    fail_data(fmt::format("{} needs {} bytes, but there are {}{}", what, need, have,
                          o.raw_header ? fmt::format(" after the header of {}", o.raw_header) : ""),
              path, hint);
  }
  DatasetParts parts;
  const LatticePart part = cut_grid(grid, o.region);
  parts.mesh = grid;
  const Role role = l.components == 3 && is_float(l.type) ? Role::vectors : Role::scalars;
  parts.fields.add({"values", Association::point, load_brick_part(l, part, {file}, context), "", role});
  return make_dataset(std::move(parts));
}

}  // namespace sg
