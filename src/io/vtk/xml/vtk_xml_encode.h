// SPDX-License-Identifier: Apache-2.0
// The elements of a VTK XML file as they are written, and their arrays in the chosen encoding.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "base/file/file.h"
#include "data/array.h"
#include "io/io.h"
#include "io/vtk/vtk_codec.h"

namespace sg::vtk {

/// Attributes in order; values are escaped.
using XmlAttributes = std::vector<std::pair<std::string_view, std::string>>;

/// As they follow the name of an element.
std::string attributes_text(const XmlAttributes& attributes);
/// Three exact numbers.
std::string point_text(Vec3 v);

/// With the characters reserved by XML escaped.
std::string escaped_xml(std::string_view text);

/// "UInt8" ... "Float64".
std::string_view xml_type_name(ElementType type);

/// Writes elements and arrays one after the other; appended bytes follow in finish(). The bytes of the file do not depend
/// on the number of threads. Appended uncompressed arrays begin at multiples of 64 bytes of the file.
class XmlWriter {
 public:
  /// Throws Error(usage) for an unknown encoding or compression.
  XmlWriter(const std::string& path, const WriteOptions& options, Context& context);

  void begin(std::string_view element, const XmlAttributes& attributes = {});
  void end();
  /// `unit` goes where VTK keeps it (vtkDataArray::UNITS_LABEL).
  void array(std::string_view name, const Array& array, bool with_tuples = false, std::string_view unit = {});
  /// Closes all elements, writes the appended bytes and puts the file in its place.
  void finish();

 private:
  struct Block {
    std::vector<std::byte> header, bytes;  // compressed
    Array plain;                           // or the array itself
    uint64_t offset = 0, size = 0;
  };
  Block compressed(const Array& packed) const;
  void write_base64(const std::byte* data, size_t n);
  void inline_binary(const Array& packed);
  void open(std::string_view element, const XmlAttributes& attributes, bool empty);
  void write_unit(std::string_view unit);
  void flush();
  void check() const { context_.check(); }

  AtomicFile file_;
  Context& context_;
  VtkEncoding encoding_ = VtkEncoding::appended;
  Codec codec_ = Codec::none;
  std::string text_;
  std::vector<std::string> open_;
  std::vector<Block> blocks_;
  uint64_t appended_ = 0;
};

/// "vti", "vtr", "vts", "vtu", "vtp" or "vthb": the form that holds a mesh of that kind.
std::string_view extension_for(const Mesh& mesh);
/// Where a grid lies in the whole of which it is a piece: the index of its first point; for uniform grids the position of index 0 0 0.
struct GridPlace {
  std::array<long long, 3> start;
  Vec3 zero;
};
/// One dataset to a file *.vti ... *.vtp; surfaces and point clouds to *.vtu too. Throws Error(usage) for another extension.
void write_dataset(const std::string& path, const Dataset& dataset, const WriteOptions& options, Context& context,
                   const GridPlace* place = nullptr);

}  // namespace sg::vtk
