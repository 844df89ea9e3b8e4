// SPDX-License-Identifier: Apache-2.0
// The fields of VTK XML pieces: which there are, and their numbers, piece after piece.
#include <fmt/core.h>

#include <algorithm>
#include <unordered_map>

#include "base/bytes.h"
#include "base/parallel.h"
#include "base/text/text.h"
#include "io/vtk/vtk_cells.h"
#include "io/vtk/xml/vtk_xml_pieces.h"

namespace sg::vtk {

pugi::xml_node find_array(pugi::xml_node parent, std::string_view name) {
  for (const pugi::xml_node& n : parent.children("DataArray"))
    if (equal_ignoring_case(n.attribute("Name").value(), name)) return n;
  return {};
}

pugi::xml_node need_array(const XmlFile& file, pugi::xml_node parent, std::string_view name) {
  const pugi::xml_node n = find_array(parent, name);
  if (!n) file.fail(fmt::format("has no DataArray '{}'", name), parent, "the file is truncated or not complete");
  return n;
}

pugi::xml_node points_array(const XmlPiece& piece, uint64_t tuples) {
  const pugi::xml_node n = piece.node.child("Points").child("DataArray");
  if (!n) {
    if (tuples == 0) return {};
    piece.file->fail("has no Points", piece.node, "the file is truncated or not complete");
  }
  if (const int components = piece.file->number_type(n).second; components != 3)
    piece.file->fail(fmt::format("has {} coordinates per point", components), n, "3");
  return n;
}

Array read_points(const XmlPiece& piece, uint64_t tuples) {
  const pugi::xml_node n = points_array(piece, tuples);
  return n ? as_coordinates(piece.file->array(n, tuples)) : Array{};
}

namespace {

Role role_of(pugi::xml_node data, std::string_view name) {
  constexpr std::pair<const char*, Role> roles[] = {
      {"Scalars", Role::scalars}, {"Vectors", Role::vectors},      {"Normals", Role::normals},       {"TCoords", Role::tcoords},
      {"Tensors", Role::tensors}, {"GlobalIds", Role::global_ids}, {"PedigreeIds", Role::global_ids}};
  for (const auto& [attribute, role] : roles)
    if (data.attribute(attribute) && name == data.attribute(attribute).value()) return role;
  return Role::none;
}

// VTK keeps it among the information of an array.
std::string unit_of(pugi::xml_node array) {
  const pugi::xml_node key = array.find_child_by_attribute("InformationKey", "name", "UNITS_LABEL");
  return std::string(trim(key.child_value()));
}

// Orders of cells and weights of points shape the mesh, so they are read whatever fields are requested.
bool shapes_mesh(pugi::xml_node data, std::string_view name) {
  for (const char* attribute : {"HigherOrderDegrees", "RationalWeights"})
    if (name == attribute || (data.attribute(attribute) && name == data.attribute(attribute).value())) return true;
  return false;
}

// The numeric arrays among the PointData or CellData of a piece by their names; of several with the same the last one.
class NamedArrays {
 public:
  NamedArrays(const XmlPiece& piece, const char* element) {
    for (const pugi::xml_node& data : piece.node.children(element))
      for (const pugi::xml_node& n : data.children())
        if (XmlFile::is_numeric(n)) by_name_[n.attribute("Name").value()] = n;
  }
  pugi::xml_node find(std::string_view name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? pugi::xml_node() : found->second;
  }

 private:
  std::unordered_map<std::string_view, pugi::xml_node> by_name_;  // names lie in the document
};

}  // namespace

bool is_wanted(const XmlRead& read, std::string_view name) {
  const auto& wanted = read.options.fields;
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), name) != wanted.end();
}

