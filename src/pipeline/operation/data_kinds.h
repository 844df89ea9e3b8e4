// SPDX-License-Identifier: Apache-2.0
// The kinds of what flows between operations, as a set that can be stated: the mesh kinds in the order of Mesh, and tables.
#pragma once
#include <array>
#include <cstdint>
#include <string>

#include "base/schema/enum_words.h"
#include "data/dataset.h"

namespace sg {

enum class DataKind : uint8_t { uniform, rectilinear, curvilinear, unstructured, surface, points, amr, table };
constexpr auto enum_words(DataKind) {
  using enum DataKind;
  return std::array{Word{"uniform", uniform},
                    Word{"rectilinear", rectilinear},
                    Word{"curvilinear", curvilinear},
                    Word{"unstructured", unstructured},
                    Word{"surface", surface},
                    Word{"points", points},
                    Word{"amr", amr},
                    Word{"table", table}};
}
constexpr int data_kinds = 8;

inline DataKind kind_of(const Mesh& mesh) { return DataKind(mesh.index()); }
inline DataKind kind_of(const Dataset& dataset) { return kind_of(dataset.mesh()); }

struct KindSet {
  uint16_t bits = 0;

  constexpr KindSet() = default;
  constexpr KindSet(DataKind kind) : bits(uint16_t(1u << unsigned(kind))) {}
  constexpr bool has(DataKind kind) const { return bits >> unsigned(kind) & 1; }
  constexpr bool empty() const { return bits == 0; }
  friend constexpr KindSet operator|(KindSet a, KindSet b) { return of(a.bits | b.bits); }
  friend constexpr KindSet operator&(KindSet a, KindSet b) { return of(a.bits & b.bits); }
  friend constexpr KindSet operator-(KindSet a, KindSet b) { return of(a.bits & ~b.bits); }
  friend constexpr bool operator==(KindSet, KindSet) = default;

 private:
  static constexpr KindSet of(int bits) {
    KindSet s;
    s.bits = uint16_t(bits);
    return s;
  }
};

namespace kinds {
inline constexpr KindSet uniform = DataKind::uniform, rectilinear = DataKind::rectilinear, curvilinear = DataKind::curvilinear,
                         unstructured = DataKind::unstructured, surface = DataKind::surface, points = DataKind::points, amr = DataKind::amr,
                         table = DataKind::table;
inline constexpr KindSet straight = uniform | rectilinear;        ///< grids along straight axes
inline constexpr KindSet lattices = straight | curvilinear;       ///< points in rows, columns and layers
inline constexpr KindSet solids = lattices | unstructured | amr;  ///< may have cells of volume
inline constexpr KindSet with_cells = solids | surface;
inline constexpr KindSet meshes = with_cells | points;
}  // namespace kinds

/// "a uniform grid", "a point cloud", "a table".
std::string_view kind_text(DataKind kind);
/// One of them: "a mesh", "a mesh with cells", "a uniform or rectilinear grid", "a mesh other than an AMR grid", "a surface or a point
/// cloud".
std::string kinds_text(KindSet kinds);

}  // namespace sg
