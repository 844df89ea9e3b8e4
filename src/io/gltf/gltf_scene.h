// SPDX-License-Identifier: Apache-2.0
// Cameras and lights (KHR_lights_punctual) of a glTF document, where its nodes place them.
// Source: Khronos glTF 2.0 Specification, 3.10; KHR_lights_punctual.
#pragma once
#include "base/text/json.h"
#include "io/gltf/gltf_document.h"
#include "io/scene/file_scene.h"

namespace sg {

/// Takes both from the JSON into the document, whose nodes are there. What no picture can be made of (a field of view of 0, a light of a
/// negative intensity) is left out with a warning, as the meshes need none of it. Throws Error(data) for numbers of cameras and lights that
/// do not exist.
void take_cameras_and_lights(const Json& root, GltfDocument& document, Context& context);

/// Those that a node of the scene has, in the order of the nodes: named by it, else by themselves, else "camera 1", "light 1". Cameras look
/// along -z of their node with y up, lights shine along -z; scales do not change them.
FileScene scene_of(const GltfDocument& document);

/// Names what the scene has in the notes of the first dataset.
void note_scene(const GltfDocument& document, Data& first);

}  // namespace sg
