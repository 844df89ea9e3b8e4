// SPDX-License-Identifier: Apache-2.0
// NIfTI-1, NIfTI-2 and Analyze 7.5: .nii, .nii.gz and pairs of .hdr and .img (each may end in .gz).
// The fourth axis is time (or the directions of a diffusion series): one volume is read at a time. The fifth holds components.
// Stored numbers become value = slope * stored + intercept. Reference: the NIfTI-1 and NIfTI-2 header definitions.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/bytes/gzip_stream.h"
#include "io/bytes/inflate.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/volume/lattice_part.h"
#include "io/volume/nifti_header.h"

namespace sg {

namespace {

bool is_gzip(const MappedFile& f) { return f.size() >= 2 && f.data()[0] == std::byte(0x1f) && f.data()[1] == std::byte(0x8b); }

NiftiHeader read_header(const MappedFile& file) {
  const std::span<const std::byte> bytes(file.data(), file.size());
  if (!is_gzip(file)) return parse_nifti_header(bytes.first(std::min<size_t>(bytes.size(), 544)), file.path());
  std::byte head[544];
  return parse_nifti_header({head, gzip_peek(bytes, head, sizeof head)}, file.path());
}

// "a/b.hdr.gz" -> "a/b" and "hdr".
std::pair<std::string, std::string> stem_of(const std::string& path) {
  std::string p = path;
  if (to_lower(p).ends_with(".gz")) p.resize(p.size() - 3);
  const size_t dot = file_name_of(p).rfind('.');
  if (dot == std::string::npos) return {p, ""};
  const size_t at = p.size() - file_name_of(p).size() + dot;
  return {p.substr(0, at), to_lower(p.substr(at + 1))};
}

std::string partner(const std::string& stem, std::initializer_list<const char*> endings) {
  for (const char* e : endings)
    if (file_exists(stem + e)) return stem + e;
  return "";
}

/// A file or pair, opened; sizes checked against the bytes there are.
struct Source {
  NiftiHeader h;
  NiftiType type;
  MappedFile image;
  size_t voxels = 0, steps = 1, blocks = 1;  ///< a block: one component of one step
  size_t tuple = 1, total = 0;               ///< bytes of a stored voxel, of all numbers
  std::vector<double> bval, bvec;            ///< of a diffusion series: steps, 3 * steps
  bool gzip = false;
  size_t block_bytes() const { return voxels * tuple; }
  size_t begin(size_t step, size_t block) const { return h.data_begin + (block * steps + step) * block_bytes(); }
};

// FSL's text files: one number per volume, and three rows of them (or three per row).
std::vector<double> numbers_beside(const std::string& header, std::initializer_list<const char*> endings, const char* plain, size_t count,
                                   bool vectors) {
  std::string path = partner(stem_of(header).first, endings);
  if (path.empty()) path = file_exists(path_beside(header, plain)) ? path_beside(header, plain) : "";
  if (path.empty()) return {};
  const MappedFile file(path);
  std::vector<double> r;
  size_t first_line = 0;
  for (std::string_view line : split(file.text(), '\n')) {
    for (std::string_view w : words(line)) {
      const auto v = parse_double(w);
      if (!v || r.size() > count * 3) return {};
      r.push_back(*v);
    }
    if (first_line == 0) first_line = r.size();
  }
  if (r.size() != (vectors ? 3 * count : count)) return {};
  if (!vectors || first_line != count) return r;
  std::vector<double> tuples(r.size());
  for (size_t i = 0; i < count; ++i)
    for (size_t c = 0; c < 3; ++c) tuples[3 * i + c] = r[c * count + i];
  return tuples;
}

// Vectors are also stored along the fourth axis: where the intent says so, and three float volumes without b-values (FSL's V1).
bool fourth_axis_is_vector(const Source& s) {
  if (s.h.dims[3] < 2 || s.blocks > 1 || s.type.components > 1) return false;
  if (s.h.intent >= 1003 && s.h.intent <= 1007) return true;
  return s.h.dims[3] == 3 && is_float(s.type.type) && s.bval.empty();
}

Source open_nifti(const std::string& path) {
  Source s;
  const auto [stem, ending] = stem_of(path);
  std::string header = path;
  if (ending == "img") {
    header = partner(stem, {".hdr", ".hdr.gz", ".HDR"});
    if (header.empty()) fail_data("the header of the .img file is missing", path, "expected a .hdr file beside it with the same name");
  }
  s.image = MappedFile(header);
  s.h = read_header(s.image);
  s.type = nifti_type(s.h, header);
  if (!s.h.single_file) {
    const std::string image = ending == "img" ? path : partner(stem, {".img", ".img.gz", ".IMG"});
    if (image.empty())
      fail_data("no data: this is only a header", path, fmt::format("expected the numbers in '{}.img' beside it", file_name_of(stem)));
    s.image = MappedFile(image);
  }
  s.gzip = is_gzip(s.image);
  s.tuple = element_size(s.type.type) * size_t(s.type.components);
  uint64_t n = 1, total = 0;
  const auto& d = s.h.dims;
  bool good = multiply(d[0], d[1], n) && multiply(n, d[2], n);
  s.voxels = n;
  good = good && multiply(n, d[3], n) && multiply(n, d[4], n) && multiply(n, d[5], n) && multiply(n, d[6], n) && n < uint64_t(1) << 60 &&
         multiply(n, s.tuple, total) && total < uint64_t(1) << 60 && s.h.data_begin < uint64_t(1) << 60;
  if (!good) fail_data("the sizes are too large", header);
  s.total = total;
  s.steps = d[3];
  s.blocks = d[4] * d[5] * d[6];
  if (s.gzip) check_ratio(Codec::gzip, s.image.size(), s.h.data_begin + total, s.image.path());
  else if (s.image.size() < s.h.data_begin || s.image.size() - s.h.data_begin < total)
    fail_data(fmt::format("too short: {} bytes are needed from byte {} on, but there are {}", total, s.h.data_begin,
                          s.image.size() - std::min(s.image.size(), s.h.data_begin)),
              s.image.path());
  if (s.steps > (1 << 20) || s.blocks > (1 << 20)) fail_data(fmt::format("{} volumes of {} components", s.steps, s.blocks), header);
  if (s.blocks > 1 && s.type.components > 1) fail_data("a fifth axis of complex or coloured voxels is not supported", header);
  if (s.steps > 1) {
    s.bval = numbers_beside(header, {".bval", ".bvals"}, "bvals", s.steps, false);
    s.bvec = numbers_beside(header, {".bvec", ".bvecs"}, "bvecs", s.steps, true);
  }
  if (fourth_axis_is_vector(s)) s.blocks = s.steps, s.steps = 1;
  return s;
}

std::vector<double> times_of(const Source& s) {
  std::vector<double> t;
  if (s.steps < 2) return t;
  const double step = s.h.pixdim[4] > 0 && std::isfinite(s.h.pixdim[4]) ? s.h.pixdim[4] : 1;
  const double begin = std::isfinite(s.h.time_offset) ? s.h.time_offset : 0;
  for (size_t i = 0; i < s.steps; ++i) t.push_back(begin + double(i) * step);
  return t;
}

bool scaled(const NiftiHeader& h) {
  return std::isfinite(h.slope) && h.slope != 0 && std::isfinite(h.intercept) && (h.slope != 1 || h.intercept != 0);
}

// The wanted points of one step as stored, this machine's byte order: one component after the other.
Array load_step(const Source& s, size_t step, const LatticePart& part) {
  const size_t size = element_size(s.type.type), points = part.points();
  const int components = int(s.blocks) * s.type.components;
  const auto layout = [&](Buffer b, size_t offset, size_t next_block) {
    if (s.type.components > 1) return Array(std::move(b), s.type.type, points, components, offset, ptrdiff_t(s.tuple), ptrdiff_t(size));
    return Array(std::move(b), s.type.type, points, components, offset, ptrdiff_t(size), ptrdiff_t(next_block));
  };
  const bool swap = s.h.big_endian && size > 1;
  if (!s.gzip && !swap && part.whole() && reinterpret_cast<uintptr_t>(s.image.data() + s.begin(step, 0)) % size == 0)
    return layout({s.image.owner(), s.image.data(), s.image.size()}, s.begin(step, 0), s.steps * s.block_bytes());

  std::byte* out = nullptr;
  const size_t share = points * s.tuple;
  const bool at_once = s.gzip && s.steps == 1 && part.whole();  // the whole stream, header first, straight to its place
  const size_t front = at_once ? (s.h.data_begin + 63) / 64 * 64 : 0;
  Buffer buffer = Buffer::allocate(front + share * s.blocks, &out);
  if (at_once) {
    unpack(Codec::gzip, {s.image.data(), s.image.size()}, {}, out + front - s.h.data_begin, s.h.data_begin + s.total, s.image.path());
  } else if (s.gzip) {
    GzipStream stream({s.image.data(), s.image.size()}, s.image.path());
    size_t at = 0;
    for (size_t b = 0; b < s.blocks; ++b) {
      stream.read(nullptr, s.begin(step, b) - at);
      stream_part([&](std::byte* to, size_t n) { stream.read(to, n); }, s.tuple, part, out + b * share);
      at = s.begin(step, b) + s.block_bytes();
    }
  } else {
    for (size_t b = 0; b < s.blocks; ++b) copy_part(s.image.data() + s.begin(step, b), s.tuple, part, out + b * share);
  }
  if (swap) swap_bytes(out + front, share * s.blocks / size, size);
  return layout(std::move(buffer), front, share);
}

// slope * stored + intercept: f32 where that holds all stored digits, else f64.
Array scale(const Array& stored, double slope, double intercept) {
  const bool wide = element_size(stored.type()) > 4 || stored.type() == ElementType::i32 || stored.type() == ElementType::u32;
  return dispatch(stored, [&](auto v) {
    auto make = [&](auto zero) {
      using T = decltype(zero);
      T* out = nullptr;
      Array r = Array::make<T>(v.count, v.components, &out);
      parallel_for(v.count, 1 << 16, [&](size_t begin, size_t end) {
        for (int c = 0; c < v.components; ++c)
          for (size_t i = begin; i < end; ++i) out[i * size_t(v.components) + size_t(c)] = T(slope * double(v(i, c)) + intercept);
      });
      return r;
    };
    return wide ? make(double()) : make(float());
  });
}

// A symmetric matrix is stored as xx xy yy xz yz zz.
Array full_matrix(const Array& six) {
  return dispatch(six, [&](auto v) {
    using T = std::remove_cv_t<std::remove_reference_t<decltype(*v.data)>>;
    static constexpr int place[9] = {0, 1, 3, 1, 2, 4, 3, 4, 5};
    T* out = nullptr;
    Array r = Array::make<T>(v.count, 9, &out);
    parallel_for(v.count, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 9; ++c) out[i * 9 + size_t(c)] = v(i, place[c]);
    });
    return r;
  });
}

