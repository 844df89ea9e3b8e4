// SPDX-License-Identifier: Apache-2.0
// What the readers of the five VTK XML dataset kinds share: fields of a piece, and fields that all pieces have.
#pragma once
#include "io/io.h"
#include "io/vtk_xml.h"

namespace sg::vtk {

struct XmlRead {
  const XmlFile& file;
  const ReadOptions& options;
  Context& context;
};

/// The arrays of the PointData, CellData or FieldData of `parent`. Throws Error(data) for arrays shorter than `tuples`.
FieldSet read_fields(const XmlRead& read, pugi::xml_node parent, const char* element, Association association,
                     std::optional<uint64_t> tuples);

/// The numeric array of that name below `parent`, or an empty node.
pugi::xml_node find_array(pugi::xml_node parent, std::string_view name);
/// The same; throws Error(data) when there is none.
pugi::xml_node need_array(const XmlRead& read, pugi::xml_node parent, std::string_view name);
/// The first DataArray of the element Points: coordinates of `tuples` points.
Array read_points(const XmlRead& read, pugi::xml_node piece, uint64_t tuples);

/// A field that all pieces have with one type and number of components; the others are dropped with a warning.
struct SharedField {
  const Field* first;
  std::vector<Array> arrays;  ///< one per piece
};
std::vector<SharedField> shared_fields(const XmlRead& read, const std::vector<FieldSet>& pieces);

void read_image(const XmlRead& read, DatasetParts& parts);
void read_rectilinear(const XmlRead& read, DatasetParts& parts);
void read_curvilinear(const XmlRead& read, DatasetParts& parts);
void read_unstructured(const XmlRead& read, DatasetParts& parts);
void read_polydata(const XmlRead& read, DatasetParts& parts);

}  // namespace sg::vtk
