// SPDX-License-Identifier: Apache-2.0
// Decoding of one DataArray. In base64 as in raw bytes an array is
//   plain       [bytes] numbers
//   compressed  [blocks] [bytes per block] [bytes of the last, 0 = full] [compressed bytes of each block]... block block ...
// with [x] of header_type. In base64 the header of a compressed array is a padded stream of its own.
#include <fmt/core.h>
#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <tuple>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "data/lattice_crop.h"
#include "io/vtk/vtk_numbers.h"
#include "io/vtk/xml/vtk_xml.h"

namespace sg::vtk {

// What the element requires.
struct XmlFile::Wanted {
  pugi::xml_node element;
  ElementType type = ElementType::f32;
  bool bits = false, text = false;
  int components = 1;
  std::optional<uint64_t> tuples;
};

// Where its bytes are: to the end of the appended section, or the text of the element.
struct XmlFile::Source {
  std::string_view bytes;
  bool base64 = false;
  std::shared_ptr<std::string> joined = std::make_shared<std::string>();  // the text without white space, when there was some
};

namespace {

bool has_blanks(std::string_view s) {
  unsigned char n = 0;
  for (const char c : s) n |= static_cast<unsigned char>(static_cast<unsigned char>(c) <= ' ');
  return n != 0;
}

}  // namespace

uint64_t XmlFile::word(const std::byte* p) const { return wide_header_ ? load<uint64_t>(p, big_endian_) : load<uint32_t>(p, big_endian_); }

uint64_t XmlFile::most_bytes() const {
  // As text a byte is two characters and eight bytes are two characters ("0 "); a bit of raw bytes becomes a byte.
  const uint64_t plain = uint64_t(file_.size()) * 8;
  return codec_ == Codec::none ? plain : std::max(plain, most_uncompressed(codec_, file_.size()));
}

XmlFile::Source XmlFile::source(pugi::xml_node element) const {
  Source s;
  if (std::string_view(element.attribute("format").value()) != "appended") {
    s.base64 = true;
    s.bytes = text_of(element, *s.joined);
    if (has_blanks(s.bytes)) {
      std::string tight;
      for (const char c : s.bytes)
        if (static_cast<unsigned char>(c) > ' ') tight += c;
      *s.joined = std::move(tight);
      s.bytes = *s.joined;
    }
    return s;
  }
  if (!have_appended_) fail("is appended, but the file has no AppendedData", element);
  if (!element.attribute("offset")) fail("is appended but has no offset", element);
  const uint64_t offset = parse_count(*this, element, "offset");
  if (offset > appended_.size())
    fail(fmt::format("begins at offset {} of {} appended bytes", offset, appended_.size()), element,
         "the file is truncated or the offset is wrong");
  s.base64 = appended_base64_;
  s.bytes = appended_.substr(offset);
  return s;
}

// Bytes of `available` that make the array; checks that they are enough.
uint64_t XmlFile::bytes_to_read(const Wanted& want, uint64_t available) const {
  const uint64_t tuple = uint64_t(want.components) * element_size(want.type);
  if (!want.tuples) return want.bits ? available : available / tuple * tuple;
  uint64_t n = 0;
  if (!multiply(*want.tuples, tuple, n)) fail(fmt::format("has {} tuples, which exceed any memory", *want.tuples), want.element);
  if (want.bits) n = n / 8 + (n % 8 != 0);
  if (n > available)
    fail(fmt::format("needs {} bytes for {} tuples but holds {}", n, *want.tuples, available), want.element,
         "the file is truncated or the count is wrong");
  return n;
}

// Numbers in the file's byte order, `bytes` of them at `offset`, as an array of aligned native numbers.
Array XmlFile::finished(const Wanted& want, Buffer buffer, size_t offset, size_t bytes) const {
  const std::byte* from = buffer.data + offset;
  if (want.bits) {
    const size_t n = want.tuples ? size_t(*want.tuples) * size_t(want.components) : bytes * 8;
    uint8_t* out = nullptr;
    Array a = Array::make<uint8_t>(n / size_t(want.components), want.components, &out);
    for (size_t i = 0; i < a.count() * size_t(want.components); ++i) out[i] = uint8_t(from[i / 8] >> (7 - i % 8)) & 1;
    return a;
  }
  const size_t size = element_size(want.type), n = bytes / size, tuples = n / size_t(want.components);
  const bool swap = big_endian_ && size > 1;
  if (!swap && reinterpret_cast<uintptr_t>(from) % size == 0) {
    const ptrdiff_t step = ptrdiff_t(size);
    return Array(std::move(buffer), want.type, tuples, want.components, offset, step * want.components, step);
  }
  std::byte* out = nullptr;
  Array a = Array::make_raw(want.type, tuples, want.components, &out);
  if (swap && buffer.data == file_.data()) read_swapped(file_, offset, n, size, out);
  else if (swap) swap_bytes_copy(out, from, n, size);
  else if (buffer.data == file_.data()) file_.copy_to(out, offset, bytes);  // VTK writes arrays on any byte
  else parallel_for(bytes, size_t(1) << 20, [&](size_t begin, size_t end) { std::memcpy(out + begin, from + begin, end - begin); });
  return a;
}

Array XmlFile::plain(const Wanted& want, const Source& s) const {
  const size_t header = word_bytes();
  if (!s.base64) {
    if (s.bytes.size() < header) fail("is too short for its size", want.element, "the file is truncated");
    const auto* p = reinterpret_cast<const std::byte*>(s.bytes.data());
    const uint64_t available = word(p);
    if (available > s.bytes.size() - header)
      fail(fmt::format("announces {} bytes, but the file has {}", available, s.bytes.size() - header), want.element,
           "the file is truncated or damaged");
    const Buffer whole{file_.owner(), file_.data(), file_.size()};
    return finished(want, whole, size_t(p + header - file_.data()), bytes_to_read(want, available));
  }
  std::byte head[8];
  const size_t used = decode_base64(s.bytes, head, header);
  if (used == SIZE_MAX) fail("is not base64", want.element, "the file is truncated or damaged");
  const uint64_t available = word(head);
  if (available > s.bytes.size() / 4 * 3)
    fail(fmt::format("announces {} bytes, but its text has {}", available, s.bytes.size()), want.element,
         "the file is truncated or damaged");
  const size_t bytes = bytes_to_read(want, available);
  // Size and numbers are one stream; decoded so that the numbers start on a cache line.
  std::byte* out = nullptr;
  const Buffer b = Buffer::allocate(64 + bytes, &out);
  if (decode_base64(s.bytes, out + 64 - header, header + bytes) == SIZE_MAX)
    fail("is not base64", want.element, "the file is truncated or damaged");
  return finished(want, b, 64, bytes);
}

// Where the compressed blocks of an array lie.
struct XmlFile::BlockTable {
  size_t blocks = 0, block = 0, last = 0;  // unpacked bytes of a block, of the last one
  uint64_t total = 0;                      // unpacked bytes of all
  std::vector<size_t> starts;              // packed
  Buffer decoded;                          // of base64
  const std::byte* packed = nullptr;

