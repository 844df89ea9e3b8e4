// SPDX-License-Identifier: Apache-2.0
#include "io/scan/scan_to_write.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"

namespace sg {

std::string ScanToWrite::note(std::string_view key) const {
  for (const auto& [k, v] : data->notes())
    if (equal_ignoring_case(k, key)) return v;
  return "";
}

std::string ScanToWrite::modality() const {
  std::string word;
  for (const char c : to_lower(trim(note("Modality")))) word += c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c;
  if (word.starts_with("MET_MOD_")) word = word.substr(8);
  if (word.empty() && equal_ignoring_case(field.unit, "HU")) return "CT";
  constexpr size_t most = 16;  // of a DICOM code
  const bool good = word.size() <= most && word != "UNKNOWN" && word != "OTHER" && word != "OT" &&
                    word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") == std::string::npos;
  return good ? word : "";
}

ScanToWrite scan_to_write(const Data& data, const std::string& path, std::string_view format, const PatientAxes& file_axes, Several several,
                          bool keeps_unit, WriteLosses& losses) {
  ScanToWrite scan;
  scan.data = single_dataset(data, fmt::format("writing {}", format));
  const UniformGrid* grid = scan.data->as<UniformGrid>();
  if (!grid)
    fail_usage(fmt::format("{} files hold a uniform grid, not a {} mesh", format, scan.data->kind()), path,
               "resample it first: -f 'resample'");
  scan.field = losses.one_point_field(*scan.data, keeps_unit);
  scan.grid = *grid;
  PatientAxes axes = patient_axes(stated_space(*scan.data)).value_or(PatientAxes());
  for (int a = 0; a < 3; ++a) axes.sign[a] *= file_axes.sign[a];
  turn(scan.grid, axes);
  const bool vectors = several == Several::three_are_vectors && scan.field.components() == 3 && element_size(scan.field.array.type()) > 1;
  if (vectors && !scan.is_colors()) scan.field.role = Role::vectors;
  if (vectors) turn(scan.field, axes.matrix());
  else if (scan.field.role == Role::tensors || scan.field.role == Role::vectors || scan.field.role == Role::normals)
    losses.also(fmt::format("keeps the numbers of '{}' without their axes", scan.field.name));
  return scan;
}

}  // namespace sg
