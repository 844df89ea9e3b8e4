// SPDX-License-Identifier: Apache-2.0
#include "pipeline/operation/data_kinds.h"

#include <vector>

namespace sg {

namespace {

// "a", "a or b", "a, b or c".
std::string listed(const std::vector<std::string_view>& words) {
  std::string r;
  for (size_t i = 0; i < words.size(); ++i) {
    if (i > 0) r += i + 1 < words.size() ? ", " : " or ";
    r += words[i];
  }
  return r;
}

std::vector<DataKind> members(KindSet kinds) {
  std::vector<DataKind> r;
  for (int k = 0; k < data_kinds; ++k)
    if (kinds.has(DataKind(k))) r.push_back(DataKind(k));
  return r;
}

}  // namespace

std::string_view kind_text(DataKind kind) {
  switch (kind) {
    case DataKind::uniform: return "a uniform grid";
    case DataKind::rectilinear: return "a rectilinear grid";
    case DataKind::curvilinear: return "a curvilinear grid";
    case DataKind::unstructured: return "an unstructured mesh";
    case DataKind::surface: return "a surface";
    case DataKind::points: return "a point cloud";
    case DataKind::amr: return "an AMR grid";
    case DataKind::table: return "a table";
  }
  return "";
}

std::string kinds_text(KindSet kinds) {
  const KindSet meshes = kinds & kinds::meshes;
  std::vector<std::string_view> parts;
  const std::vector<DataKind> missing = members(kinds::meshes - meshes);
  std::string first;  // of several kinds by one name
  KindSet named;
  if (meshes == kinds::meshes) first = "a mesh", named = meshes;
  else if (meshes == kinds::with_cells) first = "a mesh with cells", named = meshes;
  else if (missing.size() == 1) first = "a mesh other than " + std::string(kind_text(missing[0])), named = meshes;
  else if ((meshes & kinds::lattices) == kinds::lattices) first = "a uniform, rectilinear or curvilinear grid", named = kinds::lattices;
  else if ((meshes & kinds::straight) == kinds::straight) first = "a uniform or rectilinear grid", named = kinds::straight;
  if (!first.empty()) parts.push_back(first);
  for (const DataKind k : members(kinds - named)) parts.push_back(kind_text(k));
  return listed(parts);
}

}  // namespace sg
