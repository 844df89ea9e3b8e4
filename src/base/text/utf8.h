// SPDX-License-Identifier: Apache-2.0
// Text as bytes that should be UTF-8, for names of files and fields that leave the program, whatever their bytes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace sg {

/// Length of the UTF-8 sequence at s[i] and its code point; 0 when there is none (overlong forms and surrogates are invalid). i < s.size().
size_t decode_utf8(std::string_view s, size_t i, uint32_t& code);
bool is_utf8(std::string_view s);
/// The code point as UTF-8, at the end of `out`. code <= 0x10ffff.
void append_utf8(std::string& out, uint32_t code);

/// Code points that draw nothing and may change what is drawn around them: controls, line and paragraph separators, marks of direction.
bool is_control(uint32_t code);

/// For terminals and pictures: control characters as \n, \t, \x1b, \u202e, bytes that are not UTF-8 as \xff; the rest as it is. Line ends
/// are kept when `lines`.
std::string printable(std::string_view s, bool lines = false);

/// Any bytes as UTF-8 text, and back: invalid UTF-8 becomes U+EF80 to U+EFFF, byte by byte, and so do these code points themselves.
/// bytes_of_text(text_of_bytes(s)) == s for all s; other text is unchanged.
std::string text_of_bytes(std::string_view s);
std::string bytes_of_text(std::string_view s);

}  // namespace sg
