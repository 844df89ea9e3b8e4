// SPDX-License-Identifier: Apache-2.0
// Surfaces and point clouds as glTF 2.0: one node and mesh per dataset, with a primitive for its triangles, lines and vertices each.
// Triangles of materials that the data have looks of are a primitive for each. Point fields other than normals, texture coordinates and
// colours become attributes _NAME; glTF has no cell fields. A .gltf holds its buffer as a data: URI.
#include <fmt/core.h>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/file/file.h"
#include "data/fields/label_names.h"
#include "data/fields/material_numbers.h"
#include "data/fields/texture_coordinates.h"
#include "io/formats.h"
#include "io/gltf/gltf_bytes.h"
#include "io/gltf/gltf_write_materials.h"
#include "io/surface/surface_parts.h"
#include "io/write_losses.h"

namespace sg {

namespace {

using OrderedJson = nlohmann::ordered_json;

int component_type(ElementType t) {
  switch (t) {
    case ElementType::i8: return 5120;
    case ElementType::u8: return 5121;
    case ElementType::i16: return 5122;
    case ElementType::u16: return 5123;
    case ElementType::u32: return 5125;
    default: return 5126;
  }
}

// Attributes are 8 and 16 bit integers or f32.
ElementType as_attribute_type(ElementType t) { return !is_float(t) && element_size(t) <= 2 ? t : ElementType::f32; }

Array as_attribute(const Array& a) { return a.converted(as_attribute_type(a.type())).made_packed(); }

// Another field may have been given the name already: a component of 'T' that of 'T_0'.
std::string free_key(const OrderedJson& attributes, std::string key) {
  while (attributes.contains(key)) key += '_';
  return key;
}

/// The triangles of each material.
std::map<int64_t, std::vector<int64_t>> triangles_by_number(const SurfaceMesh& mesh, const Field& numbers) {
  std::map<int64_t, std::vector<int64_t>> all;
  const PolygonList p = surface_polygons(mesh);
  for (size_t c = 0; c < p.source.size(); ++c) {
    std::vector<int64_t>& t = all[material_number(numbers, p.source[c])];
    for (size_t k = p.offsets[c] + 2; k < p.offsets[c + 1]; ++k) t.insert(t.end(), {p.ids[p.offsets[c]], p.ids[k - 1], p.ids[k]});
  }
  return all;
}

struct Writer {
  const std::string& path;
  Context& context;
  WriteLosses& losses;
  OrderedJson root;
  std::string bytes{};
  GltfMaterialWriter materials{[this](std::string_view picture) { return put_bytes(picture); }, losses};

  /// A view of bytes that are no numbers.
  size_t put_bytes(std::string_view some) {
    while (bytes.size() % 4) bytes += '\0';
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", some.size()}});
    bytes += some;
    return root["bufferViews"].size() - 1;
  }

  // Elements padded to multiples of four bytes; returns the accessor.
  int put(const Array& a, int target, bool normalized = false, bool with_range = false) {
    const size_t size = element_size(a.type()) * size_t(a.components()), stride = target == 34962 ? (size + 3) / 4 * 4 : size;
    while (bytes.size() % 4) bytes += '\0';
    const size_t begin = bytes.size();
    for (size_t i = 0; i < a.count(); ++i) {
      bytes.append(reinterpret_cast<const char*>(a.raw()) + i * size, size);
      bytes.append(stride - size, '\0');
    }
    OrderedJson view = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size() - begin}};
    if (target == 34962) view["byteStride"] = stride;
    view["target"] = target;
    root["bufferViews"].push_back(view);
    const char* shape = a.components() == 1 ? "SCALAR" : a.components() == 2 ? "VEC2" : a.components() == 3 ? "VEC3" : "VEC4";
    OrderedJson accessor = {
        {"bufferView", root["bufferViews"].size() - 1}, {"componentType", component_type(a.type())}, {"count", a.count()}, {"type", shape}};
    if (normalized) accessor["normalized"] = true;
    if (with_range) {
      OrderedJson lo, hi;
      const FieldStats s = field_stats(a);
      for (const Range& r : s.range) lo.push_back(r.empty() ? 0 : r.lo), hi.push_back(r.empty() ? 0 : r.hi);
      accessor["min"] = lo, accessor["max"] = hi;
    }
    root["accessors"].push_back(accessor);
    return int(root["accessors"].size()) - 1;
  }

