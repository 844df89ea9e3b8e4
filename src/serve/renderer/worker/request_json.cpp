// SPDX-License-Identifier: Apache-2.0
#include "serve/renderer/worker/request_json.h"

#include "serve/renderer/tell.h"

namespace sg::serve {

namespace {

Json area_json(const std::array<int, 4>& area) {
  std::vector<Json> list;
  for (const int a : area) list.emplace_back(int64_t(a));
  return Json(std::move(list));
}

std::array<int, 4> area_from(const Json& json) {
  std::array<int, 4> area;
  for (size_t i = 0; i < 4; ++i) area[i] = int(json[i].number());
  return area;
}

}  // namespace

Json request_json(const DrawRequest& r) {
  return Json(Json::Members{{"view", Json(int64_t(r.view))},
                            {"width", Json(int64_t(r.width))},
                            {"height", Json(int64_t(r.height))},
                            {"camera", r.camera ? camera_json(*r.camera) : Json()},
                            {"part", r.part ? area_json(*r.part) : Json()},
                            {"quality", Json(int64_t(r.quality))}});
}

DrawRequest request_from(const Json& json) {
  DrawRequest r;
  r.view = int(json["view"].number()), r.width = int(json["width"].number()), r.height = int(json["height"].number());
  r.camera = stated_camera(json);
  if (!json["part"].is_null()) r.part = area_from(json["part"]);
  r.quality = Quality(int(json["quality"].number()));
  return r;
}

Json drawn_json(const DrawnView& d) {
  return Json(Json::Members{{"width", Json(int64_t(d.width))},
                            {"height", Json(int64_t(d.height))},
                            {"type", text(d.type)},
                            {"camera", camera_json(d.camera)},
                            {"part", Json(d.part)},
                            {"area", area_json(d.area)},
                            {"coarse", Json(d.coarse)},
                            {"seconds", Json(d.seconds)},
                            {"told", text(d.told)}});
}

DrawnView drawn_from(const Json& json, std::string bytes) {
  DrawnView d;
  d.width = int(json["width"].number()), d.height = int(json["height"].number()), d.type = json["type"].text();
  d.camera = camera_from(json["camera"]);
  d.part = json["part"].boolean();
  d.area = area_from(json["area"]);
  d.coarse = json["coarse"].number(), d.seconds = json["seconds"].number();
  d.told = json["told"].text();
  d.bytes = std::make_shared<const std::string>(std::move(bytes));
  return d;
}

}  // namespace sg::serve
