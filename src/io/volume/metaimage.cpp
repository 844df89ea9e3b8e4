// SPDX-License-Identifier: Apache-2.0
// MetaImage (.mhd with separate data files, .mha in one file): "Key = value" lines, the last of which is ElementDataFile.
// The consecutive numbers of TransformMatrix are the directions of the axes, one axis after the other. Positions are in the patient frame,
// as ITK has them, where the file is of a patient: where AnatomicalOrientation or a Modality is stated.
#include <fmt/core.h>

#include <algorithm>

#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "data/lattice_crop.h"
#include "data/patient/patient_frame.h"
#include "io/formats.h"
#include "io/text/text_scan.h"
#include "io/volume/brick.h"
#include "io/volume/direction.h"

namespace sg {

namespace {

struct Header {
  std::string path;
  std::vector<std::pair<std::string, std::string>> lines;
  std::string_view rest;  ///< what follows the ElementDataFile line
  size_t rest_at = 0;

  std::string_view get(std::initializer_list<std::string_view> keys) const {
    for (std::string_view key : keys)
      for (const auto& [k, v] : lines)
        if (equal_ignoring_case(k, key)) return v;
    return {};
  }
  bool flag(std::initializer_list<std::string_view> keys) const {
    const std::string_view v = get(keys);
    if (v.empty()) return false;
    if (const auto b = parse_bool(v)) return *b;
    if (equal_ignoring_case(v, "t") || equal_ignoring_case(v, "y")) return true;
    return false;
  }
  // The numbers of a key; nothing when the key is absent. Throws unless there are `n`.
  std::vector<double> numbers(std::initializer_list<std::string_view> keys, size_t n) const {
    std::vector<double> r;
    const std::string_view v = get(keys);
    for (std::string_view w : words(v)) {
      const auto d = parse_double(w);
      if (!d || !std::isfinite(*d)) fail_data(fmt::format("{}: '{}' is not a number", *keys.begin(), w), path);
      r.push_back(*d);
    }
    if (!r.empty() && r.size() != n) fail_data(fmt::format("{} has {} numbers, but {} are needed", *keys.begin(), r.size(), n), path);
    return r;
  }
};

Header parse_header(const MappedFile& file) {
  Header h{.path = file.path(), .lines = {}, .rest = {}};
  const char *p = reinterpret_cast<const char*>(file.data()), *base = p, *end = p + file.size();
  for (size_t number = 1; p < end; ++number) {
    const char* e = line_end(p, end);
    if (e - p > 65536)
      fail_data(fmt::format("line {} is longer than 64 KiB", number), h.path, "a MetaImage header has lines of 'Key = value'");
    const std::string_view line = trim({p, size_t(e - p)});
    p = e < end ? e + 1 : end;
    if (line.empty() || line[0] == '#') continue;
    const size_t eq = std::min(line.find('='), line.find(':'));
    if (eq == std::string_view::npos)
      fail_data(fmt::format("line {}: '{}' is not of the form 'Key = value'", number, line.substr(0, 60)), h.path);
    h.lines.emplace_back(trim(line.substr(0, eq)), trim(line.substr(eq + 1)));
    if (equal_ignoring_case(h.lines.back().first, "ElementDataFile")) {
      h.rest_at = size_t(p - base);
      h.rest = {p, size_t(end - p)};
      return h;
    }
  }
  fail_data("the header has no ElementDataFile", h.path,
            "the last line of the header must say where the data is: LOCAL, a file, LIST or a pattern");
}

bool parse_met_type(std::string_view name, ElementType& t) {
  std::string key = to_lower(name);
  if (key.starts_with("met_")) key = key.substr(4);
  if (key.ends_with("_array")) key = key.substr(0, key.size() - 6);
  struct {
    std::string_view name;
    ElementType type;
  } static constexpr table[] = {{"uchar", ElementType::u8},       {"char", ElementType::i8},       {"ushort", ElementType::u16},
                                {"short", ElementType::i16},      {"uint", ElementType::u32},      {"int", ElementType::i32},
                                {"ulong_long", ElementType::u64}, {"long_long", ElementType::i64}, {"ulong", ElementType::u32},
                                {"long", ElementType::i32},       {"float", ElementType::f32},     {"double", ElementType::f64},
                                {"ascii_char", ElementType::i8}};
  for (const auto& e : table)
    if (e.name == key) return t = e.type, true;
  return false;
}

// Which files hold the data: names, and whether they lie behind the header itself.
std::vector<BrickPart> find_parts(const Header& h, const MappedFile& file, size_t slices) {
  const std::string_view value = h.get({"ElementDataFile"});
  std::vector<std::string> names;
  const auto w = words(value);
  if (equal_ignoring_case(value, "LOCAL")) {
    BrickPart p;
    p.file = file;
    p.begin = h.rest_at;
    return {p};
  }
  if (!w.empty() && equal_ignoring_case(w[0], "LIST")) {
    for (std::string_view line : split(h.rest, '\n'))
      if (!line.empty()) names.emplace_back(line);
    if (names.empty()) fail_data("ElementDataFile = LIST is not followed by names", h.path);
    if (names.size() > 1000000) fail_data("ElementDataFile = LIST has more than a million names", h.path);
  } else if (value.find('%') != std::string_view::npos && (w.size() >= 3 || !file_exists(path_beside(h.path, value)))) {
    int64_t n[3] = {1, int64_t(slices), 1};
    for (size_t i = 1; i < std::min<size_t>(w.size(), 4); ++i) {
      const auto v = parse_int(w[i]);
      if (!v)
        fail_data(fmt::format("ElementDataFile: '{}' is not a whole number", w[i]), h.path,
                  "write pattern first last step, e.g. slice%03d.raw 1 93 1");
      n[i - 1] = *v;
    }
    names = pattern_names(std::string(w[0]), n[0], n[1], n[2], h.path);
  } else if (value.empty()) {
    fail_data("ElementDataFile is empty", h.path);
  } else {
    names.emplace_back(value);
  }
  std::vector<BrickPart> parts;
  for (const std::string& name : names) {
    BrickPart p;
    p.file = MappedFile(named_file(h.path, name));
    parts.push_back(std::move(p));
  }
  return parts;
}

bool of_a_patient(const Header& h) {
  const std::string_view orientation = h.get({"AnatomicalOrientation"}), modality = h.get({"Modality"});
  return (!orientation.empty() && orientation.find('?') == std::string_view::npos) ||
         (modality.starts_with("MET_MOD_") && modality != "MET_MOD_OTHER" && modality != "MET_MOD_UNKNOWN");
}

UniformGrid make_grid(const Header& h, const std::vector<size_t>& sizes) {
  const size_t n = sizes.size();
  UniformGrid g;
  for (size_t a = 0; a < std::min<size_t>(n, 3); ++a) g.dims[a] = sizes[a];
  auto spacing = h.numbers({"ElementSpacing"}, n);
  if (spacing.empty()) spacing = h.numbers({"ElementSize"}, n);
  const auto origin = h.numbers({"Offset", "Position", "Origin"}, n);
  const auto matrix = h.numbers({"TransformMatrix", "Rotation", "Orientation"}, n * n);
  Vec3 axes[3];
  for (size_t a = 0; a < std::min<size_t>(n, 3); ++a) {
    g.spacing[int(a)] = spacing.empty() ? 1 : spacing[a];
    if (!origin.empty()) g.origin[int(a)] = origin[a];
    for (size_t c = 0; c < std::min<size_t>(n, 3); ++c) axes[a][int(c)] = matrix.empty() ? double(a == c) : matrix[a * n + c];
  }
  if (!matrix.empty()) g.direction = direction_of(axes, int(std::min<size_t>(n, 3)), h.path);
  return g;
}

}  // namespace

bool sniff_metaimage(std::span<const std::byte> head) {
  const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
  // The first key is one of MetaIO's, and NDims follows soon.
  size_t at = 0;
  while (at < text.size() && (is_space(text[at]) || text[at] == '#')) {
    if (text[at] == '#') at = std::min(text.find('\n', at), text.size());
    else ++at;
  }
  const std::string_view first = text.substr(at, text.find('\n', at) - at);
  const size_t eq = first.find('=');
  if (eq == std::string_view::npos || eq > 64) return false;
  for (const char c : first.substr(0, eq))
    if (!is_blank(c) && !std::isalnum(static_cast<unsigned char>(c)) && c != '_') return false;
  const std::string lower = to_lower(text);
  return lower.find("ndims") != std::string::npos &&
         (lower.find("dimsize") != std::string::npos || lower.find("elementtype") != std::string::npos || lower.find("objecttype") == at);
}

Data read_metaimage(const std::string& path, const ReadOptions& options, Context& context) {
  const MappedFile file(path);
  const Header h = parse_header(file);
  if (const auto v = h.get({"ObjectType"}); !v.empty() && !equal_ignoring_case(v, "Image"))
    fail_data(fmt::format("is a MetaIO {}, not an Image", v), path);
  const auto ndims = parse_int(h.get({"NDims"}));
  if (!ndims || *ndims < 1 || *ndims > 10) fail_data(fmt::format("NDims is '{}'", h.get({"NDims"})), path, "1 to 10");
  std::vector<size_t> sizes;
  for (std::string_view w : words(h.get({"DimSize"}))) {
    const auto v = parse_int(w);
    if (!v || *v < 1) fail_data(fmt::format("DimSize: '{}' is not a valid size", w), path);
    sizes.push_back(size_t(*v));
  }
  if (sizes.size() != size_t(*ndims)) fail_data(fmt::format("DimSize has {} numbers but NDims is {}", sizes.size(), *ndims), path);
  const size_t total = checked_product(sizes, path);

  BrickLayout l;
  if (!parse_met_type(h.get({"ElementType"}), l.type))
    fail_data(fmt::format("ElementType '{}' is unknown", h.get({"ElementType"})), path,
              "MET_UCHAR, MET_SHORT, MET_USHORT, MET_INT, MET_FLOAT, MET_DOUBLE, ...");
  int64_t channels = 1;
  if (const auto v = h.get({"ElementNumberOfChannels"}); !v.empty()) {
    const auto n = parse_int(v);
    if (!n || *n < 1 || *n > 1 << 20) fail_data(fmt::format("ElementNumberOfChannels is '{}'", v), path);
    channels = *n;
  }
  UniformGrid grid = make_grid(h, sizes);
  const size_t voxels = grid.dims[0] * grid.dims[1] * grid.dims[2], steps = total / voxels;  // axes beyond the third
  if (steps > 1 << 20) fail_data(fmt::format("has {} volumes in one file", steps), path);
  l.count = total;
  l.components = int(channels);
  l.big_endian = h.flag({"ElementByteOrderMSB", "BinaryDataByteOrderMSB"});
  const bool binary = h.get({"BinaryData"}).empty() || h.flag({"BinaryData"});
  if (!binary) l.encoding = BrickEncoding::text;

  DatasetParts out;
  LatticePart part = cut_grid(grid, steps > 1 ? LatticeRegion() : options.region);
  out.mesh = grid;
  for (const auto& [key, value] : h.lines) {
    static constexpr std::string_view known[] = {"ObjectType",
                                                 "NDims",
                                                 "DimSize",
                                                 "ElementType",
                                                 "ElementDataFile",
                                                 "ElementSpacing",
                                                 "BinaryData",
                                                 "HeaderSize",
                                                 "CompressedData",
                                                 "CompressedDataSize",
                                                 "BinaryDataByteOrderMSB",
                                                 "ElementByteOrderMSB",
                                                 "ElementNumberOfChannels",
                                                 "FieldName"};
    if (std::none_of(std::begin(known), std::end(known), [&](std::string_view k) { return equal_ignoring_case(k, key); }))
      out.notes.emplace_back(key, value);
  }
  if (of_a_patient(h)) note_patient_frame(out);
  if (steps > 1) part.dims = part.count = {total, 1, 1};
  if (options.header_only && (h.flag({"CompressedData"}) || !binary)) return make_dataset(std::move(out));
  std::vector<BrickPart> parts = find_parts(h, file, sizes.back());
  if (h.flag({"CompressedData"})) {
    const std::byte* first = parts[0].file.data() + parts[0].begin;
    const bool gzip = parts[0].file.size() >= parts[0].begin + 2 && first[0] == std::byte(0x1f) && first[1] == std::byte(0x8b);
    l.encoding = gzip ? BrickEncoding::gzip : BrickEncoding::zlib;
    // CompressedDataSize is often wrong and never needed (the stream knows its end), so it is not believed.
  }
  if (const auto v = h.get({"HeaderSize"}); !v.empty()) {
    const auto n = parse_int(v);
    if (!n || *n < -1) fail_data(fmt::format("HeaderSize is '{}'", v), path, "give a number of bytes, or -1 if the data is at the end");
    for (BrickPart& p : parts) *n < 0 ? void(p.skip = -1) : void(p.begin += size_t(*n));
  }
  Array a = load_brick_part(l, part, parts, context);
  if (steps > 1) {
    // Further volumes become components, one volume after the other in memory.
    if (channels > 1)
      fail_data(fmt::format("{} axes and {} channels", sizes.size(), channels), path, "supported: up to 3 axes with channels, or 4 axes");
    const auto size = ptrdiff_t(element_size(l.type));
    a = Array(a.buffer(), l.type, voxels, int(steps), size_t(a.raw() - a.buffer().data), size, size * ptrdiff_t(voxels));
    context.info(fmt::format("{}: the {} volumes of the fourth axis became components", path, steps));
  }
  const Role role = channels >= 3 && channels <= 4 && l.type == ElementType::u8 ? Role::colors
                    : channels == 3                                             ? Role::vectors
                                                                                : Role::scalars;
  const std::string_view name = h.get({"FieldName"});
  out.fields.add({std::string(name.empty() ? "MetaImage" : name), Association::point, std::move(a), "", role});
  const DatasetPtr d = make_dataset(std::move(out));
  return steps == 1 || options.region.whole() ? d : crop_lattice(*d, options.region.lo, options.region.hi, options.region.stride);
}

}  // namespace sg
