// SPDX-License-Identifier: Apache-2.0
#include "io/surface/obj_materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "image/image.h"

namespace sg {

namespace {

using Words = std::vector<std::string_view>;

std::optional<float> number_after(const Words& w, size_t i, double lo, double hi) {
  const auto v = i < w.size() ? parse_double(w[i]) : std::nullopt;
  if (!v || !std::isfinite(*v)) return {};
  return float(std::clamp(*v, lo, hi));
}

/// Three numbers, or one that is a grey. "Kd spectral" and "Kd xyz" have no colour of ours.
std::optional<Vec3f> color_after(const Words& w, double most) {
  const auto r = number_after(w, 1, 0, most), g = w.size() > 3 ? number_after(w, 2, 0, most) : r,
             b = w.size() > 3 ? number_after(w, 3, 0, most) : r;
  if (!r || !g || !b) return {};
  return Vec3f{*r, *g, *b};
}

Vec3f decoded(Vec3f c) { return {srgb_decode(c.x), srgb_decode(c.y), srgb_decode(c.z)}; }

class Library {
 public:
  Library(const std::string& path, std::map<std::string, ObjMaterial>& materials, Context& context)
      : path_(path), materials_(materials), context_(context) {}

  void read(std::string_view text) {
    while (!text.empty()) {
      const size_t end = std::min(text.find('\n'), text.size());
      const std::string_view line = trim(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
      const auto w = words(line.substr(0, line.find('#')));
      if (w.size() < 2) continue;
      if (w[0] == "newmtl") begin(std::string(trim(line.substr(6))));
      else if (now_) statement(w, line);
    }
  }

 private:
  void begin(const std::string& name) {
    now_ = &materials_[name];
    *now_ = {}, states_opacity_ = false;
    now_->look.metallic = 0, now_->look.roughness = 0.5f;
  }

  void statement(const Words& w, std::string_view line) {
    MaterialLook& l = now_->look;
    if (w[0] == "Kd") {
      if (const auto c = color_after(w, 1)) now_->diffuse = *c, l.base_color = decoded(*c);
    } else if (w[0] == "Ke") {
      if (const auto c = color_after(w, 1e6)) l.emission = *c;
    } else if (w[0] == "map_Kd") {
      map(w, line, l.base_picture);
    } else if (w[0] == "map_Ke") {
      map(w, line, l.emission_picture);
    } else if (w[0] == "norm") {
      map(w, line, l.normal_picture);
    } else if (w[0] == "map_Pr" || w[0] == "map_Pm") {
      FactorPicture f{{}, {{w[0] == "map_Pr" ? MaterialFactor::roughness : MaterialFactor::metalness, 0}}};
      map(w, line, f.picture);
      if (f.picture.file) l.factors.push_back(std::move(f)), l.states_matter = true;
    } else if (const auto v = number_after(w, w[1] == "-halo" ? 2 : 1, 0, 1e6)) {
      if (w[0] == "d") opacity(std::min(*v, 1.f)), states_opacity_ = true;
      else if (w[0] == "Tr" && !states_opacity_) opacity(1 - std::min(*v, 1.f));  // some write both, and mean d
      else if (w[0] == "Ns") l.roughness = std::pow(2 / (*v + 2), 0.25f);
      else if (w[0] == "Ni") l.ior = std::clamp(*v, 1.f, 4.f);
      else if (w[0] == "Pr") l.roughness = std::min(*v, 1.f), l.states_matter = true;
      else if (w[0] == "Pm") l.metallic = std::min(*v, 1.f), l.states_matter = true;
      else if (w[0] == "Pc") l.coat = std::min(*v, 1.f);
      else if (w[0] == "Pcr") l.coat_roughness = std::min(*v, 1.f);
    }
  }

  void opacity(float v) {
    now_->look.opacity = v;
    if (v < 1) now_->look.alpha = MaterialLook::Alpha::blend;
  }

  /// map_Kd -s 2 2 1 -o 0 0 0 -clamp on the name, with blanks.png
  void map(const Words& w, std::string_view line, MaterialPicture& p) {
    struct Option {
      std::string_view name;
      size_t most;  ///< numbers or words behind it
    };
    constexpr Option options[] = {{"-blendu", 1}, {"-blendv", 1}, {"-boost", 1}, {"-cc", 1}, {"-clamp", 1}, {"-imfchan", 1},
                                  {"-mm", 2},     {"-texres", 1}, {"-bm", 1},    {"-o", 3},  {"-s", 3},     {"-t", 3}};
    size_t i = 1;
    Vec3f scale{1, 1, 1}, offset;
    while (i + 1 < w.size()) {
      const auto o = std::find_if(std::begin(options), std::end(options), [&](const Option& k) { return k.name == w[i]; });
      if (o == std::end(options)) break;
      size_t n = 0;
      for (++i; n < o->most && i + 1 < w.size() && (o->most == 1 || parse_double(w[i])); ++n, ++i) {
        const float v = number_after(w, i, -1e6, 1e6).value_or(0);
        if (o->name == "-s") scale[int(n)] = v;
        if (o->name == "-o") offset[int(n)] = v;
        if (o->name == "-clamp" && w[i] == "on") p.beyond_u = p.beyond_v = MaterialPicture::Beyond::clamp;
      }
    }
    if (i >= w.size()) return;
    const std::string name(trim(line.substr(size_t(w[i].data() - line.data()))));
    std::string path = name;
    std::replace(path.begin(), path.end(), '\\', '/');
    p.place = {scale.x, 0, offset.x, 0, scale.y, offset.y};
    try {
      const MappedFile file(named_file(path_, path));
      auto picture = std::make_shared<PictureFile>();
      picture->name = name, picture->owner = file.owner(), picture->bytes = {file.data(), file.size()};
      p.file = std::move(picture);
    } catch (const Error& e) {
      context_.warn(fmt::format("{}: a picture on its surface is left out: {}", path_, e.what()));
    }
  }

  bool states_opacity_ = false;
  const std::string& path_;
  std::map<std::string, ObjMaterial>& materials_;
  Context& context_;
  ObjMaterial* now_ = nullptr;
};

}  // namespace

std::map<std::string, ObjMaterial> read_obj_materials(const std::string& obj, std::span<const std::string_view> libraries,
                                                      Context& context) {
  std::map<std::string, ObjMaterial> materials;
  std::vector<std::string> read;
  for (const std::string_view library : libraries) {
    const std::string name(library);
    if (std::find(read.begin(), read.end(), name) != read.end()) continue;
    read.push_back(name);
    try {
      const std::string path = named_file(obj, name);
      const MappedFile file(path);
      Library(path, materials, context).read(file.text());
    } catch (const Error& e) {
      context.warn(fmt::format("{}: its materials have no colours: {}", obj, e.what()));
    }
  }
  // Many programs state black under a picture, or nothing, and mean the picture.
  for (auto& [name, m] : materials) {
    MaterialLook& l = m.look;
    if (l.base_picture.file && l.base_color == Vec3f()) l.base_color = {1, 1, 1};
    if (l.emission_picture.file && l.emission == Vec3f()) l.emission = {1, 1, 1};
  }
  return materials;
}

}  // namespace sg