Field make_field(const Source& s, Array a) {
  Role role = Role::scalars;
  const int n = a.components();
  if (s.type.colors) role = Role::colors;
  else if (s.h.intent == 1005 && n == 6) a = full_matrix(a), role = Role::tensors;
  else if (s.h.intent == 1004 && n == 9) role = Role::tensors;
  else if (s.h.intent == 1002 && n == 1) role = Role::labels;
  else if (n == 3 && s.type.components == 1) role = Role::vectors;
  return {"NIFTI", Association::point, std::move(a), "", role};
}

// The axes that components are measured along, seen from the patient frame. Tensors and displacements (DISPVECT) have those of NIfTI;
// vectors of any other kind have no frame by the standard, and ITK and ANTs write ours. FSL's directions are along the voxels' axes, with x
// to the left.
Mat3 vector_frame(const Source& s, const UniformGrid& grid, const std::string& path, Context& context) {
  if (s.h.intent >= 1004 && s.h.intent <= 1006) return nifti_axes.matrix();
  const std::string stem = stem_of(path).first;
  if (s.h.intent != 0 || s.blocks != 3 || !(stem.ends_with("_V1") || stem.ends_with("_V2") || stem.ends_with("_V3"))) return Mat3();
  context.info(fmt::format("{}: directions as FSL names them, along the voxels' axes; turned into the patient's", path));
  Mat3 m = grid.direction;
  if (determinant(m) > 0)
    for (int r = 0; r < 3; ++r) m.m[r][0] = 0 - m.m[r][0];
  return m;
}

}  // namespace