std::vector<XmlField> list_fields(const XmlRead& read, const std::vector<XmlPiece>& pieces, const char* element, Association association) {
  std::vector<XmlField> fields;
  if (pieces.empty()) return fields;
  std::unordered_map<std::string, size_t> places;  // of names in `fields`
  std::vector<NamedArrays> arrays;
  for (const XmlPiece& p : pieces) arrays.emplace_back(p, element);
  auto add = [&](const XmlPiece& piece, pugi::xml_node data, pugi::xml_node n) {
    std::string name = n.attribute("Name").value();
    const auto [type, components] = piece.file->number_type(n);
    XmlField f{{name, association, {}, unit_of(n), role_of(data, name)}, type, components, {}};
    if (name.empty()) {
      f.field.name = fmt::format("unnamed {}", fields.size());
      if (pieces.size() == 1) f.nodes.push_back(n);
      fields.push_back(std::move(f));
      return;
    }
    const auto [at, added] = places.try_emplace(name, fields.size());
    if (added) fields.push_back(std::move(f));
    else fields[at->second] = std::move(f);
  };
  for (const pugi::xml_node& data : pieces[0].node.children(element))
    for (const pugi::xml_node& n : data.children()) {
      if (!XmlFile::is_numeric(n)) continue;  // strings and element types of later versions
      const std::string_view name = n.attribute("Name").value();
      if (is_wanted(read, name) || is_ghost_name(name) || shapes_mesh(data, name)) add(pieces[0], data, n);
    }
  // A ghost array counts even when only some pieces have one.
  for (size_t k = 0; k < pieces.size(); ++k)
    for (const char* ghost : {"vtkGhostType", "vtkGhostLevels"})
      if (const pugi::xml_node n = arrays[k].find(ghost); n && !places.contains(ghost)) add(pieces[k], n.parent(), n);
  std::erase_if(fields, [&](XmlField& f) {
    if (f.nodes.size() == pieces.size()) return false;
    for (size_t k = 0; k < pieces.size(); ++k) {
      const pugi::xml_node n = arrays[k].find(f.field.name);
      const bool fits = n ? pieces[k].file->number_type(n) == std::pair(f.type, f.components) : is_ghost_name(f.field.name);
      if (!fits) {
        read.context.warn(fmt::format("{} array '{}' differs between pieces and is left out", association_name(association), f.field.name));
        return true;
      }
      f.nodes.push_back(n);
    }
    return false;
  });
  return fields;
}

bool header_only(const XmlRead& read, const XmlField& f) {
  return read.options.header_only && !is_ghost_name(f.field.name) && !shapes_mesh(f.nodes[0].parent(), f.field.name);
}

void check_backed(const std::vector<XmlPiece>& pieces, const XmlField& f, size_t tuples) {
  uint64_t most = 0, bytes = 0;
  const XmlFile* last = nullptr;
  for (const XmlPiece& p : pieces) {
    if (p.file != last && !add(most, p.file->most_bytes(), most)) most = UINT64_MAX;
    last = p.file;
  }
  if (!multiply(tuples, uint64_t(f.components) * element_size(f.type), bytes) || bytes > most)
    pieces[0].file->fail(fmt::format("announces {} tuples of {} numbers, more than the files can hold", tuples, f.components), f.nodes[0],
                         "the file is damaged");
}

Array joined_field(const XmlRead& read, const std::vector<XmlPiece>& pieces, const XmlField& f, const std::vector<size_t>& tuples) {
  read.context.check();
  size_t n = 0;
  for (const size_t t : tuples) n += t;
  if (n == 0) {
    std::byte* none = nullptr;
    return Array::make_raw(f.type, 0, f.components, &none);
  }
  if (header_only(read, f)) return check_backed(pieces, f, n), hollow(f.type, n, f.components);
  if (pieces.size() == 1) return pieces[0].file->array(f.nodes[0], tuples[0]);
  check_backed(pieces, f, n);
  // Each piece's numbers go as soon as they are in their place.
  std::byte* out = nullptr;
  Array all = Array::make_raw(f.type, n, f.components, &out);
  const size_t tuple = size_t(f.components) * element_size(f.type);
  for (size_t i = 0; i < pieces.size(); ++i) {
    const size_t bytes = tuples[i] * tuple;
    if (f.nodes[i]) {
      const Array part = pieces[i].file->array(f.nodes[i], tuples[i]).made_packed();
      parallel_for(bytes, size_t(4) << 20, [&](size_t a, size_t b) { std::memcpy(out + a, part.raw() + a, b - a); });
    } else if (bytes > 0) {
      std::memset(out, 0, bytes);
    }
    out += bytes;
  }
  return all;
}

FieldSet read_whole_fields(const XmlRead& read, pugi::xml_node parent) {
  FieldSet fields;
  for (const pugi::xml_node& data : parent.children("FieldData"))
    for (const pugi::xml_node& n : data.children()) {
      if (!XmlFile::is_numeric(n)) continue;
      std::string name = n.attribute("Name").value();
      if (!is_wanted(read, name) && name != "TimeValue") continue;
      std::optional<uint64_t> count;
      if (n.attribute("NumberOfTuples")) count = parse_count(read.file, n, "NumberOfTuples");
      const Role role = role_of(data, name);
      if (name.empty()) name = fmt::format("unnamed {}", fields.size());
      fields.add({std::move(name), Association::whole, read.file.array(n, count), unit_of(n), role});
    }
  return fields;
}

}  // namespace sg::vtk
