// SPDX-License-Identifier: Apache-2.0
// Exodus II: element blocks, side sets and node sets of one mesh, its variables and time steps.
// Source: Exodus II file format (Sandia SAND92-2137 and successors); the tree and the names are those of VTK's reader.
#pragma once
#include <map>

#include "base/context.h"
#include "io/io.h"
#include "io/plugins/netcdf/exodus_shapes.h"
#include "io/plugins/netcdf/nc_file.h"

namespace sg::nc {

bool is_exodus(const NcFile& file);
std::vector<double> exodus_times(const NcFile& file);
/// A collection of "Element Blocks", "Side Sets" and "Node Sets" (those that hold anything), each a collection of datasets; blocks of faces
/// and edges when there are no element blocks or one of their variables is requested.
Data read_exodus(const NcFile& file, const ReadOptions& options, Context& context);

/// The kinds of objects that have names, ids and variables. The words are those of the file's variables.
struct ObjectKind {
  const char* group;     ///< "Element Blocks"
  const char* prefix;    ///< of eb_prop1, eb_names
  const char* number;    ///< dimension with their number
  const char* size;      ///< dimension with the size of object n: this, then n
  const char* connect;   ///< variable with the cells (or members) of object n
  const char* variable;  ///< of name_elem_var, vals_elem_var1eb1
  const char* suffix;    ///< ... before the number of the object
  bool set;              ///< a set, not a block
};
extern const ObjectKind element_blocks, face_blocks, edge_blocks, side_sets, node_sets;

struct ExodusObject {
  const ObjectKind* kind = nullptr;
  int number = 0;  ///< 1, 2, ... in the file's names
  int64_t id = 0;
  std::string name;
  size_t size = 0;   ///< elements, or members
  size_t first = 0;  ///< number of its first element among all, from 0
};
/// All objects of a kind in the file's order.
std::vector<ExodusObject> exodus_objects(const NcFile& file, const ObjectKind& kind);

/// The cells of a block as stored: node numbers from 1.
struct BlockCells {
  ExodusShape shape;
  size_t per = 0;                ///< numbers per element; 0 where they differ
  Array ids;                     ///< i32 or i64: nodes; of polyhedra: faces
  std::vector<int64_t> offsets;  ///< where they differ: size + 1
  size_t begin(size_t e) const { return per ? e * per : size_t(offsets[e]); }
  size_t end(size_t e) const { return per ? (e + 1) * per : size_t(offsets[e + 1]); }
};

/// Numbers in the file count from 1. The smallest wraps around, so that it stays wrong.
inline int64_t zero_based(int64_t number) { return int64_t(uint64_t(number) - 1); }

/// An open Exodus file and what its parts share.
class ExodusMesh {
 public:
  ExodusMesh(const NcFile& file, const ReadOptions& options, Context& context);

  DatasetPtr block(const ExodusObject& o);
  DatasetPtr side_set(const ExodusObject& o);
  DatasetPtr node_set(const ExodusObject& o);
  /// Whether a field is requested.
  bool wanted(const std::string& name) const;
  std::vector<std::string> variable_names(const ObjectKind& kind) const;

  const std::vector<ExodusObject> elements, faces, edges, sides, node_lists;

 private:
  struct SideList;
  /// Appends side s (from 0) of element e of a block.
  void add_side(const ExodusObject& set, const ExodusObject& block, size_t e, int64_t s, SideList& out);
  const BlockCells& cells_of(const ExodusObject& o);
  void add_polyhedra(const BlockCells& cells, const ExodusObject& o, UnstructuredMesh& mesh, std::vector<int64_t>& ids);
  std::vector<std::pair<const BlockCells*, size_t>> all_faces();
  /// Takes ids (node numbers from 0) into `mesh`, with points and point fields of those nodes only.
  DatasetPtr finish(UnstructuredMesh mesh, std::vector<int64_t> ids, FieldSet cell_fields, const ExodusObject& o, size_t cells);
  FieldSet object_fields(const ExodusObject& o, size_t cells);
  void add_point_fields(FieldSet& fields, const std::vector<int64_t>* nodes);
  void add_map(FieldSet& fields, Association a, const char* variable, std::string name, size_t first, size_t count, bool skip_identity,
               const std::vector<int64_t>* nodes);
  std::optional<Array> values(const ObjectKind& kind, size_t variable, const ExodusObject* o);
  Array grouped(const std::vector<Array>& members) const;
  Points points_of(const std::vector<int64_t>* nodes);

  const NcFile& file_;
  const ReadOptions& options_;
  Context& context_;
  int space_ = 3;
  size_t nodes_ = 0;
  std::optional<double> time_;
  size_t step_ = 0;
  std::map<std::pair<const ObjectKind*, int>, BlockCells> cells_;
  std::array<Array, 3> axes_;
  std::optional<FieldSet> node_fields_;  // of all nodes
  std::vector<std::pair<std::string, std::string>> notes_;
  FieldSet whole_;
};

}  // namespace sg::nc