  size_t bytes_of(size_t i) const { return i + 1 == blocks ? last : block; }
  bool unpack(Codec codec, size_t i, std::byte* out) const {
    return decompress_block(codec, packed + starts[i], starts[i + 1] - starts[i], out, bytes_of(i));
  }
};

XmlFile::BlockTable XmlFile::block_table(const Wanted& want, const Source& s) const {
  const size_t w = word_bytes();
  auto damaged = [&](std::string what) { fail(std::move(what), want.element, "the file is truncated or damaged"); };
  auto head_bytes = [&](std::byte* to, size_t n) {
    if (s.base64) return decode_base64(s.bytes, to, n);
    if (s.bytes.size() < n) return SIZE_MAX;
    std::memcpy(to, s.bytes.data(), n);
    return n;
  };
  std::byte three[24];
  size_t used = head_bytes(three, 3 * w);
  if (used == SIZE_MAX) damaged("has no header for its compressed blocks");
  BlockTable t;
  const uint64_t blocks = word(three), block = word(three + w), last = word(three + 2 * w);
  if (blocks > s.bytes.size() / w) damaged(fmt::format("announces {} compressed blocks in {} bytes", blocks, s.bytes.size()));
  std::vector<std::byte> head((3 + blocks) * w);
  used = head_bytes(head.data(), head.size());
  if (used == SIZE_MAX) damaged(fmt::format("has no sizes for its {} compressed blocks", blocks));
  if (last > block || !multiply(blocks, block, t.total)) damaged(fmt::format("has {} blocks of {} and {} bytes", blocks, block, last));
  if (last > 0 && blocks > 0) t.total -= block - last;
  t.blocks = blocks, t.block = block, t.last = last > 0 ? last : block;
  if (blocks == 1) t.block = t.last;  // nothing else backs the size of a whole block
  t.starts.assign(blocks + 1, 0);
  const std::string_view rest = s.bytes.substr(used);
  const uint64_t most = s.base64 ? rest.size() / 4 * 3 : rest.size();
  for (uint64_t i = 0; i < blocks; ++i) {
    const uint64_t size = word(&head[(3 + i) * w]);
    uint64_t end = 0;
    if (!add(t.starts[i], size, end) || end > most)
      damaged(fmt::format("has a compressed block {} of {} bytes in {}", i, size, most - t.starts[i]));
    if (t.bytes_of(i) > most_uncompressed(codec_, size))
      damaged(fmt::format("announces that {} bytes of block {} hold {}", size, i, t.bytes_of(i)));
    t.starts[i + 1] = end;
  }
  t.packed = reinterpret_cast<const std::byte*>(rest.data());
  if (s.base64) {
    std::byte* to = nullptr;
    t.decoded = Buffer::allocate(t.starts.back(), &to);
    if (decode_base64(rest, to, t.starts.back()) == SIZE_MAX) damaged("is not base64");
    t.packed = to;
  }
  return t;
}

// Whole pages of a mapped file may go; they come back from the file when they are looked at again.
static void forget_mapped(const std::byte* p, size_t bytes) {
  constexpr uintptr_t page = 4096;
  const auto begin = (reinterpret_cast<uintptr_t>(p) + page - 1) / page * page,
             end = (reinterpret_cast<uintptr_t>(p) + bytes) / page * page;
  if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
}

Array XmlFile::compressed(const Wanted& want, const Source& s) const {
  const BlockTable t = block_table(want, s);
  const size_t bytes = bytes_to_read(want, t.total);
  std::byte* out = nullptr;
  const size_t needed = t.block ? (bytes + t.block - 1) / t.block : 0;
  const Buffer b = Buffer::allocate(size_t(std::min<uint64_t>(t.total, uint64_t(needed) * t.block)), &out);
  std::atomic<bool> good{true};
  // About 1 MiB of packed bytes at a time, which are then dropped from memory: they are not needed again.
  const size_t packed = needed ? t.starts[needed] : 0;
  const size_t grain = packed < size_t(16) << 20 ? 1 : std::max<size_t>(1, needed / (packed >> 20));
  parallel_for(needed, grain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i)
      if (!t.unpack(codec_, i, out + i * t.block)) good = false;
    if (grain > 1 && !s.base64) forget_mapped(t.packed + t.starts[begin], t.starts[end] - t.starts[begin]);
  });
  if (!good) fail("cannot be decompressed", want.element, "the file is truncated or damaged");
  return finished(want, b, 0, bytes);
}

