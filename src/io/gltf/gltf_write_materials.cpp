// SPDX-License-Identifier: Apache-2.0
// Sources: Khronos glTF 2.0 Specification, 3.8 and 3.9; KHR_texture_transform.
#include "io/gltf/gltf_write_materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "data/fields/texture_coordinates.h"

namespace sg {

namespace {

using OrderedJson = nlohmann::ordered_json;

/// PNG and JPEG are what glTF knows.
const char* mime_of(std::span<const std::byte> bytes) {
  const auto starts = [&](std::initializer_list<int> head) {
    return bytes.size() > head.size() &&
           std::equal(head.begin(), head.end(), bytes.begin(), [](int a, std::byte b) { return a == int(b); });
  };
  return starts({0x89, 'P', 'N', 'G'}) ? "image/png" : starts({0xFF, 0xD8, 0xFF}) ? "image/jpeg" : nullptr;
}

OrderedJson numbers(Vec3f v) { return {v.x, v.y, v.z}; }

int wrap_of(MaterialPicture::Beyond beyond) {
  switch (beyond) {
    case MaterialPicture::Beyond::clamp: return 33071;
    case MaterialPicture::Beyond::mirror: return 33648;
    case MaterialPicture::Beyond::repeat: break;
  }
  return 10497;
}

/// KHR_texture_transform from the file's coordinates, which run downwards, to the picture's: scaled, turned, moved. Null for none, nothing
/// where it is another map.
std::optional<OrderedJson> transform(const MaterialPicture& picture, bool field_runs_down) {
  // u = a s + b t + c, v = d s + e t + f, v downwards.
  const auto& p = picture.place;
  double a = p[0], b = p[1], c = p[2], d = -p[3], e = -p[4], f = 1 - p[5];
  if (!field_runs_down) c += b, b = -b, f += e, e = -e;  // the field's y is 1 - t
  if (a == 1 && b == 0 && c == 0 && d == 0 && e == 1 && f == 0) return OrderedJson();
  const double sx = std::hypot(a, d), turn = std::atan2(-d, a), cosine = std::cos(turn), sine = std::sin(turn),
               sy = std::abs(cosine) > std::abs(sine) ? e / cosine : b / sine;
  const double off = std::max(std::abs(sine * sy - b), std::abs(cosine * sy - e));
  if (!(off <= 1e-6 * (sx + std::abs(sy)))) return {};
  OrderedJson r;
  r["offset"] = {c, f}, r["rotation"] = turn, r["scale"] = {sx, sy};
  return r;
}

}  // namespace

struct GltfMaterialWriter::Document {
  PutBytes put_bytes;
  WriteLosses& losses;
  OrderedJson root = OrderedJson::object();
  std::map<std::string, int> materials{};  // by what they are, as text
  std::map<const PictureFile*, std::optional<int>> images{};

  OrderedJson material(const MaterialLook& look, const std::vector<std::string>& coordinates);
  void put_factors(OrderedJson& pbr, OrderedJson& extensions, const MaterialLook& look, const std::vector<std::string>& coordinates);
  /// A textureInfo; null where there is no such picture.
  OrderedJson texture(const MaterialPicture& picture, const std::vector<std::string>& coordinates);
  std::optional<int> image(const PictureFilePtr& file);
  int sampler(const MaterialPicture& picture);
  void use(const char* extension);
};

GltfMaterialWriter::GltfMaterialWriter(PutBytes put, WriteLosses& losses)
    : document_(std::make_unique<Document>(Document{std::move(put), losses})) {}
GltfMaterialWriter::~GltfMaterialWriter() = default;

std::string GltfMaterialWriter::text() const { return document_->root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace); }

void GltfMaterialWriter::Document::use(const char* extension) {
  OrderedJson& used = root["extensionsUsed"];
  if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
}

