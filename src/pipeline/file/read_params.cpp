// SPDX-License-Identifier: Apache-2.0
#include "pipeline/file/read_params.h"

#include <fmt/core.h>

#include <algorithm>

namespace sg {

void describe(Schema& s, ReadParams& p) {
  s("path", p.path,
    "File to read; its format is found from its content. Several files as one series in time: flow_{n}.vtk ({n}: a number), flow_*.vtk, "
    "or a list.")
      .unit("file");
  s("fields", p.fields, "Fields to load; default: those that are needed.");
  s("dims", p.dims, "Raw bricks: points along x, y, z.").at_least(1);
  s("type", p.type, "Raw bricks: type of the numbers, like u8, u16 or f32.");
  s("big_endian", p.big_endian, "Raw bricks: the numbers have their high byte first.");
  s("header", p.header, "Raw bricks: bytes to skip before the numbers.").at_least(0);
  s("components", p.components, "Raw bricks: numbers per point.").at_least(1);
  s("spacing", p.spacing, "Raw bricks: distance of the points along x, y, z.").positive();
  s("csv_header", p.csv_header, "Delimited text: whether the first line names the columns; auto: by its cells.")
      .choices({"auto", "yes", "no"});
  s("time", p.time, "Of a series: the step nearest to this time.");
  s("step", p.step, "Of a series: this step, 0 is the first; -1: by time, else the format's default.").at_least(-1);
  s("times", p.times, "Of several files as a series: their times, START:STEP or a list; default: those in the files, else 0, 1, 2, ...")
      .unit("time");
  s("region", p.region, "Of a grid: first and last point along x, y, z: i0,i1,j0,j1,k0,k1, counted from 0.").at_least(0);
  s("stride", p.stride, "Of a grid: every n-th point, one number or one per axis.").at_least(1);
  s("piece", p.piece, "Which of the pieces, counted from 0.").at_least(0);
  s("pieces", p.pieces, "In how many pieces the data is cut.").at_least(1);
  s("ghost_levels", p.ghost_levels, "Layers of cells of neighbouring pieces, marked as ghosts.").at_least(0);
}

namespace {

LatticeRegion region_of(const ReadParams& p) {
  LatticeRegion r;
  if (!p.region.empty()) {
    if (p.region.size() != 6) fail_usage(fmt::format("needs six numbers, not {}", p.region.size()), "read region", "like 0,99,0,99,20,40");
    for (size_t a = 0; a < 3; ++a) {
      r.lo[a] = size_t(p.region[2 * a]), r.hi[a] = size_t(p.region[2 * a + 1]);
      if (r.lo[a] > r.hi[a])
        fail_usage(fmt::format("begins at {} and ends at {}", r.lo[a], r.hi[a]), "read region", "first,last along each axis");
    }
  }
  if (!p.stride.empty()) {
    if (p.stride.size() != 1 && p.stride.size() != 3)
      fail_usage(fmt::format("needs one or three numbers, not {}", p.stride.size()), "read stride", "like 2 or 2,2,1");
    for (size_t a = 0; a < 3; ++a) r.stride[a] = size_t(p.stride[p.stride.size() == 3 ? a : 0]);
  }
  return r;
}

}  // namespace

ReadOptions read_options(const ReadParams& p) {
  if (p.path.empty()) fail_usage("no file is named", "read path", "write read: FILE");
  ReadOptions o;
  o.fields = p.fields;
  if (!p.dims.empty()) {
    if (p.dims.size() != 3) fail_usage(fmt::format("needs three numbers, not {}", p.dims.size()), "read dims", "like 256,256,94");
    if (p.type.empty()) fail_usage("a raw brick needs the type of its numbers", "read type", "like u8, u16 or f32");
    for (int i = 0; i < 3; ++i) o.raw_dims[size_t(i)] = size_t(p.dims[size_t(i)]);
  }
  ElementType ignored;
  if (!p.type.empty() && !parse_element_type(p.type, ignored))
    fail_usage(fmt::format("'{}' is no type of numbers", p.type), "read type", "has: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
  o.raw_type = p.type;
  o.raw_big_endian = p.big_endian;
  o.raw_header = size_t(p.header);
  o.raw_components = p.components;
  o.raw_spacing = p.spacing;
  o.time = p.time;
  o.step = p.step;
  o.times = p.times;
  o.csv_header = p.csv_header;
  o.region = region_of(p);
  if (p.piece >= p.pieces) fail_usage(fmt::format("there is no piece {} of {}", p.piece, p.pieces), "read piece", "pieces count from 0");
  o.piece = p.piece, o.pieces = p.pieces, o.ghost_levels = p.ghost_levels;
  return o;
}

std::vector<std::string> read_words(const std::string& path, const ReadOptions& o) {
  ReadParams p;
  p.path = path;
  p.fields = o.fields;
  if (o.raw_dims[0] > 0) p.dims = {int64_t(o.raw_dims[0]), int64_t(o.raw_dims[1]), int64_t(o.raw_dims[2])};
  p.type = o.raw_type;
  p.big_endian = o.raw_big_endian;
  p.header = int64_t(o.raw_header);
  p.components = o.raw_components;
  p.csv_header = o.csv_header;
  p.spacing = o.raw_spacing;
  p.time = o.time;
  p.step = o.step;
  p.times = o.times;
  const LatticeRegion& r = o.region;
  if (r.lo != LatticeRegion().lo || r.hi != LatticeRegion().hi)
    for (size_t a = 0; a < 3; ++a)
      p.region.push_back(int64_t(r.lo[a])), p.region.push_back(int64_t(std::min<size_t>(r.hi[a], size_t(INT64_MAX))));
  if (r.stride != LatticeRegion().stride) p.stride = {int64_t(r.stride[0]), int64_t(r.stride[1]), int64_t(r.stride[2])};
  p.piece = o.piece, p.pieces = o.pieces, p.ghost_levels = o.ghost_levels;
  return changed_words(param_set_of(std::move(p)));
}

}  // namespace sg
