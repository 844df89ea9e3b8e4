// SPDX-License-Identifier: Apache-2.0
// CellVolume: a scalar field of any mesh of solid cells, ready for rays: tetrahedra, values, gradients, a second field.
#pragma once
#include <memory>
#include <span>

#include "render/volume/medium/medium.h"
#include "render/volume/sources/cells/tet_mesh.h"
#include "scene/scene.h"

namespace sg::volume {

struct CellVolume {
  DatasetPtr data;  ///< linear cells and polyhedra: curved cells divided, the leaves of an AMR grid without hanging nodes
  std::shared_ptr<const TetMesh> mesh;
  /// With curved cells and a field of points: what `data` was made of, and of which cell each of its cells is a part. The field is read
  /// there, through the cells' own functions.
  DatasetPtr curved;
  std::span<const int64_t> part_of;
  std::span<const float> curved_values;  ///< stored, of the points of `curved`
  bool leaves = false;                   ///< of an AMR grid: polyhedra are boxes whose faces are split
  bool by_cell = false;                  ///< the field is constant in each cell
  std::string key;                       ///< names the field in the dataset's memo
  Plane<float> values;                   ///< stored: of the mesh's vertices, or of the cells of `data`
  Plane<float> seconds;                  ///< the second field at the mesh's vertices, or of its cells; may be empty
  bool second_by_cell = false;
  float base = 0;       ///< value = stored + base
  Range range;          ///< of the stored values that are drawn; empty when none are
  float fit_error = 0;  ///< largest departure of a stretch from the field in cells that are not tetrahedra or boxes

  /// The cell of a tetrahedron, in `curved` or else `data`; is the field linear in the tetrahedron?
  uint32_t whole(size_t tet) const { return part_of.empty() ? mesh->cell(tet) : uint32_t(part_of[mesh->cell(tet)]); }
  bool linear(size_t tet) const {
    if (mesh->all_tets && part_of.empty()) return true;
    if (!part_of.empty()) return curved->as<UnstructuredMesh>()->type(whole(tet)) == CellType::tetra;
    const auto& c = mesh->cells;
    return (tet == 0 || c[tet - 1] != c[tet]) && (tet + 1 == c.size() || c[tet + 1] != c[tet]);
  }

  /// World, of the mesh's vertices: those of gradient(), of second order up to the border; of cell fields those of parabolas fitted to the
  /// cells around the nearest one (fitted_derivatives.h).
  /// Made when first asked for, and kept with the dataset.
  std::shared_ptr<const Plane<Vec3f>> gradients() const;

  std::shared_ptr<const void> owner, curved_owner;  ///< of the values
};

/// Reads the item and cuts its mesh, or takes the mesh from the dataset's memo. Cells that are ghosts, blanked, or have a corner without
/// a finite value or place draw nothing. The shape of curved cells is divided until it departs from straight ones by less than 1/512 of
/// the mesh's size (or there would be more than a million parts); their fields are not, they are read in reference space. Cell fields of
/// AMR grids become continuous: means and planes through the cells around each corner (see contour_amr.h); others are constant in each
/// cell. Lattices are hexahedra. Throws Error(usage) for what has no volume.
CellVolume make_cell_volume(const VolumeItem& item, Context& context);

/// Of a composite volume, as prepare_cast makes it.
Medium make_medium(const VolumeItem& item, const CellVolume& volume);

}  // namespace sg::volume
