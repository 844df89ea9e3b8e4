// SPDX-License-Identifier: Apache-2.0
#include "io/plugins/gdcm/dicom_elements.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "base/bytes.h"
#include "base/error.h"
#include "base/text/text.h"
#include "io/bytes/inflate.h"

namespace sg {

namespace {

constexpr uint32_t undefined = 0xffffffff, item_tag = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd;
constexpr uint32_t syntax_tag = 0x00020010;
constexpr std::string_view explicit_syntax = "1.2.840.10008.1.2.1", deflated_syntax = "1.2.840.10008.1.2.1.99";
constexpr uint32_t shared_groups = 0x52009229, frame_groups = 0x52009230;

struct Walker {
  DicomElements& d;
  bool big = false, explicit_vr = true;

  [[noreturn]] void fail(size_t at, uint32_t tag, const std::string& what) const {
    fail_data(fmt::format("byte {}: element ({:04x},{:04x}) {}", at, tag >> 16, tag & 0xffff, what), d.path);
  }

  struct Head {
    DicomElement e;
    uint32_t length = 0;
    bool sequence = false;
  };
  // Reads tag, VR and length at `at`; `end` bounds it.
  Head head(size_t at, size_t end) const {
    Head h;
    if (end - at < 8) fail_data(fmt::format("byte {}: the file ends inside an element", at), d.path);
    const std::byte* p = d.bytes.data() + at;
    h.e.tag = uint32_t(load<uint16_t>(p, big)) << 16 | load<uint16_t>(p + 2, big);
    h.e.begin = at;
    const bool delimiter = h.e.tag >> 16 == 0xfffe;
    if (!explicit_vr || delimiter) {
      h.length = load<uint32_t>(p + 4, big);
      h.e.value = at + 8;
    } else {
      const std::string_view vr(reinterpret_cast<const char*>(p + 4), 2);
      bool wide = false;
      for (const std::string_view w : {"OB", "OW", "OF", "OD", "OL", "OV", "SQ", "UN", "UT", "UC", "UR", "SV", "UV"})
        wide = wide || w == vr;
      h.sequence = vr == "SQ";
      if (wide) {
        if (end - at < 12) fail(at, h.e.tag, "is cut off");
        h.length = load<uint32_t>(p + 8, big);
        h.e.value = at + 12;
      } else {
        h.length = load<uint16_t>(p + 6, big);
        h.e.value = at + 8;
      }
    }
    if (h.length == undefined) h.sequence = true;
    else if (h.length > end - h.e.value) fail(at, h.e.tag, fmt::format("announces {} bytes, but {} follow", h.length, end - h.e.value));
    h.e.end = h.length == undefined ? end : h.e.value + h.length;
    return h;
  }

  // Items of a sequence from `at`; returns where it ends.
  size_t sequence(size_t at, size_t end, bool open, int depth, bool keep) {
    if (depth > 16) fail_data(fmt::format("byte {}: sequences are nested more than 16 deep", at), d.path);
    while (at < end) {
      const Head h = head(at, end);
      if (h.e.tag == sequence_end && open) return h.e.value;
      if (h.e.tag != item_tag) fail(at, h.e.tag, "is not an item of a sequence");
      at = h.length == undefined ? item(h.e.value, end, true, depth, keep) : item(h.e.value, h.e.end, false, depth, keep);
    }
    if (open) fail_data(fmt::format("byte {}: a sequence has no end", at), d.path);
    return at;
  }

  size_t item(size_t at, size_t end, bool open, int depth, bool keep) {
    while (at < end) {
      const Head h = head(at, end);
      if (h.e.tag == item_end && open) return h.e.value;
      if (h.sequence) at = sequence(h.e.value, h.length == undefined ? end : h.e.end, h.length == undefined, depth + 1, keep);
      else {
        if (keep && d.in_groups.size() < 10'000'000) d.in_groups.push_back(h.e);
        at = h.e.end;
      }
    }
    if (open) fail_data(fmt::format("byte {}: an item has no end", at), d.path);
    return at;
  }

  // Fragments of packed pixels: items without structure.
  size_t fragments(size_t at, size_t end) {
    while (at < end) {
      const Head h = head(at, end);
      if (h.e.tag == sequence_end) return h.e.value;
      if (h.e.tag != item_tag || h.length == undefined) fail(at, h.e.tag, "is not a fragment of pixel data");
      d.fragment_bytes += h.length;
      at = h.e.end;
    }
    fail_data(fmt::format("byte {}: the pixel data has no end", at), d.path);
  }

