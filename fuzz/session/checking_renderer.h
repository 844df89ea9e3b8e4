// SPDX-License-Identifier: Apache-2.0
// A renderer that has small pipelines and takes every other one as it is, once it has been checked as a command checks it: what edits make
// is tried without what it would cost to run it.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "serve/renderer/local_renderer.h"

namespace sg::fuzz {

/// Called with a promise that was broken; does not return.
using OnBroken = std::function<void(const std::string& promise)>;

class CheckingRenderer : public serve::Renderer {
 public:
  /// `asked` has what steps and looks are asked of loaded, `drawn` what is drawn and looked up in pictures; both may be shared by renderers
  /// that follow each other. `files`: those that may be read.
  CheckingRenderer(std::shared_ptr<serve::LocalRenderer> asked, std::shared_ptr<serve::LocalRenderer> drawn, std::vector<std::string> files,
                   OnBroken broken);
  PipelineFile load(const PipelineFile& pipeline, Context& context) override;
  Json::Members tell(Context& context) override;
  serve::DrawnView draw(const serve::DrawRequest& request, const serve::OnFiner& on_finer, Context& context) override;
  void forget(int view) override;
  Json::Members answer(const Json& question, Context& context) override;
  std::string save(const serve::DrawRequest& request, const std::string& name, Context& context) override;

 private:
  const std::shared_ptr<serve::LocalRenderer> asked_, drawn_;
  const std::vector<std::string> files_;
  const OnBroken broken_;
  PipelineFile loaded_;
};

}  // namespace sg::fuzz
