// SPDX-License-Identifier: Apache-2.0
// MINC 2, writing: what libminc and its tools look for, in the frame of MINC (right, anterior, superior).
#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "io/minc/minc_volume.h"
#include "io/plugins/hdf5/h5_write.h"
#include "io/plugins/hdf5/minc/minc_2.h"
#include "io/scan/scan_to_write.h"
#include "io/volume/nifti_header.h"

namespace sg::minc {

namespace {

void add_words(h5::Writer& w, const std::string& object, const char* kind) {
  w.text(object, "varid", "MINC standard variable");
  w.text(object, "vartype", kind);
  w.text(object, "version", "MINC Version    1.0");
}

// Which direction of space each axis of a grid is named after: the nearest one that is free, the clearest first.
std::array<int, 3> names_of_axes(const Mat3& direction) {
  std::array<int, 3> space{0, 1, 2};
  const std::string letters = axis_letters(direction);
  for (size_t a = 0; a < 3; ++a) space[a] = letters[a] == 'L' || letters[a] == 'R' ? 0 : letters[a] == 'A' || letters[a] == 'P' ? 1 : 2;
  return space;
}

// Directions are positive along the axis of their name, as MINC's are; the sign is that of the step.
void write_dimensions(h5::Writer& w, const UniformGrid& g, const std::array<int, 3>& space, int components) {
  Mat3 cosines;
  Vec3 steps;
  for (int a = 0; a < 3; ++a) {
    const Vec3 step = g.direction.column(a) * g.spacing[a];
    const double size = length(step), sign = step[space[size_t(a)]] < 0 ? -1 : 1;
    if (!(size > 0)) fail_usage(fmt::format("the spacing along axis {} is 0, which MINC cannot hold", a), w.path());
    steps[a] = sign * size;
    for (int r = 0; r < 3; ++r) cosines.m[r][a] = step[r] / steps[a];
  }
  const Vec3 start = inverse(cosines) * g.origin;
  w.group(root + "/dimensions");
  for (int a = 2; a >= 0; --a) {
    const std::string at = root + "/dimensions/" + spaces[space[size_t(a)]];
    w.array(at, Array::from_vector(std::vector<int32_t>{0}), {});
    add_words(w, at, "dimension____");
    w.number<uint32_t>(at, "length", uint32_t(g.dims[size_t(a)]));
    w.text(at, "spacing", "regular__");
    w.text(at, "alignment", "centre");
    w.text(at, "units", "mm");
    w.number<double>(at, "start", start[a]);
    w.number<double>(at, "step", steps[a]);
    w.numbers<double>(at, "direction_cosines", {cosines.m[0][a], cosines.m[1][a], cosines.m[2][a]});
  }
  if (components == 1) return;
  const std::string at = root + "/dimensions/vector_dimension";
  w.array(at, Array::from_vector(std::vector<int32_t>{0}), {});
  w.number<uint32_t>(at, "length", uint32_t(components));
}

// Stored numbers that are their own real values: the range of each is that of the type, or of the numbers.
std::pair<double, double> range_of(const Array& a) {
  if (!is_float(a.type())) return minc::type_range(a.type());
  Range all;
  for (const Range& r : field_stats(a).range) all.add(r);
  return all.empty() ? std::pair(0.0, 0.0) : std::pair(all.lo, all.hi);
}

}  // namespace

void write_minc_2(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const Compression compression = options.compression.value_or(Compression::none);
  if (compression != Compression::none && compression != Compression::zlib)
    fail_usage(fmt::format("MINC files cannot be compressed with '{}'", word_of(compression)), path, "use zlib or none");
  WriteLosses losses(path, "MINC");
  ScanToWrite scan = scan_to_write(data, path, "MINC", nifti_axes, Several::three_are_vectors, true, losses);
  for (const size_t n : scan.grid.dims)
    if (n > UINT32_MAX) fail_usage(fmt::format("MINC cannot hold {} voxels along an axis", n), path);
  losses.renames(scan.field, "image");
  Array values = scan.field.array;
  if (values.type() == ElementType::i64 || values.type() == ElementType::u64) {
    losses.rounds(scan.field, ElementType::f64);
    values = values.converted(ElementType::f64);
  }
  const int components = scan.field.components();
  const h5::Turn turn;
  h5::Writer w(path, compression == Compression::zlib, context);
  w.group(root);
  w.text(root, "minc_version", "2.0");
  if (const std::string history = scan.note("history"); !history.empty()) w.text(root, "history", history.substr(0, 60000));
  const std::array<int, 3> space = names_of_axes(scan.grid.direction);
  write_dimensions(w, scan.grid, space, components);
  w.group(root + "/info");
  if (const std::string word = minc_modality(scan.modality()); !word.empty()) {
    w.array(root + "/info/study", Array::from_vector(std::vector<int32_t>{0}), {});
    add_words(w, root + "/info/study", "group________");
    w.text(root + "/info/study", "modality", word);
  }
  w.group(root + "/image");
  w.group(root + "/image/0");
  std::vector<hsize_t> dims;
  std::string order;
  for (size_t a = 3; a-- > 0;) dims.push_back(scan.grid.dims[a]), order += (order.empty() ? "" : ",") + std::string(spaces[space[a]]);
  if (components > 1) dims.push_back(hsize_t(components)), order += ",vector_dimension";
  w.array(image_path, values, dims);
  add_words(w, image_path, "group________");
  w.text(image_path, "dimorder", order);
  w.text(image_path, "complete", "true_");
  if (!scan.field.unit.empty()) w.text(image_path, "units", scan.field.unit);
  const auto [lo, hi] = range_of(values);
  w.numbers<double>(image_path, "valid_range", {lo, hi});
  for (const auto& [name, value] : {std::pair("-min", lo), std::pair("-max", hi)}) {
    w.array(image_path + name, Array::from_vector(std::vector<double>{value}), {});
    add_words(w, image_path + name, "var_attribute");
  }
  w.commit();
  losses.tell(context);
}

}  // namespace sg::minc