std::optional<int> GltfMaterialWriter::Document::image(const PictureFilePtr& file) {
  const auto [known, fresh] = images.try_emplace(file.get());
  if (!fresh) return known->second;
  const char* mime = mime_of(file->bytes);
  if (!mime) {
    losses.also(fmt::format("leaves out the picture '{}', which is neither PNG nor JPEG", file->name));
    return {};
  }
  const size_t view = put_bytes({reinterpret_cast<const char*>(file->bytes.data()), file->bytes.size()});
  root["images"].push_back({{"bufferView", view}, {"mimeType", mime}});
  return known->second = int(root["images"].size()) - 1;
}

int GltfMaterialWriter::Document::sampler(const MaterialPicture& p) {
  constexpr int nearest = 9728, linear = 9729, all_levels = 9987;
  const OrderedJson wanted = {{"magFilter", p.nearest ? nearest : linear},
                              {"minFilter", all_levels},
                              {"wrapS", wrap_of(p.beyond_u)},
                              {"wrapT", wrap_of(p.beyond_v)}};
  OrderedJson& all = root["samplers"];
  const auto known = std::find(all.begin(), all.end(), wanted);
  if (known != all.end()) return int(known - all.begin());
  all.push_back(wanted);
  return int(all.size()) - 1;
}

OrderedJson GltfMaterialWriter::Document::texture(const MaterialPicture& p, const std::vector<std::string>& coordinates) {
  if (!p.file) return {};
  const auto set = p.coordinates.empty() ? coordinates.begin() : std::find(coordinates.begin(), coordinates.end(), p.coordinates);
  if (set == coordinates.end()) {
    losses.also(fmt::format("leaves out the picture '{}', which has no texture coordinates", p.file->name));
    return {};
  }
  const auto source = image(p.file);
  if (!source) return {};
  const OrderedJson wanted = {{"source", *source}, {"sampler", sampler(p)}};
  OrderedJson& all = root["textures"];
  auto known = std::find(all.begin(), all.end(), wanted);
  const auto number = int(known - all.begin());
  if (known == all.end()) all.push_back(wanted);
  OrderedJson info = {{"index", number}};
  if (set != coordinates.begin()) info["texCoord"] = set - coordinates.begin();
  const auto moved = transform(p, runs_down(*set));
  if (!moved) {
    losses.also(fmt::format("drops the slanting place of the picture '{}'", p.file->name));
  } else if (!moved->is_null()) {
    info["extensions"]["KHR_texture_transform"] = *moved;
    use("KHR_texture_transform");
  }
  return info;
}

// Pictures of numbers, each where glTF has a place for it with just these channels.
void GltfMaterialWriter::Document::put_factors(OrderedJson& pbr, OrderedJson& extensions, const MaterialLook& l,
                                               const std::vector<std::string>& coordinates) {
  using enum MaterialFactor;
  struct Place {
    MaterialFactor factor;
    int channel;
    OrderedJson& in;
    const char* key;
  };
  OrderedJson clear, coated;
  const Place places[] = {{roughness, 1, pbr, "metallicRoughnessTexture"},
                          {metalness, 2, pbr, "metallicRoughnessTexture"},
                          {transmission, 0, clear, "transmissionTexture"},
                          {coat, 0, coated, "clearcoatTexture"},
                          {coat_roughness, 1, coated, "clearcoatRoughnessTexture"}};
  const auto place_of = [&](const FactorChannel& c) {
    return std::find_if(std::begin(places), std::end(places),
                        [&](const Place& p) { return p.factor == c.factor && p.channel == c.channel; });
  };
  for (const FactorPicture& f : l.factors) {
    const auto has = [&](MaterialFactor factor) {
      return std::any_of(f.channels.begin(), f.channels.end(), [&](const FactorChannel& c) { return c.factor == factor; });
    };
    const bool written = has(metalness) == has(roughness) && std::all_of(f.channels.begin(), f.channels.end(), [&](const FactorChannel& c) {
                           return place_of(c) != std::end(places);
                         });
    for (const FactorChannel& c : f.channels) {
      if (!written) break;
      const Place& place = *place_of(c);
      if (OrderedJson info = texture(f.picture, coordinates); !info.is_null()) place.in[place.key] = std::move(info);
    }
    if (!written) losses.also(fmt::format("leaves out the picture '{}' of numbers of a material", f.picture.file->name));
  }
  if (!clear.is_null()) extensions["KHR_materials_transmission"] = std::move(clear);
  if (!coated.is_null()) extensions["KHR_materials_clearcoat"] = std::move(coated);
}

