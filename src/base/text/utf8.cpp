// SPDX-License-Identifier: Apache-2.0
#include "base/text/utf8.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace sg {

namespace {

// In the private use area, as MirBSD's OPTU encodings have it: raw bytes 0x80 to 0xff.
constexpr uint32_t raw = 0xef00, first_raw = 0xef80, last_raw = 0xefff;

uint32_t byte_at(std::string_view s, size_t i) { return static_cast<unsigned char>(s[i]); }

}  // namespace

size_t decode_utf8(std::string_view s, size_t i, uint32_t& code) {
  const uint32_t b = byte_at(s, i);
  const size_t n = b < 0x80 ? 1 : b >> 5 == 6 ? 2 : b >> 4 == 14 ? 3 : b >> 3 == 30 ? 4 : 0;
  if (n == 0 || i + n > s.size()) return 0;
  code = n == 1 ? b : b & (0x7fu >> n);
  for (size_t k = 1; k < n; ++k) {
    if (byte_at(s, i + k) >> 6 != 2) return 0;
    code = code << 6 | (byte_at(s, i + k) & 0x3f);
  }
  constexpr uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  return code < least[n] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000) ? 0 : n;
}

bool is_utf8(std::string_view s) {
  uint32_t code = 0;
  for (size_t i = 0; i < s.size();) {
    const size_t n = decode_utf8(s, i, code);
    if (n == 0) return false;
    i += n;
  }
  return true;
}

void append_utf8(std::string& out, uint32_t c) {
  if (c < 0x80) {
    out += char(c);
  } else if (c < 0x800) {
    out += char(0xc0 | c >> 6), out += char(0x80 | (c & 0x3f));
  } else if (c < 0x10000) {
    out += char(0xe0 | c >> 12), out += char(0x80 | (c >> 6 & 0x3f)), out += char(0x80 | (c & 0x3f));
  } else {
    out += char(0xf0 | c >> 18), out += char(0x80 | (c >> 12 & 0x3f)), out += char(0x80 | (c >> 6 & 0x3f)), out += char(0x80 | (c & 0x3f));
  }
}

bool is_control(uint32_t c) {
  return c < 0x20 || (c >= 0x7f && c < 0xa0) || c == 0x61c || (c >= 0x200b && c <= 0x200f) || (c >= 0x2028 && c <= 0x202e) ||
         (c >= 0x2060 && c <= 0x206f) || c == 0xfeff || (c >= 0xfff0 && c <= 0xfffb) || (c >= 0xe0000 && c <= 0xe0fff);
}

std::string printable(std::string_view s, bool lines) {
  std::string r;
  r.reserve(s.size());
  for (size_t i = 0; i < s.size();) {
    uint32_t code = 0;
    const size_t n = decode_utf8(s, i, code);
    if (n == 0) r += fmt::format("\\x{:02x}", byte_at(s, i));
    else if (!is_control(code) || (lines && code == '\n')) r.append(s, i, n);
    else if (code == '\n') r += "\\n";
    else if (code == '\t') r += "\\t";
    else if (code == '\r') r += "\\r";
    else if (code < 0x100) r += fmt::format("\\x{:02x}", code);
    else if (code < 0x10000) r += fmt::format("\\u{:04x}", code);
    else r += fmt::format("\\U{:08x}", code);
    i += std::max<size_t>(n, 1);
  }
  return r;
}

std::string text_of_bytes(std::string_view s) {
  std::string r;
  r.reserve(s.size());
  for (size_t i = 0; i < s.size();) {
    uint32_t code = 0;
    const size_t n = decode_utf8(s, i, code);
    if (n > 0 && (code < first_raw || code > last_raw)) {
      r.append(s, i, n);
    } else {
      for (size_t k = 0; k < std::max<size_t>(n, 1); ++k) append_utf8(r, raw + byte_at(s, i + k));
    }
    i += std::max<size_t>(n, 1);
  }
  return r;
}

std::string bytes_of_text(std::string_view s) {
  std::string r;
  r.reserve(s.size());
  for (size_t i = 0; i < s.size();) {
    uint32_t code = 0;
    const size_t n = decode_utf8(s, i, code);
    if (n > 0 && code >= first_raw && code <= last_raw) r += char(code - raw);
    else r.append(s, i, std::max<size_t>(n, 1));
    i += std::max<size_t>(n, 1);
  }
  return r;
}

}  // namespace sg
