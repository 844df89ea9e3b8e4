// SPDX-License-Identifier: Apache-2.0
#include "checking_renderer.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "base/error.h"
#include "base/text/utf8.h"
#include "pipeline/picture/picture.h"
#include "pipeline/picture/picture_parts.h"
#include "pipeline/picture/scene/picture_scene.h"
#include "scene/show/show.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/wish.h"
#include "serve/session/forbidden.h"

namespace sg::fuzz {

using namespace serve;

namespace {

constexpr int most_pixels = 48 * 48;  // that are drawn

bool is_small(const DrawRequest& r) { return r.width * r.height <= most_pixels; }

}  // namespace

CheckingRenderer::CheckingRenderer(std::shared_ptr<LocalRenderer> asked, std::shared_ptr<LocalRenderer> drawn,
                                   std::vector<std::string> files, OnBroken broken)
    : asked_(std::move(asked)), drawn_(std::move(drawn)), files_(std::move(files)), broken_(std::move(broken)) {}

PipelineFile CheckingRenderer::load(const PipelineFile& pipeline, Context&) {
  for (const std::string& path : files_read(pipeline))
    if (std::find(files_.begin(), files_.end(), path) == files_.end()) broken_("reads " + path);
  const std::string text = emit_pipeline(pipeline);
  if (emit_pipeline(parse_pipeline(text, "", picture_vocabulary())) != text) broken_("a pipeline changes as it is written and read");
  stated_in(pipeline), stated_scene(pipeline);
  for (const PipelineFile::Show& s : pipeline.show)
    if (s.kind != auto_show) show_params(find_show(s.kind), s.words);
  build_graph(pipeline).graph.validate();
  loaded_ = pipeline;
  return pipeline;
}

Json::Members CheckingRenderer::tell(Context&) { return tell_pipeline(loaded_); }

DrawnView CheckingRenderer::draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) {
  if (is_small(request)) return drawn_->draw(request, on_finer, context);
  DrawnView drawn;
  drawn.width = request.width, drawn.height = request.height, drawn.type = "image/png";
  drawn.bytes = std::make_shared<const std::string>("picture");
  if (request.camera) drawn.camera = *request.camera;
  return drawn;
}

void CheckingRenderer::forget(int view) { drawn_->forget(view); }

Json::Members CheckingRenderer::answer(const Json& question, Context& context) {
  const auto wish = wish_of(question);
  if (wish != Wish::over_time) return (wish == Wish::probe || wish == Wish::measures ? drawn_ : asked_)->answer(question, context);
  (void)parse_pipeline(bytes_of_text(question["pipeline"].text()), bytes_of_text(question["origin"].text()), picture_vocabulary());
  return {{"unit", serve::text("")}, {"value", Json(1.0)}};
}

std::string CheckingRenderer::save(const DrawRequest& request, const std::string& name, Context& context) {
  return is_small(request) ? drawn_->save(request, name, context) : "picture";
}

}  // namespace sg::fuzz
