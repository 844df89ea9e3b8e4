// SPDX-License-Identifier: Apache-2.0
// OpenVDB files: sparse grids become dense uniform grids over their active box, point data grids become point clouds.
#pragma once
#include <openvdb/openvdb.h>

#include "io/io.h"

namespace sg {

/// A grid's map as origin and steps; false when it is not affine.
bool vdb_affine(const openvdb::GridBase& grid, Vec3& origin, Vec3 step[3]);

/// Points of a point data grid with their attributes of numbers. Throws Error(data).
DatasetPtr vdb_points(const openvdb::GridBase& grid, const std::string& path, const ReadOptions& options, Context& context);
bool is_vdb_points(const openvdb::GridBase& grid);
/// Makes the types known, once.
void start_openvdb();

Data read_vdb(const std::string& path, const ReadOptions& options, Context& context);
void write_vdb(const std::string& path, const Data& data, const WriteOptions& options, Context& context);

/// Metadata of grids that we write: the box of the dense grid, so that a background at its border survives.
inline constexpr const char* vdb_box_lo = "dense_box_lo";
inline constexpr const char* vdb_box_hi = "dense_box_hi";

}  // namespace sg
