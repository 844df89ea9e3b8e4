// SPDX-License-Identifier: Apache-2.0
// Decoding of one DataArray. In base64 as in raw bytes an array is
//   plain       [bytes] numbers
//   compressed  [blocks] [bytes per block] [bytes of the last, 0 = full] [compressed bytes of each block]... block block ...
// with [x] of header_type. In base64 the header of a compressed array is a padded stream of its own.
#include <atomic>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text.h"
#include "io/vtk_numbers.h"
#include "io/vtk_xml.h"

namespace sg::vtk {

// What the element asks for.
struct XmlFile::Wanted {
  pugi::xml_node element;
  ElementType type = ElementType::f32;
  bool bits = false;
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
  if (!have_appended_) fail("is appended but the file has no AppendedData", element);
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
  if (!multiply(*want.tuples, tuple, n)) fail(fmt::format("has {} tuples, more than any memory", *want.tuples), want.element);
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
  if (swap) swap_bytes_copy(out, from, n, size);
  else if (buffer.data == file_.data()) file_.copy_to(out, offset, bytes);  // VTK writes arrays on any byte
  else parallel_for(bytes, size_t(1) << 20, [&](size_t begin, size_t end) { std::memcpy(out + begin, from + begin, end - begin); });
  return a;
}

Array XmlFile::plain(const Wanted& want, const Source& s) const {
  const size_t header = word_bytes();
  if (!s.base64) {
    if (s.bytes.size() < header) fail("has no room for its size", want.element, "the file is truncated");
    const auto* p = reinterpret_cast<const std::byte*>(s.bytes.data());
    const uint64_t available = word(p);
    if (available > s.bytes.size() - header)
      fail(fmt::format("says it has {} bytes but the file has {}", available, s.bytes.size() - header), want.element,
           "the file is truncated or damaged");
    const Buffer whole{file_.owner(), file_.data(), file_.size()};
    return finished(want, whole, size_t(p + header - file_.data()), bytes_to_read(want, available));
  }
  std::byte head[8];
  const size_t used = decode_base64(s.bytes, head, header);
  if (used == SIZE_MAX) fail("is no base64", want.element, "the file is truncated or damaged");
  const uint64_t available = word(head);
  if (available > s.bytes.size() / 4 * 3)
    fail(fmt::format("says it has {} bytes but its text has {}", available, s.bytes.size()), want.element,
         "the file is truncated or damaged");
  const size_t bytes = bytes_to_read(want, available);
  // Size and numbers are one stream; decoded so that the numbers come to lie on a cache line.
  std::byte* out = nullptr;
  const Buffer b = Buffer::allocate(64 + bytes, &out);
  if (decode_base64(s.bytes, out + 64 - header, header + bytes) == SIZE_MAX)
    fail("is no base64", want.element, "the file is truncated or damaged");
  return finished(want, b, 64, bytes);
}

Array XmlFile::compressed(const Wanted& want, const Source& s) const {
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
  if (used == SIZE_MAX) damaged("has no header of its compressed blocks");
  const uint64_t blocks = word(three), block = word(three + w), last = word(three + 2 * w);
  if (blocks > s.bytes.size() / w) damaged(fmt::format("says it has {} compressed blocks in {} bytes", blocks, s.bytes.size()));
  std::vector<std::byte> head((3 + blocks) * w);
  used = head_bytes(head.data(), head.size());
  if (used == SIZE_MAX) damaged(fmt::format("has no sizes of its {} compressed blocks", blocks));

  uint64_t total = 0;
  if (last > block || !multiply(blocks, block, total)) damaged(fmt::format("has {} blocks of {} and {} bytes", blocks, block, last));
  if (last > 0 && blocks > 0) total -= block - last;
  const size_t bytes = bytes_to_read(want, total);
  std::vector<size_t> starts(blocks + 1, 0);
  const std::string_view rest = s.bytes.substr(used);
  const uint64_t most = s.base64 ? rest.size() / 4 * 3 : rest.size();
  for (uint64_t i = 0; i < blocks; ++i) {
    const uint64_t size = word(&head[(3 + i) * w]), full = i + 1 == blocks && last > 0 ? last : block;
    uint64_t end = 0;
    if (!add(starts[i], size, end) || end > most)
      damaged(fmt::format("has a compressed block {} of {} bytes in {}", i, size, most - starts[i]));
    if (full > most_uncompressed(codec_, size)) damaged(fmt::format("says that {} bytes of block {} hold {}", size, i, full));
    starts[i + 1] = end;
  }

  const auto* packed = reinterpret_cast<const std::byte*>(rest.data());
  Buffer decoded;
  if (s.base64) {
    std::byte* to = nullptr;
    decoded = Buffer::allocate(starts.back(), &to);
    if (decode_base64(rest, to, starts.back()) == SIZE_MAX) damaged("is no base64");
    packed = to;
  }
  std::byte* out = nullptr;
  const size_t needed = block ? (bytes + block - 1) / block : 0;
  const Buffer b = Buffer::allocate(size_t(std::min<uint64_t>(total, needed * block)), &out);
  std::atomic<bool> good{true};
  parallel_for(needed, 1, [&](size_t i, size_t) {
    const size_t full = i + 1 == blocks && last > 0 ? last : block;
    if (!decompress_block(codec_, packed + starts[i], starts[i + 1] - starts[i], out + i * block, full)) good = false;
  });
  if (!good) damaged("cannot be decompressed");
  return finished(want, b, 0, bytes);
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
  fail(fmt::format("'{}' is no {} number ({} of {})", words(t.substr(at, 40)).front(), element_name(want.type), end.parsed + 1, n),
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

Array XmlFile::array(pugi::xml_node element, std::optional<uint64_t> tuples) const {
  Wanted want;
  want.element = element;
  want.tuples = tuples;
  const std::string_view type = element.attribute("type").value();
  if (type == "Bit") want.type = ElementType::u8, want.bits = true;
  else if (!parse_element_type(type, want.type))
    fail(fmt::format("has the unknown type '{}'", type), element, "Int8 ... UInt64, Float32 or Float64");
  const uint64_t components = element.attribute("NumberOfComponents") ? parse_count(*this, element, "NumberOfComponents") : 1;
  if (components > 1 << 20) fail(fmt::format("has {} components", components), element);
  want.components = int(std::max<uint64_t>(components, 1));
  const std::string_view format = element.attribute("format").value();
  if (format.empty() || format == "ascii") return text(want);
  if (format != "binary" && format != "appended") fail(fmt::format("has the format '{}'", format), element, "ascii, binary or appended");
  const Source s = source(element);
  // An array of nothing may have no bytes at all.
  if (s.bytes.empty() && (!tuples || *tuples == 0)) return finished(want, {}, 0, 0);
  return codec_ == Codec::none ? plain(want, s) : compressed(want, s);
}

}  // namespace sg::vtk
