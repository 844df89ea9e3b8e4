// SPDX-License-Identifier: Apache-2.0
// The parts of faces(), one per family of meshes. Each returns chunks in an order that depends only on the mesh.
#pragma once
#include "base/context.h"
#include "filter/mesh/faces/curved_faces.h"
#include "filter/mesh/surface_builder.h"

namespace sg::detail {

/// Curved faces and curves are left to `curved`: what each chunk found, with their places among the others.
std::vector<SurfaceChunk> unstructured_faces(const UnstructuredMesh& mesh, const std::vector<uint8_t>& states,
                                             std::vector<CurvedChunk>& curved, const Context& ctx);
std::vector<SurfaceChunk> lattice_faces(const Mesh& mesh, const std::vector<uint8_t>& states, const Context& ctx);
std::vector<SurfaceChunk> amr_faces(const Dataset& in, const AmrGrid& grid, const std::vector<uint8_t>& states, const Context& ctx);

}  // namespace sg::detail
