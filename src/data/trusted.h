// SPDX-License-Identifier: Apache-2.0
// Datasets whose mesh a kernel of ours has just made.
#pragma once
#include "data/dataset.h"

namespace sg {

/// make_dataset() without validate() of the mesh, whose looks at every index take as long as making them. For results that are right by
/// construction and whose tests call validate(); builds with assertions check all the same. Never for what a file or a caller gave.
DatasetPtr make_trusted_dataset(DatasetParts parts, std::shared_ptr<const BrickedVolume> bricks = {});

namespace detail {
/// Whether make_trusted_dataset() is running in this thread.
bool mesh_is_trusted();
}  // namespace detail

}  // namespace sg