// 64-bit numbers on any byte as 32-bit ones; false when one does not fit.
static bool narrow(const std::byte* from, size_t n, int32_t* to) {
  int64_t odd = 0;
  for (size_t i = 0; i < n; ++i) {
    const auto v = load<int64_t>(from + 8 * i, false);
    to[i] = int32_t(v);
    odd |= v ^ int64_t(to[i]);
  }
  return odd == 0;
}

// Thread-local memory for a block in transit, which stays in the cache.
static std::byte* scratch(size_t bytes) {
  thread_local std::vector<std::byte> own;
  if (own.size() < bytes) own.resize(bytes);
  return own.data();
}
constexpr size_t most_scratch = size_t(1) << 20;

// Empty when a number does not fit, or the blocks are of an odd size.
Array XmlFile::narrowed_blocks(const Wanted& want, const Source& s) const {
  const BlockTable t = block_table(want, s);
  const size_t bytes = bytes_to_read(want, t.total);
  if (t.block == 0 || t.block % 8 != 0 || t.block > most_scratch) return {};
  int32_t* out = nullptr;
  Array a = Array::make<int32_t>(bytes / 8, 1, &out);
  const size_t needed = (bytes + t.block - 1) / t.block, packed = needed ? t.starts[needed] : 0;
  const size_t grain = packed < size_t(16) << 20 ? 1 : std::max<size_t>(1, needed / (packed >> 20));
  std::atomic<bool> good{true}, fits{true};
  parallel_for(needed, grain, [&](size_t begin, size_t end) {
    std::byte* block = scratch(t.block);
    for (size_t i = begin; i < end && fits; ++i) {
      const size_t n = std::min(bytes - i * t.block, t.bytes_of(i)) / 8;
      if (!t.unpack(codec_, i, block)) good = false;
      else if (!narrow(block, n, out + i * t.block / 8)) fits = false;
    }
    if (grain > 1 && !s.base64) forget_mapped(t.packed + t.starts[begin], t.starts[end] - t.starts[begin]);
  });
  return good && fits ? a : Array();
}