OrderedJson GltfMaterialWriter::Document::material(const MaterialLook& l, const std::vector<std::string>& coordinates) {
  OrderedJson m, pbr, extensions;
  const auto put = [](OrderedJson& in, const char* key, OrderedJson value) {
    if (!value.is_null()) in[key] = std::move(value);
  };
  const bool opaque = l.alpha == MaterialLook::Alpha::opaque;
  pbr["baseColorFactor"] = {l.base_color.x, l.base_color.y, l.base_color.z, opaque ? 1 : l.opacity};
  put(pbr, "baseColorTexture", texture(l.base_picture, coordinates));
  pbr["metallicFactor"] = l.metallic, pbr["roughnessFactor"] = l.roughness;
  put_factors(pbr, extensions, l, coordinates);
  if (OrderedJson info = texture(l.normal_picture, coordinates); !info.is_null()) {
    if (l.normal_scale != 1) info["scale"] = l.normal_scale;
    m["normalTexture"] = std::move(info);
  }
  if (OrderedJson info = texture(l.occlusion_picture, coordinates); !info.is_null()) {
    if (l.occlusion_strength != 1) info["strength"] = l.occlusion_strength;
    m["occlusionTexture"] = std::move(info);
  }
  put(m, "emissiveTexture", texture(l.emission_picture, coordinates));
  if (const float most = std::max({l.emission.x, l.emission.y, l.emission.z}); most > 0) {
    m["emissiveFactor"] = numbers(l.emission * (1 / std::max(1.f, most)));
    if (most > 1) extensions["KHR_materials_emissive_strength"]["emissiveStrength"] = most;
  }
  if (!opaque) m["alphaMode"] = l.alpha == MaterialLook::Alpha::mask ? "MASK" : "BLEND";
  if (l.alpha == MaterialLook::Alpha::mask) m["alphaCutoff"] = l.alpha_cutoff;
  if (l.ior != 1.5f) extensions["KHR_materials_ior"]["ior"] = l.ior;
  if (l.transmission > 0) {
    extensions["KHR_materials_transmission"]["transmissionFactor"] = l.transmission;
    if (!l.thin) {
      OrderedJson& body = extensions["KHR_materials_volume"];
      body["thicknessFactor"] = 1, body["attenuationColor"] = numbers(l.attenuation_color);
      if (l.attenuation_distance > 0) body["attenuationDistance"] = l.attenuation_distance;
    }
  }
  if (l.coat > 0) {
    OrderedJson& coated = extensions["KHR_materials_clearcoat"];
    coated["clearcoatFactor"] = l.coat, coated["clearcoatRoughnessFactor"] = l.coat_roughness;
  }
  m["pbrMetallicRoughness"] = std::move(pbr);
  m["doubleSided"] = true;  // surfaces of data have no back
  for (const auto& [extension, words] : extensions.items()) use(extension.c_str());
  if (!extensions.empty()) m["extensions"] = std::move(extensions);
  return m;
}

int GltfMaterialWriter::add(const MaterialLook& look, const std::string& name, const std::vector<std::string>& coordinates) {
  OrderedJson m;
  if (!name.empty()) m["name"] = name;
  m.update(document_->material(look, coordinates));
  auto& known = document_->materials;
  const auto [at, fresh] = known.try_emplace(m.dump(-1, ' ', false, OrderedJson::error_handler_t::replace), int(known.size()));
  if (fresh) document_->root["materials"].push_back(std::move(m));
  return at->second;
}

}  // namespace sg
