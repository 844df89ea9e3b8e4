// SPDX-License-Identifier: Apache-2.0
// The elements of a DICOM file (PS3.5): every length is checked against the file, nothing is copied. GDCM is only given files that have
// passed here, because it allocates memory before checking that a file can fill it.
#pragma once
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "base/file/file.h"
#include "base/vec.h"

namespace sg {

constexpr uint32_t pixel_tag = 0x7fe00010;

struct DicomElement {
  uint32_t tag = 0;                      ///< group << 16 | element
  size_t begin = 0, value = 0, end = 0;  ///< bytes: header, value, behind the value
};

struct DicomElements {
  std::span<const std::byte> bytes;
  std::string path;
  std::string transfer_syntax;
  bool big_endian = false, explicit_vr = true;
  size_t meta_end = 0;                   ///< behind preamble and group 2
  std::map<uint32_t, DicomElement> top;  ///< first of each tag, up to the pixel data
  std::vector<DicomElement> in_groups;   ///< leaves inside the functional groups of multi-frame files, in file order
  bool encapsulated = false;             ///< pixel data in fragments
  size_t fragment_bytes = 0;

  bool has(uint32_t tag) const { return top.count(tag) > 0; }
  std::string text(const DicomElement& e) const;
  std::string text(uint32_t tag) const;
  /// Numbers of a text (DS, IS) between backslashes; those that are none are left out.
  std::vector<double> numbers(const DicomElement& e) const;
  std::vector<double> numbers(uint32_t tag) const;
  /// An unsigned 16-bit value.
  size_t whole(uint32_t tag, size_t otherwise) const;
};

/// The bytes of a file, whose data set is inflated where it is stored deflated (PS3.5 A.5): then they say so no longer.
class DicomFile {
 public:
  DicomFile() = default;
  explicit DicomFile(const std::string& path);
  std::span<const std::byte> bytes() const {
    return inflated_.empty() ? std::span<const std::byte>(file_.data(), file_.size()) : std::span<const std::byte>(inflated_);
  }

 private:
  MappedFile file_;
  std::vector<std::byte> inflated_;
};

/// Walks over the file. Throws Error(data) naming byte and tag where a length leaves the file or sequences nest too deep.
DicomElements walk_dicom(std::span<const std::byte> bytes, const std::string& path);

}  // namespace sg