// Empty when a number does not fit, or when the bytes can stay where they are.
Array XmlFile::narrowed_plain(const Wanted& want, const Source& s) const {
  const size_t header = word_bytes();
  const auto* p = reinterpret_cast<const std::byte*>(s.bytes.data());
  if (s.base64 || s.bytes.size() < header || reinterpret_cast<uintptr_t>(p + header) % 8 == 0) return {};
  const uint64_t available = word(p);
  if (available > s.bytes.size() - header) return {};
  const size_t n = bytes_to_read(want, available) / 8, offset = size_t(p + header - file_.data());
  int32_t* out = nullptr;
  Array a = Array::make<int32_t>(n, 1, &out);
  std::atomic<bool> fits{true};
  parallel_for(n, size_t(1) << 15, [&](size_t begin, size_t end) {
    std::byte* block = scratch((end - begin) * 8);
    file_.copy_to(block, offset + begin * 8, (end - begin) * 8);
    if (fits && !narrow(block, end - begin, out + begin)) fits = false;
  });
  return fits ? a : Array();
}

Array XmlFile::ids(pugi::xml_node element, std::optional<uint64_t> tuples) const {
  const Wanted want = wanted(element, tuples);
  Array a;
  if (want.type == ElementType::i64 && want.components == 1 && !want.text && !big_endian_)
    if (const Source s = source(element); !s.bytes.empty()) a = codec_ == Codec::none ? narrowed_plain(want, s) : narrowed_blocks(want, s);
  return a.empty() ? array(element, tuples) : a;
}

int XmlFile::equal_steps(pugi::xml_node element, uint64_t n) const {
  const Wanted want = wanted(element, n);
  if (n == 0 || codec_ == Codec::none || want.type != ElementType::i64 || want.components != 1 || want.text || big_endian_) return 0;
  const Source s = source(element);
  if (s.bytes.empty() || s.base64) return 0;
  const BlockTable t = block_table(want, s);
  const size_t bytes = bytes_to_read(want, t.total);
  if (t.block == 0 || t.block % 8 != 0 || t.block > most_scratch || !t.unpack(codec_, 0, scratch(t.block))) return 0;
  const auto step = load<int64_t>(scratch(8), false);
  constexpr int64_t most = 4096;  // larger cells are worth their offsets
  if (step <= 0 || step > most || n > uint64_t(INT64_MAX / most)) return 0;
  std::atomic<bool> equal{true};
  parallel_for((bytes + t.block - 1) / t.block, 1, [&](size_t i, size_t) {
    std::byte* block = scratch(t.block);
    if (!equal || !t.unpack(codec_, i, block)) return void(equal = false);
    int64_t odd = 0, want_next = int64_t(i * t.block / 8) * step;
    const size_t count = std::min(bytes - i * t.block, t.bytes_of(i)) / 8;
    for (size_t k = 0; k < count; ++k) odd |= load<int64_t>(block + 8 * k, false) ^ (want_next += step);
    if (odd) equal = false;
  });
  return equal ? int(step) : 0;
}

// Calls f(bytes from the start of the array, row of the window) for the rows of the planes [begin, end) of a window.
template <class F>
static void for_rows(const Window& w, size_t tuple, size_t begin, size_t end, F&& f) {
  parallel_for((end - begin) * w.count[1], 16, [&](size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) {
      const size_t row = begin * w.count[1] + i;
      const size_t j = w.lo[1] + row % w.count[1] * w.stride[1], k = w.lo[2] + row / w.count[1] * w.stride[2];
      f((w.lo[0] + w.dims[0] * (j + w.dims[1] * k)) * tuple, row);
    }
  });
}

// Tuples of a row, `stride` apart.
static void copy_row(const std::byte* from, size_t count, size_t stride, size_t tuple, std::byte* to) {
  if (stride == 1) std::memcpy(to, from, count * tuple);
  else
    for (size_t i = 0; i < count; ++i) std::memcpy(to + i * tuple, from + i * stride * tuple, tuple);
}

