// SPDX-License-Identifier: Apache-2.0
// Draws in this process.
#pragma once
#include <map>
#include <memory>
#include <mutex>

#include "pipeline/picture/prepare.h"
#include "serve/renderer/renderer.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/unfinished.h"

namespace sg::serve {

class LocalRenderer : public Renderer {
 public:
  /// `cache_bytes`: of results that are kept for later edits. `coloring`: of the first pipeline, as PictureOptions::coloring.
  LocalRenderer(uint64_t cache_bytes, std::vector<std::string> coloring);
  PipelineFile load(const PipelineFile& pipeline, Context& context) override;
  Json::Members tell(Context& context) override;
  using Renderer::draw;
  DrawnView draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) override;
  void forget(int view) override;
  Json::Members answer(const Json& question, Context& context) override;
  std::string save(const DrawRequest& request, const std::string& name, Context& context) override;

 private:
  struct Loaded {
    PipelineFile file;
    PreparedPicture prepared;
    uint64_t picture = 0;  ///< number: the same where the same is seen
  };
  // Of the last whole picture of a view: what places are looked up in.
  struct Planes {
    Seen seen;
    Projection projection;
    Rect area;
    int width;
  };
  std::shared_ptr<const Loaded> loaded() const;
  std::shared_ptr<const Planes> planes_of(int view) const;
  DrawnView draw_whole(const Loaded& now, const StatedPicture& stated, const DrawRequest& request, const OnFiner& on_finer,
                       Context& context);
  DrawnView draw_moving(const PreparedPicture& prepared, const StatedPicture& stated, const DrawRequest& request, double& coarse,
                        Context& context);

  std::shared_ptr<Cache> cache_, other_times_;  ///< of what is loaded; of questions over time, which would drive that out
  std::vector<std::string> coloring_;           ///< until a pipeline has it
  std::map<int, double> coarse_;                ///< of the next moving picture of each view; for the thread that draws
  double pace_ = 0;                             ///< of the last one of any view, with which others begin
  Unfinished unfinished_;
  mutable std::mutex mutex_;  ///< for what follows
  std::shared_ptr<const Loaded> loaded_;
  std::map<int, std::shared_ptr<const Planes>> planes_;
  StepSeconds seconds_;
};

}  // namespace sg::serve
