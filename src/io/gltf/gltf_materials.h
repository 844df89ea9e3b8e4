// SPDX-License-Identifier: Apache-2.0
// How the materials of a glTF document look: metallic-roughness with its textures, and the extensions that OpenPBR knows, too.
#pragma once
#include <vector>

#include "base/text/json.h"
#include "data/fields/material_table.h"
#include "io/gltf/gltf_document.h"

namespace sg {

/// In the order of the document's list. `document` has its buffers and views. What is damaged, or a picture that cannot be read, is left
/// out with a warning: the shape is there without it.
std::vector<MaterialLook> gltf_looks(const Json& root, const GltfDocument& document, Context& context);

}  // namespace sg
