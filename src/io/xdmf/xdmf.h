// SPDX-License-Identifier: Apache-2.0
// XDMF files, versions 1 to 3: what their parts share. Light data is XML; arrays are inline, in binary files, or in HDF5 files that
// the plug-in hdf5 reads. Format: XDMF model and format documentation, xdmf.org, and its archive for version 2. Names of elements and
// attributes are found in any letter case; version 1 calls a DataItem DataStructure or DataTransform.
#pragma once
#include <map>
#include <optional>
#include <pugixml.hpp>

#include "base/file/file.h"
#include "io/io.h"

namespace sg::xdmf {

/// Levels of grids in grids, and of references that lead to others.
constexpr int deepest = 16;

/// Values of a DataItem: one component, the last dimension fastest.
struct Item {
  Array values;
  std::vector<size_t> dims;  ///< slowest first
  size_t count() const { return values.count(); }
};

/// One document.
class Document {
 public:
  /// Throws Error(data) naming the line for text that is not XML.
  Document(const std::string& path, Context& context);

  const std::string& path() const { return path_; }
  Context& context() const { return context_; }
  pugi::xml_node root() const { return document_.document_element(); }

  /// "file: line 7, <Attribute Name=...>".
  std::string where(pugi::xml_node node) const;
  [[noreturn]] void fail(std::string problem, pugi::xml_node node, std::string hint = {}) const;

  /// The elements of that name below `parent`, includes and references followed; "DataItem" finds its older names, too.
  std::vector<pugi::xml_node> children(pugi::xml_node parent, std::string_view name) const;
  /// The first of them, or an empty node.
  pugi::xml_node child(pugi::xml_node parent, std::string_view name) const;
  /// Whether elements of `grid` are referenced in other grids.
  bool is_borrowed(pugi::xml_node grid) const;
  /// Notes which grids others borrow from; by reading all grids once.
  void note_references();

  /// The text with the entities of the document type ("&HeavyData;") replaced.
  std::string with_entities(std::string text) const;

  /// The values of a DataItem. Throws Error(data), or Error(usage) for kinds that are not read.
  Item item(pugi::xml_node data_item, int depth = 0) const;

 private:
  pugi::xml_node resolve(pugi::xml_node node) const;
  std::vector<pugi::xml_node> select(const std::string& xpath, pugi::xml_node from) const;
  Item inline_item(pugi::xml_node n, const std::vector<size_t>& dims, std::optional<ElementType> type = {}) const;
  Item binary_item(pugi::xml_node n, const std::vector<size_t>& dims) const;
  Item hdf_item(pugi::xml_node n, const std::vector<size_t>& dims, const Item* slab) const;
  Item hyperslab(pugi::xml_node n, int depth) const;
  Item coordinates(pugi::xml_node n, int depth) const;
  Item selection(pugi::xml_node n, int depth) const;
  std::vector<pugi::xml_node> parts_of(pugi::xml_node n, size_t count) const;
  Item with_dimensions(Item found, pugi::xml_node n) const;
  Item function(pugi::xml_node n, int depth) const;

  std::string path_;
  Context& context_;
  MappedFile file_;
  pugi::xml_document document_;
  std::map<std::string, std::string> entities_;
  mutable std::map<std::string, std::vector<pugi::xml_node>> selected_;
  std::vector<pugi::xml_node> lenders_;
};

/// Product of dimensions; throws Error(data) when it overflows.
size_t product(const std::vector<size_t>& dims, const std::string& where);
/// Whole numbers of an attribute ("10 20 30"); throws Error(data).
std::vector<size_t> dimensions(const Document& doc, pugi::xml_node node, const char* attribute);
/// The element type that NumberType (or DataType) and Precision name.
ElementType number_type(const Document& doc, pugi::xml_node node);
/// The attribute of that name in any letter case; an empty one where there is none.
pugi::xml_attribute find_attribute(pugi::xml_node node, std::string_view name);
/// The value of the first of two attributes that is there, without blanks around it.
std::string_view attribute(pugi::xml_node node, std::string_view name, std::string_view older = {});
/// Whether the element has that name, in any letter case and whatever its namespace.
bool is_named(pugi::xml_node node, std::string_view name);

/// "$0 + 2 * $1", "JOIN($0, $1)": values of the arguments combined. Throws Error(data) for what it does not know.
Item evaluate_function(std::string_view text, const std::vector<Item>& arguments, const std::string& where);

/// Cells of a Topology that is not a grid, for `points` points.
UnstructuredMesh read_topology(const Document& doc, pugi::xml_node topology, Points points);
/// Dimensions {x, y, z} of a Topology that is a grid (SMesh, RectMesh, CoRectMesh), or nothing.
std::optional<std::array<size_t, 3>> lattice_of(const Document& doc, pugi::xml_node topology);
bool is_topology(pugi::xml_node topology, std::string_view suffix);
/// Points of a Geometry of kind XYZ, XY, X_Y_Z or X_Y.
Points read_points(const Document& doc, pugi::xml_node geometry);

}  // namespace sg::xdmf
