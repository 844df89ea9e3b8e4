// SPDX-License-Identifier: Apache-2.0
// NRRD (nearly raw raster data): attached and detached headers. The header is read in nrrd_header.cpp; here its axes become a
// grid and one point field. The field is named by the key "field name" that we write, else as VTK names it: ImageFile for raw data,
// ImageScalars for all other encodings.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file_fence.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice.h"
#include "data/lattice_crop.h"
#include "data/patient/patient_frame.h"
#include "io/bytes/inflate.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/volume/lattice_part.h"
#include "io/volume/nrrd_header.h"
#include "io/write_losses.h"

namespace sg {

bool sniff_nrrd(std::span<const std::byte> head) { return head.size() >= 8 && std::memcmp(head.data(), "NRRD000", 7) == 0; }

namespace {

// Lines are skipped in the file as it is stored, before anything is unpacked.
size_t skip_lines(const MappedFile& file, size_t begin, size_t lines) {
  const char* p = reinterpret_cast<const char*>(file.data()) + begin;
  const char* end = reinterpret_cast<const char*>(file.data()) + file.size();
  for (size_t i = 0; i < lines; ++i) {
    p = line_end(p, end);
    if (p == end) fail_data(fmt::format("'line skip' is {}, but there are only {} lines", lines, i), file.path());
    ++p;
  }
  return size_t(p - reinterpret_cast<const char*>(file.data()));
}

std::vector<BrickPart> find_parts(const NrrdHeader& h, const MappedFile& file) {
  std::vector<BrickPart> parts;
  auto add = [&](const MappedFile& f, size_t begin) {
    BrickPart p;
    p.file = f;
    p.begin = h.line_skip ? skip_lines(f, begin, h.line_skip) : begin;
    p.skip = h.byte_skip;
    parts.push_back(std::move(p));
  };
  if (h.data_files.empty()) {
    add(file, h.data_begin);
    return parts;
  }
  if (h.data_files.size() > 1) {
    // Each file holds the first `subdim` axes; there are as many files as entries on the other axes.
    const size_t n = h.axes.size(), sub = h.subdim ? h.subdim : n > 1 ? n - 1 : 1;
    size_t want = 1;
    for (size_t a = sub; a < n; ++a) want *= h.axes[a].size;
    // With as many dimensions per file as there are axes, the files share the slowest axis in equal slabs.
    if (sub == n ? h.axes[n - 1].size % h.data_files.size() != 0 : want != h.data_files.size())
      fail_data(fmt::format("has {} data files, but the sizes need {}", h.data_files.size(), want), h.path);
  }
  for (const std::string& name : h.data_files) add(MappedFile(named_file(h.path, name)), 0);
  return parts;
}

// Puts tuples first: file order (axes fastest first) -> packed tuples of the component axes' entries.
Array gather_components(const Array& stored, const NrrdHeader& h, size_t tuples, int components) {
  const size_t n = h.axes.size(), size = element_size(stored.type());
  std::vector<size_t> stride(n, 1);
  for (size_t a = 1; a < n; ++a) stride[a] = stride[a - 1] * h.axes[a - 1].size;
  std::vector<size_t> of_component(static_cast<size_t>(components), 0);
  for (size_t c = 0; c < of_component.size(); ++c) {
    size_t rest = c;
    for (size_t a = 0; a < n; ++a)
      if (!h.axes[a].is_space) of_component[c] += rest % h.axes[a].size * stride[a], rest /= h.axes[a].size;
  }
  std::byte* out = nullptr;
  Array r = Array::make_raw(stored.type(), tuples, components, &out);
  const std::byte* in = stored.raw();
  parallel_for(tuples, 1 << 14, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      size_t rest = t, at = 0;
      for (size_t a = 0; a < n; ++a)
        if (h.axes[a].is_space) at += rest % h.axes[a].size * stride[a], rest /= h.axes[a].size;
      for (size_t c = 0; c < of_component.size(); ++c)
        std::memcpy(out + (t * of_component.size() + c) * size, in + (at + of_component[c]) * size, size);
    }
  });
  return r;
}

// Symmetric matrices are stored as xx xy xz yy yz zz; nine numbers, row by row, mean the same to every filter.
Array full_tensor(const Array& six, int first) {
  const Array f = six.converted(six.type() == ElementType::f64 ? ElementType::f64 : ElementType::f32);
  static constexpr int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  auto expand = [&](auto zero) {
    using T = decltype(zero);
    const auto v = f.view<T>();
    T* out = nullptr;
    Array r = Array::make<T>(v.count, 9, &out);
    parallel_for(v.count, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i)
        for (int c = 0; c < 9; ++c) out[i * 9 + size_t(c)] = v(i, first + place[c]);
    });
    return r;
  };
  return f.type() == ElementType::f64 ? expand(double()) : expand(float());
}

