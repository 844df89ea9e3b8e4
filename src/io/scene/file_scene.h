// SPDX-License-Identifier: Apache-2.0
// What a file says of a picture besides its data: cameras and lights.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"
#include "base/vec.h"
#include "io/io.h"

namespace sg {

struct FileCamera {
  std::string name;
  Vec3 position, forward, up;  ///< in the data's coordinates; unit
  bool parallel = false;
  double view_angle = 30;  ///< degrees, vertical
  double height = 1;       ///< of what a parallel one sees
};

struct FileLight {
  enum class Shape { point, spot, directional };
  std::string name;
  Shape shape = Shape::point;
  Vec3 position, forward;        ///< forward: where it shines to, unit
  Vec3f color{1, 1, 1};          ///< linear
  double intensity = 1;          ///< candela; of directional ones lux
  double inner = 0, outer = 45;  ///< of spots: degrees from the axis
};

struct FileScene {
  std::vector<FileCamera> cameras;
  std::vector<FileLight> lights;
};

/// Empty for formats that have neither. Throws Error(data) as reading the file does.
FileScene scene_in_file(const std::string& path, const ReadOptions& options, Context& context);

/// Notes of a dataset that name them, one after the other by ", "; of the first dataset of a file alone.
inline constexpr std::string_view cameras_note = "cameras", lights_note = "lights";

}  // namespace sg
