// SPDX-License-Identifier: Apache-2.0
#include "io/volume/nifti_header.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/error.h"
#include "base/text/text.h"
#include "data/patient/patient_frame.h"
#include "io/volume/direction.h"

namespace sg {

namespace {

// The number at a byte of the header.
template <class T>
T at(std::span<const std::byte> b, size_t byte, bool big) {
  return load<T>(b.data() + byte, big);
}

std::string text_at(std::span<const std::byte> b, size_t byte, size_t n) {
  std::string s(reinterpret_cast<const char*>(b.data() + byte), n);
  s.resize(std::min(s.find('\0'), s.size()));
  for (char& c : s)
    if (static_cast<unsigned char>(c) < 32 || static_cast<unsigned char>(c) > 126) c = ' ';
  return std::string(trim(s));
}

bool magic_is(std::span<const std::byte> b, size_t byte, const char* magic, size_t n) {
  return std::memcmp(b.data() + byte, magic, n) == 0;
}

// 348 or 540 in either byte order; 0 = neither.
int header_size(std::span<const std::byte> b, bool& big) {
  if (b.size() < 348) return 0;
  for (const bool order : {false, true})
    if (const int n = at<int32_t>(b, 0, order); n == 348 || (n == 540 && b.size() >= 540)) return big = order, n;
  return 0;
}

void set_dims(NiftiHeader& h, const std::array<int64_t, 8>& dim, const std::string& where) {
  if (dim[0] < 0 || dim[0] > 7)
    fail_data(fmt::format("byte {}: {} dimensions", h.version == 2 ? 16 : 40, dim[0]), where, "dim[0] must be 0 to 7");
  h.stored_dims = int(dim[0]);
  // Some files of one voxel state 0 dimensions: then all sizes count.
  for (int a = 1; a <= (dim[0] ? int(dim[0]) : 7); ++a) {
    if (dim[size_t(a)] < 0) fail_data(fmt::format("dim[{}] is {}", a, dim[size_t(a)]), where, "sizes must be 1 or more");
    h.dims[size_t(a) - 1] = std::max<size_t>(size_t(dim[size_t(a)]), 1);
  }
}

void parse_1(NiftiHeader& h, std::span<const std::byte> b, const std::string& where) {
  const bool big = h.big_endian;
  std::array<int64_t, 8> dim;
  for (size_t i = 0; i < 8; ++i) dim[i] = at<int16_t>(b, 40 + 2 * i, big), h.pixdim[i] = at<float>(b, 76 + 4 * i, big);
  set_dims(h, dim, where);
  h.datatype = at<int16_t>(b, 70, big);
  const double begin = at<float>(b, 108, big);
  if (!(begin >= 0) || begin > 1e15) fail_data(fmt::format("byte 108: the data begins at byte {}", begin), where);
  h.data_begin = size_t(begin);
  h.description = text_at(b, 148, 80);
  h.orient = int(b[252]);
  if (h.version == 0)
    for (size_t a = 0; a < 3; ++a) h.origin_voxel[a] = at<int16_t>(b, 253 + 2 * a, big);
  if (h.version == 0) return;  // what follows has other meanings in Analyze, or none that are agreed on
  h.slope = at<float>(b, 112, big), h.intercept = at<float>(b, 116, big);
  h.units = int(b[123]);
  h.time_offset = at<float>(b, 136, big);
  h.qform_code = at<int16_t>(b, 252, big), h.sform_code = at<int16_t>(b, 254, big);
  for (size_t i = 0; i < 3; ++i) {
    h.quatern[i] = at<float>(b, 256 + 4 * i, big);
    h.qoffset[i] = at<float>(b, 268 + 4 * i, big);
    for (size_t j = 0; j < 4; ++j) h.srow[i][j] = at<float>(b, 280 + 16 * i + 4 * j, big);
  }
  h.intent = at<int16_t>(b, 68, big);
  h.intent_name = text_at(b, 328, 16);
}

void parse_2(NiftiHeader& h, std::span<const std::byte> b, const std::string& where) {
  const bool big = h.big_endian;
  std::array<int64_t, 8> dim;
  for (size_t i = 0; i < 8; ++i) dim[i] = at<int64_t>(b, 16 + 8 * i, big), h.pixdim[i] = at<double>(b, 104 + 8 * i, big);
  set_dims(h, dim, where);
  h.datatype = at<int16_t>(b, 12, big);
  const int64_t begin = at<int64_t>(b, 168, big);
  if (begin < 0) fail_data(fmt::format("byte 168: the data begins at byte {}", begin), where);
  h.data_begin = size_t(begin);
  h.slope = at<double>(b, 176, big), h.intercept = at<double>(b, 184, big);
  h.time_offset = at<double>(b, 216, big);
  h.description = text_at(b, 240, 80);
  h.qform_code = at<int32_t>(b, 344, big), h.sform_code = at<int32_t>(b, 348, big);
  for (size_t i = 0; i < 3; ++i) {
    h.quatern[i] = at<double>(b, 352 + 8 * i, big);
    h.qoffset[i] = at<double>(b, 376 + 8 * i, big);
    for (size_t j = 0; j < 4; ++j) h.srow[i][j] = at<double>(b, 400 + 32 * i + 8 * j, big);
  }
  h.units = at<int32_t>(b, 500, big);
  h.intent = at<int32_t>(b, 504, big);
  h.intent_name = text_at(b, 508, 16);
}

struct Form {
  bool good = false;
  Vec3 axis[3], origin;  // axis: the step from one voxel to the next
};

Form sform(const NiftiHeader& h) {
  Form f;
  for (int r = 0; r < 3; ++r) {
    for (int a = 0; a < 3; ++a) f.axis[a][r] = h.srow[r][a];
    f.origin[r] = h.srow[r][3];
  }
  return f;
}

Form qform(const NiftiHeader& h) {
  const double b = h.quatern[0], c = h.quatern[1], d = h.quatern[2], square = 1 - (b * b + c * c + d * d);
  double a = std::sqrt(std::max(square, 0.0)), s = 1;
  if (square < 1e-7) a = 0, s = 1 / std::sqrt(std::max(b * b + c * c + d * d, 1e-300));  // half a turn: a rounded unit vector
  const double qb = b * s, qc = c * s, qd = d * s;
  Form f;
  f.axis[0] = Vec3(a * a + qb * qb - qc * qc - qd * qd, 2 * (qb * qc + a * qd), 2 * (qb * qd - a * qc));
  f.axis[1] = Vec3(2 * (qb * qc - a * qd), a * a + qc * qc - qb * qb - qd * qd, 2 * (qc * qd + a * qb));
  f.axis[2] = Vec3(2 * (qb * qd + a * qc), 2 * (qc * qd - a * qb), a * a + qd * qd - qb * qb - qc * qc);
  for (int i = 0; i < 3; ++i) {
    const double size = std::abs(h.pixdim[size_t(i) + 1]);
    f.axis[i] = f.axis[i] * (size > 0 ? size : 1);
    f.origin[i] = h.qoffset[i];
  }
  if (h.pixdim[0] < 0) f.axis[2] = f.axis[2] * -1.0;
  return f;
}

bool usable(Form& f) {
  Mat3 m;
  for (int a = 0; a < 3; ++a) {
    const double l = length(f.axis[a]);
    if (!(l > 0) || !std::isfinite(l) || !std::isfinite(f.origin[a])) return false;
    for (int r = 0; r < 3; ++r) m.m[r][a] = f.axis[a][r] / l;
  }
  return std::abs(determinant(m)) > 1e-9;
}

std::string_view form_name(int code) {
  constexpr std::string_view names[] = {"none", "scanner", "aligned to another image", "Talairach", "MNI152", "another template"};
  return code >= 0 && code <= 5 ? names[code] : "unknown";
}

}  // namespace

bool is_nifti_header(std::span<const std::byte> b) {
  bool big = false;
  const int n = header_size(b, big);
  if (n == 540) return magic_is(b, 4, "n+2", 4) || magic_is(b, 4, "ni2", 4);
  if (n != 348) return false;
  if (magic_is(b, 344, "n+1", 4) || magic_is(b, 344, "ni1", 4)) return true;
  // Analyze has no magic: a size that fits, 1 to 7 positive sizes, a known type and its bits.
  const int dims = at<int16_t>(b, 40, big), type = at<int16_t>(b, 70, big);
  if (dims < 1 || dims > 7 || at<int16_t>(b, 42, big) < 1) return false;
  for (const int known : {2, 4, 8, 16, 32, 64, 128, 130, 132, 136})
    if (type == known) return true;
  return false;
}

NiftiHeader parse_nifti_header(std::span<const std::byte> b, const std::string& where) {
  NiftiHeader h;
  const int n = header_size(b, h.big_endian);
  if (n == 0)
    fail_data(b.size() < 348 ? fmt::format("a header of {} bytes", b.size()) : std::string("byte 0: not a valid header size"), where,
              "a NIfTI-1 or Analyze header has 348 bytes, a NIfTI-2 header 540, and begins with that number");
  if (n == 540) {
    h.version = 2;
    h.single_file = magic_is(b, 4, "n+2", 3);
    if (!h.single_file && !magic_is(b, 4, "ni2", 3)) fail_data("byte 4: neither 'n+2' nor 'ni2'", where);
    parse_2(h, b, where);
  } else {
    h.single_file = magic_is(b, 344, "n+1", 3);
    h.version = h.single_file || magic_is(b, 344, "ni1", 3) ? 1 : 0;
    parse_1(h, b, where);
  }
  if (h.single_file) h.data_begin = std::max<size_t>(h.data_begin, h.version == 2 ? 544 : 352);
  return h;
}

namespace {

// Analyze's byte 252 tells in which plane slices were stored and whether they are flipped; the axes in the patient frame as ITK reads them
// (RPI, RIP, PIR, RAI, RSP, PIL in its words, which name where an axis comes from). Other numbers count as 0, the usual radiological order:
// rows from the patient's right to the left.
Mat3 analyze_axes(int orient) {
  struct Axes {
    Vec3 i, j, k;
  };
  constexpr Vec3 left{1, 0, 0}, posterior{0, 1, 0}, anterior{0, -1, 0}, superior{0, 0, 1}, inferior{0, 0, -1}, right{-1, 0, 0};
  constexpr Axes table[6] = {{left, anterior, superior},  {left, superior, anterior}, {anterior, superior, left},
                             {left, posterior, superior}, {left, inferior, anterior}, {anterior, superior, right}};
  const Axes& a = table[orient >= 0 && orient < 6 ? orient : 0];
  Mat3 m;
  for (int r = 0; r < 3; ++r) m.m[r][0] = a.i[r], m.m[r][1] = a.j[r], m.m[r][2] = a.k[r];
  return m;
}

}  // namespace

namespace {

// SPM's origin. Other programs keep text there: numbers far from the volume are none, as in SPM.
bool has_origin_voxel(const NiftiHeader& h) {
  bool any = false;
  for (size_t a = 0; a < 3; ++a) {
    const auto n = double(h.dims[a]), o = double(h.origin_voxel[a]);
    if (!(o > -n && o < 2 * n)) return false;
    any = any || o != 0;
  }
  return any;
}

}  // namespace

UniformGrid nifti_grid(const NiftiHeader& h, const std::string& where, DatasetParts& out) {
  auto& notes = out.notes;
  UniformGrid g;
  for (size_t a = 0; a < 3; ++a) g.dims[a] = h.dims[a];
  Form f;
  std::string form;
  if (h.sform_code > 0) {
    f = sform(h);
    f.good = usable(f);
    form = f.good ? fmt::format("sform, {}", form_name(h.sform_code)) : "";
  }
  if (!f.good && h.qform_code > 0) {
    f = qform(h);
    f.good = usable(f);
    form = f.good ? fmt::format("qform, {}", form_name(h.qform_code)) : "";
  }
  if (f.good) {
    g.direction = direction_of(f.axis, 3, where);
    for (int a = 0; a < 3; ++a) g.spacing[a] = length(f.axis[a]);
    g.origin = f.origin;
    turn(g, nifti_axes);
    note_patient_frame(out, nifti_space);
    notes.emplace_back("orientation", form);
    double shear = 0;
    for (int a = 0; a < 3; ++a) shear = std::max(shear, std::abs(dot(g.direction.column(a), g.direction.column((a + 1) % 3))));
    if (shear > 1e-3) notes.emplace_back("shear", "the axes are not at right angles");
  } else {
    for (int a = 0; a < 3; ++a) {
      const double s = std::abs(h.pixdim[size_t(a) + 1]);
      g.spacing[a] = s > 0 && std::isfinite(s) ? s : 1;
    }
    if (h.version == 0) {
      g.direction = analyze_axes(h.orient);
      if (has_origin_voxel(h)) {
        for (int a = 0; a < 3; ++a) g.origin = g.origin - g.direction.column(a) * (g.spacing[a] * double(h.origin_voxel[size_t(a)] - 1));
        notes.emplace_back("origin", fmt::format("voxel {} {} {}, as SPM counts", h.origin_voxel[0], h.origin_voxel[1], h.origin_voxel[2]));
      }
      note_patient_frame(out);
      notes.emplace_back("orientation",
                         h.orient >= 0 && h.orient < 6 ? fmt::format("Analyze, {}", h.orient) : "not given, taken as radiological");
    } else {
      notes.emplace_back("orientation", "not given");
    }
  }
  const int length_unit = h.units & 7, time_unit = h.units & 0x38;
  if (length_unit >= 1 && length_unit <= 3) notes.emplace_back("length unit", length_unit == 1 ? "m" : length_unit == 2 ? "mm" : "um");
  if (h.dims[3] > 1)
    for (const auto& [code, name] : {std::pair(8, "s"), {16, "ms"}, {24, "us"}, {32, "Hz"}, {40, "ppm"}, {48, "rad/s"}})
      if (time_unit == code) notes.emplace_back("time unit", name);
  if (!h.description.empty()) notes.emplace_back("description", h.description);
  if (!h.intent_name.empty()) notes.emplace_back("intent", h.intent_name);
  return g;
}

NiftiType nifti_type(const NiftiHeader& h, const std::string& where) {
  using enum ElementType;
  switch (h.datatype) {
    case 2: return {u8};
    case 4: return {i16};
    case 8: return {i32};
    case 16: return {f32};
    case 32: return {f32, 2};
    case 64: return {f64};
    case 128: return {u8, 3, true};
    case 256: return {i8};
    case 512: return {u16};
    case 768: return {u32};
    case 1024: return {i64};
    case 1280: return {u64};
    case 1792: return {f64, 2};
    case 2304: return {u8, 4, true};
    case 130:
      if (h.version == 0) return {i8};
      break;  // SPM's additions to Analyze
    case 132:
      if (h.version == 0) return {u16};
      break;
    case 136:
      if (h.version == 0) return {u32};
      break;
    case 1: fail_data("numbers of one bit are not supported", where, "convert the file to 8 bits");
    case 1536:
    case 2048: fail_data("numbers of 128 bits are not supported", where, "convert the file to 64 bits");
    default: break;
  }
  fail_data(
      fmt::format("byte {}: datatype {} is unknown", h.version == 2 ? 12 : 70, h.datatype), where,
      "supported: 2 uint8, 4 int16, 8 int32, 16 float, 64 double, 256 int8, 512 uint16, 768 uint32, 1024 int64, 1280 uint64, 128 RGB");
}

}  // namespace sg
