// SPDX-License-Identifier: Apache-2.0
// DICOM, writing: a volume as one multi-frame file of secondary capture (PS3.3 A.8.4 and A.8.5), in explicit VR little endian. Its place
// stands in the functional groups: orientation and spacing for all frames, a position for each. What the data do not tell
// (patient, dates) stays empty. Identifiers are made of the content: the same data give the same bytes.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include <xxhash.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "data/patient/modality.h"
#include "io/formats.h"
#include "io/scan/dicom_encoder.h"
#include "io/scan/dicom_stored.h"
#include "io/scan/scan_to_write.h"

namespace sg {

namespace {

constexpr std::string_view gray_class = "1.2.840.10008.5.1.4.1.1.7.3", color_class = "1.2.840.10008.5.1.4.1.1.7.4",
                           explicit_little = "1.2.840.10008.1.2.1";

struct DicomGeometry {
  Vec3 row, column;  ///< unit directions of increasing column and row numbers
  double between_columns = 1, between_rows = 1, between_slices = 1;
  std::vector<Vec3> positions;  ///< of the first voxel of each frame
};

DicomGeometry geometry_of(const UniformGrid& g, const std::string& path) {
  constexpr double right_angle = 1e-4;
  Vec3 step[3];
  for (int a = 0; a < 3; ++a) {
    step[a] = g.direction.column(a) * g.spacing[a];
    if (!(length(step[a]) > 0)) fail_usage(fmt::format("the spacing along axis {} is 0, which DICOM cannot hold", a), path);
  }
  DicomGeometry d;
  d.between_columns = length(step[0]), d.between_rows = length(step[1]), d.between_slices = length(step[2]);
  d.row = step[0] / d.between_columns, d.column = step[1] / d.between_rows;
  if (std::abs(dot(d.row, d.column)) > right_angle)
    fail_usage("rows and columns are not at right angles, as DICOM wants them", path, "resample it first: -f 'resample'");
  for (size_t k = 0; k < g.dims[2]; ++k) d.positions.push_back(g.origin + step[2] * double(k));
  return d;
}

// A text as DICOM's short ones are: one line without backslashes.
std::string one_line(std::string text, size_t most) {
  for (char& c : text)
    if (c == '\\' || static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = ' ';
  return std::string(trim(std::string_view(text).substr(0, most)));
}

DicomEncoder orientation_item(const DicomGeometry& g) {
  DicomEncoder e;
  e.numbers(0x00200037, {g.row.x, g.row.y, g.row.z, g.column.x, g.column.y, g.column.z});
  return e;
}

DicomEncoder measures_item(const DicomGeometry& g) {
  DicomEncoder e;
  e.numbers(0x00180050, {g.between_slices});
  e.numbers(0x00180088, {g.between_slices});
  e.numbers(0x00280030, {g.between_rows, g.between_columns});
  return e;
}

DicomEncoder frame_item(const Vec3& position) {
  DicomEncoder place, e;
  place.numbers(0x00200032, {position.x, position.y, position.z});
  e.sequence(0x00209113, {place});
  return e;
}

/// Identifiers of a file: each is made of all of its content and of what it names.
class Identifiers {
 public:
  Identifiers(const std::string& description, const Array& numbers) {
    const XXH128_hash_t a = XXH3_128bits(description.data(), description.size()), b = XXH3_128bits(numbers.raw(), numbers.bytes());
    content_ = fmt::format("{:016x}{:016x}{:016x}{:016x}", a.high64, a.low64, b.high64, b.low64);
  }
  std::string of(std::string_view what) const {
    const std::string all = content_ + std::string(what);
    const XXH128_hash_t h = XXH3_128bits(all.data(), all.size());
    return dicom_uid(h.high64, h.low64);
  }

 private:
  std::string content_;
};

std::string meta_group(std::string_view sop_class, const std::string& instance) {
  DicomEncoder rest;
  rest.bytes(0x00020001, "OB", std::string_view("\0\1", 2));
  rest.text(0x00020002, "UI", sop_class);
  rest.text(0x00020003, "UI", instance);
  rest.text(0x00020010, "UI", explicit_little);
  rest.text(0x00020012, "UI", dicom_uid(0x5347000000000000, 1));  // this program's kind of file
  rest.text(0x00020013, "SH", "SIGHTGLASS");
  DicomEncoder length;
  const uint32_t bytes[1] = {uint32_t(rest.data().size())};
  length.long_whole(0x00020000, bytes);
  return std::string(128, '\0') + "DICM" + length.data() + rest.data();
}

struct DicomPixels {
  Array numbers;                      ///< packed
  std::optional<DicomStored> stored;  ///< of gray values
};

DicomPixels pixels_of(const ScanToWrite& scan, const std::string& path, WriteLosses& losses) {
  const Field& f = scan.field;
  if (scan.is_colors()) {
    if (f.components() == 3) return {f.array.made_packed(), {}};
    losses.also(fmt::format("drops the opacity of '{}'", f.name));
    std::byte* out = nullptr;
    Array rgb = Array::make_raw(ElementType::u8, f.array.count(), 3, &out);
    const auto v = f.array.view<uint8_t>();
    for (size_t i = 0; i < v.count; ++i)
      for (int c = 0; c < 3; ++c) out[3 * i + size_t(c)] = std::byte(v(i, c));
    return {rgb, {}};
  }
  if (f.components() > 1)
    fail_usage(fmt::format("DICOM files hold one number per voxel or colours, but '{}' has {} components", f.name, f.components()), path,
               "write .nii or .nrrd");
  DicomStored s = dicom_stored(f.array);
  if (!s.exact) losses.also(fmt::format("rounds '{}' to steps of {}", f.name, short_number(s.slope, 3)));
  if (s.missing > 0) losses.also(fmt::format("replaces {} numbers of '{}' that are not finite", s.missing, f.name));
  const Array numbers = s.numbers;
  return {numbers, std::move(s)};
}

}  // namespace

void write_dicom(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  WriteLosses losses(path, "DICOM");
  const ScanToWrite scan = scan_to_write(data, path, "DICOM", PatientAxes(), Several::numbers, true, losses);
  const bool hounsfield = equal_ignoring_case(scan.field.unit, "HU");
  if (!hounsfield) losses.drops_unit(scan.field);
  losses.renames(scan.field, "DICOMImage");
  const auto& dims = scan.grid.dims;
  if (dims[0] > UINT16_MAX || dims[1] > UINT16_MAX)
    fail_usage(fmt::format("DICOM cannot hold pictures of {} x {} pixels; the limit is 65535", dims[0], dims[1]), path, "write .nrrd");
  const DicomGeometry geometry = geometry_of(scan.grid, path);
  const DicomPixels pixels = pixels_of(scan, path, losses);
  if (pixels.numbers.bytes() >= 0xfffffffe)
    fail_usage(fmt::format("DICOM cannot hold {} bytes of numbers; the limit is 4 GiB", pixels.numbers.bytes()), path, "write .nrrd");
  const bool gray = pixels.stored.has_value();

  // Functional groups: first, since identifiers are made of them too.
  DicomEncoder shared;
  shared.sequence(0x00209116, {orientation_item(geometry)});
  shared.sequence(0x00289110, {measures_item(geometry)});
  std::vector<DicomEncoder> frames;
  for (const Vec3& position : geometry.positions) frames.push_back(frame_item(position));
  DicomEncoder groups;
  groups.sequence(0x52009229, {shared});
  groups.sequence(0x52009230, frames);

  const std::string modality = scan.modality(), described = one_line(scan.note("SeriesDescription"), 64);
  std::string content = fmt::format("{} {} {} {} {} ", dims[0], dims[1], dims[2], modality, described) + groups.data();
  if (gray) content += fmt::format(" {} {}", pixels.stored->slope, pixels.stored->intercept);
  const Identifiers uid(content, pixels.numbers);
  const std::string_view sop_class = gray ? gray_class : color_class;
  const std::string instance = uid.of("instance");

  DicomEncoder e;
  e.text(0x00080008, "CS", "DERIVED\\SECONDARY");
  e.text(0x00080016, "UI", sop_class);
  e.text(0x00080018, "UI", instance);
  for (const auto& [tag, vr] : {std::pair(0x00080020u, "DA"), {0x00080030u, "TM"}, {0x00080050u, "SH"}}) e.text(tag, vr, "");
  e.text(0x00080060, "CS", modality.empty() ? "OT" : modality);
  e.text(0x00080064, "CS", "WSD");
  e.text(0x00080070, "LO", "Sightglass");
  e.text(0x00080090, "PN", "");
  if (!described.empty()) e.text(0x0008103e, "LO", described);
  for (const auto& [tag, vr] : {std::pair(0x00100010u, "PN"), {0x00100020u, "LO"}, {0x00100030u, "DA"}, {0x00100040u, "CS"}})
    e.text(tag, vr, "");
  if (const std::string part = one_line(scan.note("BodyPartExamined"), 16); !part.empty()) e.text(0x00180015, "CS", part);
  if (const std::string lies = one_line(scan.note("PatientPosition"), 16); !lies.empty()) e.text(0x00185100, "CS", lies);
  e.text(0x0020000d, "UI", uid.of("study"));
  e.text(0x0020000e, "UI", uid.of("series"));
  e.text(0x00200010, "SH", "");
  e.text(0x00200011, "IS", "1");
  e.text(0x00200013, "IS", "1");
  e.text(0x00200020, "CS", "");
  e.text(0x00200052, "UI", uid.of("frame of reference"));
  e.text(0x00200060, "CS", "");
  e.text(0x00201040, "LO", "");
  e.whole(0x00280002, gray ? 1 : 3);
  e.text(0x00280004, "CS", gray ? "MONOCHROME2" : "RGB");
  if (!gray) e.whole(0x00280006, 0);
  e.text(0x00280008, "IS", std::to_string(dims[2]));
  e.pointer(0x00280009, 0x52009230);  // frames are told apart by their groups
  e.whole(0x00280010, uint16_t(dims[1]));
  e.whole(0x00280011, uint16_t(dims[0]));
  const int bits = gray ? pixels.stored->bits : 8;
  e.whole(0x00280100, gray ? 16 : 8);
  e.whole(0x00280101, uint16_t(bits));
  e.whole(0x00280102, uint16_t(bits - 1));
  e.whole(0x00280103, 0);
  e.text(0x00280301, "CS", "NO");
  if (const Range window = stated_window(*scan.data); gray && !window.empty()) {
    e.numbers(0x00281050, {0.5 * (window.lo + window.hi)});
    e.numbers(0x00281051, {window.hi - window.lo});
  }
  if (gray) {
    e.numbers(0x00281052, {pixels.stored->intercept});
    e.numbers(0x00281053, {pixels.stored->slope});
    e.text(0x00281054, "LO", hounsfield ? "HU" : "US");
    e.text(0x20500020, "CS", "IDENTITY");
  }

  const bool odd = pixels.numbers.bytes() % 2;
  DicomEncoder head;
  head.wide_head(0x7fe00010, gray ? "OW" : "OB", uint32_t(pixels.numbers.bytes() + odd));
  AtomicFile file(path);
  file.write(meta_group(sop_class, instance));
  file.write(e.data());
  file.write(groups.data());
  file.write(head.data());
  file.write(pixels.numbers.raw(), pixels.numbers.bytes());
  if (odd) file.write(std::string_view("\0", 1));
  file.commit();
  losses.tell(context);
}

}  // namespace sg
