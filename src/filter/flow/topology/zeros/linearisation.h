// SPDX-License-Identifier: Apache-2.0
// The flow near a critical point: eigenvalues, eigenvectors, class and index of its velocity gradient (Helman, Hesselink 1991).
#pragma once
#include <array>
#include <cstdint>
#include <string_view>

#include "base/vec.h"

namespace sg {

/// "in" counts directions along which the flow comes (negative real parts), "out" those along which it leaves. Saddles of planes are
/// `saddle`; the others of that name are solid. Numbers are those of the field "type".
enum class CriticalType : uint8_t {
  degenerate,  ///< an eigenvalue is zero: the gradient does not decide
  saddle,
  attracting_node,
  repelling_node,
  attracting_focus,
  repelling_focus,
  centre,
  saddle_1_in,  ///< 1 in, 2 out
  saddle_2_in,
  spiral_saddle_1_in,  ///< 1 in, spiralling out in a plane
  spiral_saddle_2_in
};
constexpr int critical_types = 11;
/// "saddle", "attracting node", ...
std::string_view critical_type_name(CriticalType t);
inline bool is_saddle(CriticalType t) { return t == CriticalType::saddle || t >= CriticalType::saddle_1_in; }
inline bool is_attracting(CriticalType t) { return t == CriticalType::attracting_node || t == CriticalType::attracting_focus; }
inline bool is_repelling(CriticalType t) { return t == CriticalType::repelling_node || t == CriticalType::repelling_focus; }

/// Eigenvalues in descending order of their real parts, complex pairs side by side, the one of positive imaginary part first.
/// Vectors have length 1; those of a complex pair are the real and the imaginary part of the eigenvector of the first.
struct Linearisation {
  int count = 0;  ///< 2 or 3
  std::array<double, 3> re{}, im{};
  std::array<Vec3, 3> vector{};
  CriticalType type = CriticalType::degenerate;
  int index = 0;  ///< sign of the determinant; 0 when degenerate
};

/// `gradient` m[i][j] = dv_i/dx_j. A complex pair whose real part is at most `centre` times its imaginary part is a centre.
Linearisation linearise(const Mat3& gradient, double centre = 1e-3);
/// The same within the plane of the unit vectors e1 and e2.
Linearisation linearise_in_plane(const Mat3& gradient, Vec3 e1, Vec3 e2, double centre = 1e-3);

}  // namespace sg