  int put_indices(const std::vector<int64_t>& ids, size_t points) {
    if (points < 65535) return put(Array::from_vector(std::vector<uint16_t>(ids.begin(), ids.end())), 34963);
    return put(Array::from_vector(std::vector<uint32_t>(ids.begin(), ids.end())), 34963);
  }

  /// `coordinates` receives the fields that become TEXCOORD_0, _1, ...; `drawn`: the numbers of materials that are written, or null.
  OrderedJson attributes(const Dataset& d, const Points& points, const Field* drawn, std::vector<std::string>& coordinates) {
    OrderedJson r;
    if (!survives(points.xyz, ElementType::f32)) losses.rounds("positions", points.xyz.type(), ElementType::f32);
    r["POSITION"] = put(points.xyz.converted(ElementType::f32), 34962, false, true);
    int colors = 0;
    for (const Field& f : d.fields()) {
      if (f.association != Association::point) {
        const bool in_materials =
            drawn && (&f == drawn || f.name == "BaseColor" || f.name == "BaseColorMultiplier" || f.name == "MaterialColors");
        if (!in_materials) losses.leaves_out(f);
        continue;
      }
      losses.drops_unit(f);
      const int n = f.components();
      const bool byte = f.array.type() == ElementType::u8;
      if (f.role == Role::normals && n == 3 && !r.contains("NORMAL")) {
        losses.renames(f, "NORMAL"), losses.rounds(f, ElementType::f32);
        r["NORMAL"] = put(f.array.converted(ElementType::f32), 34962);
      } else if (f.role == Role::tcoords && n == 2) {
        const std::string key = fmt::format("TEXCOORD_{}", coordinates.size());
        losses.renames(f, key), losses.rounds(f, ElementType::f32);
        coordinates.push_back(f.name);
        r[key] = put(runs_down(f.name) ? f.array.converted(ElementType::f32) : turned_round(f.array), 34962);
      } else if (f.role == Role::colors && (n == 3 || n == 4) && (byte || is_float(f.array.type()))) {
        losses.renames(f, fmt::format("COLOR_{}", colors));
        if (!byte) losses.rounds(f, ElementType::f32);
        r[fmt::format("COLOR_{}", colors++)] = put(byte ? f.array.made_packed() : f.array.converted(ElementType::f32), 34962, byte);
      } else if (n <= 4) {
        losses.rounds(f, as_attribute_type(f.array.type()));
        const std::string key = free_key(r, "_" + f.name);
        losses.renames(f, key.substr(1));
        r[key] = put(as_attribute(f.array), 34962);
      } else {
        losses.splits(f), losses.rounds(f, as_attribute_type(f.array.type()));
        for (int c = 0; c < n; ++c) r[free_key(r, fmt::format("_{}_{}", f.name, c))] = put(as_attribute(f.array.component(c)), 34962);
      }
    }
    return r;
  }

