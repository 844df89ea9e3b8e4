// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/zarr_array.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "base/bytes.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "io/zarr/zarr_json.h"

namespace sg::zarr {

namespace {

constexpr uint64_t largest_chunk = uint64_t(1) << 30, most_elements = uint64_t(1) << 56;

// "<f4", "|u1", ">i2".
void parse_v2_type(ZarrArray& a, const Json& json, const std::string& path) {
  const std::string text = text_of(json, "dtype", "");
  constexpr std::string_view types[] = {"u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"};  // in the order of ElementType
  if (text.size() == 3 && std::string_view("<>|=").find(text[0]) != std::string_view::npos) {
    a.big_endian = text[0] == '>';
    const std::string_view name = std::string_view(text).substr(1);
    for (size_t i = 0; i < std::size(types); ++i)
      if (types[i] == (name == "b1" ? "u1" : name)) {
        a.type = ElementType(i);
        return;
      }
  }
  fail_data(fmt::format("numbers of type '{}' are not supported", text.substr(0, 40)), path,
            "supported: int and uint of 8 to 64 bits, float of 32 and 64");
}

void set_fill(ZarrArray& a, const Json& v, const std::string& path) {
  double d = 0;
  if (v.is_null()) return;
  if (v.is_text()) {
    const std::string& s = v.text();
    if (s == "NaN") d = std::nan("");
    else if (s == "Infinity") d = HUGE_VAL;
    else if (s == "-Infinity") d = -HUGE_VAL;
    else fail_data(fmt::format("the fill value '{}' is not a number", s.substr(0, 40)), path);
    if (!is_float(a.type)) fail_data(fmt::format("the fill value {} is not a whole number", s), path);
  } else if (v.is_number()) {
    d = v.number();
  } else if (v.is_bool()) {
    d = v.boolean() ? 1 : 0;
  } else {
    fail_data("the fill value is not a number", path);
  }
  const Array one = Array::from_vector(std::vector<double>{d}).converted(a.type);
  // 64-bit integers do not pass through doubles unchanged.
  if (v.is_whole() && a.type == ElementType::u64) {
    const uint64_t w = v.whole();
    std::memcpy(a.fill, &w, 8);
  } else if ((v.is_whole() || v.negative() < 0) && a.type == ElementType::i64) {
    const int64_t w = v.is_whole() ? int64_t(v.whole()) : v.negative();
    std::memcpy(a.fill, &w, 8);
  } else {
    std::memcpy(a.fill, one.raw(), element_size(a.type));
  }
}

void check_sizes(const ZarrArray& a, const std::string& path) {
  uint64_t elements = 1, chunk = element_size(a.type);
  if (a.shape.empty() || a.shape.size() > 8) fail_data(fmt::format("has {} axes", a.shape.size()), path, "1 to 8 are supported");
  for (const size_t n : a.shape)
    if (!multiply(elements, n, elements) || elements > most_elements) fail_data("the shape has more than 2^56 elements", path);
  for (const size_t n : a.chunk)
    if (!multiply(chunk, n, chunk) || chunk > largest_chunk)
      fail_data("a chunk has more than 1 GiB", path, "chunks of a few MiB are usual");
}

void add_codec(ZarrArray& a, const std::string& name, const std::string& path) {
  Codec c;
  if (!parse_codec(name, c))
    fail_data(fmt::format("chunks packed by '{}' are not supported", name.substr(0, 40)), path,
              "supported: zlib, gzip, bz2, zstd, blosc, lz4, none");
  a.codecs.push_back(c);
}

ZarrArray parse_v2(const Json& json, const std::string& folder, const std::string& path) {
  ZarrArray a;
  a.folder = folder;
  parse_v2_type(a, json, path);
  a.shape = whole_numbers(json, "shape", 0, 1, path);
  a.chunk = whole_numbers(json, "chunks", a.shape.size(), 1, path);
  check_sizes(a, path);
  if (const std::string order = text_of(json, "order", "C"); order != "C")
    fail_data(fmt::format("the order of numbers is '{}'", order.substr(0, 10)), path, "only 'C' is supported");
  if (const Json* filters = list_of(json, "filters"); filters && !filters->empty())
    fail_data("filters before the compressor are not supported", path, "write the array without filters");
  if (const Json* c = object_of(json, "compressor")) add_codec(a, text_of(*c, "id", ""), path);
  const std::string separator = text_of(json, "dimension_separator", ".");
  if (separator != "." && separator != "/")
    fail_data(fmt::format("the dimension separator is '{}'", separator.substr(0, 10)), path, ". or /");
  a.separator = separator[0];
  set_fill(a, json["fill_value"], path);
  return a;
}

void parse_v3_codecs(ZarrArray& a, const Json& json, const std::string& path) {
  const Json* codecs = list_of(json, "codecs");
  if (!codecs) fail_data("has no list 'codecs'", path);
  bool bytes = false;
  for (const Json& c : codecs->items()) {
    const std::string name = c.is_text() ? c.text() : text_of(c, "name", "");
    if (name == "bytes") {
      const Json* how = object_of(c, "configuration");
      a.big_endian = how && text_of(*how, "endian", "little") == "big";
      bytes = true;
    } else if (name == "sharding_indexed") {
      fail_data("shards (many chunks in one file) are not supported", path, "write the array without shards");
    } else {
      add_codec(a, name, path);
    }
  }
  if (!bytes) fail_data("the codecs do not say how numbers are stored as bytes", path, "expected a codec 'bytes'");
}

ZarrArray parse_v3(const Json& json, const std::string& folder, const std::string& path) {
  ZarrArray a;
  a.folder = folder;
  const std::string type = text_of(json, "data_type", "");
  if (type == "bool") a.type = ElementType::u8;
  else if (!parse_element_type(type, a.type)) fail_data(fmt::format("numbers of type '{}' are not supported", type.substr(0, 40)), path);
  a.shape = whole_numbers(json, "shape", 0, 1, path);
  const Json* grid = object_of(json, "chunk_grid");
  const Json* how = grid && text_of(*grid, "name", "") == "regular" ? object_of(*grid, "configuration") : nullptr;
  if (!how) fail_data("the grid of chunks is not regular", path);
  a.chunk = whole_numbers(*how, "chunk_shape", a.shape.size(), 1, path);
  check_sizes(a, path);
  a.before = "c/", a.separator = '/';
  if (const Json* key = object_of(json, "chunk_key_encoding")) {
    const bool v2 = text_of(*key, "name", "default") == "v2";
    const Json* config = object_of(*key, "configuration");
    const std::string separator = config ? text_of(*config, "separator", v2 ? "." : "/") : v2 ? "." : "/";
    if (separator != "." && separator != "/") fail_data("the separator of chunk names is neither '.' nor '/'", path);
    a.separator = separator[0];
    a.before = v2 ? "" : std::string("c") + separator;
  }
  parse_v3_codecs(a, json, path);
  set_fill(a, json["fill_value"], path);
  if (const Json* names = list_of(json, "dimension_names"); names && names->size() == a.shape.size())
    for (const Json& n : names->items()) a.names.push_back(n.text());
  return a;
}

// The whole of a small file; false when there is none. Mapping costs more than reading here.
bool read_all(const std::string& path, std::vector<std::byte>& out) {
  check_may_read(path);
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) {
    if (errno == ENOENT || errno == ENOTDIR) return false;
    fail_data(std::string("cannot be opened: ") + std::strerror(errno), path);
  }
  struct Close {
    int fd;
    ~Close() { ::close(fd); }
  } const close{fd};
  struct stat st {};
  if (::fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) fail_data("is not a file", path);
  out.resize(size_t(st.st_size));
  for (size_t got = 0; got < out.size();) {
    const ssize_t n = ::read(fd, out.data() + got, out.size() - got);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail_data(n < 0 ? std::string("cannot be read: ") + std::strerror(errno) : std::string("ends before its size"), path);
    got += size_t(n);
  }
  return true;
}

}  // namespace

