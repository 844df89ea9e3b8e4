// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/xml/vtk_xml_encode.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "base/parallel.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "io/vtk/vtk_numbers.h"

namespace sg::vtk {

namespace {

constexpr size_t block_bytes = size_t(1) << 18;
constexpr uint64_t alignment = 64;
constexpr size_t header_bytes = 8;  // header_type UInt64

}  // namespace

std::string attributes_text(const XmlAttributes& attributes) {
  std::string r;
  for (const auto& [name, value] : attributes) r += fmt::format(" {}=\"{}\"", name, escaped_xml(value));
  return r;
}

std::string point_text(Vec3 v) { return fmt::format("{} {} {}", exact_number(v.x), exact_number(v.y), exact_number(v.z)); }

std::string escaped_xml(std::string_view s) {
  // Bytes that are not UTF-8 can only be Latin-1; control characters other than tab and line ends are not allowed in XML 1.0, not even as
  // references.
  std::string from_latin1, r;
  if (!is_utf8(s)) {
    for (const char c : s) append_utf8(from_latin1, static_cast<unsigned char>(c));
    s = from_latin1;
  }
  for (size_t i = 0; i < s.size();) {
    uint32_t c = 0;
    const size_t n = decode_utf8(s, i, c);
    switch (c) {
      case '&': r += "&amp;"; break;
      case '<': r += "&lt;"; break;
      case '>': r += "&gt;"; break;
      case '"': r += "&quot;"; break;
      default:
        if (c == '\t' || c == '\n' || c == '\r' || (c > 0x7f && is_control(c))) r += fmt::format("&#{};", c);
        else if (is_control(c)) r += fmt::format("\\x{:02x}", c);
        else r.append(s, i, n);
    }
    i += n;
  }
  return r;
}

std::string_view xml_type_name(ElementType t) {
  constexpr std::string_view names[] = {"UInt8", "Int8", "UInt16", "Int16", "UInt32", "Int32", "UInt64", "Int64", "Float32", "Float64"};
  return names[size_t(t)];
}

namespace {

void put_word(std::vector<std::byte>& to, uint64_t v) {
  const size_t at = to.size();
  to.resize(at + sizeof v);
  std::memcpy(&to[at], &v, sizeof v);
}

uint64_t aligned(uint64_t n) { return (n + alignment - 1) / alignment * alignment; }

}  // namespace

XmlWriter::XmlWriter(const std::string& path, const WriteOptions& options, Context& context) : file_(path), context_(context) {
  encoding_ = options.encoding;
  switch (const Compression c = options.compression.value_or(Compression::none)) {
    case Compression::none: codec_ = Codec::none; break;
    case Compression::zlib: codec_ = Codec::zlib; break;
    case Compression::lz4: codec_ = Codec::lz4; break;
    case Compression::lzma: codec_ = Codec::lzma; break;
    default: fail_usage(fmt::format("VTK XML cannot be compressed with '{}'", word_of(c)), path, "use none, zlib, lz4 or lzma");
  }
  if (encoding_ == VtkEncoding::ascii && codec_ != Codec::none)
    fail_usage("text cannot be compressed", path, "use encoding base64 or appended, or compression none");
}

void XmlWriter::open(std::string_view element, const XmlAttributes& attributes, bool empty) {
  text_.append(2 * open_.size(), ' ');
  text_ += '<';
  text_ += element;
  for (const auto& [name, value] : attributes) text_ += fmt::format(" {}=\"{}\"", name, escaped_xml(value));
  if (element == "VTKFile" && codec_ != Codec::none) text_ += fmt::format(" compressor=\"{}\"", codec_name(codec_));
  text_ += empty ? "/>\n" : ">\n";
  if (text_.size() > 1 << 20 && encoding_ != VtkEncoding::appended) flush();
}

void XmlWriter::flush() {
  file_.write(text_);
  text_.clear();
}

void XmlWriter::begin(std::string_view element, const XmlAttributes& attributes) {
  open(element, attributes, false);
  open_.emplace_back(element);
}

void XmlWriter::end() {
  const std::string name = std::move(open_.back());
  open_.pop_back();
  text_.append(2 * open_.size(), ' ');
  text_ += fmt::format("</{}>\n", name);
}

XmlWriter::Block XmlWriter::compressed(const Array& a) const {
  const size_t bytes = a.bytes(), n = (bytes + block_bytes - 1) / block_bytes;
  std::vector<std::vector<std::byte>> parts(n);
  parallel_for(
      n, 1,
      [&](size_t i, size_t) {
        const size_t begin = i * block_bytes;
        parts[i] = compress_block(codec_, a.raw() + begin, std::min(block_bytes, bytes - begin));
      },
      &context_);
  Block b;
  put_word(b.header, n);
  put_word(b.header, block_bytes);
  put_word(b.header, bytes % block_bytes);
  size_t total = 0;
  for (const auto& p : parts) put_word(b.header, p.size()), total += p.size();
  b.bytes.reserve(total);
  for (const auto& p : parts) b.bytes.insert(b.bytes.end(), p.begin(), p.end());
  return b;
}

void XmlWriter::write_base64(const std::byte* data, size_t n) {
  std::string s(base64_size(n), '\0');
  encode_base64(data, n, s.data());
  file_.write(s);
}

void XmlWriter::inline_binary(const Array& a) {
  flush();
  if (codec_ != Codec::none) {
    const Block b = compressed(a);
    write_base64(b.header.data(), b.header.size());
    write_base64(b.bytes.data(), b.bytes.size());
  } else {
    // One stream of size and numbers: its first nine bytes are three whole groups.
    std::vector<std::byte> first;
    put_word(first, a.bytes());
    const size_t more = std::min<size_t>(1, a.bytes());
    first.insert(first.end(), a.raw(), a.raw() + more);
    write_base64(first.data(), first.size());
    write_base64(a.raw() + more, a.bytes() - more);
  }
  text_ += '\n';
}

void XmlWriter::array(std::string_view name, const Array& given, bool with_tuples, std::string_view unit) {
  check();
  const Array a = given.made_packed();
  XmlAttributes attributes{
      {"type", std::string(xml_type_name(a.type()))}, {"Name", std::string(name)}, {"NumberOfComponents", std::to_string(a.components())}};
  if (with_tuples) attributes.emplace_back("NumberOfTuples", std::to_string(a.count()));
  if (encoding_ == VtkEncoding::appended) {
    Block b;
    if (codec_ != Codec::none) {
      b = compressed(a);
      b.offset = appended_;
      b.size = b.header.size() + b.bytes.size();
    } else {
      put_word(b.header, a.bytes());
      b.plain = a;
      b.offset = aligned(appended_);
      b.size = header_bytes + a.bytes();
    }
    appended_ = b.offset + b.size;
    attributes.emplace_back("format", "appended");
    attributes.emplace_back("offset", std::to_string(b.offset));
    blocks_.push_back(std::move(b));
    open("DataArray", attributes, unit.empty());
    if (unit.empty()) return;
    open_.emplace_back("DataArray");
    write_unit(unit);
    end();
    return;
  }
  const bool text = encoding_ == VtkEncoding::ascii;
  attributes.emplace_back("format", text ? "ascii" : "binary");
  begin("DataArray", attributes);
  if (text) text_ += format_numbers(a, size_t(a.components()) * std::max<size_t>(1, 12 / size_t(a.components())));
  else inline_binary(a);
  if (!unit.empty()) write_unit(unit);
  end();
}

void XmlWriter::write_unit(std::string_view unit) {
  text_ += fmt::format("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{}</InformationKey>\n", escaped_xml(unit));
}

void XmlWriter::finish() {
  while (open_.size() > 1) end();
  if (encoding_ == VtkEncoding::appended) {
    // Blanks before '_' so that numbers behind a size of eight bytes begin at a multiple of 64: readers need not copy them.
    text_ += "  <AppendedData encoding=\"raw\">\n";
    const uint64_t end_of_mark = text_.size() + 1 + header_bytes;
    text_.append(aligned(end_of_mark) - end_of_mark, ' ');
    text_ += '_';
    flush();
    const size_t start = file_.position();
    const std::byte zeros[alignment]{};
    for (const Block& b : blocks_) {
      check();
      file_.write(zeros, b.offset - (file_.position() - start));
      file_.write(b.header.data(), b.header.size());
      if (b.plain.empty()) file_.write(b.bytes.data(), b.bytes.size());
      else file_.write(b.plain.raw(), b.plain.bytes());
    }
    file_.write("\n  </AppendedData>\n");
  }
  while (!open_.empty()) end();
  flush();
  file_.commit();
}

}  // namespace sg::vtk
