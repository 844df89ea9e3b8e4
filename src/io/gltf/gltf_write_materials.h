// SPDX-License-Identifier: Apache-2.0
// Materials that hang on a field of labels (MaterialTable), as those of a glTF file.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "data/fields/material_table.h"
#include "io/write_losses.h"

namespace sg {

class GltfMaterialWriter {
 public:
  /// Puts bytes into the file's buffer; returns the number of their bufferView.
  using PutBytes = std::function<size_t(std::string_view bytes)>;

  GltfMaterialWriter(PutBytes put, WriteLosses& losses);
  ~GltfMaterialWriter();

  /// The number of a look among the file's materials; each is written once, and so are its pictures. `coordinates`: the fields that the
  /// file has as TEXCOORD_0, TEXCOORD_1, ... What glTF cannot say is told as a loss.
  int add(const MaterialLook& look, const std::string& name, const std::vector<std::string>& coordinates);
  /// An object with those of the members materials, textures, samplers, images and extensionsUsed that there are, as JSON.
  std::string text() const;

 private:
  struct Document;
  std::unique_ptr<Document> document_;
};

}  // namespace sg
