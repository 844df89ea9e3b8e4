// SPDX-License-Identifier: Apache-2.0
// BOV, "brick of values": a text header of KEY: VALUE lines describing one or several raw files. Source: VisIt, "Getting Data Into VisIt",
// chapter 3. Also a raw file named .bov whose size is only in its name.
#include <fmt/core.h>

#include <algorithm>

#include "base/bytes.h"
#include "base/file/file_fence.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/bytes/inflate.h"
#include "io/formats.h"
#include "io/mesh/unread.h"
#include "io/text/text_scan.h"
#include "io/volume/brick.h"
#include "io/volume/raw_guess.h"

namespace sg {

namespace {

struct BovHeader {
  std::string file, variable = "values";
  std::array<size_t, 3> size{0, 0, 0}, brick{0, 0, 0};  // numbers in all, numbers per file
  ElementType type = ElementType::f32;
  bool have_type = false, big_endian = false, zonal = false, divided = false;
  int components = 1;
  size_t offset = 0;
  Vec3 origin{0, 0, 0};
  std::optional<Vec3> extent;
  std::optional<double> time;
};

bool bov_type(std::string_view name, ElementType& type) {
  const std::string n = to_lower(name);
  if (n == "byte" || n == "bytes") return type = ElementType::u8, true;
  if (n == "short" || n == "shorts") return type = ElementType::i16, true;
  if (n == "int" || n == "ints") return type = ElementType::i32, true;
  if (n == "long" || n == "longs") return type = ElementType::i64, true;
  if (n == "float" || n == "floats") return type = ElementType::f32, true;
  if (n == "double" || n == "doubles") return type = ElementType::f64, true;
  return false;
}

class BovParser {
 public:
  BovParser(const std::string& path, Context& context) : path_(path), file_(path), context_(context) {}

  BovHeader run() {
    std::string_view rest = file_.text();
    for (number_ = 1; !rest.empty(); ++number_) {
      const size_t end = std::min(rest.find('\n'), rest.size());
      std::string_view line = rest.substr(0, end);
      rest.remove_prefix(std::min(end + 1, rest.size()));
      line = trim(line.substr(0, line.find('#')));
      if (line.empty()) continue;
      const size_t colon = line.find(':');
      if (colon == std::string_view::npos) fail(fmt::format("'{}' is not of the form KEY: VALUE", line.substr(0, 40)));
      key(to_lower(trim(line.substr(0, colon))), trim(line.substr(colon + 1)));
    }
    number_ = 0;
    if (h_.file.empty()) fail("has no DATA_FILE");
    if (h_.size[0] == 0) fail("has no DATA_SIZE");
    if (!h_.have_type) fail("has no DATA_FORMAT");
    if (h_.brick[0] == 0) h_.brick = h_.size;
    return h_;
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& hint = {}) const {
    fail_data(number_ ? fmt::format("line {}: {}", number_, problem) : problem, path_, hint);
  }
  double real(std::string_view w) const {
    const auto v = parse_double(w);
    if (!v || !std::isfinite(*v)) fail(fmt::format("'{}' is not a number", w.substr(0, 40)));
    return *v;
  }
  size_t count(std::string_view w, size_t least) const {
    const auto v = parse_int(w);
    if (!v || *v < int64_t(least)) fail(fmt::format("'{}' is not a valid count from {}", w.substr(0, 40), least));
    return size_t(*v);
  }
  std::array<size_t, 3> triple(std::string_view value) const {
    const auto w = words(value);
    if (w.size() != 3) fail("expected three numbers");
    return {count(w[0], 1), count(w[1], 1), count(w[2], 1)};
  }
  Vec3 vec(std::string_view value) const {
    const auto w = words(value);
    if (w.size() != 3) fail("expected three numbers");
    return {real(w[0]), real(w[1]), real(w[2])};
  }

  void key(const std::string& k, std::string_view v) {
    if (v.size() >= 2 && v.front() == '"' && v.back() == '"') v = v.substr(1, v.size() - 2);
    const std::string low = to_lower(v);
    if (k == "time") h_.time = real(v);
    else if (k == "data_file") h_.file = v;
    else if (k == "data_size" || k == "data size") h_.size = triple(v);
    else if (k == "data_format" || k == "data format") {
      if (!bov_type(v, h_.type)) fail(fmt::format("unknown DATA_FORMAT '{}'", v), "use BYTE, SHORT, INT, LONG, FLOAT or DOUBLE");
      h_.have_type = true;
    } else if (k == "variable") h_.variable = v;
    else if (k == "data_endian") {
      if (low != "little" && low != "big") fail(fmt::format("DATA_ENDIAN '{}'", v), "use LITTLE or BIG");
      h_.big_endian = low == "big";
    } else if (k == "centering") {
      if (low != "zonal" && low != "nodal") fail(fmt::format("CENTERING '{}'", v), "use zonal or nodal");
      h_.zonal = low == "zonal";
    } else if (k == "brick_origin" || k == "brick origin") h_.origin = vec(v);
    else if (k == "brick_size" || k == "brick size") h_.extent = vec(v);
    else if (k == "byte_offset") h_.offset = count(v, 0);
    else if (k == "divide_brick") h_.divided = low == "true";
    else if (k == "data_bricklets") bricklets_ = triple(v), h_.brick = bricklets_;
    else if (k == "data_components") {
      const size_t n = count(v, 1);
      if (n > 1000) fail(fmt::format("{} components", n));
      h_.components = int(n);
    } else if (k != "has_boundary") context_.warn(fmt::format("{}: line {}: unknown key '{}' is ignored", path_, number_, k));
  }