// The stored array as a field: components taken together, role from the kind of the component axis.
void add_field(DatasetParts& out, const NrrdHeader& h, const Array& stored, size_t tuples, int components) {
  const size_t n = h.axes.size();
  size_t leading = 0, first_space = n, last_space = 0;
  std::string kind;
  bool together = true;
  for (size_t a = 0; a < n; ++a) {
    if (h.axes[a].is_space) first_space = std::min(first_space, a), last_space = a;
    else if (h.axes[a].size > 1) kind = h.axes[a].kind;
  }
  bool trailing = false;
  for (size_t a = 0; a < n; ++a)
    if (!h.axes[a].is_space && h.axes[a].size > 1) {
      if (a < first_space) ++leading;
      else if (a > last_space) trailing = true;
      else together = false;
    }
  const auto size = ptrdiff_t(element_size(stored.type()));
  const size_t offset = size_t(stored.raw() - stored.buffer().data);
  Array a;
  if (together && !trailing) a = Array(stored.buffer(), stored.type(), tuples, components, offset, size * components, size);
  else if (together && leading == 0) a = Array(stored.buffer(), stored.type(), tuples, components, offset, size, size * ptrdiff_t(tuples));
  else a = gather_components(stored, h, tuples, components);

  Role role = Role::scalars;
  const bool colour_kind = kind.find("color") != std::string::npos;
  if ((components == 3 || components == 4) && (colour_kind || (stored.type() == ElementType::u8 && kind.empty() && leading)))
    role = Role::colors;
  else if (components == 3 && (kind.find("vector") != std::string::npos || kind.find("gradient") != std::string::npos || kind == "list"))
    role = Role::vectors;
  else if (components == 3 && kind.find("normal") != std::string::npos) role = Role::normals;
  else if (components == 9 && kind == "3d-matrix") role = Role::tensors;
  const std::string name = !h.field_name.empty() ? h.field_name : h.encoding == BrickEncoding::raw ? "ImageFile" : "ImageScalars";
  // Vectors and tensors, from the axes along which they were measured to those of the file to the patient's.
  const Mat3 to_ours = patient_axes(h.space).value_or(PatientAxes()).matrix() * h.measurement_frame;
  const auto add = [&](Array values, Role of_values) {
    Field f{name, Association::point, std::move(values), h.sample_units, of_values};
    turn(f, to_ours);
    out.fields.add(std::move(f));
  };
  if (components == 7 && kind == "3d-masked-symmetric-matrix") {
    add(full_tensor(a, 1), Role::tensors);
    out.fields.add({"Mask", Association::point, a.component(0), "", Role::none});
  } else if (components == 6 && kind == "3d-symmetric-matrix") {
    add(full_tensor(a, 0), Role::tensors);
  } else {
    add(std::move(a), role);
  }
}

}  // namespace

Data read_nrrd(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  NrrdHeader h = parse_nrrd_header(file);
  classify_axes(h);
  std::vector<size_t> sizes, component_sizes;
  for (const NrrdAxis& a : h.axes) {
    sizes.push_back(a.size);
    if (!a.is_space) component_sizes.push_back(a.size);
  }
  BrickLayout l;
  l.type = h.type;
  l.count = checked_product(sizes, path);
  l.encoding = h.encoding;
  l.big_endian = h.big_endian;
  const size_t components = checked_product(component_sizes, path);
  if (components > (1 << 24)) fail_data(fmt::format("{} numbers per point", components), path);

  DatasetParts out;
  UniformGrid grid = nrrd_grid(h);
  const UniformGrid whole = grid;
  const LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  out.notes = h.notes;
  if (patient_axes(h.space)) note_patient_frame(out, h.space);
  else if (!h.space.empty()) out.notes.emplace_back("space", h.space);
  // What costs reading is left out when only the header is wanted; mapped data cost nothing.
  if (options.header_only && h.encoding != BrickEncoding::raw) return make_dataset(std::move(out));
  // Where a point's numbers lie together, only the wanted rows are read; else the part is cut from the whole.
  bool together = true, in_space = false;
  for (const NrrdAxis& a : h.axes)
    if (a.is_space) in_space = true;
    else if (a.size > 1 && in_space) together = false;
  if (together) {
    l.count /= components;
    l.components = int(components);
    const Array a = load_brick_part(l, part, find_parts(h, file), context);
    const size_t offset = size_t(a.raw() - a.buffer().data), size = element_size(l.type);
    const auto step = ptrdiff_t(size);
    add_field(out, h, Array(a.buffer(), l.type, a.count() * components, 1, offset, step, step), a.count(), int(components));
    return make_dataset(std::move(out));
  }
  out.mesh = whole;
  add_field(out, h, load_brick(l, find_parts(h, file), context), l.count / components, int(components));
  const DatasetPtr d = make_dataset(std::move(out));
  return part.whole() ? d : crop_lattice(*d, options.region.lo, options.region.hi, options.region.stride);
}