  void add(const std::string& name, const Dataset& d) {
    const auto* cloud = d.as<PointCloud>();
    const Points& points = cloud ? cloud->points : surface_to_write(d, "glTF", path).points;
    const size_t n = points.count();
    if (n == 0) return context.warn(fmt::format("{}: '{}' has no points and is left out", path, name));
    OrderedJson primitives;
    const Field* numbers = cloud ? nullptr : material_numbers(d);
    std::vector<std::string> coordinates;
    const OrderedJson of_points = attributes(d, points, numbers, coordinates);
    auto primitive = [&](int mode, const std::vector<int64_t>& ids, std::optional<int> material = {}) {
      if (ids.empty()) return;
      primitives.push_back({{"attributes", of_points}, {"indices", put_indices(ids, n)}, {"mode", mode}});
      if (material) primitives.back()["material"] = *material;
    };
    if (!cloud) {
      const auto& mesh = *d.as<SurfaceMesh>();
      std::vector<int64_t> ids;
      const CellsView lines = cells_view(mesh.lines), vertices = cells_view(mesh.vertices);
      if (numbers) {
        std::map<double, std::string> names;
        for (const auto& [note, text] : d.notes())
          if (note == "labels of " + numbers->name) names = names_in_note(text);
        for (const auto& [number, triangles] : triangles_by_number(mesh, *numbers)) {
          const auto look = numbers->materials->looks.find(number);
          const auto name = names.find(double(number));
          primitive(4, triangles,
                    look == numbers->materials->looks.end()
                        ? std::nullopt
                        : std::optional(materials.add(look->second, name == names.end() ? "" : name->second, coordinates)));
        }
      } else {
        primitive(4, surface_triangles(mesh));
      }
      for (size_t c = 0; c < lines.count; ++c)
        for (size_t k = 1; k < lines.size(c); ++k) ids.insert(ids.end(), {lines.point(c, k - 1), lines.point(c, k)});
      primitive(1, ids);
      ids.clear();
      for (size_t c = 0; c < vertices.count; ++c)
        for (size_t k = 0; k < vertices.size(c); ++k) ids.push_back(vertices.point(c, k));
      primitive(0, ids);
    }
    if (primitives.empty()) primitives.push_back({{"attributes", of_points}, {"mode", 0}});
    root["meshes"].push_back({{"primitives", primitives}});
    OrderedJson node = {{"mesh", root["meshes"].size() - 1}};
    if (!name.empty()) node["name"] = name;
    const Vec3 o = points.origin;
    if (!(o == Vec3())) node["translation"] = {o.x, o.y, o.z};
    root["nodes"].push_back(node);
    root["scenes"][0]["nodes"].push_back(root["nodes"].size() - 1);
  }
};

void append_word(std::string& s, uint32_t v) { s.append(reinterpret_cast<const char*>(&v), 4); }

}  // namespace

void write_gltf(const std::string& path, const Data& data, const WriteOptions&, Context& context) {
  WriteLosses losses(path, "glTF");
  Writer w{path, context, losses, {{"asset", {{"version", "2.0"}, {"generator", "sightglass"}}}, {"scene", 0}}};
  for_each_dataset(data, [&](const std::string& name, const DatasetPtr& d) { w.add(name, *d); });
  if (w.root["meshes"].empty()) fail_usage("there is no surface to write", path);
  w.root.update(OrderedJson::parse(w.materials.text()));
  losses.tell(context);
  while (w.bytes.size() % 4) w.bytes += '\0';
  OrderedJson buffer = {{"byteLength", w.bytes.size()}};
  const bool binary = extension_of(path) == "glb";
  if (!binary) buffer["uri"] = "data:application/octet-stream;base64," + to_base64(w.bytes);
  w.root["buffers"].push_back(buffer);
  std::string json = w.root.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
  if (!binary) return write_file(path, json);
  while (json.size() % 4) json += ' ';
  if (w.bytes.size() + json.size() > UINT32_MAX - 28)
    fail_usage(fmt::format("{} bytes do not fit into one .glb file", w.bytes.size()), path, "its limit is 4 GiB; write .vtp instead");
  std::string head = "glTF";
  for (const size_t v : {size_t(2), 28 + json.size() + w.bytes.size(), json.size()}) append_word(head, uint32_t(v));
  head += "JSON" + json;
  append_word(head, uint32_t(w.bytes.size()));
  head.append("BIN\0", 4);
  AtomicFile file(path);
  file.write(head);
  file.write(w.bytes);
  file.commit();
}

}  // namespace sg
