// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <set>

#include "base/error.h"
#include "base/text/text.h"
#include "io/options.h"
#include "io/stated_format.h"

namespace sg {

namespace {

std::vector<int64_t> integers(const std::array<size_t, 3>& n) { return {int64_t(n[0]), int64_t(n[1]), int64_t(n[2])}; }
bool is_open(const Value& v) { return std::holds_alternative<std::monostate>(v); }

// Views of members that other layers use as they are.
struct IntegersView {
  static constexpr ParamType type = ParamType::integers;
  static constexpr bool optional = true;
};
struct DimsView : IntegersView {
  static Value get(const std::array<size_t, 3>& dims) { return dims[0] > 0 ? Value(integers(dims)) : Value(); }
  static void set(std::array<size_t, 3>& dims, const Value& v) {
    for (size_t a = 0; a < 3; ++a) dims[a] = is_open(v) ? 0 : size_t(std::get<std::vector<int64_t>>(v)[a]);
  }
};
struct BoxView : IntegersView {
  static Value get(const LatticeRegion& r) {
    if (r.lo == LatticeRegion().lo && r.hi == LatticeRegion().hi) return {};
    std::vector<int64_t> ends;
    for (size_t a = 0; a < 3; ++a) ends.push_back(int64_t(r.lo[a])), ends.push_back(int64_t(std::min<size_t>(r.hi[a], INT64_MAX)));
    return ends;
  }
  static void set(LatticeRegion& r, const Value& v) {
    r.lo = LatticeRegion().lo, r.hi = LatticeRegion().hi;
    if (is_open(v)) return;
    const auto& ends = std::get<std::vector<int64_t>>(v);
    for (size_t a = 0; a < 3; ++a) r.lo[a] = size_t(ends[2 * a]), r.hi[a] = size_t(ends[2 * a + 1]);
  }
};
struct StrideView : IntegersView {
  static Value get(const LatticeRegion& r) { return r.stride == LatticeRegion().stride ? Value() : Value(integers(r.stride)); }
  static void set(LatticeRegion& r, const Value& v) {
    r.stride = LatticeRegion().stride;
    if (is_open(v)) return;
    const auto& n = std::get<std::vector<int64_t>>(v);
    if (n.size() == 2) fail_usage("needs one or three numbers, not 2", "stride", "write e.g. 2 or 2,2,1");
    for (size_t a = 0; a < 3; ++a) r.stride[a] = size_t(n[n.size() == 3 ? a : 0]);
  }
};

void describe_path(Schema& s, ReadParams& p) {
  s("path", p.path,
    "File to read; its format is detected from its content. Several files form one time series: flow_{n}.vtk ({n}: a number), flow_*.vtk, "
    "or a list.")
      .unit("file")
      .required();
}

void describe_format(Schema& s, ReadOptions& p) {
  s("format", p.format,
    "Format of what is read, by one of its extensions (obj, csv, nii.gz) or its name; default: detected from the content, then the name.");
}

void describe_fields(Schema& s, ReadOptions& p) { s("fields", p.fields, "Fields to load; default: those needed."); }

void describe_parts(Schema& s, ReadOptions& p) {
  s("time", p.time, "Of a series: read the step nearest to this time.");
  s("step", p.step, "Of a series: read this step, counted from 0; -1: by time, else the format's default.").at_least(-1);
  s("times", p.times, "Of several files as a series: their times, as START:STEP or a list; default: those in the files, else 0, 1, 2, ...")
      .unit("time");
  s.view<BoxView>("region", p.region, "Of a grid: first and last point to read along x, y, z: i0,i1,j0,j1,k0,k1, counted from 0.")
      .at_least(0)
      .items(6);
  s.view<StrideView>("stride", p.region, "Of a grid: read every n-th point, one number or one per axis.").at_least(1).items(1, 3);
  s("piece", p.piece, "Piece to read, counted from 0.").at_least(0);
  s("pieces", p.pieces, "Number of pieces into which the data is split.").range(1, 1000000);
  s("ghost_levels", p.ghost_levels, "Layers of neighbouring cells to add, marked as ghosts.").range(0, 1000);
}

}  // namespace

void describe_raw(Schema& s, ReadOptions& p) {
  s.view<DimsView>("dims", p.raw_dims, "Raw bricks: number of points along x, y, z.").at_least(1).items(3);
  s("type", p.raw_type, "Raw bricks: number type: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64.");
  s("big_endian", p.raw_big_endian, "Raw bricks: numbers are big-endian.");
  s("header", p.raw_header, "Raw bricks: bytes to skip before the numbers.").at_least(0);
  s("components", p.raw_components, "Raw bricks: components per point.").at_least(1);
  s("spacing", p.raw_spacing, "Raw bricks: spacing of the points along x, y, z.").positive();
}

void describe_csv(Schema& s, ReadOptions& p) {
  s("csv_header", p.csv_header, "Delimited text: whether the first line names the columns; auto: judged by its cells.");
}

void describe(Schema& s, ReadOptions& p) {
  describe_format(s, p);
  describe_fields(s, p);
  std::set<void (*)(Schema&, ReadOptions&)> described;  // formats may share their options
  for (const Format& f : formats())
    if (f.describe_read && described.insert(f.describe_read).second) f.describe_read(s, p);
  describe_parts(s, p);
}

void describe(Schema& s, ReadParams& p) { describe_path(s, p), describe(s, p.options); }

void describe(Schema& s, ReadParams& p, const Format& format) {
  describe_path(s, p), describe_fields(s, p.options);
  if (format.describe_read) format.describe_read(s, p.options);
  describe_parts(s, p.options);
}

void check(const ReadOptions& o) {
  check_stated_format(o.format);
  ElementType ignored;
  if (!o.raw_type.empty() && !parse_element_type(o.raw_type, ignored))
    fail_usage(fmt::format("'{}' is not a number type", o.raw_type), "read type", "available: u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
  if (o.raw_dims[0] > 0 && o.raw_type.empty())
    fail_usage("a raw brick needs a number type", "read type", "give one of u8 i8 u16 i16 u32 i32 u64 i64 f32 f64");
  for (size_t a = 0; a < 3; ++a)
    if (o.region.lo[a] > o.region.hi[a])
      fail_usage(fmt::format("begins at {} and ends at {}", o.region.lo[a], o.region.hi[a]), "read region",
                 "give first,last along x, y, z");
  if (o.piece >= o.pieces) fail_usage(fmt::format("there is no piece {} of {}", o.piece, o.pieces), "read piece", "pieces count from 0");
}

std::vector<std::string> read_words(const std::string& path, const ReadOptions& options) {
  return changed_words(param_set_of(ReadParams{path, options}));
}

}  // namespace sg
