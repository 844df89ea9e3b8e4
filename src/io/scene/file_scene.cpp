// SPDX-License-Identifier: Apache-2.0
#include "io/scene/file_scene.h"

#include "io/formats.h"
#include "io/gltf/gltf_scene.h"

namespace sg {

FileScene scene_in_file(const std::string& path, const ReadOptions& options, Context& context) {
  if (find_format(path, options).read != read_gltf) return {};
  Context quiet(context, 0, 1);  // what is wrong with it is told by the reader of its data
  quiet.on_log = nullptr;
  return scene_of(read_gltf_document(path, quiet));
}

}  // namespace sg
