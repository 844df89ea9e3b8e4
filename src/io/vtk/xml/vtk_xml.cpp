// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/xml/vtk_xml.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>

#include "base/text/text.h"

namespace sg::vtk {

namespace {

// Lines before a byte; for errors only.
size_t line_of(std::string_view text, size_t byte) {
  return size_t(std::count(text.begin(), text.begin() + ptrdiff_t(std::min(byte, text.size())), '\n')) + 1;
}

constexpr std::string_view appended_tag = "<AppendedData";
constexpr const char* text_attribute = "sightglass-text";  // set by us, on what the parser sees

}  // namespace

std::string_view xml_type(std::string_view text) {
  const size_t root = text.find("<VTKFile");
  if (root == std::string_view::npos) return {};
  size_t type = root;  // the attribute type, not header_type
  do type = text.find("type=", type + 1);
  while (type != std::string_view::npos && static_cast<unsigned char>(text[type - 1]) > ' ');
  if (type == std::string_view::npos || type + 6 >= text.size()) return {};
  return text.substr(type + 6, text.find_first_of("\"'", type + 6) - type - 6);
}

XmlFile::XmlFile(const std::string& path) : file_(path) {
  parse();
  read_root();
}

// Gives the XML parser the elements of `head` and `tail`, but not the long texts of DataArrays: it would copy them and look at
// each character. They are left in the mapped file; an attribute tells the parsed element which text belongs to it.
void XmlFile::parse_elements(std::string_view head, std::string_view tail) {
  // Nothing in these files needs entities of their own; what comes with them is a bomb.
  if (const size_t at = head.substr(0, head.find("<VTKFile")).find("<!ENTITY"); at != std::string_view::npos)
    fail_data("declares XML entities", fmt::format("{}: byte {}", path(), at), "VTK files have none: remove the declaration");
  constexpr size_t long_text = 256;
  constexpr std::string_view element = "<DataArray";
  std::string slim;
  std::vector<std::pair<size_t, size_t>> cuts;  // place in `slim`, the same place in the file
  size_t done = 0;
  for (size_t at = head.find(element); at != std::string_view::npos; at = head.find(element, at)) {
    at += element.size();
    char quote = 0;
    while (at < head.size() && (quote || head[at] != '>')) {
      if (quote ? head[at] == quote : head[at] == '"' || head[at] == '\'') quote = quote ? char(0) : head[at];
      ++at;
    }
    if (at == head.size() || head[at - 1] == '/') continue;
    const size_t end = head.find('<', at);
    if (end == std::string_view::npos || end - at - 1 <= long_text) continue;
    const std::string_view text = head.substr(at + 1, end - at - 1);
    if (text.find('&') != std::string_view::npos) continue;  // escapes are for the parser
    slim += head.substr(done, at - done);
    slim += fmt::format(" {}=\"{}\">", text_attribute, texts_.size());
    texts_.push_back(text);
    done = at = end;
    cuts.emplace_back(slim.size(), end);
  }
  slim += head.substr(done);
  slim += tail;
  constexpr unsigned options = pugi::parse_cdata | pugi::parse_escapes | pugi::parse_wconv_attribute;
  const pugi::xml_parse_result result = document_.load_buffer(slim.data(), slim.size(), options, pugi::encoding_utf8);
  if (result) return;
  auto byte = size_t(std::max<ptrdiff_t>(result.offset, 0));
  for (auto cut = cuts.rbegin(); cut != cuts.rend(); ++cut)
    if (cut->first <= byte) {
      byte = byte - cut->first + cut->second;
      break;
    }
  fail_data(fmt::format("is not well-formed XML: {}", result.description()),
            fmt::format("{}: line {}, byte {}", path(), line_of(file_.text(), byte), byte), "the file is truncated or damaged");
}

void XmlFile::parse() {
  const std::string_view all = file_.text();
  const size_t tag = all.find(appended_tag);
  if (tag == std::string_view::npos) return parse_elements(all, "");
  // The bytes behind '_' may be anything, so the XML parser sees the file only up to there.
  const size_t open_end = all.find('>', tag);
  if (open_end == std::string_view::npos) fail_data("ends inside <AppendedData>", path(), "the file is truncated");
  const size_t from = std::min(open_end + 1, all.size());
  const size_t underscore = all.find_first_not_of(" \t\r\n", from);
  if (underscore == std::string_view::npos || all[underscore] != '_')
    fail_data("the appended data does not begin with '_'", fmt::format("{}: byte {}", path(), std::min(underscore, all.size())),
              "the file is truncated or damaged");
  const size_t close = all.rfind("</AppendedData");
  const size_t root_close = close == std::string_view::npos ? close : all.find("</VTKFile", close);
  if (close < underscore || root_close == std::string_view::npos || all.find('>', root_close) == std::string_view::npos)
    fail_data("the appended data has no end tag", fmt::format("{}: byte {}", path(), all.size()), "the file is truncated");
  appended_ = all.substr(underscore + 1, close - underscore - 1);
  have_appended_ = true;
  parse_elements(all.substr(0, open_end), all[open_end - 1] == '/' ? "></VTKFile>" : "/></VTKFile>");
}

void XmlFile::read_root() {
  const pugi::xml_node root = document_.child("VTKFile");
  if (!root) fail_data("has no element VTKFile", path(), "a VTK XML file begins with <VTKFile type=\"...\">");
  type_ = root.attribute("type").value();
  const std::string_view order = root.attribute("byte_order").value();
  big_endian_ = order == "BigEndian";
  if (!order.empty() && !big_endian_ && order != "LittleEndian")
    fail(fmt::format("has the byte order '{}'", order), root, "use LittleEndian or BigEndian");
  const std::string_view header = root.attribute("header_type").value();
  wide_header_ = header == "UInt64";
  if (!header.empty() && !wide_header_ && header != "UInt32")
    fail(fmt::format("has the header type '{}'", header), root, "use UInt32 or UInt64");
  if (const std::string_view compressor = root.attribute("compressor").value(); !compressor.empty()) {
    for (const Codec c : {Codec::zlib, Codec::lz4, Codec::lzma})
      if (compressor == codec_name(c)) codec_ = c;
    if (codec_ == Codec::none)
      fail(fmt::format("has the unknown compressor '{}'", compressor), root,
           "supported: vtkZLibDataCompressor, vtkLZ4DataCompressor, vtkLZMADataCompressor");
  }
  dataset_ = root.child(type_.c_str());
  if (type_.empty() || !dataset_) fail(fmt::format("has no element for its type '{}'", type_), root);
  if (have_appended_) {
    const std::string_view encoding = root.child("AppendedData").attribute("encoding").value();
    appended_base64_ = encoding == "base64" || encoding.empty();  // base64 is what the format takes for granted
    if (!appended_base64_ && encoding != "raw")
      fail(fmt::format("has the encoding '{}'", encoding), root.child("AppendedData"), "use raw or base64");
  }
}

std::string_view XmlFile::text_of(pugi::xml_node element, std::string& joined) const {
  std::string_view one;
  if (const pugi::xml_attribute kept = element.attribute(text_attribute))
    if (const auto i = parse_count(*this, element, text_attribute); i < texts_.size()) one = trim(texts_[i]);
  // Comments and InformationKey elements may cut the text; nearly always there is one piece.
  for (const pugi::xml_node& n : element.children()) {
    if (n.type() != pugi::node_pcdata && n.type() != pugi::node_cdata) continue;
    const std::string_view t = trim(n.value());
    if (t.empty()) continue;
    if (one.empty()) {
      one = t;
      continue;
    }
    if (joined.empty()) joined = one;
    joined += ' ';
    joined += t;
    one = joined;
  }
  return one;
}

std::string XmlFile::describe(pugi::xml_node element) {
  const std::string_view name = element.attribute("Name").value();
  if (!name.empty()) return fmt::format("{} '{}'", element.name(), name);
  return fmt::format("{} of {}", element.name(), element.parent().name());
}

void XmlFile::fail(std::string problem, pugi::xml_node element, std::string hint) const {
  fail_data(std::move(problem), fmt::format("{}: {}", path(), describe(element)), std::move(hint));
}

bool XmlFile::is_numeric(pugi::xml_node element) {
  return std::string_view(element.name()) == "DataArray" && std::string_view(element.attribute("type").value()) != "String";
}

void parse_longs(const XmlFile& file, pugi::xml_node element, const char* attribute, long long* out, size_t n) {
  const std::string_view text = element.attribute(attribute).value();
  const auto list = words(text);
  bool good = list.size() == n;
  for (size_t i = 0; good && i < n; ++i) {
    const std::string_view w = list[i].starts_with('+') ? list[i].substr(1) : list[i];
    const auto r = std::from_chars(w.data(), w.data() + w.size(), out[i]);
    good = r.ec == std::errc{} && r.ptr == w.data() + w.size();
  }
  if (!good) file.fail(fmt::format("{}=\"{}\" is not {} whole numbers", attribute, text.substr(0, 80), n), element);
}

bool parse_doubles(const XmlFile& file, pugi::xml_node element, const char* attribute, double* out, size_t n) {
  const pugi::xml_attribute a = element.attribute(attribute);
  if (!a) return false;
  const auto list = words(a.value());
  bool good = list.size() == n;
  for (size_t i = 0; good && i < n; ++i) {
    const auto v = parse_double(list[i]);
    good = v.has_value();
    if (v) out[i] = *v;
  }
  if (!good) file.fail(fmt::format("{}=\"{}\" is not {} numbers", attribute, std::string_view(a.value()).substr(0, 80), n), element);
  return true;
}

uint64_t parse_count(const XmlFile& file, pugi::xml_node element, const char* attribute) {
  const pugi::xml_attribute a = element.attribute(attribute);
  if (!a) return 0;
  std::string_view w = trim(a.value());
  if (w.starts_with('+')) w.remove_prefix(1);
  uint64_t v = 0;
  const auto r = std::from_chars(w.data(), w.data() + w.size(), v);
  if (r.ec != std::errc{} || r.ptr != w.data() + w.size())
    file.fail(fmt::format("{}=\"{}\" is not a valid count", attribute, std::string_view(a.value()).substr(0, 80)), element,
              "it must be a non-negative whole number");
  return v;
}

}  // namespace sg::vtk
