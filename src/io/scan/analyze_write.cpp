// SPDX-License-Identifier: Apache-2.0
// Analyze 7.5: a header of 348 bytes (.hdr) and the numbers beside it (.img). Written in the one order that all of its readers agree on
// (plane of slices 0, radiological): rows from the patient's right to the left, columns to the front, slices to the head. The place is kept
// as SPM keeps it, by the voxel at the origin.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/atomic_files.h"
#include "io/formats.h"
#include "io/scan/scan_to_write.h"

namespace sg {

namespace {

constexpr size_t analyze_header_bytes = 348;

template <class T>
void put_at(std::vector<std::byte>& header, size_t byte, T v) {
  std::memcpy(header.data() + byte, &v, sizeof v);
}

/// How axes of a grid become those of the file: file axis a runs along axis from[a] of the grid, backwards where flip[a].
struct AxisOrder {
  std::array<size_t, 3> from{0, 1, 2};
  std::array<bool, 3> flip{};
  double turned = 0;  ///< largest angle between an axis and that of the file, degrees
};

constexpr std::string_view file_letters = "LAS", opposite_letters = "RPI";

AxisOrder axis_order(const Mat3& direction) {
  AxisOrder o;
  const std::string letters = axis_letters(direction);
  for (size_t a = 0; a < 3; ++a)
    for (size_t g = 0; g < 3; ++g) {
      if (letters[g] != file_letters[a] && letters[g] != opposite_letters[a]) continue;
      o.from[a] = g, o.flip[a] = letters[g] == opposite_letters[a];
      const Vec3 d = direction.column(int(g));
      o.turned = std::max(o.turned, std::acos(std::clamp(std::abs(d[int(a)]) / length(d), 0.0, 1.0)) * 180 / M_PI);
    }
  return o;
}

Array in_order(const Array& values, const std::array<size_t, 3>& dims, const AxisOrder& o) {
  const Array in = values.made_packed();
  if (o.from == std::array<size_t, 3>{0, 1, 2} && o.flip == std::array<bool, 3>{}) return in;
  const size_t stride[3] = {1, dims[0], dims[0] * dims[1]}, size = element_size(in.type()) * size_t(in.components());
  std::byte* out = nullptr;
  Array r = Array::make_raw(in.type(), in.count(), in.components(), &out);
  const std::array<size_t, 3> n{dims[o.from[0]], dims[o.from[1]], dims[o.from[2]]};
  const auto along = [&](size_t a, size_t i) { return (o.flip[a] ? n[a] - 1 - i : i) * stride[o.from[a]]; };
  parallel_for(n[1] * n[2], 64, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const size_t from = along(1, row % n[1]) + along(2, row / n[1]);
      for (size_t i = 0; i < n[0]; ++i) std::memcpy(out + (row * n[0] + i) * size, in.raw() + (from + along(0, i)) * size, size);
    }
  });
  return r;
}

/// The numbers in a type that Analyze has, the smallest that keeps them.
Array in_analyze_type(const ScanToWrite& scan, WriteLosses& losses) {
  const Array& a = scan.field.array;
  using enum ElementType;
  for (const ElementType own : {u8, i16, i32, f32, f64})
    if (a.type() == own) return a;
  for (const ElementType wider : {i16, i32, f64})
    if (survives(a, wider)) return a.converted(wider);
  losses.rounds(scan.field, f64);
  return a.converted(f64);
}

int16_t analyze_type(const Array& a) {
  if (a.components() == 3) return 128;
  switch (a.type()) {
    case ElementType::u8: return 2;
    case ElementType::i16: return 4;
    case ElementType::i32: return 8;
    case ElementType::f32: return 16;
    default: return 64;
  }
}

// SPM's origin: the number, counted from 1, of the voxel at the origin along each axis, near the volume; none for others.
std::optional<std::array<int16_t, 3>> origin_voxel(const std::array<double, 3>& at, const std::array<size_t, 3>& n) {
  std::array<int16_t, 3> o;
  for (size_t a = 0; a < 3; ++a) {
    const double v = std::round(at[a]) + 1;
    if (!(v > -double(n[a]) && v < 2 * double(n[a]) && std::abs(v) <= INT16_MAX)) return {};
    o[a] = int16_t(v);
  }
  if (o == std::array<int16_t, 3>{}) return {};
  return o;
}

}  // namespace

