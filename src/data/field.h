// SPDX-License-Identifier: Apache-2.0
// Field: a named array on the points, the cells or the whole of a dataset.
#pragma once
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "data/array.h"

namespace sg {

enum class Association : uint8_t { point, cell, whole };
/// "point", "cell", "whole".
std::string_view association_name(Association a);

/// What the file says the array is for; a hint for defaults, never a type.
enum class Role : uint8_t { none, scalars, vectors, normals, tcoords, tensors, colors, global_ids, labels };

/// How a field should be shown, set by the operation that made it: a hint for choosing colours by default.
struct FieldLook {
  /// Which values are to be seen in a volume; fibres: the few that are not zero, as solid strands; zero: the surface where it is 0.
  enum class Shows : uint8_t { any, high, low, fibres, zero } shows = Shows::any;
  bool one_sided = false;  ///< its negative values are not a separate kind: use a sequential map
  bool two_sided = false;  ///< its signs are two kinds, however unequal their ranges
  bool tailed = false;     ///< derivatives: isolated extremes mean little
  bool texture = false;    ///< dark and bright for the colours of another field, in [0, 1] or with both signs
  bool bands = false;      ///< numbers of bands, whose ends are the cell fields "band low" and "band high"
  bool result = false;     ///< the result requested of the operation: preferred for colouring

  friend bool operator==(const FieldLook&, const FieldLook&) = default;
};

struct MaterialTable;

struct Field {
  std::string name;
  Association association = Association::point;
  Array array;
  std::string unit;
  Role role = Role::none;
  FieldLook look = {};
  std::shared_ptr<const MaterialTable> materials = nullptr;  ///< labels of cells: how the numbered materials look (material_table.h)

  int components() const { return array.components(); }
  /// The same field with other numbers, as operations carry it; also on another association.
  Field with(Array numbers) const { return {name, association, std::move(numbers), unit, role, look, materials}; }
  Field with(Array numbers, Association on) const { return {name, on, std::move(numbers), unit, role, look, materials}; }
};

/// The fields of a dataset in file order. Names are unique per association.
class FieldSet {
 public:
  FieldSet() = default;
  FieldSet(const FieldSet&);
  FieldSet(FieldSet&&) noexcept;
  FieldSet& operator=(const FieldSet&);
  FieldSet& operator=(FieldSet&&) noexcept;
  ~FieldSet();

  /// Adds, or replaces the field of the same name and association. A result (FieldLook::result) takes the place of the one before.
  void add(Field f);
  void remove(std::string_view name, Association a);

  const Field* find(std::string_view name, Association a) const;
  /// Point fields first, then cell, then whole.
  const Field* find(std::string_view name) const;
  /// Throws Error(usage) with "did you mean". `association` empty = any.
  const Field& require(std::string_view name) const;
  const Field& require(std::string_view name, Association a) const;
  /// The first field of that role, points first; null when there is none.
  const Field* with_role(Role role) const;
  /// The field with look.result; null when there is none.
  const Field* result() const;
  /// The field an operation takes when none is named: role scalars, else the first point field with `components`
  /// components (0 = any) that is not an id, normal or texture coordinate, else the first such cell field; null when none.
  const Field* active(int components = 1) const;

  std::vector<std::string> names() const;
  std::vector<Field>::const_iterator begin() const { return fields_.begin(); }
  std::vector<Field>::const_iterator end() const { return fields_.end(); }
  size_t size() const { return fields_.size(); }
  bool empty() const { return fields_.empty(); }
  const Field& operator[](size_t i) const { return fields_[i]; }

 private:
  struct Index;
  size_t place_of(std::string_view name, Association a) const;
  std::vector<Field> fields_;
  std::shared_ptr<Index> index_;  ///< places by name, once there are many; copies share it until one of them changes
};

/// Range over the finite values of one component.
struct Range {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  bool empty() const { return !(lo <= hi); }
  void add(const Range& r) {
    if (r.lo < lo) lo = r.lo;
    if (r.hi > hi) hi = r.hi;
  }
  friend bool operator==(const Range&, const Range&) = default;
};

struct FieldStats {
  std::vector<Range> range;  ///< per component, finite values only
  Range magnitude;           ///< of the tuple's length (components > 1), finite tuples only
  uint64_t nan = 0;          ///< numbers that are NaN, all components together
  uint64_t infinite = 0;
};

/// One parallel pass; the result does not depend on the number of threads. `skip` (one per tuple, nonzero = leave out) may be empty.
FieldStats field_stats(const Array& array, bool with_magnitude = false, const Array& skip = {});

}  // namespace sg