bool sniff_nifti(std::span<const std::byte> head) {
  std::byte unpacked[540];
  if (const size_t n = gzip_peek(head, unpacked, sizeof unpacked)) return is_nifti_header({unpacked, n});
  return is_nifti_header(head);
}

Data read_nifti(const std::string& path, const ReadOptions& options, Context& context) {
  const Source s = open_nifti(path);
  const std::vector<double> times = times_of(s);
  const size_t step = times.empty() ? 0 : chosen_step(times, options, path);
  DatasetParts out;
  UniformGrid grid = nifti_grid(s.h, path, out);
  const LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  if (!times.empty()) {
    out.time = times[step];
    out.notes.emplace_back("steps", fmt::format("{}", times.size()));
  }
  auto wanted = [&](std::string_view name) {
    return options.fields.empty() || std::find(options.fields.begin(), options.fields.end(), name) != options.fields.end();
  };
  const bool costs = s.gzip || scaled(s.h) || (s.h.big_endian && s.tuple > 1);
  if (wanted("NIFTI") && !(options.header_only && costs)) {
    Array a = load_step(s, step, part);
    if (scaled(s.h) && !s.type.colors) {
      a = scale(a, s.h.slope, s.h.intercept);
      context.info(fmt::format("{}: values are {} * stored + {}", path, s.h.slope, s.h.intercept));
    }
    Field field = make_field(s, std::move(a));
    if (s.h.version > 0) turn(field, vector_frame(s, grid, path, context));
    out.fields.add(std::move(field));
  }
  if (!s.bval.empty() && wanted("bval")) out.fields.add({"bval", Association::whole, Array::from_vector(s.bval), "s/mm^2", Role::none});
  if (!s.bvec.empty() && wanted("bvec")) out.fields.add({"bvec", Association::whole, Array::from_vector(s.bvec, 3), "", Role::none});
  return make_dataset(std::move(out));
}

std::vector<double> times_of_nifti(const std::string& path, const ReadOptions&, Context&) { return times_of(open_nifti(path)); }

}  // namespace sg
