// SPDX-License-Identifier: Apache-2.0
// An open VTK XML file: its elements, and the arrays that they describe in any encoding.
#pragma once
#include <array>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"
#include "io/vtk/vtk_codec.h"

namespace sg::vtk {

/// Part of a lattice of dims[0] x dims[1] x dims[2] tuples: count[a] of them along each axis, from lo[a] on, every stride[a]-th.
struct Window {
  std::array<size_t, 3> dims{1, 1, 1}, lo{0, 0, 0}, count{1, 1, 1}, stride{1, 1, 1};
  bool whole() const { return count == dims; }
  size_t tuples() const { return count[0] * count[1] * count[2]; }
};

/// The name of the root's type in the first bytes of a VTK XML file ("ImageData", "Collection"); "" when it is none.
std::string_view xml_type(std::string_view head);

class XmlFile {
 public:
  /// Parses the elements; appended bytes are left where they are. Throws Error(data) with byte and line.
  explicit XmlFile(const std::string& path);

  /// The dataset element ("ImageData", "UnstructuredGrid", ...), of the type that the root announces.
  pugi::xml_node dataset() const { return dataset_; }
  std::string_view type() const { return type_; }
  const std::string& path() const { return file_.path(); }

  /// The numbers of a DataArray. With `tuples` there must be at least as many (more are dropped), without all there are.
  /// Little-endian uncompressed appended bytes are not copied when they lie on multiples of the element size.
  Array array(pugi::xml_node element, std::optional<uint64_t> tuples) const;
  /// The characters of a string array, as bytes.
  Array codes(pugi::xml_node element) const;
  /// The same for point ids: 64-bit numbers that have to be unpacked or copied come as 32-bit ones where all of them fit.
  Array ids(pugi::xml_node element, std::optional<uint64_t> tuples) const;
  /// The step s of n offsets s, 2s, 3s, ...; 0 when they are others, or when telling takes an array (text, base64, other byte orders).
  int equal_steps(pugi::xml_node element, uint64_t n) const;
  /// The part of a lattice that `window` names. Of uncompressed raw bytes only those rows are read, of compressed ones only the
  /// blocks with such rows are unpacked; other encodings are read whole.
  Array block(pugi::xml_node element, const Window& window) const;
  /// No array of this file can hold more bytes.
  uint64_t most_bytes() const;
  /// Type and components of a DataArray, as array() will give them. Throws Error(data) for unknown ones.
  std::pair<ElementType, int> number_type(pugi::xml_node element) const;
  /// Where `tuples` one-component numbers lie in the file as they are (uncompressed, raw, little-endian), on any byte; null when
  /// they do not. For a look that needs no array.
  const std::byte* in_place(pugi::xml_node element, uint64_t tuples, ElementType& type) const;
  /// A DataArray of a type that is read; strings are not.
  static bool is_numeric(pugi::xml_node element);
  /// "DataArray 'T'" for errors.
  static std::string describe(pugi::xml_node element);
  [[noreturn]] void fail(std::string problem, pugi::xml_node element, std::string hint = {}) const;

 private:
  struct Wanted;
  struct Source;
  struct BlockTable;
  void parse();
  void parse_elements(std::string_view head, std::string_view tail);
  std::string_view text_of(pugi::xml_node element, std::string& joined) const;
  void read_root();
  Source source(pugi::xml_node element) const;
  Wanted wanted(pugi::xml_node element, std::optional<uint64_t> tuples) const;
  Array read(const Wanted& want) const;
  BlockTable block_table(const Wanted& want, const Source& source) const;
  Array raw_window(const Wanted& want, const std::byte* numbers, const Window& window) const;
  Array compressed_window(const Wanted& want, const Source& source, const Window& window) const;
  Array plain(const Wanted& want, const Source& source) const;
  Array compressed(const Wanted& want, const Source& source) const;
  Array text(const Wanted& want) const;
  Array narrowed_blocks(const Wanted& want, const Source& source) const;
  Array narrowed_plain(const Wanted& want, const Source& source) const;
  uint64_t word(const std::byte* p) const;
  size_t word_bytes() const { return wide_header_ ? 8 : 4; }
  uint64_t bytes_to_read(const Wanted& want, uint64_t available) const;
  Array finished(const Wanted& want, Buffer buffer, size_t offset, size_t bytes) const;

  MappedFile file_;
  pugi::xml_document document_;
  pugi::xml_node dataset_;
  std::string type_;
  std::vector<std::string_view> texts_;  // long texts of DataArrays, kept from the XML parser
  std::string_view appended_;
  bool have_appended_ = false, appended_base64_ = false;
  bool big_endian_ = false, wide_header_ = false;
  Codec codec_ = Codec::none;
};

/// Whole numbers of an attribute ("WholeExtent"), n of them or an Error.
void parse_longs(const XmlFile& file, pugi::xml_node element, const char* attribute, long long* out, size_t n);
/// Numbers of an attribute, or false when it is missing.
bool parse_doubles(const XmlFile& file, pugi::xml_node element, const char* attribute, double* out, size_t n);
/// A count attribute: 0 when missing.
uint64_t parse_count(const XmlFile& file, pugi::xml_node element, const char* attribute);

}  // namespace sg::vtk