void write_analyze(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  const std::string ending = to_lower(extension_of(path));
  if (ending != "hdr" && ending != "img") fail_usage("packed pairs can be read but not written", path, "name it .hdr or .img");
  WriteLosses losses(path, "Analyze");
  ScanToWrite scan = scan_to_write(data, path, "Analyze", PatientAxes(), Several::numbers, false, losses);
  if (scan.field.components() > 1 && !(scan.is_colors() && scan.field.components() == 3))
    fail_usage(fmt::format("Analyze files hold one number per voxel or colours of 3 bytes, but '{}' has {} components", scan.field.name,
                           scan.field.components()),
               path, "write .nii");
  losses.renames(scan.field, "NIFTI");

  const AxisOrder order = axis_order(scan.grid.direction);
  const Array values = in_order(in_analyze_type(scan, losses), scan.grid.dims, order);
  std::array<size_t, 3> n;
  std::array<double, 3> spacing, at;  // at: where the origin lies, in voxels
  for (size_t a = 0; a < 3; ++a) {
    const auto g = int(order.from[a]);
    n[a] = scan.grid.dims[size_t(g)];
    const Vec3 step = scan.grid.direction.column(g) * scan.grid.spacing[g];
    spacing[a] = length(step);
    if (n[a] > INT16_MAX)
      fail_usage(fmt::format("Analyze cannot hold {} voxels along an axis; the limit is 32767", n[a]), path, "write .nrrd");
  }
  // The middle of the volume keeps its place where axes are turned.
  const auto& g = scan.grid;
  Vec3 middle = g.origin;
  for (int a = 0; a < 3; ++a) middle = middle + g.direction.column(a) * (g.spacing[a] * 0.5 * double(g.dims[size_t(a)] - 1));
  const double sign[3] = {1, -1, 1};  // left, anterior, superior in the patient frame
  for (size_t a = 0; a < 3; ++a) at[a] = 0.5 * double(n[a] - 1) - sign[a] * middle[int(a)] / spacing[a];
  if (order.turned > 0.01) losses.also(fmt::format("drops a turn of {} degrees against the patient's axes", short_number(order.turned, 3)));
  const auto origin = origin_voxel(at, n);
  double moved = 0;
  for (size_t a = 0; origin && a < 3; ++a) moved = std::max(moved, std::abs(at[a] - (double((*origin)[a]) - 1)) * spacing[a]);
  if (!origin) losses.also("drops the origin");
  else if (moved > 1e-3) losses.also(fmt::format("moves the origin by {} mm, to a voxel", short_number(moved, 3)));

  std::vector<std::byte> header(analyze_header_bytes);
  put_at(header, 0, int32_t(analyze_header_bytes));
  put_at(header, 32, int32_t(16384));  // extents, as the format's description wants it
  header[38] = std::byte('r');         // all volumes are of one size
  const int16_t dim[5] = {4, int16_t(n[0]), int16_t(n[1]), int16_t(n[2]), 1};
  for (size_t i = 0; i < 5; ++i) put_at(header, 40 + 2 * i, dim[i]);
  std::memcpy(header.data() + 56, "mm", 2);
  put_at(header, 70, analyze_type(values));
  put_at(header, 72, int16_t(8 * element_size(values.type()) * size_t(values.components())));
  for (size_t a = 0; a < 3; ++a) put_at(header, 80 + 4 * a, float(spacing[a]));
  put_at(header, 112, 1.0f);  // SPM's factor of the numbers
  const std::string about = scan.note("description");
  std::memcpy(header.data() + 148, about.data(), std::min<size_t>(about.size(), 79));
  if (origin)
    for (size_t a = 0; a < 3; ++a) put_at(header, 253 + 2 * a, (*origin)[a]);

  const std::string stem = path.substr(0, path.size() - 3);
  AtomicFiles files({ending == "img" ? path : stem + "img", ending == "hdr" ? path : stem + "hdr"});
  files.write(0, values.raw(), values.bytes());
  files.write(1, header.data(), header.size());
  files.commit();
  losses.tell(context);
}

}  // namespace sg
