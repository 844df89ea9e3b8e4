// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/gdcm/dicom_picture.h"

#include <fmt/core.h>
#include <gdcmImageApplyLookupTable.h>
#include <gdcmImageChangePhotometricInterpretation.h>
#include <gdcmImageChangePlanarConfiguration.h>
#include <gdcmImageReader.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "base/bytes.h"
#include "base/error.h"
#include "base/file/file.h"
#include "base/text/text.h"
#include "io/isolated/child.h"
#include "io/plausible.h"
#include "io/plugins/gdcm/dicom_elements.h"

namespace sg {

namespace {

bool vector_of(const std::vector<double>& n, size_t at, Vec3& v) {
  if (n.size() < at + 3) return false;
  v = {n[at], n[at + 1], n[at + 2]};
  return true;
}

// Geometry from the top level, else from the functional groups of multi-frame files.
void read_geometry(const DicomElements& d, DicomPicture& p) {
  auto orientation = d.numbers(0x00200037), spacing = d.numbers(0x00280030), between = d.numbers(0x00180088), thick = d.numbers(0x00180050);
  if (spacing.size() < 2) spacing = d.numbers(0x00181164);
  if (Vec3 v; vector_of(d.numbers(0x00200032), 0, v)) p.positions.push_back(v);
  auto slope = d.numbers(0x00281053), intercept = d.numbers(0x00281052);
  std::vector<Vec3> positions;
  for (const DicomElement& e : d.in_groups) {
    if (e.tag == 0x00200037 && orientation.empty()) orientation = d.numbers(e);
    else if (e.tag == 0x00280030 && spacing.empty()) spacing = d.numbers(e);
    else if (e.tag == 0x00180088 && between.empty()) between = d.numbers(e);
    else if (e.tag == 0x00180050 && thick.empty()) thick = d.numbers(e);
    else if (e.tag == 0x00281053 && slope.empty()) slope = d.numbers(e);
    else if (e.tag == 0x00281052 && intercept.empty()) intercept = d.numbers(e);
    else if (e.tag == 0x00200032)
      if (Vec3 v; vector_of(d.numbers(e), 0, v)) positions.push_back(v);
  }
  if (positions.size() == p.frames) p.positions = std::move(positions);
  Vec3 x, y;
  if (vector_of(orientation, 0, x) && vector_of(orientation, 3, y) && length(cross(x, y)) > 1e-6)
    p.x = normalize(x), p.y = normalize(y), p.has_orientation = true;
  if (spacing.size() >= 2 && spacing[0] > 0 && spacing[1] > 0) p.spacing_y = spacing[0], p.spacing_x = spacing[1], p.has_spacing = true;
  if (!between.empty() && std::abs(between[0]) > 0) p.slice_distance = std::abs(between[0]);
  else if (!thick.empty() && thick[0] > 0) p.slice_distance = thick[0];
  if (!slope.empty() && slope[0] != 0) p.slope = slope[0];
  if (!intercept.empty()) p.intercept = intercept[0];
}

// A DICOM file of only those elements that decoding needs, so that GDCM meets nothing else.
std::string minimal_file(const DicomElements& d) {
  auto piece = [&](size_t begin, size_t end) { return std::string(reinterpret_cast<const char*>(d.bytes.data()) + begin, end - begin); };
  std::string s = piece(0, d.meta_end);
  for (const auto& [tag, e] : d.top)
    if (tag == 0x00080016 || tag == 0x00080060 || (tag >> 16 == 0x0028 && e.end - e.value < (1 << 20)) || tag == pixel_tag)
      s += piece(e.begin, e.end);
  return s;
}

struct Decoded {
  std::shared_ptr<void> owner;
  const std::byte* bytes = nullptr;
  int bits_allocated = 16, bits_stored = 16, high_bit = 15;
  bool is_signed = false;
};

// What the decoding process leaves behind: this, then the pixels.
struct Result {
  int state = 0;  // 0 = died, 1 = good, 2 = failed with a message
  int bits_allocated = 0, bits_stored = 0, high_bit = 0, is_signed = 0;
  char message[256]{};
};

void say(Result& r, const std::string& text) {
  std::memcpy(r.message, text.data(), std::min(text.size(), sizeof r.message - 1));
  r.state = 2;
}

// Unpacks `file` to at most `room` bytes behind `r`. Runs in a process of its own.
void decode_here(const std::string& file, const DicomPicture& p, Result& r, char* out, size_t room) {
  std::istringstream stream(file);
  gdcm::ImageReader reader;
  reader.SetStream(stream);
  if (!reader.Read()) return say(r, "the decoder does not support them");
  const gdcm::Image* image = &reader.GetImage();
  gdcm::ImageApplyLookupTable lookup;
  gdcm::ImageChangePlanarConfiguration planar;
  gdcm::ImageChangePhotometricInterpretation colors;
  if (image->GetPhotometricInterpretation() == gdcm::PhotometricInterpretation::PALETTE_COLOR) {
    lookup.SetInput(*image);
    if (!lookup.Apply()) return say(r, "the palette cannot be applied");
    image = &lookup.GetOutput();
  }
  if (image->GetPixelFormat().GetSamplesPerPixel() == 3 && image->GetPlanarConfiguration() == 1) {
    planar.SetInput(*image);
    planar.SetPlanarConfiguration(0);
    if (!planar.Change()) return say(r, "the colour planes cannot be combined");
    image = &static_cast<const gdcm::Image&>(planar.GetOutput());
  }
  if (image->GetPhotometricInterpretation() == gdcm::PhotometricInterpretation::YBR_FULL) {
    colors.SetInput(*image);
    colors.SetPhotometricInterpretation(gdcm::PhotometricInterpretation::RGB);
    if (colors.Change()) image = &static_cast<const gdcm::Image&>(colors.GetOutput());
  }
  const gdcm::PixelFormat& f = image->GetPixelFormat();
  r.bits_allocated = f.GetBitsAllocated(), r.bits_stored = f.GetBitsStored(), r.high_bit = f.GetHighBit();
  r.is_signed = f.GetPixelRepresentation() == 1;
  const size_t need = p.numbers_per_frame() * p.frames * size_t(r.bits_allocated / 8), have = image->GetBufferLength();
  if (have != need || need > room || int(f.GetSamplesPerPixel()) != p.components())
    return say(r, fmt::format("they decompress to {} bytes, but {} are needed", have, need));
  if (!image->GetBuffer(out)) return say(r, "they are damaged");
  r.state = 1;
}

// GDCM ends the program on some damaged files (its assertions are compiled in), so it works in a process of its own.
Decoded decode(const DicomPicture& p) {
  const DicomFile file(p.path);
  const DicomElements d = walk_dicom(file.bytes(), p.path);
  const std::string minimal = minimal_file(d);
  const size_t room = p.numbers_per_frame() * p.frames * (p.photometric == "PALETTE COLOR" ? 2 : size_t(p.bits_allocated / 8));
  check_plausible(room, file.bytes().size(), p.path);
  const size_t total = sizeof(Result) + room;
  void* shared = ::mmap(nullptr, total, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) fail_data(fmt::format("not enough memory for {} bytes of pixels", room), p.path);
  const std::shared_ptr<void> owner(shared, [total](void* m) { ::munmap(m, total); });
  auto* r = new (shared) Result;
  char* out = static_cast<char*>(shared) + sizeof(Result);

  const ChildLimits limits = reading_limits(room);  // decompression makes a few copies of the pixels
  run_child(limits, p.path, Context(), [&] {
    try {
      decode_here(minimal, p, *r, out, room);
    } catch (const std::exception& e) {
      say(*r, e.what());
    } catch (...) {
    }
  });
  if (r->state != 1)
    fail_data(fmt::format("its pixels (transfer syntax {}) cannot be decoded: {}", d.transfer_syntax,
                          r->state == 2 ? r->message : "they are damaged"),
              p.path);
  Decoded result{owner, reinterpret_cast<const std::byte*>(out), r->bits_allocated, r->bits_stored, r->high_bit, r->is_signed != 0};
  if (result.bits_allocated != 8 && result.bits_allocated != 16 && result.bits_allocated != 32)
    fail_data(fmt::format("its pixels decode to numbers of {} bits", result.bits_allocated), p.path);
  return result;
}

// How stored numbers become values.
struct Convert {
  int bits = 16, stored = 16, high = 15;
  bool is_signed = false, big = false;
  double slope = 1, intercept = 0;
};

template <class Bits, class Out>
void convert(const std::byte* in, size_t n, const Convert& c, Out* out) {
  const int shift = std::clamp(c.high + 1 - c.stored, 0, c.bits - 1), unused = 64 - std::clamp(c.stored, 1, c.bits);
  const bool scaled = c.slope != 1 || c.intercept != 0;
  for (size_t i = 0; i < n; ++i) {
    const uint64_t raw = uint64_t(load<Bits>(in + i * sizeof(Bits), c.big)) >> shift << unused;
    const int64_t v = c.is_signed ? int64_t(raw) >> unused : int64_t(raw >> unused);
    out[i] = scaled ? Out(c.slope * double(v) + c.intercept) : Out(v);
  }
}

template <class Out>
void convert_to(const std::byte* in, size_t n, const Convert& c, std::byte* out) {
  auto* to = reinterpret_cast<Out*>(out);
  if (c.bits == 8) convert<uint8_t>(in, n, c, to);
  else if (c.bits == 16) convert<uint16_t>(in, n, c, to);
  else convert<uint32_t>(in, n, c, to);
}

ElementType stored_type(int bits, bool is_signed) {
  if (bits <= 8) return is_signed ? ElementType::i8 : ElementType::u8;
  if (bits <= 16) return is_signed ? ElementType::i16 : ElementType::u16;
  return is_signed ? ElementType::i32 : ElementType::u32;
}

}  // namespace

bool read_dicom_header(const std::string& path, DicomPicture& p) {
  const DicomFile file(path);
  const DicomElements d = walk_dicom(file.bytes(), path);
  p.path = path;
  if (!d.has(pixel_tag)) return false;
  const DicomElement& pixels = d.top.at(pixel_tag);
  p.rows = d.whole(0x00280010, 0), p.columns = d.whole(0x00280011, 0);
  if (p.rows == 0 || p.columns == 0) fail_data(fmt::format("a picture of {} rows and {} columns", p.rows, p.columns), path);
  if (const auto n = d.numbers(0x00280008); !n.empty()) {
    if (n[0] < 1 || n[0] > 1e7 || n[0] != std::floor(n[0])) fail_data(fmt::format("{} frames", n[0]), path);
    p.frames = size_t(n[0]);
  }
  p.samples = int(d.whole(0x00280002, 1));
  if (p.samples < 1 || p.samples > 4) fail_data(fmt::format("{} samples per pixel", p.samples), path);
  p.planar = int(d.whole(0x00280006, 0));
  p.bits_allocated = int(d.whole(0x00280100, 16));
  p.bits_stored = int(d.whole(0x00280101, size_t(p.bits_allocated)));
  p.high_bit = int(d.whole(0x00280102, size_t(p.bits_stored) - 1));
  if (p.bits_allocated != 8 && p.bits_allocated != 16 && p.bits_allocated != 32)
    fail_data(fmt::format("{} bits per number", p.bits_allocated), path, "8, 16 or 32");
  if (p.bits_stored < 1 || p.bits_stored > p.bits_allocated || p.high_bit >= p.bits_allocated || p.high_bit + 1 < p.bits_stored)
    fail_data(fmt::format("{} of {} bits up to bit {}", p.bits_stored, p.bits_allocated, p.high_bit), path);
  p.is_signed = d.whole(0x00280103, 0) == 1;
  p.photometric = d.text(0x00280004);
  p.big_endian = d.big_endian;
  p.decode = d.encapsulated || p.photometric == "PALETTE COLOR" || p.photometric.starts_with("YBR");
  p.pixels_begin = pixels.value, p.pixels_bytes = pixels.end - pixels.value;

  // At most 65535^2 pixels a frame: the product fits. Packed data shrink by no more than some thousand.
  uint64_t need = 0;
  const size_t per_frame = p.rows * p.columns * size_t(p.samples) * size_t(p.bits_allocated / 8);
  if (!multiply(per_frame, p.frames, need) ||
      need / (d.encapsulated ? 5000 : 1) > (d.encapsulated ? d.fragment_bytes + 64 : p.pixels_bytes))
    fail_data(fmt::format("{} frames of {} x {} need {} bytes, but there are {}", p.frames, p.columns, p.rows, need,
                          d.encapsulated ? d.fragment_bytes : p.pixels_bytes),
              path);
  read_geometry(d, p);
  p.series = d.text(0x0020000e);
  p.description = d.text(0x0008103e);
  if (const auto n = d.numbers(0x00200013); !n.empty()) p.instance = n[0];
  for (const auto& [tag, name] : {std::pair(0x00080060u, "Modality"),
                                  {0x0008103eu, "SeriesDescription"},
                                  {0x00180015u, "BodyPartExamined"},
                                  {0x00185100u, "PatientPosition"},
                                  {0x00281050u, "WindowCenter"},
                                  {0x00281051u, "WindowWidth"},
                                  {0x00280004u, "PhotometricInterpretation"}})
    if (const std::string v = d.text(tag); !v.empty()) p.notes.emplace_back(name, v);
  return true;
}

ElementType dicom_type(const DicomPicture& p, bool as_float) {
  if (as_float) return ElementType::f32;
  if (p.slope == 1 && p.intercept == 0)
    return p.photometric == "PALETTE COLOR" ? ElementType::u8 : stored_type(p.bits_allocated, p.is_signed);
  const double most = std::ldexp(1.0, p.bits_stored - (p.is_signed ? 1 : 0)) - 1, least = p.is_signed ? -most - 1 : 0;
  const double a = least * p.slope + p.intercept, b = most * p.slope + p.intercept;
  // One step of the stored numbers is still seen in f32, whose digits reach 2^24 of them, far from the intercept.
  const ElementType real = std::max(std::abs(a), std::abs(b)) > std::ldexp(std::abs(p.slope), 23) ? ElementType::f64 : ElementType::f32;
  if (p.slope != std::floor(p.slope) || p.intercept != std::floor(p.intercept)) return real;
  if (std::min(a, b) >= -32768 && std::max(a, b) <= 32767) return ElementType::i16;
  return std::min(a, b) >= -2147483648.0 && std::max(a, b) <= 2147483647.0 ? ElementType::i32 : real;
}

void read_dicom_frames(const DicomPicture& p, size_t first, size_t count, ElementType type, std::byte* out) {
  Convert c{p.bits_allocated, p.bits_stored, p.high_bit, p.is_signed, p.big_endian, p.slope, p.intercept};
  Decoded decoded;
  DicomFile file;
  const std::byte* in = nullptr;
  if (p.decode) {
    decoded = decode(p);
    c.bits = decoded.bits_allocated, c.stored = decoded.bits_stored, c.high = decoded.high_bit;
    c.is_signed = decoded.is_signed, c.big = false;
    if (p.photometric == "PALETTE COLOR" && c.bits == 16) c.slope = 1.0 / 257, c.intercept = 0;  // colours of 16 bits
    in = decoded.bytes;
  } else {
    file = DicomFile(p.path);
    const size_t size = file.bytes().size();
    if (p.pixels_begin > size || p.pixels_bytes > size - p.pixels_begin) fail_data("changed while it was being read", p.path);
    in = file.bytes().data() + p.pixels_begin;
  }
  const size_t n = p.numbers_per_frame(), size = size_t(c.bits / 8);
  in += first * n * size;
  const size_t total = n * count;
  std::vector<std::byte> together;
  if (!p.decode && p.samples > 1 && p.planar == 1) {
    // Planes of colours, frame by frame: put together.
    together.resize(total * size);
    const size_t pixels = p.rows * p.columns, samples = size_t(p.samples);
    for (size_t f = 0; f < count; ++f)
      for (size_t s = 0; s < samples; ++s)
        for (size_t i = 0; i < pixels; ++i)
          std::memcpy(&together[(f * n + i * samples + s) * size], in + (f * n + s * pixels + i) * size, size);
    in = together.data();
  }
  switch (type) {
    case ElementType::u8: return convert_to<uint8_t>(in, total, c, out);
    case ElementType::i8: return convert_to<int8_t>(in, total, c, out);
    case ElementType::u16: return convert_to<uint16_t>(in, total, c, out);
    case ElementType::i16: return convert_to<int16_t>(in, total, c, out);
    case ElementType::u32: return convert_to<uint32_t>(in, total, c, out);
    case ElementType::i32: return convert_to<int32_t>(in, total, c, out);
    case ElementType::f64: return convert_to<double>(in, total, c, out);
    default: return convert_to<float>(in, total, c, out);
  }
}

}  // namespace sg
