// SPDX-License-Identifier: Apache-2.0
// Sources: Khronos glTF 2.0 Specification, 3.8 and 3.9; KHR_texture_transform, KHR_materials_ior, _transmission, _volume, _clearcoat,
// _emissive_strength.
#include "io/gltf/gltf_materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/gltf/gltf_bytes.h"

namespace sg {

namespace {

/// The number of a member in [lo, hi]; `otherwise` where it is none.
float factor(const Json& o, const char* key, float otherwise, float lo = 0, float hi = 1) {
  const Json& v = o[key];
  return v.is_number() && std::isfinite(v.number()) ? std::clamp(float(v.number()), lo, hi) : otherwise;
}

Vec3f color_factor(const Json& o, const char* key, Vec3f otherwise) {
  const Json& list = o[key];
  if (!list.is_list() || list.size() < 3) return otherwise;
  Vec3f c;
  for (size_t i = 0; i < 3; ++i) {
    if (!list[i].is_number() || !std::isfinite(list[i].number())) return otherwise;
    c[int(i)] = std::clamp(float(list[i].number()), 0.f, 1.f);
  }
  return c;
}

MaterialPicture::Beyond beyond_of(const Json& sampler, const char* key) {
  constexpr uint64_t clamp_to_edge = 33071, mirrored_repeat = 33648;
  const uint64_t mode = sampler[key].whole();
  return mode == clamp_to_edge     ? MaterialPicture::Beyond::clamp
         : mode == mirrored_repeat ? MaterialPicture::Beyond::mirror
                                   : MaterialPicture::Beyond::repeat;
}

class LookReader {
 public:
  LookReader(const Json& root, const GltfDocument& document, Context& context)
      : root_(root), doc_(document), context_(context), files_(root["images"].items().size()), tried_(files_.size()) {}

  MaterialLook look(const Json& o) {
    const Json &pbr = o["pbrMetallicRoughness"], &extensions = o["extensions"];
    MaterialLook l;
    l.base_color = color_factor(pbr, "baseColorFactor", l.base_color);
    l.opacity = pbr["baseColorFactor"].size() == 4 && pbr["baseColorFactor"][3].is_number()
                    ? std::clamp(float(pbr["baseColorFactor"][3].number()), 0.f, 1.f)
                    : 1.f;
    if (!(l.opacity >= 0)) l.opacity = 1;
    const std::string& mode = o["alphaMode"].text();
    if (mode == "MASK") l.alpha = MaterialLook::Alpha::mask;
    if (mode == "BLEND") l.alpha = MaterialLook::Alpha::blend;
    if (l.alpha == MaterialLook::Alpha::opaque) l.opacity = 1;
    l.alpha_cutoff = factor(o, "alphaCutoff", 0.5f);
    l.base_picture = picture(pbr["baseColorTexture"]);
    l.states_matter = pbr.contains("metallicFactor") || pbr.contains("roughnessFactor");
    l.metallic = factor(pbr, "metallicFactor", 1), l.roughness = factor(pbr, "roughnessFactor", 1);
    using enum MaterialFactor;
    factors(l, pbr["metallicRoughnessTexture"], {{roughness, 1}, {metalness, 2}});
    l.normal_picture = picture(o["normalTexture"]), l.normal_scale = factor(o["normalTexture"], "scale", 1, -100, 100);
    l.occlusion_picture = picture(o["occlusionTexture"]), l.occlusion_strength = factor(o["occlusionTexture"], "strength", 1);
    l.emission =
        color_factor(o, "emissiveFactor", {}) * factor(extensions["KHR_materials_emissive_strength"], "emissiveStrength", 1, 0, 1e6f);
    l.emission_picture = picture(o["emissiveTexture"]);
    l.ior = factor(extensions["KHR_materials_ior"], "ior", 1.5f, 1, 4);
    const Json &clear = extensions["KHR_materials_transmission"], &coated = extensions["KHR_materials_clearcoat"];
    l.transmission = factor(clear, "transmissionFactor", 0);
    factors(l, clear["transmissionTexture"], {{transmission, 0}});
    const Json& volume = extensions["KHR_materials_volume"];
    l.thin = !(factor(volume, "thicknessFactor", 0, 0, 1e30f) > 0);
    l.attenuation_color = color_factor(volume, "attenuationColor", l.attenuation_color);
    l.attenuation_distance = factor(volume, "attenuationDistance", 0, 0, 1e30f);
    l.coat = factor(coated, "clearcoatFactor", 0), l.coat_roughness = factor(coated, "clearcoatRoughnessFactor", 0);
    factors(l, coated["clearcoatTexture"], {{coat, 0}}), factors(l, coated["clearcoatRoughnessTexture"], {{coat_roughness, 1}});
    return l;
  }