  void dataset(size_t at) {
    const size_t end = d.bytes.size();
    uint32_t last = 0;
    while (at < end) {
      const Head h = head(at, end);
      DicomElement e = h.e;
      if (e.tag <= last && last > 0) {  // rubbish behind the elements: they come in ascending order
        if (d.has(pixel_tag)) return;
        fail(at, e.tag, "is out of order");
      }
      last = e.tag;
      if (e.tag == pixel_tag && h.length == undefined) {
        d.encapsulated = true;
        e.end = fragments(e.value, end);
      } else if (h.sequence) {
        const bool keep = e.tag == shared_groups || e.tag == frame_groups;
        e.end = sequence(e.value, h.length == undefined ? end : e.end, h.length == undefined, 0, keep);
      }
      d.top.emplace(e.tag, e);
      at = e.end;
      if (e.tag == pixel_tag) return;  // what follows is padding
    }
  }
};

}  // namespace

std::string DicomElements::text(const DicomElement& e) const {
  std::string s(reinterpret_cast<const char*>(bytes.data() + e.value), std::min<size_t>(e.end - e.value, 1024));
  s.resize(std::min(s.find('\0'), s.size()));
  return std::string(trim(s));
}

std::string DicomElements::text(uint32_t tag) const {
  const auto it = top.find(tag);
  return it == top.end() ? "" : text(it->second);
}

std::vector<double> DicomElements::numbers(const DicomElement& e) const {
  std::vector<double> r;
  const std::string s = text(e);
  for (std::string_view w : split(s, '\\'))
    if (const auto v = parse_double(w); v && std::isfinite(*v)) r.push_back(*v);
  return r;
}

std::vector<double> DicomElements::numbers(uint32_t tag) const {
  const auto it = top.find(tag);
  return it == top.end() ? std::vector<double>() : numbers(it->second);
}

size_t DicomElements::whole(uint32_t tag, size_t otherwise) const {
  const auto it = top.find(tag);
  if (it == top.end() || it->second.end - it->second.value < 2) return otherwise;
  return load<uint16_t>(bytes.data() + it->second.value, big_endian);
}

DicomFile::DicomFile(const std::string& path) : file_(path) {
  constexpr size_t preamble = 132;
  if (file_.size() < preamble || std::memcmp(file_.data() + preamble - 4, "DICM", 4) != 0) return;
  DicomElements d;
  d.bytes = bytes(), d.path = path;
  const Walker w{d};
  size_t at = preamble;
  std::optional<DicomElement> syntax;
  while (at + 8 <= file_.size() && load<uint16_t>(file_.data() + at) == 2) {
    const auto h = w.head(at, file_.size());
    if (h.e.tag == syntax_tag && d.text(h.e) == deflated_syntax) syntax = h.e;
    at = h.e.end;
  }
  if (!syntax) return;
  const std::vector<std::byte> rest = inflate_raw(bytes().subspan(at), path);
  inflated_.assign(file_.data(), file_.data() + at);
  inflated_.insert(inflated_.end(), rest.begin(), rest.end());
  std::memset(inflated_.data() + syntax->value, 0, syntax->end - syntax->value);
  std::memcpy(inflated_.data() + syntax->value, explicit_syntax.data(), explicit_syntax.size());
}

DicomElements walk_dicom(std::span<const std::byte> bytes, const std::string& path) {
  DicomElements d;
  d.bytes = bytes;
  d.path = path;
  Walker w{d};
  size_t at = 0;
  d.transfer_syntax = "1.2.840.10008.1.2";
  if (bytes.size() >= 132 && std::memcmp(bytes.data() + 128, "DICM", 4) == 0) {
    // Group 2 is always explicit little endian.
    for (at = 132; at + 8 <= bytes.size() && load<uint16_t>(bytes.data() + at) == 2;) {
      const auto h = w.head(at, bytes.size());
      if (h.sequence) w.fail(at, h.e.tag, "is an unexpected sequence");
      if (h.e.tag == syntax_tag) d.transfer_syntax = d.text(h.e);
      at = h.e.end;
    }
  } else if (bytes.size() < 16 || (load<uint16_t>(bytes.data()) != 8 && load<uint16_t>(bytes.data()) != 2)) {
    fail_data("is not a DICOM file: there is no 'DICM' at byte 128, and no element of group 8 at its beginning", path);
  } else {
    // Old files without a preamble: the VR is either there or not.
    const auto* vr = reinterpret_cast<const char*>(bytes.data()) + 4;
    if (vr[0] >= 'A' && vr[0] <= 'Z' && vr[1] >= 'A' && vr[1] <= 'Z') d.transfer_syntax = "1.2.840.10008.1.2.1";
  }
  d.meta_end = at;
  w.explicit_vr = d.explicit_vr = d.transfer_syntax != "1.2.840.10008.1.2";
  w.big = d.big_endian = d.transfer_syntax == "1.2.840.10008.1.2.2";
  w.dataset(at);
  return d;
}

}  // namespace sg
