// SPDX-License-Identifier: Apache-2.0
// Which fields say something in a picture, and which only serve the program that wrote the file.
#pragma once
#include "data/dataset.h"

namespace sg {

/// How much a field says by itself, most first.
enum class Telling {
  values,     ///< a quantity
  divisions,  ///< parts, materials, blocks, levels: where things are, not what
  numbering,  ///< ranks, ghosts and masks: bookkeeping; coordinates, which the axes show already; textures
  ids,        ///< a number of its own for each point, cell or group: colours of it would be a pattern without meaning
  nothing,    ///< the same everywhere, or rounding errors beside another field
};

/// Whether the name of a field says that its values number things, and they are whole, in whatever type they are stored ("material_id").
bool names_numbers(const Field& f);

/// By name, values and their neighbours: a field of integers called `block` divides, one that counts up in order is an id, one that varies
/// by less than 1e-12 of its size or reaches less than 1e-12 of another field's says nothing.
Telling telling(const Dataset& data, const Field& field);

}  // namespace sg
