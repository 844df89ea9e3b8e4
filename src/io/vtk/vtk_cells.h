// SPDX-License-Identifier: Apache-2.0
// From the cell lists of VTK files to ours: uniform sizes, record lists, polyhedra, merged pieces, ghosts.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "data/dataset.h"

namespace sg::vtk {

/// Indices as i32 or i64; other integer types are widened. Throws Error(data) for floating point.
Array as_indices(const Array& a);
/// Coordinates as f32 or f64: short integers become f32, long ones f64.
Array as_coordinates(const Array& a);

/// Cells from the `n` numbers at which each cell's ids end; `fixed` is used when all cells have one size.
/// Throws Error(data) when the ends run backwards or out of the ids.
CellArray cells_from_ends(const Array& ends, const Array& connectivity);
/// The size k of all cells when the n numbers at p, aligned or not, are k, 2k, 3k, ...; else 0.
int uniform_size(const std::byte* p, ElementType type, size_t n, bool big_endian = false);
/// Cells of one size.
CellArray cells_of_size(int size, size_t n, const Array& connectivity);
/// The same from n+1 (or no) numbers at which each cell's ids begin.
CellArray cells_from_starts(const Array& starts, const Array& connectivity);
/// `n` records of a count and as many ids.
CellArray cells_from_records(const Array& records, size_t n);

/// Sets `types`, or `single_type` when all are equal.
void set_types(UnstructuredMesh& mesh, const Array& types);

/// Collects the faces of polyhedra, cell by cell.
class FaceCollector {
 public:
  /// A face stream: number of faces, then for each face its size and its ids. Returns the numbers used; throws Error(data).
  size_t add(IndexView stream, size_t begin, size_t end);
  void add_none() { cell_faces_.push_back(int64_t(offsets_.size()) - 1); }
  void finish(UnstructuredMesh& mesh);

 private:
  std::vector<int64_t> ids_, offsets_{0}, cell_faces_{0};
};

/// Legacy files keep a polyhedron's face stream in place of its ids: replaces it by faces and distinct points.
void expand_polyhedra(UnstructuredMesh& mesh);

/// Arrays of one type and one number of components, one after the other. A lone array is passed through.
Array concatenated(std::span<const Array> parts);
/// The same for indices, with shift[i] added to those of parts[i].
Array concatenated_indices(std::span<const Array> parts, std::span<const size_t> shift);
/// Cells of several pieces as one list; point ids of piece i are shifted by shift[i].
CellArray concatenated_cells(std::span<const CellArray> parts, std::span<const size_t> shift);

/// Rational weights of Bezier cells, and orders of Lagrange and Bezier cells along their axes, from a field. Fields that are not of
/// that kind (components, values) throw Error(data).
void set_weights(UnstructuredMesh& mesh, const Field& field);
void set_degrees(UnstructuredMesh& mesh, const Field& field);

/// An array of that type and size without numbers of its own: all NaN, or 0 for integers. What header_only leaves of a field.
Array hollow(ElementType type, size_t tuples, int components);

/// Moves vtkGhostType and vtkGhostLevels from the fields to the ghost arrays.
void take_ghosts(DatasetParts& parts);
bool is_ghost_name(std::string_view name);

}  // namespace sg::vtk
