// SPDX-License-Identifier: Apache-2.0
// Small DICOM files, byte by byte.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "io/bytes/inflate.h"

namespace sg::test {

enum class Syntax { implicit, little, big, rle, deflated };

// The deflate stream of a gzip member.
inline std::string deflated(const std::string& s) {
  const std::vector<std::byte> gzip = pack_gzip(std::as_bytes(std::span(s)));
  constexpr size_t head = 10, tail = 8;
  return std::string(reinterpret_cast<const char*>(gzip.data()) + head, gzip.size() - head - tail);
}

// Builds DICOM files of a few elements.
struct Dicom {
  Syntax syntax = Syntax::little;
  std::string body;

  std::string number(uint64_t v, int bytes, bool big) const {
    std::string s;
    for (int i = 0; i < bytes; ++i) s += char(v >> (8 * (big ? bytes - 1 - i : i)) & 255);
    return s;
  }
  bool big() const { return syntax == Syntax::big; }
  std::string element(uint32_t tag, const std::string& vr, std::string value, bool implicit_vr) const {
    if (value.size() % 2) value += vr == "UI" || vr == "OB" ? '\0' : ' ';
    std::string s = number(tag >> 16, 2, big()) + number(tag & 0xffff, 2, big());
    if (implicit_vr) return s + number(value.size(), 4, false) + value;
    s += vr;
    if (vr == "OB" || vr == "OW" || vr == "SQ") return s + std::string(2, '\0') + number(value.size(), 4, big()) + value;
    return s + number(value.size(), 2, big()) + value;
  }
  void text(uint32_t tag, const std::string& vr, const std::string& v) { body += element(tag, vr, v, syntax == Syntax::implicit); }
  void whole(uint32_t tag, int v) { body += element(tag, "US", number(uint64_t(v), 2, big()), syntax == Syntax::implicit); }

  std::string shorts(const std::vector<int>& v) const {
    std::string s;
    for (const int x : v) s += number(uint64_t(x) & 0xffff, 2, big());
    return s;
  }
  std::string file() const {
    Dicom meta;
    const char* uid = syntax == Syntax::implicit ? "1.2.840.10008.1.2"
                      : syntax == Syntax::little ? "1.2.840.10008.1.2.1"
                      : syntax == Syntax::big    ? "1.2.840.10008.1.2.2"
                      : syntax == Syntax::rle    ? "1.2.840.10008.1.2.5"
                                                 : "1.2.840.10008.1.2.1.99";
    const std::string two = meta.element(0x00020010, "UI", uid, false);
    return std::string(128, '\0') + "DICM" + meta.element(0x00020000, "UL", meta.number(two.size(), 4, false), false) + two +
           (syntax == Syntax::deflated ? deflated(body) : body);
  }
};

struct SliceOptions {
  Syntax syntax = Syntax::little;
  std::string series = "1.2.3", position = "0\\0\\0", orientation = "1\\0\\0\\0\\1\\0", slope, intercept, photometric = "MONOCHROME2";
  int number = 1, columns = 3, rows = 2, stored = 16, frames = 1, samples = 1, planar = 0, bits = 16;
  bool is_signed = true;
  std::string pixels;  // as stored
};

inline std::string slice(const SliceOptions& o) {
  Dicom d;
  d.syntax = o.syntax;
  d.text(0x00080016, "UI", "1.2.840.10008.5.1.4.1.1.2");
  d.text(0x00080060, "CS", "CT");
  d.text(0x0008103e, "LO", "test " + o.series);
  d.text(0x00100010, "PN", "Doe^John");
  d.text(0x0020000e, "UI", o.series);
  d.text(0x00200013, "IS", std::to_string(o.number));
  if (!o.position.empty()) d.text(0x00200032, "DS", o.position);
  if (!o.orientation.empty()) d.text(0x00200037, "DS", o.orientation);
  d.whole(0x00280002, o.samples);
  d.text(0x00280004, "CS", o.photometric);
  if (o.samples > 1) d.whole(0x00280006, o.planar);
  if (o.frames > 1) d.text(0x00280008, "IS", std::to_string(o.frames));
  d.whole(0x00280010, o.rows);
  d.whole(0x00280011, o.columns);
  d.text(0x00280030, "DS", "2\\0.5");
  d.whole(0x00280100, o.bits);
  d.whole(0x00280101, o.stored);
  d.whole(0x00280102, o.stored - 1);
  d.whole(0x00280103, o.is_signed);
  if (!o.intercept.empty()) d.text(0x00281052, "DS", o.intercept);
  if (!o.slope.empty()) d.text(0x00281053, "DS", o.slope);
  if (o.syntax == Syntax::rle) {
    // An empty offset table, one fragment with two byte planes as literal runs.
    std::string planes[2];
    for (size_t i = 0; i < o.pixels.size(); ++i) planes[i % 2 ? 0 : 1] += o.pixels[i];
    std::string data = d.number(2, 4, false) + d.number(64, 4, false);
    for (std::string& p : planes) {
      p = char(p.size() - 1) + p;
      if (p.size() % 2) p += char(-128);
    }
    data += d.number(64 + planes[0].size(), 4, false) + std::string(64 - 12, '\0') + planes[0] + planes[1];
    d.body += d.number(0x7fe0, 2, false) + d.number(0x10, 2, false) + "OB" + std::string(2, '\0') + d.number(0xffffffff, 4, false);
    auto item = [&](uint32_t tag, const std::string& v) {
      d.body += d.number(tag >> 16, 2, false) + d.number(tag & 0xffff, 2, false) + d.number(v.size(), 4, false) + v;
    };
    item(0xfffee000, "");
    item(0xfffee000, data);
    item(0xfffee0dd, "");
  } else {
    d.text(0x7fe00010, o.bits == 8 ? "OB" : "OW", o.pixels);
  }
  return d.file();
}

inline std::string stored(const std::vector<int>& v, Syntax s = Syntax::little) {
  Dicom d;
  d.syntax = s;
  return d.shorts(v);
}

}  // namespace sg::test
