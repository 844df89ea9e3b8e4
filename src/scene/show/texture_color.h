// SPDX-License-Identifier: Apache-2.0
// Colours and a grey texture together: the map of one field, dark and bright by another.
#pragma once
#include "base/schema/param_ref.h"
#include "scene/scene.h"

namespace sg {

/// The name of the point field that is the texture of a dataset: `wanted`; empty: the scalar one whose look is that of a
/// texture (lic, spot noise) and that is not itself the colour; "" for none (and for wanted=none). Throws Error(usage) for unknown names
/// and fields of several components.
std::string texture_field(const Dataset& data, const FieldName& wanted, const std::optional<FieldColor>& color);

/// Gives the item colours of its own (a u8 point field): those it has, times the texture: 0.5 leaves a colour nearly as it is, 0 is dark, 1
/// is bright. Textures of both signs count from -0.5 to 0.5. Where the texture is NaN the colour stays as it is.
void apply_texture(SurfaceItem& item, const std::string& texture);

}  // namespace sg
