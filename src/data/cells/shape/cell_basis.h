// SPDX-License-Identifier: Apache-2.0
// Families of shape functions behind CellShape. Internal to src/data.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "base/vec.h"
#include "data/cells/cell_type.h"

namespace sg::basis {

constexpr int max_order = 10;

/// What a lattice cell's functions are products of: simplex(r,s[,t]) of order n[0], or axes of orders n[0..2], or triangle x axis.
enum class Form : uint8_t { box, simplex, wedge };

/// Functions of nodes with lattice places `place` (three numbers a node). `dn` null: values only; `n` null: derivatives only.
void lattice_functions(Form form, bool bernstein, int dimension, std::array<int, 3> orders, std::span<const uint16_t> place, Vec3 rst,
                       double* n, Vec3* dn);

/// A space with as many functions as the cell has nodes: products of powers of six variables.
/// Cells: r, s, t and l = 1-r-s-t (1-r-s on triangles and wedges). Pyramids: u, v in [-1,1] across the section at t, w = 1-t, t,
/// 1-u^2, 1-v^2.
struct Space {
  bool pyramid = false, flat_simplex = false;
  std::vector<std::array<uint8_t, 6>> powers;
};
/// The space of a quadratic cell or pyramid, and the reference places of its nodes; no powers for any other.
Space space_of(CellType type, size_t nodes, std::vector<Vec3>& at);
/// Values (and derivatives unless null) of the space's own functions.
void space_functions(const Space& space, Vec3 rst, double* f, Vec3* df);
/// C with N_k = sum_i C[k][i] f_i, so that N_k(at_j) = [j == k].
std::vector<double> nodal_coefficients(const Space& space, std::span<const Vec3> at);

/// Linear cells, in closed form.
void linear_functions(CellType type, Vec3 rst, double* n, Vec3* dn);

/// Corners of the reference element of a linear type, in its node order.
std::vector<Vec3> reference_corners(CellType linear);

}  // namespace sg::basis
