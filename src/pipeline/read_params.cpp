// SPDX-License-Identifier: Apache-2.0
#include "pipeline/read_params.h"

namespace sg {

void describe(Schema& s, ReadParams& p) {
  s("path", p.path, "File to read; its format is found from its content.");
  s("fields", p.fields, "Fields to load; default: those that are needed.");
  s("dims", p.dims, "Raw bricks: points along x, y, z.").at_least(1);
  s("type", p.type, "Raw bricks: type of the numbers, like u8, u16 or f32.");
  s("big_endian", p.big_endian, "Raw bricks: the numbers have their high byte first.");
  s("header", p.header, "Raw bricks: bytes to skip before the numbers.").at_least(0);
  s("components", p.components, "Raw bricks: numbers per point.").at_least(1);
  s("spacing", p.spacing, "Raw bricks: distance of the points along x, y, z.").positive();
}

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
  return o;
}

}  // namespace sg
