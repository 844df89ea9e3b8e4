// SPDX-License-Identifier: Apache-2.0
// Materials that hang on a field of labels (MaterialTable), as those of a glTF file.
#pragma once
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "data/fields/material_table.h"
#include "io/write_losses.h"

namespace sg {

class GltfMaterialWriter {
 public:
  using OrderedJson = nlohmann::ordered_json;

  /// Adds to the document and to its one buffer.
  GltfMaterialWriter(OrderedJson& root, std::string& bytes, WriteLosses& losses) : root_(root), bytes_(bytes), losses_(losses) {}

  /// The number of a look among the file's materials; each is written once, and so are its pictures. `coordinates`: the fields that the
  /// file has as TEXCOORD_0, TEXCOORD_1, ... What glTF cannot say is told as a loss.
  int add(const MaterialLook& look, const std::string& name, const std::vector<std::string>& coordinates);

 private:
  OrderedJson material(const MaterialLook& look, const std::vector<std::string>& coordinates);
  void put_factors(OrderedJson& pbr, OrderedJson& extensions, const MaterialLook& look, const std::vector<std::string>& coordinates);
  /// A textureInfo; null where there is no such picture.
  OrderedJson texture(const MaterialPicture& picture, const std::vector<std::string>& coordinates);
  std::optional<int> image(const PictureFilePtr& file);
  int sampler(const MaterialPicture& picture);
  void use(const char* extension);

  OrderedJson& root_;
  std::string& bytes_;
  WriteLosses& losses_;
  std::map<std::string, int> materials_;  // by what they are, as text
  std::map<const PictureFile*, std::optional<int>> images_;
};

}  // namespace sg