namespace {

std::string escaped(std::string_view s) {
  std::string r;
  for (const char c : s) r += c == '\\' ? "\\\\" : c == '\n' ? "\\n" : std::string(1, c);
  return r;
}

std::string_view nrrd_type(ElementType t) {
  constexpr std::string_view names[] = {"uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float", "double"};
  return names[size_t(t)];
}

std::string header_text(const UniformGrid& g, const Field& f, bool gzip, const std::vector<std::pair<std::string, std::string>>& notes) {
  const int n = f.components();
  const bool tensor = f.role == Role::tensors && n == 9;
  auto vector = [](Vec3 v) { return fmt::format("({},{},{})", exact_number(v.x), exact_number(v.y), exact_number(v.z)); };
  std::string t = "NRRD0005\n# Complete NRRD file format specification at:\n# http://teem.sourceforge.net/nrrd/format.html\n";
  t += fmt::format("type: {}\ndimension: {}\n", nrrd_type(f.array.type()), n > 1 ? 4 : 3);
  std::string keys, space = "space dimension: 3\n";
  static constexpr std::string_view fields[] = {
      "content", "space units", "measurement frame in the file", stored_space_note, "number", "min", "max", "labels", "units", "comment"};
  for (const auto& [key, value] : notes) {
    if (key == "space" && value.find("time") == std::string::npos) space = fmt::format("space: {}\n", value);
    else if (key == "content") t += fmt::format("content: {}\n", escaped(value));
    else if (std::find(std::begin(fields), std::end(fields), key) == std::end(fields) && !key.empty() &&
             key.find(':') == std::string::npos && key[0] != '#' && key != "space")
      keys += fmt::format("{}:={}\n", escaped(key), escaped(value));
  }
  t += space;
  t += fmt::format("sizes: {}{} {} {}\n", n > 1 ? fmt::format("{} ", n) : "", g.dims[0], g.dims[1], g.dims[2]);
  t += "space directions:" + std::string(n > 1 ? " none" : "");
  for (int a = 0; a < 3; ++a) t += " " + vector(g.direction.column(a) * g.spacing[a]);
  std::string_view kind = "list";
  if (tensor) kind = "3D-matrix";
  else if (f.role == Role::colors) kind = n == 3 ? "RGB-color" : n == 4 ? "RGBA-color" : "list";
  else if (f.role == Role::vectors && n == 3) kind = "3-vector";
  else if (f.role == Role::normals && n == 3) kind = "3-normal";
  t += fmt::format("\nkinds:{} domain domain domain\n", n > 1 ? fmt::format(" {}", kind) : "");
  if (!f.unit.empty()) t += fmt::format("sample units: \"{}\"\n", f.unit);
  if (!f.name.empty()) keys += fmt::format("{}:={}\n", nrrd_name_key, escaped(f.name));
  t += fmt::format("endian: little\nencoding: {}\nspace origin: {}\n", gzip ? "gzip" : "raw", vector(g.origin));
  return t + keys + "\n";
}

}  // namespace

void write_nrrd(const std::string& path, const Data& data, const WriteOptions& options, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing NRRD");
  const UniformGrid* grid = d->as<UniformGrid>();
  if (!grid)
    fail_usage(fmt::format("a NRRD file holds a uniform grid, not a {} mesh", d->kind()), path, "resample it first: -f 'resample'");
  const Compression compression = options.compression.value_or(Compression::none);
  if (compression != Compression::none && compression != Compression::gzip)
    fail_usage(fmt::format("NRRD cannot be compressed with '{}'", word_of(compression)), path, "use none or gzip");
  if (extension_of(path) == "nhdr") fail_usage("detached NRRD headers can be read but not written", path, "name it .nrrd");
  const UniformGrid placed = with_long_axes(*grid);
  WriteLosses losses(path, "NRRD");
  const Field& f = losses.one_point_field(*d, true);
  const Array a = f.array.made_packed();
  const std::span<const std::byte> bytes(a.raw(), a.bytes());
  const bool gzip = compression == Compression::gzip;
  AtomicFile file(path);
  std::string header = header_text(placed, f, gzip, d->notes());
  // Raw data begin at a multiple of their element size, so that readers can map them.
  if (!gzip) {
    size_t pad = (64 - header.size() % 64) % 64;
    if (pad == 1) pad += 64;  // a comment line has two characters at least
    if (pad) header.insert(9, "#" + std::string(pad - 2, ' ') + "\n");
  }
  file.write(header);
  if (gzip) {
    const auto packed = pack_gzip(bytes);
    file.write(packed.data(), packed.size());
  } else {
    file.write(bytes.data(), bytes.size());
  }
  file.commit();
  losses.tell(context);
}

}  // namespace sg
