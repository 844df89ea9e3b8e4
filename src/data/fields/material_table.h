// SPDX-License-Identifier: Apache-2.0
// MaterialTable: how the materials look that a field of labels numbers, as the file says. It hangs on that field (Field::materials), so
// that every operation that carries cells' fields carries it, too.
#pragma once
#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/vec.h"
#include "data/memory/memo.h"

namespace sg {

/// A picture file as bytes: of a file of its own, or out of another. Who draws it decodes it, once.
struct PictureFile {
  std::string name;  ///< for messages
  std::shared_ptr<const void> owner;
  std::span<const std::byte> bytes;
  std::shared_ptr<Memo> memo = std::make_shared<Memo>();  ///< what was made of it
};
using PictureFilePtr = std::shared_ptr<const PictureFile>;

/// A picture on a surface.
struct MaterialPicture {
  enum class Beyond { repeat, mirror, clamp };

  PictureFilePtr file;                            ///< null: there is none
  std::string coordinates;                        ///< point field; "" = the first of role tcoords
  std::array<double, 6> place{1, 0, 0, 0, 1, 0};  ///< u = p0 x + p1 y + p2, v = p3 x + p4 y + p5; (0, 0) is the picture's lower left
  Beyond beyond_u = Beyond::repeat, beyond_v = Beyond::repeat;
  bool nearest = false;  ///< texels are seen as squares from near by
};

/// Numbers of a material that a picture multiplies, each with a channel of it: 0 red, 1 green, 2 blue. Of indices of refraction, what they
/// are above 1. The last three have three numbers each, multiplied with red, green and blue, whatever the channel.
enum class MaterialFactor {
  roughness,
  coat_roughness,
  specular,
  ior,
  coat_ior,
  metalness,
  transmission,
  coat,
  subsurface,
  subsurface_anisotropy,
  retro,
  transmission_color,
  coat_color,
  subsurface_radius
};
constexpr size_t material_factors = size_t(MaterialFactor::subsurface_radius) + 1;
struct FactorChannel {
  MaterialFactor factor;
  int channel;
};
struct FactorPicture {
  MaterialPicture picture;
  std::vector<FactorChannel> channels;
};

/// The names and meanings of glTF 2.0, of which the materials of OBJ are made, too. Colours are in linear light.
struct MaterialLook {
  /// What the alpha of the base colour means: nothing, a hole where it is below the cutoff, or coverage.
  enum class Alpha { opaque, mask, blend };

  Vec3f base_color{1, 1, 1};
  float opacity = 1;
  Alpha alpha = Alpha::opaque;
  float alpha_cutoff = 0.5f;
  MaterialPicture base_picture;  ///< times base_color; colours of a screen
  bool states_matter = false;    ///< what follows was stated, rather than left at its default
  float metallic = 1, roughness = 1;
  std::vector<FactorPicture> factors;  ///< pictures of numbers
  MaterialPicture normal_picture;      ///< of directions: right, up and out of the surface as 0 to 1 for -1 to 1
  float normal_scale = 1;              ///< of their share across the surface
  MaterialPicture occlusion_picture;   ///< red: the share of light from all around that arrives
  float occlusion_strength = 1;        ///< of what that takes away
  Vec3f emission;
  MaterialPicture emission_picture;  ///< times emission; colours of a screen
  float ior = 1.5f, transmission = 0, coat = 0, coat_roughness = 0;
  bool thin = true;                  ///< what is transmitted goes through a sheet, not into a body
  Vec3f attenuation_color{1, 1, 1};  ///< of light in the body after attenuation_distance, which is 0 for clear ones
  float attenuation_distance = 0;
};

struct MaterialTable {
  std::map<int64_t, MaterialLook> looks;  ///< by the number in the field
};

}  // namespace sg
