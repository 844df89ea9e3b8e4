// SPDX-License-Identifier: Apache-2.0
// A glTF 2.0 document as plain structs, checked as far as it can be without reading the numbers, and the bytes of its buffers.
// Source: Khronos glTF 2.0 Specification (ISO/IEC 12113).
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "data/array.h"
#include "data/fields/material_table.h"
#include "io/scene/file_scene.h"

namespace sg {

struct GltfView {
  int buffer = 0;
  uint64_t offset = 0, length = 0, stride = 0;  ///< stride 0: elements lie without gaps
};

struct GltfSparse {
  uint64_t count = 0;
  int indices_view = -1, values_view = -1;
  uint64_t indices_offset = 0, values_offset = 0;
  ElementType indices_type = ElementType::u32;
};

struct GltfAccessor {
  int view = -1;  ///< -1: all zeros
  uint64_t offset = 0, count = 0;
  ElementType type = ElementType::f32;
  int components = 1;
  bool normalized = false;
  std::optional<GltfSparse> sparse;
};

struct GltfPrimitive {
  std::vector<std::pair<std::string, int>> attributes;  ///< name and accessor
  int indices = -1, material = -1;
  int mode = 4;  ///< points, lines, loop, line strip, triangles, triangle strip, triangle fan
};
struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
};
struct GltfNode {
  std::string name;
  int mesh = -1;
  Mat4 matrix;
  std::vector<int> children;
  int camera = -1, light = -1;
};
struct GltfCamera {
  std::string name;
  bool usable = false, parallel = false;
  double view_angle = 0, height = 0;  ///< degrees; of a parallel one's picture
};
struct GltfLight {
  std::string name;
  bool usable = false;
  FileLight::Shape shape = FileLight::Shape::point;
  Vec3f color{1, 1, 1};
  double intensity = 1, inner = 0, outer = 45;  ///< as of FileLight
};
struct GltfMaterial {
  std::string name;
  float base_color[4] = {1, 1, 1, 1};  ///< linear RGB and alpha
};

struct GltfBuffer {
  std::shared_ptr<const void> owner;
  std::string_view bytes;
};

struct GltfDocument {
  std::string path;
  std::vector<GltfBuffer> buffers;
  std::vector<GltfView> views;
  std::vector<GltfAccessor> accessors;
  std::vector<GltfMesh> meshes;
  std::vector<GltfNode> nodes;
  std::vector<GltfMaterial> materials;
  std::vector<GltfCamera> cameras;
  std::vector<GltfLight> lights;
  std::shared_ptr<const MaterialTable> looks;  ///< by the material's place in the list, from 1 on; null without materials
  std::vector<int> roots;                      ///< nodes of the scene that is shown, else those without a parent
  uint64_t backed = 0;                         ///< bytes of all buffers together
};

/// Reads .gltf or .glb. Throws Error(data) for what is broken, or needs an extension that is not known.
GltfDocument read_gltf_document(const std::string& path, Context& context);

/// The numbers of an accessor, packed, in their own type; normalized integers as f32 unless `keep_integers`.
Array gltf_array(const GltfDocument& document, int accessor, bool keep_integers = false);

}  // namespace sg
