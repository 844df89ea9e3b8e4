// SPDX-License-Identifier: Apache-2.0
// The pipelines that a session has had, to be taken back and made again.
#pragma once
#include <utility>
#include <vector>

#include "pipeline/file/pipeline_file.h"

namespace sg::serve {

class History {
 public:
  explicit History(PipelineFile first) : now_(std::move(first)) {}
  const PipelineFile& now() const { return now_; }
  bool can_undo() const { return !before_.empty(); }
  bool can_redo() const { return !after_.empty(); }

  /// The next pipeline. A `live` one takes the place of a live one before it: a drag is taken back as a whole.
  void change(PipelineFile next, bool live) {
    if (!(live && live_)) {
      before_.push_back(std::move(now_));
      if (before_.size() > most) before_.erase(before_.begin());
    }
    live_ = live, now_ = std::move(next), after_.clear();
  }
  /// The same pipeline with what was chosen from the data.
  void complete(PipelineFile completed) { now_ = std::move(completed); }
  void undo() { move(before_, after_); }
  void redo() { move(after_, before_); }

 private:
  static constexpr size_t most = 200;
  void move(std::vector<PipelineFile>& from, std::vector<PipelineFile>& to) {
    if (from.empty()) return;
    to.push_back(std::move(now_)), now_ = std::move(from.back()), from.pop_back(), live_ = false;
  }
  PipelineFile now_;
  std::vector<PipelineFile> before_, after_;
  bool live_ = false;
};

}  // namespace sg::serve