size_t ZarrArray::chunk_bytes() const {
  size_t n = element_size(type);
  for (const size_t c : chunk) n *= c;
  return n;
}

std::string ZarrArray::chunk_path(std::span<const size_t> at) const {
  std::string path = folder + before;
  for (size_t a = 0; a < at.size(); ++a) {
    if (a) path += separator;
    path += std::to_string(at[a]);
  }
  return path;
}

bool ZarrArray::read_chunk(std::span<const size_t> at, std::byte* out, std::vector<std::byte>& packed) const {
  const std::string path = chunk_path(at);
  if (!read_all(path, packed)) return false;
  const size_t bytes = chunk_bytes();
  decode(codecs, packed, out, bytes, path);
  if (big_endian && element_size(type) > 1) {
    const size_t size = element_size(type);
    for (size_t i = 0; i < bytes; i += size)
      std::reverse(out + i, out + i + size);  // swap_bytes() is parallel, this is called from inside loops
  }
  return true;
}

std::optional<ZarrArray> open_array(const std::string& folder) {
  if (const auto json = read_json(folder + ".zarray")) {
    if ((*json)["zarr_format"].whole() != 2) fail_data("is not of Zarr version 2", folder + ".zarray");
    return parse_v2(*json, folder, folder + ".zarray");
  }
  const std::string path = folder + "zarr.json";
  const auto json = read_json(path);
  if (!json || text_of(*json, "node_type", "") != "array") return std::nullopt;
  if ((*json)["zarr_format"].whole() != 3) fail_data("is not of Zarr version 3", path);
  return parse_v3(*json, folder, path);
}

}  // namespace sg::zarr
