// SPDX-License-Identifier: Apache-2.0
// Grids after the CF conventions (cfconventions.org), and plain netCDF arrays: coordinate variables, axes, time, missing values, packing.
#pragma once
#include <map>

#include "base/context.h"
#include "io/io.h"
#include "io/plugins/netcdf/nc_file.h"

namespace sg::nc {

/// The grid with most variables; a collection of all grids, that one first, when there are several.
/// Longitude and latitude stay degrees, as x and y (a note says so); depths keep their sign.
Data read_cf(const NcFile& file, const ReadOptions& options, Context& context);
std::vector<double> cf_times(const NcFile& file);

/// A data variable: which of its dimensions are axes of its grid, which is time, which are held at their first entry.
struct CfVariable {
  const Variable* v = nullptr;
  int time = -1;           ///< place in v->dims, -1 = none
  std::vector<int> axes;   ///< places in v->dims, slowest first; at most 3
  std::vector<int> first;  ///< places held at 0
};

/// Variables on the same dimensions.
struct CfGrid {
  std::vector<int> dims;  ///< of the variable with most of them, slowest first
  std::vector<CfVariable> variables;
  const Variable* lon = nullptr;  ///< positions of points or cells that are listed: 2D for curvilinear grids, 1D for lists
  const Variable* lat = nullptr;
  size_t points = 0;
};

/// What the variables of a file are for.
class CfModel {
 public:
  explicit CfModel(const NcFile& file);
  const std::vector<CfGrid>& grids() const { return grids_; }  ///< the main one first
  /// Variables without a grid of their own (numbers, profiles along one axis of another grid).
  const std::vector<CfVariable>& loose() const { return loose_; }
  /// 'x' 'y' 'z' 't' as the dimension's coordinate variable says, else ' '.
  char letter(int dim) const { return letters_[size_t(dim)]; }
  const Variable* coordinate(int dim) const;
  int time_dim() const { return time_; }  ///< of the main grid, -1 = none

 private:
  char letter_of(const Variable& v) const;
  void find_roles();
  void find_letters();
  void find_grids();
  void find_positions(CfGrid& grid) const;
  const NcFile& file_;
  std::vector<char> letters_;
  std::vector<bool> is_data_;  // per variable
  std::vector<CfGrid> grids_;
  std::vector<CfVariable> loose_;
  int time_ = -1;
};

/// The numbers of a variable as they are meant: unpacked (scale_factor, add_offset), with NaN for missing ones. Integers without
/// packing and missing values stay what they are.
Array decoded(const NcFile& file, const Variable& v, const Array& stored);
/// The type that decoded() gives to the values of a variable.
ElementType decoded_type(const NcFile& file, const Variable& v);

/// A mesh, and how the variables' numbers go on it.
struct CfMesh {
  Mesh mesh;
  Association association = Association::point;
  std::vector<int> order;  ///< place in CfGrid::dims of the mesh's x, y, z axis; -1 = none
  Array point_ghost, cell_ghost;
  std::vector<std::pair<std::string, std::string>> notes;
  std::vector<const Variable*> used;  ///< variables that became coordinates
};
CfMesh cf_mesh(const NcFile& file, const CfModel& model, const CfGrid& grid, Context& context);

}  // namespace sg::nc