Array XmlFile::raw_window(const Wanted& want, const std::byte* numbers, const Window& w) const {
  const size_t tuple = size_t(want.components) * element_size(want.type), row_bytes = w.count[0] * tuple;
  std::byte* out = nullptr;
  const Array a = Array::make_raw(want.type, w.tuples(), want.components, &out);
  for_rows(w, tuple, 0, w.count[2],
           [&](size_t from, size_t row) { copy_row(numbers + from, w.count[0], w.stride[0], tuple, out + row * row_bytes); });
  if (big_endian_) swap_bytes(out, w.tuples() * size_t(want.components), element_size(want.type));
  return a;
}

Array XmlFile::compressed_window(const Wanted& want, const Source& s, const Window& w) const {
  const BlockTable t = block_table(want, s);
  bytes_to_read(want, t.total);
  const size_t tuple = size_t(want.components) * element_size(want.type), row_bytes = w.count[0] * tuple;
  const size_t span = ((w.count[0] - 1) * w.stride[0] + 1) * tuple;  // bytes of a row, those between its tuples too
  std::byte* out = nullptr;
  const Array a = Array::make_raw(want.type, w.tuples(), want.components, &out);
  // Some planes at a time, so that the unpacked blocks of a thinned grid need not fit into memory together.
  constexpr size_t most = size_t(64) << 20;
  const size_t planes = std::max<size_t>(1, most / std::max<size_t>(1, w.dims[0] * w.dims[1] * tuple));
  for (size_t k = 0; k < w.count[2]; k += planes) {
    const size_t stop = std::min(k + planes, w.count[2]);
    std::vector<size_t> slot(t.blocks + 1, 0);
    for (size_t p = k; p < stop; ++p)
      for (size_t j = 0; j < w.count[1]; ++j) {
        const size_t y = w.lo[1] + j * w.stride[1], z = w.lo[2] + p * w.stride[2];
        const size_t begin = (w.lo[0] + w.dims[0] * (y + w.dims[1] * z)) * tuple;
        for (size_t i = begin / t.block; i <= (begin + span - 1) / t.block; ++i) slot[i] = 1;
      }
    std::vector<size_t> needed;
    for (size_t i = 0; i < t.blocks; ++i)
      if (slot[i]) slot[i] = needed.size(), needed.push_back(i);
    std::byte* unpacked = nullptr;
    const Buffer scratch = Buffer::allocate(needed.size() * t.block, &unpacked);
    std::atomic<bool> good{true};
    parallel_for(needed.size(), 1, [&](size_t i, size_t) {
      if (!t.unpack(codec_, needed[i], unpacked + i * t.block)) good = false;
    });
    if (!good) fail("cannot be decompressed", want.element, "the file is truncated or damaged");
    for_rows(w, tuple, k, stop, [&](size_t from, size_t row) {
      std::byte* to = out + row * row_bytes;
      const size_t first = from / t.block, at = from % t.block;
      if (at + span <= t.block) return copy_row(unpacked + slot[first] * t.block + at, w.count[0], w.stride[0], tuple, to);
      std::vector<std::byte> joined(span);  // a row that runs over the end of a block
      for (size_t done = 0; done < span;) {
        const size_t i = (from + done) / t.block, o = (from + done) % t.block, n = std::min(span - done, t.block - o);
        std::memcpy(&joined[done], unpacked + slot[i] * t.block + o, n);
        done += n;
      }
      copy_row(joined.data(), w.count[0], w.stride[0], tuple, to);
    });
  }
  if (big_endian_) swap_bytes(out, w.tuples() * size_t(want.components), element_size(want.type));
  return a;
}

Array XmlFile::text(const Wanted& want) const {
  std::string joined;
  const std::string_view t = text_of(want.element, joined);
  uint64_t n = 0;
  if (!want.tuples) n = count_words(t) / size_t(want.components) * size_t(want.components);
  else if (!multiply(*want.tuples, uint64_t(want.components), n) || n > (t.size() + 1) / 2)
    fail(fmt::format("has {} tuples of {} but only {} characters", *want.tuples, want.components, t.size()), want.element,
         "the file is truncated or the count is wrong");
  std::byte* out = nullptr;
  Array a = Array::make_raw(want.type, n / size_t(want.components), want.components, &out);
  const NumbersEnd end = parse_numbers(t, want.type, n, out);
  if (end.parsed == n) return a;
  if (!end.bad)
    fail(fmt::format("ends after {} of {} numbers", end.parsed, n), want.element, "the file is truncated or the count is wrong");
  const auto at = size_t(end.bad - t.data());
  fail(fmt::format("'{}' is not a valid {} number ({} of {})", words(t.substr(at, 40)).front(), element_name(want.type), end.parsed + 1, n),
       want.element);
}

