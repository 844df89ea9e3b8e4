// SPDX-License-Identifier: Apache-2.0
#include "serve/support/looking.h"

#include <vector>

#include "pipeline/picture/picture.h"
#include "serve/renderer/local_renderer.h"

namespace sg::test {

PipelineFile parsed(const std::string& text) { return parse_pipeline(text, "", picture_vocabulary()); }

std::shared_ptr<serve::Session> opened(const std::string& text) {
  return serve::Session::open(std::make_unique<serve::LocalRenderer>(64 << 20, std::vector<std::string>{}), parsed(text), "head.vti");
}

std::string Looking::pixels(std::initializer_list<Vec3> places) const {
  std::string words;
  for (const Vec3& p : places) {
    const Vec3 at = projection.to_pixel(p);
    words += (words.empty() ? "[" : ",[") + std::to_string(at.x + x) + "," + std::to_string(at.y + y) + "]";
  }
  return "[" + words + "]";
}

Looking looked(Window& window, const std::string& camera, int view) {
  window.say("{'do':'draw','n':1,'view':" + std::to_string(view) + ",'size':[400,300],'camera':{" + camera + "}}");
  const Shot last = window.frames().back();
  const serve::ViewCamera c = serve::camera_from(last.header["camera"]);
  Camera scene;
  scene.position = c.position, scene.target = c.target, scene.up = c.up, scene.parallel = c.parallel;
  scene.view_angle = c.view_angle, scene.parallel_height = c.height;
  const Json& area = last.header["area"];
  return {make_projection(scene, int(area[2].number()), int(area[3].number())), area[0].number(), area[1].number()};
}

}  // namespace sg::test
