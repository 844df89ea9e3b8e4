// SPDX-License-Identifier: Apache-2.0
// The containers of glTF: the chunks of a .glb, and what a URI names.
#pragma once
#include <string>
#include <string_view>

#include "base/file/file.h"
#include "io/gltf/gltf_document.h"

namespace sg {

struct GltfChunks {
  std::string_view json;
  std::string_view binary;  ///< data() is null when there is none
};
/// The chunks of a .glb; a .gltf is one chunk of JSON. Throws Error(data).
GltfChunks gltf_chunks(const MappedFile& file);

/// Bytes of a data: URI or of a file beside `path`. Throws Error(data) naming `where`.
GltfBuffer gltf_uri(const std::string& uri, const std::string& path, const std::string& where);

/// Base64 with padding.
std::string to_base64(std::string_view bytes);

}  // namespace sg
