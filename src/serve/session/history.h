// SPDX-License-Identifier: Apache-2.0
// The pipelines that a session has had, to be taken back and made again.
#pragma once
#include <string>
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

  /// The next pipeline. After a `live` change the next one of the same `words` takes its place: a drag, ended by one that is not live, is
  /// taken back as a whole. What changes nothing is nothing to be taken back.
  void change(PipelineFile next, bool live, const std::string& words) {
    const bool goes_on = !dragged_.empty() && dragged_ == words, same = next == now_;
    dragged_ = live && (goes_on || !same) ? words : "";
    if (same) return;
    if (!goes_on) {
      before_.push_back(std::move(now_));
      if (before_.size() > most) before_.erase(before_.begin());
    }
    now_ = std::move(next), after_.clear();
  }
  /// The same pipeline with what was chosen from the data, or the one before where the data do not allow it: then there is nothing to be
  /// taken back.
  void complete(PipelineFile completed) {
    now_ = std::move(completed);
    if (!before_.empty() && before_.back() == now_) before_.pop_back(), dragged_.clear();
  }
  void undo() { move(before_, after_); }
  void redo() { move(after_, before_); }

 private:
  static constexpr size_t most = 200;
  void move(std::vector<PipelineFile>& from, std::vector<PipelineFile>& to) {
    if (from.empty()) return;
    to.push_back(std::move(now_)), now_ = std::move(from.back()), from.pop_back(), dragged_.clear();
  }
  PipelineFile now_;
  std::vector<PipelineFile> before_, after_;
  std::string dragged_;  // the words that are being dragged
};

}  // namespace sg::serve
