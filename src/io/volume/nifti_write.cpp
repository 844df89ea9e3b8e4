// SPDX-License-Identifier: Apache-2.0
// NIfTI-1 as one file, packed by gzip when the name ends in .gz. The grid goes into the sform; several components become the fifth
// axis, colours of 8 bits RGB voxels.
#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/file/file.h"
#include "base/text/text.h"
#include "io/bytes/inflate.h"
#include "io/formats.h"
#include "io/volume/nifti_header.h"
#include "io/write_losses.h"

namespace sg {

namespace {

template <class T>
void put(std::byte* header, size_t byte, T v) {
  std::memcpy(header + byte, &v, sizeof v);
}

std::string note(const Dataset& d, std::string_view key) {
  for (const auto& [k, v] : d.notes())
    if (k == key) return v;
  return "";
}

bool is_colors(const Field& f) {
  return f.array.type() == ElementType::u8 && f.role == Role::colors && (f.components() == 3 || f.components() == 4);
}

constexpr size_t header_bytes = 352;

void fill_header(std::byte* h, const Dataset& d, const UniformGrid& g, const Field& f) {
  const int n = f.components();
  const bool colors = is_colors(f), deep = n > 1 && !colors;
  put(h, 0, int32_t(348));
  const int16_t dim[8] = {
      int16_t(deep ? 5 : 3), int16_t(g.dims[0]), int16_t(g.dims[1]), int16_t(g.dims[2]), 1, int16_t(deep ? n : 1), 1, 1};
  for (size_t i = 0; i < 8; ++i) put(h, 40 + 2 * i, dim[i]);
  constexpr int16_t codes[] = {2, 256, 512, 4, 768, 8, 1280, 1024, 16, 64};  // in the order of ElementType
  put(h, 70, colors ? int16_t(n == 3 ? 128 : 2304) : codes[size_t(f.array.type())]);
  put(h, 72, int16_t(8 * element_size(f.array.type()) * size_t(colors ? n : 1)));
  if (deep) put(h, 68, int16_t(f.role == Role::tensors && n == 9 ? 1004 : 1007));
  else if (f.role == Role::labels) put(h, 68, int16_t(1002));
  put(h, 76, 1.0f);
  put(h, 108, float(header_bytes));
  put(h, 112, 1.0f);
  const std::string unit = note(d, "length unit");
  h[123] = std::byte(unit == "m" ? 1 : unit == "um" ? 3 : unit == "mm" ? 2 : 0);
  const std::string about = note(d, "description");
  std::memcpy(h + 148, about.data(), std::min<size_t>(about.size(), 79));
  put(h, 254, int16_t(1));
  for (int r = 0; r < 3; ++r) {
    for (int a = 0; a < 3; ++a) put(h, size_t(280 + 16 * r + 4 * a), float(g.direction.m[r][a] * g.spacing[a]));
    put(h, size_t(280 + 16 * r + 12), float(g.origin[r]));
    put(h, size_t(80 + 4 * r), float(std::abs(g.spacing[r]) * length(g.direction.column(r))));
  }
  put(h, 92, 1.0f);
  std::memcpy(h + 344, "n+1", 4);
}

}  // namespace

void write_nifti(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing NIfTI");
  const UniformGrid* grid = d->as<UniformGrid>();
  if (!grid)
    fail_usage(fmt::format("a NIfTI file holds a uniform grid, not a {} mesh", d->kind()), path, "resample it first: -f 'resample'");
  const std::string lower = to_lower(path);
  WriteLosses losses(path, "NIfTI");
  Field f = losses.one_point_field(*d, false);
  // Positions of no stated frame are taken as the patient's: read again they are the same numbers.
  const PatientAxes stated = patient_axes(stated_space(*d)).value_or(PatientAxes());
  PatientAxes axes = stated;
  for (int a = 0; a < 3; ++a) axes.sign[a] *= nifti_axes.sign[a];
  UniformGrid turned = *grid;
  turn(turned, axes);
  if (f.components() == 3 && !is_colors(f)) f.role = Role::vectors;  // as it will be read
  turn(f, f.role == Role::tensors ? axes.matrix() : stated.matrix());
  for (const size_t n : {grid->dims[0], grid->dims[1], grid->dims[2], size_t(f.components())})
    if (n > 32767)
      fail_usage(fmt::format("NIfTI-1 cannot hold {} entries along an axis; the limit is 32767", n), path, "write NRRD instead");

  losses.renames(f, "NIFTI");
  bool exact = true;
  for (int a = 0; a < 3; ++a) {
    const Vec3 step = grid->direction.column(a) * grid->spacing[a];
    for (const double x : {step.x, step.y, step.z, grid->origin[a]}) exact = exact && double(float(x)) == x;
  }
  if (!exact) losses.rounds("positions", ElementType::f64, ElementType::f32);

  std::byte header[header_bytes]{};
  fill_header(header, *d, turned, f);
  // Components other than colours are stored separately: one volume after the other.
  std::vector<Array> blocks;
  if (f.components() == 1 || is_colors(f)) blocks.push_back(f.array.made_packed());
  else
    for (int c = 0; c < f.components(); ++c) blocks.push_back(f.array.component(c).made_packed());
  AtomicFile file(path);
  if (lower.ends_with(".gz")) {
    std::vector<std::byte> all(header, header + header_bytes);
    for (const Array& a : blocks) all.insert(all.end(), a.raw(), a.raw() + a.bytes());
    const auto packed = pack_gzip(all);
    file.write(packed.data(), packed.size());
  } else {
    file.write(header, header_bytes);
    for (const Array& a : blocks) file.write(a.raw(), a.bytes());
  }
  file.commit();
  losses.tell(context);
}

}  // namespace sg
