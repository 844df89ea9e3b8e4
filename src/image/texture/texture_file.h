// SPDX-License-Identifier: Apache-2.0
// Textures from the bytes of picture files.
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "image/texture/texture.h"

namespace sg {

/// Whether it begins as one of the files that decode_texture() knows.
bool is_picture(std::span<const std::byte> bytes);

/// PNG, JPEG or Radiance HDR, told apart by their content; numbers of HDR are linear whatever `encoding` says. Throws Error(data) naming
/// `name` for other files, damaged ones, and those that are too large.
Texture decode_texture(std::span<const std::byte> bytes, const std::string& name, TexelEncoding encoding, bool alpha);

/// Memory that the texture of a PNG or JPEG takes, with its mip maps and while it is decoded, by its header; 0 for others.
double texture_memory(std::span<const std::byte> bytes);

}  // namespace sg
