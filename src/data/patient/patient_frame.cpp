// SPDX-License-Identifier: Apache-2.0
#include "data/patient/patient_frame.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/text/text.h"

namespace sg {

namespace {

constexpr char to_low[] = {'R', 'A', 'I'}, to_high[] = {'L', 'P', 'S'};

char letter_of(int axis, double towards) { return towards < 0 ? to_low[axis] : to_high[axis]; }

// m * v, where zeros of m pass over what is not finite.
template <class T>
void times(const double (&m)[3][3], const T v[3], T out[3]) {
  for (int r = 0; r < 3; ++r) {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      if (m[r][c] != 0) sum += m[r][c] * double(v[c]);
    out[r] = T(sum);
  }
}

}  // namespace

std::string_view stated_space(const Dataset& data) {
  for (const auto& [key, value] : data.notes())
    if (key == "space") return value;
  return {};
}

std::optional<PatientAxes> patient_axes(std::string_view space) {
  std::string s = to_lower(trim(space));
  if (s.ends_with("-time")) s.resize(s.size() - 5);
  else if (s.size() == 4 && s.back() == 't') s.pop_back();
  if (s == "right-anterior-superior" || s == "ras") return PatientAxes{{-1, -1, 1}};
  if (s == "left-anterior-superior" || s == "las") return PatientAxes{{1, -1, 1}};
  if (s == patient_space || s == "lps") return PatientAxes{};
  return {};
}

void turn(UniformGrid& grid, const PatientAxes& axes) {
  for (int r = 0; r < 3; ++r) {
    if (axes.sign[r] > 0) continue;
    // 0 - x: a zero stays one without a sign.
    grid.origin[r] = 0 - grid.origin[r];
    for (int a = 0; a < 3; ++a) grid.direction.m[r][a] = 0 - grid.direction.m[r][a];
  }
}

void turn(Field& field, const Mat3& m) {
  const int n = field.components();
  const bool vector = n == 3 && (field.role == Role::vectors || field.role == Role::normals);
  const bool tensor = n == 9 && field.role == Role::tensors;
  if ((!vector && !tensor) || m == Mat3()) return;
  const auto turned = [&](const Array& in, auto zero) {
    using T = decltype(zero);
    const auto v = in.view<T>();
    T* out = nullptr;
    Array r = Array::make<T>(v.count, n, &out);
    parallel_for(v.count, 1 << 15, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        T a[9], b[9];
        for (int c = 0; c < n; ++c) a[c] = v(i, c);
        T* to = out + i * size_t(n);
        if (vector) {
          times(m.m, a, to);
          continue;
        }
        // A D^T, transposed: D A^T; then A times its columns.
        for (int row = 0; row < 3; ++row) times(m.m, a + 3 * row, b + 3 * row);
        for (int c = 0; c < 3; ++c) {
          const T column[3] = {b[c], b[3 + c], b[6 + c]};
          T result[3];
          times(m.m, column, result);
          for (int row = 0; row < 3; ++row) to[3 * row + c] = result[row];
        }
      }
    });
    return r;
  };
  const Array& a = field.array;
  const bool wide = a.type() == ElementType::f64 || (!is_float(a.type()) && element_size(a.type()) > 2);
  field.array = wide ? turned(a.converted(ElementType::f64), 0.0) : turned(a.converted(ElementType::f32), 0.0f);
}

void note_patient_frame(DatasetParts& parts, std::string_view stored) {
  auto& notes = parts.notes;
  notes.erase(std::remove_if(notes.begin(), notes.end(), [](const auto& n) { return n.first == "space" || n.first == stored_space_note; }),
              notes.end());
  notes.emplace_back("space", patient_space);
  if (stored != patient_space) notes.emplace_back(stored_space_note, stored);
}

std::string patient_letters(Vec3 direction) {
  constexpr double least = 0.375;
  const double l = length(direction);
  if (!(l > 0) || !std::isfinite(l)) return "";
  int order[3] = {0, 1, 2};
  std::stable_sort(order, order + 3, [&](int a, int b) { return std::abs(direction[a]) > std::abs(direction[b]); });
  std::string letters;
  for (const int a : order)
    if (std::abs(direction[a]) >= least * l) letters += letter_of(a, direction[a]);
  return letters;
}

std::string axis_letters(const Mat3& direction) {
  std::string letters(3, '?');
  bool used_row[3] = {}, used_column[3] = {};
  for (int n = 0; n < 3; ++n) {
    int row = -1, column = -1;
    for (int a = 0; a < 3; ++a)
      for (int r = 0; r < 3; ++r)
        if (!used_row[r] && !used_column[a] && (row < 0 || std::abs(direction.m[r][a]) > std::abs(direction.m[row][column]) + 1e-12))
          row = r, column = a;
    used_row[row] = used_column[column] = true;
    letters[size_t(column)] = letter_of(row, direction.m[row][column]);
  }
  return letters;
}

}  // namespace sg
