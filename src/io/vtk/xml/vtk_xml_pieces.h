// SPDX-License-Identifier: Apache-2.0
// What the readers of the five VTK XML dataset kinds share. Their pieces are in one file or in several (parallel files).
#pragma once
#include "io/io.h"
#include "io/vtk/xml/vtk_xml.h"

namespace sg::vtk {

/// A Piece element and its file.
struct XmlPiece {
  const XmlFile* file;
  pugi::xml_node node;
};

/// What a reader is given: the file that describes the whole (for parallel files the one that names the others) and all pieces.
struct XmlRead {
  const XmlFile& file;
  const ReadOptions& options;
  Context& context;
  std::vector<XmlPiece> pieces = {};
};

/// A field as stored in all pieces: nodes[i] is its DataArray in piece i. Ghost arrays may be missing in some (an empty node).
struct XmlField {
  Field field;  ///< without its numbers
  ElementType type;
  int components;
  std::vector<pugi::xml_node> nodes;
};

/// Is a field of this name asked for?
bool is_wanted(const XmlRead& read, std::string_view name);
/// The fields of PointData or CellData that all pieces have with one type and number of components and that are wanted; others
/// are dropped with a warning.
std::vector<XmlField> list_fields(const XmlRead& read, const std::vector<XmlPiece>& pieces, const char* element, Association association);
/// Only names and types are wanted (ReadOptions::header_only), and it is not a ghost array.
bool header_only(const XmlRead& read, const XmlField& field);
/// Throws Error(data) when the files of the pieces cannot hold that many numbers, before memory is asked for.
void check_backed(const std::vector<XmlPiece>& pieces, const XmlField& field, size_t tuples);
/// All numbers of a field, piece after piece of tuples[i] each.
Array joined_field(const XmlRead& read, const std::vector<XmlPiece>& pieces, const XmlField& field, const std::vector<size_t>& tuples);
/// String arrays of PointData or CellData: their words, in alphabetical order, are numbered from 0 and noted as "labels of NAME"; the field
/// holds the numbers. Throws Error(data) when there are not tuples[i] strings in piece i.
void add_categories(const XmlRead& read, const std::vector<XmlPiece>& pieces, const char* element, Association association,
                    const std::vector<size_t>& tuples, DatasetParts& parts);
/// String arrays of FieldData below `parent`, as notes.
void add_texts(const XmlRead& read, pugi::xml_node parent, DatasetParts& parts);
/// Arrays of FieldData below `parent`.
FieldSet read_whole_fields(const XmlRead& read, pugi::xml_node parent);

/// The numeric array of that name below `parent`, or an empty node.
pugi::xml_node find_array(pugi::xml_node parent, std::string_view name);
/// The same; throws Error(data) when there is none.
pugi::xml_node need_array(const XmlFile& file, pugi::xml_node parent, std::string_view name);
/// The first DataArray of the element Points, or an empty node where `tuples` is 0. Throws Error(data) when there is none, or not of
/// three components.
pugi::xml_node points_array(const XmlPiece& piece, uint64_t tuples);
/// Its numbers: coordinates of `tuples` points.
Array read_points(const XmlPiece& piece, uint64_t tuples);

void read_image(const XmlRead& read, DatasetParts& parts);
void read_rectilinear(const XmlRead& read, DatasetParts& parts);
void read_curvilinear(const XmlRead& read, DatasetParts& parts);
void read_unstructured(const XmlRead& read, DatasetParts& parts);
void read_polydata(const XmlRead& read, DatasetParts& parts);

}  // namespace sg::vtk