const std::byte* XmlFile::in_place(pugi::xml_node element, uint64_t tuples, ElementType& type) const {
  if (big_endian_ || codec_ != Codec::none || appended_base64_ || std::string_view(element.attribute("format").value()) != "appended")
    return nullptr;
  if (!parse_element_type(element.attribute("type").value(), type) ||
      (element.attribute("NumberOfComponents") && parse_count(*this, element, "NumberOfComponents") != 1))
    return nullptr;
  const Source s = source(element);
  const size_t header = word_bytes();
  if (s.bytes.size() < header) return nullptr;
  const auto* p = reinterpret_cast<const std::byte*>(s.bytes.data());
  uint64_t bytes = 0;
  const uint64_t available = word(p);
  if (available > s.bytes.size() - header || !multiply(tuples, element_size(type), bytes) || bytes > available) return nullptr;
  return p + header;
}

std::pair<ElementType, int> XmlFile::number_type(pugi::xml_node element) const {
  ElementType t{};
  const std::string_view type = element.attribute("type").value();
  if (type == "Bit") t = ElementType::u8;
  else if (!parse_element_type(type, t))
    fail(fmt::format("has the unknown type '{}'", type), element, "use Int8 ... UInt64, Float32 or Float64");
  const uint64_t components = element.attribute("NumberOfComponents") ? parse_count(*this, element, "NumberOfComponents") : 1;
  if (components > 1 << 20) fail(fmt::format("has {} components", components), element);
  return {t, int(std::max<uint64_t>(components, 1))};
}

XmlFile::Wanted XmlFile::wanted(pugi::xml_node element, std::optional<uint64_t> tuples) const {
  Wanted want;
  want.element = element;
  want.tuples = tuples;
  std::tie(want.type, want.components) = number_type(element);
  want.bits = std::string_view(element.attribute("type").value()) == "Bit";
  const std::string_view format = element.attribute("format").value();
  want.text = format.empty() || format == "ascii";
  if (!want.text && format != "binary" && format != "appended")
    fail(fmt::format("has the format '{}'", format), element, "use ascii, binary or appended");
  return want;
}

Array XmlFile::array(pugi::xml_node element, std::optional<uint64_t> tuples) const { return read(wanted(element, tuples)); }

Array XmlFile::codes(pugi::xml_node element) const {
  Wanted want;
  want.element = element, want.type = ElementType::i8, want.components = 1;
  const std::string_view format = element.attribute("format").value();
  want.text = format.empty() || format == "ascii";
  return read(want);
}

Array XmlFile::read(const Wanted& want) const {
  if (want.text) return text(want);
  const Source s = source(want.element);
  // An array of nothing may have no bytes at all.
  if (s.bytes.empty() && (!want.tuples || *want.tuples == 0)) return finished(want, {}, 0, 0);
  return codec_ == Codec::none ? plain(want, s) : compressed(want, s);
}

Array XmlFile::block(pugi::xml_node element, const Window& w) const {
  const size_t n = w.dims[0] * w.dims[1] * w.dims[2];
  if (w.whole()) return array(element, n);
  const Wanted want = wanted(element, n);
  const bool appended = std::string_view(element.attribute("format").value()) == "appended";
  if (w.tuples() > 0 && !want.text && !want.bits) {
    if (codec_ != Codec::none) {
      if (const Source s = source(element); !s.bytes.empty()) return compressed_window(want, s, w);
    } else if (appended && !appended_base64_) {
      const Source s = source(element);
      const auto* p = reinterpret_cast<const std::byte*>(s.bytes.data());
      if (s.bytes.size() < word_bytes() || word(p) > s.bytes.size() - word_bytes())
        fail("announces more bytes than the file has", element, "the file is truncated or damaged");
      bytes_to_read(want, word(p));
      return raw_window(want, p + word_bytes(), w);
    }
  }
  return crop_block(array(element, n), w.dims, w.lo, w.count, w.stride);
}

}  // namespace sg::vtk
