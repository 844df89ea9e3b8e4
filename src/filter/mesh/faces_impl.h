// SPDX-License-Identifier: Apache-2.0
// The parts of faces(), one per family of meshes. Each returns chunks in an order that depends on the mesh alone.
#pragma once
#include "base/context.h"
#include "filter/mesh/curved_faces.h"
#include "filter/mesh/surface_builder.h"

namespace sg::detail {

/// Curved faces and curves are left to `curved`: what each chunk found, with their places among the others.
std::vector<SurfaceChunk> unstructured_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states,
                                             std::vector<CurvedChunk>& curved, const Context& ctx);
std::vector<SurfaceChunk> lattice_faces(const Mesh& mesh, const std::vector<uint8_t>& states, const Context& ctx);
std::vector<SurfaceChunk> amr_faces(const Dataset& in, const AmrGrid& grid, const std::vector<uint8_t>& states, const Context& ctx);

/// Every kept point as a blend of input points: Bezier control points move onto the surface, all others stay.
struct NodeBlend {
  size_t width = 0;  ///< ids and weights per kept point; 0 = nothing to blend
  std::vector<int64_t> ids;
  std::vector<double> weights;
};
/// For the kept points (ascending) of a mesh; UnstructuredMesh::weights, else a point field "RationalWeights", make the blend rational.
NodeBlend bezier_blend(const Dataset& in, const UnstructuredMesh& mesh, std::span<const int64_t> kept);

}  // namespace sg::detail
