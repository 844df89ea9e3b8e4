// SPDX-License-Identifier: Apache-2.0
// Draws in a process of its own: what exhausts memory or crashes there ends that process, not the server.
#pragma once
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "serve/renderer/renderer.h"
#include "serve/renderer/worker/channel.h"

namespace sg::serve {

/// How workers are started.
struct WorkerOptions {
  std::vector<std::string> command;   ///< program and arguments; the number of the socket's descriptor is added
  std::vector<std::string> coloring;  ///< of the first pipeline, as PictureOptions::coloring
  std::vector<std::string> folders;   ///< nothing is read but what lies below them; none: no fence
  uint64_t memory = 0;                ///< set_memory_limit() there; 0: none
  uint64_t process_memory = 0;        ///< that the whole process may take; 0: any
};
/// With less a worker cannot start.
inline constexpr uint64_t least_worker_memory = uint64_t(256) << 20;

/// Starts a process with the first call, and another one when that has ended: then the call throws Error(data) that says so, and the next
/// one finds the pipeline loaded again.
class WorkerRenderer : public Renderer {
 public:
  explicit WorkerRenderer(WorkerOptions options);
  ~WorkerRenderer() override;
  PipelineFile load(const PipelineFile& pipeline, Context& context) override;
  Json::Members tell(Context& context) override;
  using Renderer::draw;
  DrawnView draw(const DrawRequest& request, const OnFiner& on_finer, Context& context) override;
  void forget(int view) override;
  Json::Members answer(const Json& question, Context& context) override;
  std::string save(const DrawRequest& request, const std::string& name, Context& context) override;

  /// Of the process that works now; 0: none has been started.
  int process() const;

 private:
  struct Process;
  std::shared_ptr<Process> started(Context& context);
  ChannelMessage call(Json::Members message, Context& context);

  const WorkerOptions options_;
  mutable std::mutex mutex_;
  std::shared_ptr<Process> process_;
  Json::Members loaded_;  ///< the last call "load" that went well
};

}  // namespace sg::serve