 private:
  void factors(MaterialLook& l, const Json& info, std::vector<FactorChannel> channels) {
    if (MaterialPicture p = picture(info); p.file) l.factors.push_back({std::move(p), std::move(channels)});
  }

  /// What a textureInfo names.
  MaterialPicture picture(const Json& info) {
    MaterialPicture p;
    if (!info.is_object()) return p;
    const Json &texture = root_["textures"][size_t(info["index"].whole())], &transform = info["extensions"]["KHR_texture_transform"];
    const Json* source = texture.find("source");
    if (!info["index"].is_whole() || !source || !source->is_whole() || source->whole() >= files_.size()) {
      warn("a material names a texture that there is not");
      return p;
    }
    p.file = file(size_t(source->whole()));
    if (const Json& sampler = root_["samplers"][size_t(texture["sampler"].whole())]; texture["sampler"].is_whole()) {
      constexpr uint64_t nearest = 9728;
      p.beyond_u = beyond_of(sampler, "wrapS"), p.beyond_v = beyond_of(sampler, "wrapT"),
      p.nearest = sampler["magFilter"].whole() == nearest;
    }
    const Json& set = transform.contains("texCoord") ? transform["texCoord"] : info["texCoord"];
    p.coordinates = fmt::format("TEXCOORD_{}", set.whole());
    // Scaled, turned, moved; v runs downwards in glTF.
    const auto pair = [&](const char* key, size_t i, double otherwise) {
      const Json& v = transform[key][i];
      return v.is_number() && std::isfinite(v.number()) ? v.number() : otherwise;
    };
    const double angle = transform["rotation"].is_number() ? transform["rotation"].number() : 0;
    const double c = std::isfinite(angle) ? std::cos(angle) : 1, s = std::isfinite(angle) ? std::sin(angle) : 0;
    const double sx = pair("scale", 0, 1), sy = pair("scale", 1, 1);
    p.place = {c * sx, s * sy, pair("offset", 0, 0), s * sx, -c * sy, 1 - pair("offset", 1, 0)};
    return p;
  }

  PictureFilePtr file(size_t i) {
    if (tried_[i]) return files_[i];
    tried_[i] = true;
    const Json& image = root_["images"][i];
    const std::string where = fmt::format("image {}", i);
    auto made = std::make_shared<PictureFile>();
    made->name = fmt::format("{}, {}", doc_.path, where);
    try {
      GltfBuffer bytes;
      if (image["uri"].is_text()) {
        bytes = gltf_uri(image["uri"].text(), doc_.path, where);
        if (!image["uri"].text().starts_with("data:")) made->name = image["uri"].text();
      } else if (image["bufferView"].is_whole() && image["bufferView"].whole() < doc_.views.size()) {
        const GltfView& view = doc_.views[size_t(image["bufferView"].whole())];
        const GltfBuffer& buffer = doc_.buffers[size_t(view.buffer)];
        bytes = {buffer.owner, buffer.bytes.substr(size_t(view.offset), size_t(view.length))};
      } else {
        fail_data(fmt::format("{} has neither 'uri' nor 'bufferView'", where), doc_.path);
      }
      made->owner = bytes.owner, made->bytes = std::as_bytes(std::span(bytes.bytes.data(), bytes.bytes.size()));
      files_[i] = std::move(made);
    } catch (const Error& e) {
      warn(fmt::format("a picture on its surface is left out: {}", e.what()));
    }
    return files_[i];
  }

  void warn(const std::string& what) {
    if (warned_++ < 3) context_.warn(doc_.path + ": " + what);
  }

  const Json& root_;
  const GltfDocument& doc_;
  Context& context_;
  std::vector<PictureFilePtr> files_;
  std::vector<bool> tried_;
  int warned_ = 0;
};

}  // namespace

std::vector<MaterialLook> gltf_looks(const Json& root, const GltfDocument& document, Context& context) {
  LookReader reader(root, document, context);
  std::vector<MaterialLook> looks;
  for (const Json& o : root["materials"].items()) looks.push_back(reader.look(o));
  return looks;
}

}  // namespace sg
