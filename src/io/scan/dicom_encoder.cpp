// SPDX-License-Identifier: Apache-2.0
#include "io/scan/dicom_encoder.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"

namespace sg {

namespace {

template <class T>
void append(std::string& s, T v) {
  for (size_t i = 0; i < sizeof(T); ++i) s += char(uint64_t(v) >> (8 * i) & 255);
}

void append_tag(std::string& s, uint32_t tag) {
  append(s, uint16_t(tag >> 16));
  append(s, uint16_t(tag & 0xffff));
}

constexpr uint32_t item_of_sequence = 0xfffee000;
constexpr size_t longest_decimal = 16;

}  // namespace

void DicomEncoder::head(uint32_t tag, std::string_view vr, size_t length) {
  if (length > 0xffff) fail_internal(fmt::format("element ({:04x},{:04x}) has {} bytes", tag >> 16, tag & 0xffff, length));
  append_tag(data_, tag);
  data_ += vr;
  append(data_, uint16_t(length));
}

void DicomEncoder::wide_head(uint32_t tag, std::string_view vr, uint32_t length) {
  append_tag(data_, tag);
  data_ += vr;
  append(data_, uint16_t(0));
  append(data_, length);
}

void DicomEncoder::text(uint32_t tag, std::string_view vr, std::string_view value) {
  const bool odd = value.size() % 2;
  head(tag, vr, value.size() + odd);
  data_ += value;
  if (odd) data_ += vr == "UI" ? '\0' : ' ';
}

void DicomEncoder::numbers(uint32_t tag, std::initializer_list<double> values) {
  std::string s;
  for (const double v : values) s += (s.empty() ? "" : "\\") + decimal_string(v);
  text(tag, "DS", s);
}

void DicomEncoder::whole(uint32_t tag, uint16_t value) {
  head(tag, "US", 2);
  append(data_, value);
}

void DicomEncoder::long_whole(uint32_t tag, std::span<const uint32_t> values) {
  head(tag, "UL", 4 * values.size());
  for (const uint32_t v : values) append(data_, v);
}

void DicomEncoder::pointer(uint32_t tag, uint32_t value) {
  head(tag, "AT", 4);
  append_tag(data_, value);
}

void DicomEncoder::bytes(uint32_t tag, std::string_view vr, std::string_view value) {
  wide_head(tag, vr, uint32_t(value.size()));
  data_ += value;
}

void DicomEncoder::sequence(uint32_t tag, const std::vector<DicomEncoder>& items) {
  uint64_t length = 0;
  for (const DicomEncoder& i : items) length += 8 + i.data_.size();
  if (length > 0xfffffffe) fail_internal("a sequence of more than 4 GiB");
  wide_head(tag, "SQ", uint32_t(length));
  for (const DicomEncoder& i : items) {
    append_tag(data_, item_of_sequence);
    append(data_, uint32_t(i.data_.size()));
    data_ += i.data_;
  }
}

std::string decimal_string(double value) {
  std::string s = fmt::format("{}", value == 0 ? 0.0 : value);  // the shortest that is exact
  for (int digits = int(longest_decimal); s.size() > longest_decimal && digits > 0; --digits) s = fmt::format("{:.{}g}", value, digits);
  return s;
}

std::string dicom_uid(uint64_t high, uint64_t low) {
  // Marked as a UUID of version 8 (RFC 9562), whose other bits are free.
  high = (high & ~uint64_t(0xf000)) | 0x8000;
  low = (low & ~(uint64_t(3) << 62)) | uint64_t(1) << 63;
  std::string digits;
  while (high || low) {  // divides the 128 bits by 10
    uint64_t rest = 0;
    for (uint64_t* part : {&high, &low}) {
      uint64_t q = 0;
      for (int half : {32, 0}) {
        const uint64_t n = rest << 32 | (*part >> half & 0xffffffff);
        q |= n / 10 << half;
        rest = n % 10;
      }
      *part = q;
    }
    digits += char('0' + rest);
  }
  std::reverse(digits.begin(), digits.end());
  return "2.25." + digits;
}

}  // namespace sg
