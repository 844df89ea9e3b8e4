// SPDX-License-Identifier: Apache-2.0
// NumPy's .npy (versions 1 to 3): one array. The last axis of a[k][j][i] is x, as in stacks of pictures; a fourth axis behind them
// holds components. Memory order (C or Fortran) does not change which number is where.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/formats.h"
#include "io/volume/brick.h"
#include "io/volume/lattice_part.h"
#include "io/write_losses.h"

namespace sg {

namespace {

struct NpyHeader {
  ElementType type = ElementType::u8;
  int numbers = 1;    ///< 2 for complex
  bool half = false;  ///< 16-bit floats, stored as u16 until they are widened
  bool big_endian = false, fortran = false;
  std::vector<size_t> shape;
  size_t data_begin = 0;
};

// The text of a key's value in the header's Python dictionary: up to the comma or brace outside of brackets and quotes.
std::string_view value_of(std::string_view dict, std::string_view key, const std::string& where) {
  for (const char quote : {'\'', '"'}) {
    const std::string quoted = quote + std::string(key) + quote;
    size_t at = dict.find(quoted);
    if (at == std::string_view::npos) continue;
    at = dict.find(':', at + quoted.size());
    if (at == std::string_view::npos) break;
    int depth = 0;
    size_t end = ++at;
    for (char inside = 0; end < dict.size(); ++end) {
      const char c = dict[end];
      if (inside) inside = c == inside ? 0 : inside;
      else if (c == '\'' || c == '"') inside = c;
      else if (c == '(' || c == '[') ++depth;
      else if ((c == ')' || c == ']') && depth > 0) --depth;
      else if ((c == ',' || c == '}') && depth == 0) break;
    }
    return trim(dict.substr(at, end - at));
  }
  fail_data(fmt::format("the header has no '{}'", key), where,
            "expected e.g. {'descr': '<f4', 'fortran_order': False, 'shape': (64, 64, 64)}");
}

void parse_type(NpyHeader& h, std::string_view descr, const std::string& where) {
  if (!descr.empty() && descr[0] == '[') fail_data("structured arrays are not supported", where, "save one array per field");
  if (descr.size() >= 2 && (descr[0] == '\'' || descr[0] == '"')) descr = descr.substr(1, descr.size() - 2);
  const std::string_view full = descr;
  if (!descr.empty() && std::string_view("<>=|").find(descr[0]) != std::string_view::npos) {
    h.big_endian = descr[0] == '>';
    descr.remove_prefix(1);
  }
  struct {
    std::string_view name;
    ElementType type;
    int numbers;
    bool half;
  } static constexpr table[] = {{"u1", ElementType::u8, 1, false},  {"i1", ElementType::i8, 1, false},  {"b1", ElementType::u8, 1, false},
                                {"u2", ElementType::u16, 1, false}, {"i2", ElementType::i16, 1, false}, {"f2", ElementType::u16, 1, true},
                                {"u4", ElementType::u32, 1, false}, {"i4", ElementType::i32, 1, false}, {"f4", ElementType::f32, 1, false},
                                {"u8", ElementType::u64, 1, false}, {"i8", ElementType::i64, 1, false}, {"f8", ElementType::f64, 1, false},
                                {"c8", ElementType::f32, 2, false}, {"c16", ElementType::f64, 2, false}};
  for (const auto& t : table)
    if (t.name == descr) {
      h.type = t.type, h.numbers = t.numbers, h.half = t.half;
      return;
    }
  fail_data(fmt::format("numbers of type '{}' are not supported", full.substr(0, 40)), where,
            "supported: bool, int and uint of 8 to 64 bits, float of 16 to 64 bits, complex");
}

NpyHeader parse_npy_header(const MappedFile& file) {
  const std::string& where = file.path();
  const auto* bytes = file.data();
  if (file.size() < 10 || std::memcmp(bytes, "\x93NUMPY", 6) != 0) fail_data("does not begin as a .npy file", where);
  const int major = int(bytes[6]);
  if (major < 1 || major > 3) fail_data(fmt::format("byte 6: version {}", major), where, "1 to 3");
  const size_t front = major == 1 ? 10 : 12;
  if (file.size() < front) fail_data("the file ends in its header", where);
  const size_t length = major == 1 ? load<uint16_t>(bytes + 8) : load<uint32_t>(bytes + 8);
  if (length > file.size() - front)
    fail_data(fmt::format("the header should have {} bytes, but {} follow", length, file.size() - front), where);
  const std::string_view dict = file.text().substr(front, length);
  NpyHeader h;
  h.data_begin = front + length;
  parse_type(h, value_of(dict, "descr", where), where);
  const std::string_view order = value_of(dict, "fortran_order", where);
  if (order != "True" && order != "False")
    fail_data(fmt::format("'fortran_order' is '{}'", order.substr(0, 40)), where, "use True or False");
  h.fortran = order == "True";
  std::string_view shape = value_of(dict, "shape", where);
  if (shape.size() < 2 || shape.front() != '(' || shape.back() != ')')
    fail_data(fmt::format("'shape' is '{}'", shape.substr(0, 40)), where, "expected e.g. (64, 64, 64)");
  shape = trim(shape.substr(1, shape.size() - 2));
  if (!shape.empty() && shape.back() == ',') shape.remove_suffix(1);
  for (std::string_view s : split(shape, ',')) {
    if (!s.empty() && s.back() == 'L') s.remove_suffix(1);  // Python 2
    const auto v = parse_int(s);
    if (!v || *v < 0) fail_data(fmt::format("'shape': '{}' is not a valid size", s.substr(0, 40)), where);
    h.shape.push_back(size_t(*v));
  }
  if (h.shape.size() > 4)
    fail_data(fmt::format("an array of {} axes", h.shape.size()), where, "supported: up to 3 axes of numbers, or 4 with components last");
  return h;
}

float widen_half(uint16_t h) {
  const uint32_t sign = uint32_t(h & 0x8000) << 16, exponent = h >> 10 & 31, mantissa = h & 0x3ff;
  if (exponent == 0) return (sign ? -1.0f : 1.0f) * std::ldexp(float(mantissa), -24);
  const uint32_t bits = sign | (exponent == 31 ? 0x7f800000u : (exponent + 112) << 23) | mantissa << 13;
  return std::bit_cast<float>(bits);
}

// Fortran order puts the first index fastest: each number goes to its place in C order.
void from_fortran(const std::byte* in, size_t size, const std::array<size_t, 4>& n, std::byte* out) {
  // n: z, y, x, c; their strides in the file, in numbers.
  const size_t sz = 1, sy = n[0], sx = n[0] * n[1], sc = sx * n[2];
  parallel_for(n[0] * n[1], std::max<size_t>(1, (1 << 14) / std::max<size_t>(1, n[2] * n[3])), [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      const std::byte* from = in + (row / n[1] * sz + row % n[1] * sy) * size;
      std::byte* to = out + row * n[2] * n[3] * size;
      for (size_t i = 0; i < n[2]; ++i)
        for (size_t c = 0; c < n[3]; ++c, to += size) std::memcpy(to, from + (i * sx + c * sc) * size, size);
    }
  });
}

}  // namespace

