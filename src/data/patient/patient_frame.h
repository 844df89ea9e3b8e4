// SPDX-License-Identifier: Apache-2.0
// The patient frame: one set of axes for every scan, whatever its file uses. +x points to the patient's left, +y to the back (posterior),
// +z to the head (superior): LPS, the frame of DICOM and ITK. Readers turn positions, vectors and tensors into it, writers out of it
// (docs/decisions/0019-one-patient-frame.md).
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "data/dataset.h"

namespace sg {

/// The value of the note "space" of a dataset whose positions are in the patient frame.
inline constexpr std::string_view patient_space = "left-posterior-superior";
/// The note that tells the frame of the file, where that is another one.
inline constexpr std::string_view stored_space_note = "space in the file";

/// The note "space" of a dataset; empty when it has none.
std::string_view stated_space(const Dataset& data);
/// Are the positions of this dataset in the patient frame?
inline bool in_patient_frame(const Dataset& data) { return stated_space(data) == patient_space; }

/// A frame of a patient whose axes lie along those of ours: +1 or -1 for each of them.
struct PatientAxes {
  Vec3 sign{1, 1, 1};
  Mat3 matrix() const {
    Mat3 m;
    for (int a = 0; a < 3; ++a) m.m[a][a] = sign[a];
    return m;
  }
};
/// From NRRD's words, in any case: "right-anterior-superior", "RAS", "left-posterior-superior-time", "LPST"... Nothing for spaces that are
/// not a patient's.
std::optional<PatientAxes> patient_axes(std::string_view space);

/// Turns a grid from those axes into the patient frame, or back: it is its own inverse.
void turn(UniformGrid& grid, const PatientAxes& axes);
/// Vectors v, normals and tensors D (nine numbers, row by row) measured along other axes: they become A v and A D A^T. Other fields stay as
/// they are, and so do all values for the unit matrix; else they become floating point.
void turn(Field& field, const Mat3& a);

/// Notes that the positions are in the patient frame, and `stored`, the frame of the file, where that is another one.
void note_patient_frame(DatasetParts& parts, std::string_view stored = patient_space);

/// Where a direction of the patient frame leads, most important first: "L", "PR", "SAL". Letters: Right Left, Anterior Posterior, Inferior
/// Superior; directions with less than three eighths of the length are left out.
std::string patient_letters(Vec3 direction);
/// Where the three axes of a grid lead, one letter each: "LPS" for one along the frame. Axes at equal angles between two choices take the
/// first that is free in the order of the frame's axes.
std::string axis_letters(const Mat3& direction);

}  // namespace sg
