// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/netcdf/minc.h"

#include <netcdf.h>

#include <algorithm>
#include <tuple>

#include "base/text/text.h"
#include "io/minc/minc_volume.h"

namespace sg::nc {

namespace {

minc::Dimension dimension_of(const NcFile& file, const std::string& name, size_t length) {
  minc::Dimension d{name, length, {}, {}, {}, false};
  const Variable* v = file.find(name);
  if (!v) return d;
  d.start = file.number(v, "start"), d.step = file.number(v, "step");
  if (const auto c = file.numbers(v, "direction_cosines"); c.size() == 3) d.cosines = Vec3(c[0], c[1], c[2]);
  d.irregular = file.text(v, "spacing").starts_with("irregular");
  return d;
}

// Stored numbers with the sign given by "signtype": netCDF's types are signed, MINC's bytes are not.
ElementType with_sign(const NcFile& file, const Variable& image) {
  const ElementType t = image.element();
  const std::string sign = file.text(&image, "signtype");
  const bool is_unsigned = sign.empty() ? image.type == NC_BYTE : sign.starts_with("unsigned");
  if (!is_unsigned) return t;
  return t == ElementType::i8 ? ElementType::u8 : t == ElementType::i16 ? ElementType::u16 : t == ElementType::i32 ? ElementType::u32 : t;
}

// Real values of slices: numbers over the slowest dimensions of the image.
void add_ranges(const NcFile& file, const Variable& image, minc::Volume& out) {
  if (const auto r = file.numbers(&image, "valid_range"); r.size() == 2) std::tie(out.valid_min, out.valid_max) = std::minmax(r[0], r[1]);
  if (const auto v = file.number(&image, "valid_min")) out.valid_min = v;
  if (const auto v = file.number(&image, "valid_max")) out.valid_max = v;
  const Variable *low = file.find("image-min"), *high = file.find("image-max");
  if (is_float(out.type) || !low || !high || !low->is_number() || !high->is_number() || low->dims != high->dims) return;
  for (size_t k = 0; k < low->dims.size(); ++k)
    if (k >= image.dims.size() || low->dims[k] != image.dims[k])
      file.fail("must have the slowest dimensions of 'image'", low->name, "expected one number per slice");
  out.scaled_dims = low->dims.size();
  out.min = file.doubles(*low), out.max = file.doubles(*high);
}

minc::Volume volume_of(const NcFile& file, bool with_ranges) {
  const Variable& image = file.require("image");
  minc::Volume v;
  v.path = file.path();
  for (size_t k = 0; k < image.dims.size(); ++k)
    v.dims.push_back(dimension_of(file, file.dimensions()[size_t(image.dims[k])].name, image.shape[k]));
  for (const char* s : minc::spaces)
    if (std::none_of(v.dims.begin(), v.dims.end(), [&](const minc::Dimension& d) { return d.name == s; }) && file.find(s))
      v.others.push_back(dimension_of(file, s, 1));
  v.type = with_sign(file, image);
  if (with_ranges) add_ranges(file, image, v);
  v.unit = file.text(&image, "units");
  if (const Variable* study = file.find("study")) v.modality = minc::modality_word(file.text(study, "modality"));
  for (const char* name : {"history", "title"})
    if (std::string text = file.text(nullptr, name); !text.empty()) v.notes.emplace_back(name, std::move(text));
  v.read = [&file, &image, type = v.type](const std::vector<size_t>& start, const std::vector<size_t>& count) {
    const Array read = file.read(image, start, count, image.element());
    return Array(read.buffer(), type, read.count());
  };
  return v;
}

}  // namespace

bool is_minc(const NcFile& file) {
  const Variable* image = file.find("image");
  if (!image || !image->is_number()) return false;
  for (const char* s : minc::spaces)
    if (file.dim(s)) return true;
  return file.find("rootvariable") != nullptr;
}

Data read_minc(const NcFile& file, const ReadOptions& options, Context& context) {
  return minc::read_volume(volume_of(file, !options.header_only), options, context);
}

std::vector<double> minc_times(const NcFile& file) { return minc::times_of(volume_of(file, false)); }

}  // namespace sg::nc