  std::string path_;
  MappedFile file_;
  Context& context_;
  BovHeader h_;
  std::array<size_t, 3> bricklets_{0, 0, 0};
  size_t number_ = 0;
};

Array brick_of(const std::string& path, const BovHeader& h, size_t count, Context& context) {
  BrickLayout l;
  l.type = h.type, l.count = count, l.components = h.components, l.big_endian = h.big_endian;
  BrickPart part;
  part.file = MappedFile(path);
  if (extension_of(path) == "gz") l.encoding = BrickEncoding::gzip, part.skip = int64_t(h.offset);
  else part.begin = h.offset;
  return load_brick(l, {part}, context);
}

/// Several files, numbered x fastest, each a part of the whole of equal size.
Array assembled(const std::string& path, const BovHeader& h, size_t count, Context& context) {
  std::array<size_t, 3> n{};
  for (size_t a = 0; a < 3; ++a) {
    if (h.size[a] % h.brick[a]) fail_data(fmt::format("DATA_BRICKLETS {} do not divide DATA_SIZE {}", h.brick[a], h.size[a]), path);
    n[a] = h.size[a] / h.brick[a];
  }
  const size_t files = checked_product({n[0], n[1], n[2]}, path);
  const size_t each = count / files, tuple = element_size(h.type) * size_t(h.components);
  const std::vector<std::string> names = pattern_names(h.file, 0, int64_t(files) - 1, 1, path);
  std::vector<Array> parts;
  for (const std::string& name : names) parts.push_back(brick_of(named_file(path, name), h, each, context));
  std::byte* out = nullptr;
  Array a = Array::make_raw(h.type, count, h.components, &out);
  parallel_for(files, 1, [&](size_t f, size_t) {
    const size_t x0 = f % n[0] * h.brick[0], y0 = f / n[0] % n[1] * h.brick[1], z0 = f / (n[0] * n[1]) * h.brick[2];
    for (size_t z = 0; z < h.brick[2]; ++z)
      for (size_t y = 0; y < h.brick[1]; ++y)
        std::memcpy(out + (x0 + h.size[0] * (y0 + y + h.size[1] * (z0 + z))) * tuple,
                    parts[f].raw() + h.brick[0] * (y + h.brick[1] * z) * tuple, h.brick[0] * tuple);
  });
  return a;
}

DatasetPtr grid_of(const BovHeader& h, Array values) {
  UniformGrid g;
  for (size_t a = 0; a < 3; ++a) {
    const size_t gaps = h.zonal ? h.size[a] : h.size[a] - 1;
    g.dims[a] = gaps + 1;
    if (h.extent && gaps > 0 && (*h.extent)[int(a)] != 0) g.spacing[int(a)] = (*h.extent)[int(a)] / double(gaps);
  }
  g.origin = h.origin;
  DatasetParts d;
  d.mesh = g;
  const Role role = h.components == 3 ? Role::vectors : Role::scalars;
  if (!values.empty()) d.fields.add({h.variable, h.zonal ? Association::cell : Association::point, std::move(values), "", role});
  d.time = h.time;
  return make_dataset(std::move(d));
}

}  // namespace

bool sniff_bov(std::span<const std::byte> head) {
  std::string_view t(reinterpret_cast<const char*>(head.data()), head.size());
  bool file = false, size = false;
  while (!t.empty()) {
    const size_t end = std::min(t.find('\n'), t.size());
    const std::string line = to_lower(trim(t.substr(0, end)));
    t.remove_prefix(std::min(end + 1, t.size()));
    file = file || line.starts_with("data_file:");
    size = size || line.starts_with("data_size:") || line.starts_with("data size:") || line.starts_with("data_format:");
  }
  return file && size;
}

Data read_bov(const std::string& path, const ReadOptions& options, Context& context) {
  BovHeader h = BovParser(path, context).run();
  const size_t count = checked_product({h.size[0], h.size[1], h.size[2]}, path);
  if (!is_wanted(options.fields, h.variable)) return grid_of(h, {});
  const bool several = h.file.find('%') != std::string::npos;
  if (options.header_only) return grid_of(h, unread_values(h.type, count, h.components));
  return grid_of(h, several ? assembled(path, h, count, context) : brick_of(named_file(path, h.file), h, count, context));
}

Data read_bare_bov(const std::string& path, const ReadOptions&, Context& context) {
  const MappedFile file(path);
  const auto guess = guess_raw(file);
  if (!guess)
    fail_data("is not a BOV header, and its name and length do not tell the size", path,
              "a header has lines like 'DATA_FILE: values.dat'; for raw numbers give --dims NX,NY,NZ and --type");
  BovHeader h;
  h.size = guess->dims, h.type = guess->type, h.big_endian = guess->big_endian;
  context.warn(fmt::format("{}: has no header; read as {}, judging by its name and length", path, guess->text()));
  return grid_of(h, brick_of(path, h, checked_product({h.size[0], h.size[1], h.size[2]}, path), context));
}

}  // namespace sg