bool sniff_npy(std::span<const std::byte> head) { return head.size() >= 10 && std::memcmp(head.data(), "\x93NUMPY", 6) == 0; }

Data read_npy(const std::string& path, const ReadOptions& options, Context& context) {
  BrickPart file;
  file.file = MappedFile(path);
  const NpyHeader h = parse_npy_header(file.file);
  file.begin = h.data_begin;
  std::array<size_t, 4> n{1, 1, 1, 1};  // z, y, x, components
  const size_t axes = std::min<size_t>(h.shape.size(), 3);
  for (size_t a = 0; a < axes; ++a) n[3 - axes + a] = h.shape[a];
  if (h.shape.size() == 4) n[3] = h.shape[3];
  const size_t total = checked_product({n[0], n[1], n[2], n[3]}, path);
  if (n[3] * size_t(h.numbers) > 1 << 20) fail_data(fmt::format("{} components", n[3]), path);
  BrickLayout l;
  l.type = h.type;
  l.count = total / n[3];
  l.components = int(n[3]) * h.numbers;
  l.big_endian = h.big_endian;

  DatasetParts out;
  UniformGrid grid;
  grid.dims = {n[2], n[1], n[0]};
  LatticePart part = cut_grid(grid, options.region);
  out.mesh = grid;
  Array a;
  if (h.fortran && h.shape.size() > 1) {
    const size_t size = element_size(h.type) * size_t(h.numbers);
    l.count = total, l.components = h.numbers;
    const Array stored = load_brick(l, {file}, context);
    std::byte* to = nullptr;
    const Array whole = Array::make_raw(h.type, total / n[3], int(n[3]) * h.numbers, &to);
    from_fortran(stored.raw(), size, n, to);
    a = whole;
    if (!part.whole()) {
      a = Array::make_raw(h.type, part.points(), whole.components(), &to);
      copy_part(whole.raw(), size * n[3], part, to);
    }
  } else {
    a = load_brick_part(l, part, {file}, context);
  }
  if (h.half) {
    const auto v = a.view<uint16_t>();
    float* wide = nullptr;
    const size_t numbers = a.count() * size_t(a.components());
    Array w = Array::make<float>(a.count(), a.components(), &wide);
    parallel_for(numbers, 1 << 16, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) wide[i] = widen_half(v.data[i]);
    });
    a = w;
  }
  const Role role = a.components() == 3 && is_float(a.type()) ? Role::vectors : Role::scalars;
  out.fields.add({"values", Association::point, std::move(a), "", role});
  return make_dataset(std::move(out));
}

