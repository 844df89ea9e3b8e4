// SPDX-License-Identifier: Apache-2.0
// Cells or points by their numbers.
#pragma once
#include "filter/mesh/slice/implicit_function.h"

namespace sg {

enum class IdsOf { cell, point };
constexpr auto enum_words(IdsOf) {
  using enum IdsOf;
  return std::array{Word{"cell", cell}, Word{"point", point}};
}

struct ExtractParams {
  std::vector<int64_t> ids;
  IdsOf of = IdsOf::cell;
  FieldName by = {};
  bool invert = false;
  ImplicitParams region = {};
  bool all_points = true;
  bool by_center = false;
  std::vector<std::string> types = {};
  std::vector<int64_t> levels = {};
  std::vector<std::string> blocks = {};
  std::string part = {};
};
inline void describe(Schema& s, ExtractParams& p) {
  s("ids", p.ids, "Numbers of cells or points, counted from 0; or values of the field 'by'.");
  s("of", p.of, "Whether the numbers are of cells or points; cells of selected points are those that use one of them.");
  s("by", p.by, "Integer field that holds the ids (global ids, block or material numbers); default: the order in the file.")
      .takes(fields::scalars);
  s("invert", p.invert, "Keep the others instead.");
  describe_implicit(s, p.region);
  s("all_points", p.all_points, "With a region: select a cell only if all its points lie in it (behind the plane), not just one.");
  s("by_center", p.by_center,
    "With a region: select a cell if its centre, the mean of its points, lies in it; all_points does not count then.");
  s("types", p.types, "Cell types to select, e.g. Tetra,Hexahedron.");
  s("levels", p.levels, "Levels of an AMR grid to select; 0 is the coarsest.").at_least(0);
  s("blocks", p.blocks, "Parts of a collection to select, by name, path, the end of a path or number.");
  s("part", p.part,
    "One part of a collection, by its path (or the end of it) or by its number among all parts from #0 on: the result is the part itself.");
}

/// The chosen cells as a mesh of their own (see extract_cells), in input order, with all fields. With of=point: the cells that use one
/// of the points; of a PointCloud the points. Of several conditions (ids, a region, types, levels) all must hold.
/// Throws Error(usage) when nothing is selected, for nonexistent numbers (without `by`), and for a field `by` of several components or on
/// an association other than `of`.
DatasetPtr extract(const DatasetPtr& in, const ExtractParams& p, Context& ctx);
/// The datasets and tables of a collection in order, each with its path ("wing/left"); anything else is its only part, "".
std::vector<Collection::Part> all_parts(const Data& data);

/// The part that `part` names, of all_parts(). The parts of a collection that `blocks` names (all where it is empty), by name, path of
/// names, an end of one path alone, or number among the top parts; those of which something is left after extract(), when there are other
/// conditions.
Data extract_blocks(const Data& in, const ExtractParams& p, Context& ctx);

}  // namespace sg
