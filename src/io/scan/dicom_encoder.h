// SPDX-License-Identifier: Apache-2.0
// DICOM data sets in explicit VR, little endian (PS3.5), in the making.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sg {

/// Appends elements; the caller gives them in ascending order of their tags (group << 16 | element).
class DicomEncoder {
 public:
  /// Texts and codes; padded to an even length.
  void text(uint32_t tag, std::string_view vr, std::string_view value);
  /// Decimal strings, backslashes between them.
  void numbers(uint32_t tag, std::initializer_list<double> values);
  void whole(uint32_t tag, uint16_t value);
  void long_whole(uint32_t tag, std::span<const uint32_t> values);
  /// A tag as the value.
  void pointer(uint32_t tag, uint32_t value);
  void bytes(uint32_t tag, std::string_view vr, std::string_view value);
  /// Items are data sets themselves.
  void sequence(uint32_t tag, const std::vector<DicomEncoder>& items);
  /// The head of an element whose value of `length` bytes follows.
  void wide_head(uint32_t tag, std::string_view vr, uint32_t length);

  const std::string& data() const { return data_; }

 private:
  void head(uint32_t tag, std::string_view vr, size_t length);
  std::string data_;
};

/// The decimal string nearest to a number in at most 16 characters (VR DS).
std::string decimal_string(double value);

/// A unique identifier (PS3.5 B.2: "2.25." and the decimal digits of a UUID) that is the same for the same 16 bytes.
std::string dicom_uid(uint64_t high, uint64_t low);

}  // namespace sg