void write_npy(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  const DatasetPtr d = single_dataset(data, "writing .npy");
  const Field* f = nullptr;
  for (const Field& g : d->fields())
    if (g.association == Association::point && (!f || (g.role == Role::scalars && f->role != Role::scalars))) f = &g;
  if (!f) fail_usage("there is no point field to write", path, "a .npy file holds one array of numbers");
  WriteLosses losses(path, ".npy");
  losses.keeps_only(*d, *f, false);
  losses.renames(*f, "values");
  const auto* placed = d->as<UniformGrid>();
  if (!placed) losses.also("leaves out the mesh and its positions");
  else if (!(placed->origin == Vec3() && placed->spacing == Vec3(1, 1, 1) && placed->direction == Mat3()))
    losses.also("leaves out the positions (origin, spacing and directions of the grid)");
  const Array a = f->array.made_packed();
  constexpr std::string_view types[] = {"|u1", "|i1", "<u2", "<i2", "<u4",
                                        "<i4", "<u8", "<i8", "<f4", "<f8"};  // in the order of ElementType
  std::string shape;
  if (const auto* g = d->as<UniformGrid>()) {
    // One number a point: axes of one point at the slow end are left out.
    if (f->components() > 1) shape = fmt::format("{}, {}, {}, {}", g->dims[2], g->dims[1], g->dims[0], f->components());
    else if (g->dims[2] > 1) shape = fmt::format("{}, {}, {}", g->dims[2], g->dims[1], g->dims[0]);
    else if (g->dims[1] > 1) shape = fmt::format("{}, {}", g->dims[1], g->dims[0]);
    else shape = fmt::format("{},", g->dims[0]);
  } else {
    shape = f->components() > 1 ? fmt::format("{}, {}", a.count(), f->components()) : fmt::format("{},", a.count());
  }
  std::string dict = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}", types[size_t(a.type())], shape);
  dict.append(63 - (dict.size() + 10) % 64, ' ');  // the numbers begin at a multiple of 64 bytes
  dict += '\n';
  const char front[10] = {'\x93', 'N', 'U', 'M', 'P', 'Y', 1, 0, char(dict.size() & 255), char(dict.size() >> 8)};
  AtomicFile file(path);
  file.write(front, sizeof front);
  file.write(dict);
  file.write(a.raw(), a.bytes());
  file.commit();
  losses.tell(context);
}

}  // namespace sg
