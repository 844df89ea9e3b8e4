// SPDX-License-Identifier: Apache-2.0
// glTF texts of a triangle with cameras and lights about it.
#pragma once
#include <string>

namespace sg::test {

// A triangle about the origin, with further nodes and members of the root.
inline std::string triangle_with(const std::string& nodes, const std::string& roots, const std::string& members) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0)" + roots + R"(]}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0})" +
         nodes + "]" + members + "}";
}
inline const char* const lamps = R"(,"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
  {"type":"point","intensity":40,"color":[1,0.5,0]},{"type":"spot","name":"beam","spot":{"innerConeAngle":0.1,"outerConeAngle":0.5}},
  {"type":"directional","intensity":3},{"type":"point","intensity":-1},{"type":"lava"}]}})";
inline std::string lamp_node(int light, const std::string& more) {
  return R"(,{"extensions":{"KHR_lights_punctual":{"light":)" + std::to_string(light) + "}}" + more + "}";
}

}  // namespace sg::test
