// SPDX-License-Identifier: Apache-2.0
// One pipeline, the windows that look at it, and the pictures that they get (docs/protocol.md).
#pragma once
#include <array>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/context.h"
#include "pipeline/film/film_times.h"
#include "serve/door/session_host.h"
#include "serve/renderer/renderer.h"
#include "serve/renderer/view_camera.h"
#include "serve/session/client.h"
#include "serve/session/edits/edits.h"
#include "serve/session/history.h"
#include "serve/session/questions/question_queue.h"
#include "serve/session/work.h"

namespace sg::serve {

/// One thread draws; another runs what was edited, and does what has waited too long while the first one had to draw what moves; others
/// answer questions (questions/lane.h). Messages are taken in by whichever thread has them. Ends with its last owner.
class Session : public std::enable_shared_from_this<Session> {
 public:
  /// `title`: of the window, and of pictures that are saved. `pictures_in`: the folder from which recipes in those name files; "": they
  /// name them absolutely. `longest`: that reading what is opened, a picture, question, picture to save or edit may take; 0: any time.
  static std::shared_ptr<Session> open(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title,
                                       std::string pictures_in = "", std::chrono::milliseconds longest = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  SocketHandler join(Rights rights, const std::string& user, std::shared_ptr<Socket> socket);
  size_t clients() const;
  std::optional<Saved> saved(const std::string& id) const;

 private:
  using Moment = Work::Moment;
  using ClientView = std::pair<Client*, WantedView*>;

  // Something that changes the pipeline, as it came.
  struct Change {
    int client;
    Json message;
    size_t bytes = 0;  ///< of the message as it came
  };
  // What the renderer has, as the last state told it.
  struct Loaded {
    PipelineFile file;
    std::optional<FilmTimes> film;
    std::optional<size_t> time;
  };

  Session(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title, std::string pictures_in,
          std::chrono::milliseconds longest);
  void take_message(int client, std::string_view text);
  void leave(int client);
  void draw_thread();
  void patient_thread();
  void ask_thread(size_t which);
  void clock_thread();

  // With the mutex held; those that take the lock let go of it while they work.
  void take_draw(Client& client, const Json& message);
  void take_cursor(Client& client, const Json& message);
  void make_change(const Change& change);
  void load(std::unique_lock<std::mutex>& lock);
  void tell(std::unique_lock<std::mutex>& lock, Work& work);
  void warm_up(std::unique_lock<std::mutex>& lock);
  std::vector<int> forgettable();
  bool settled() const;
  ClientView next_view(Quality best);
  ClientView waiting_view();
  void draw(std::unique_lock<std::mutex>& lock, Work& work, ClientView which);
  void send_finer(int client, const DrawnView& drawn, const WantedView& view, uint64_t revision);  // takes the mutex itself
  void answer(std::unique_lock<std::mutex>& lock, Work& work, const Question& question);
  void answer_next_time(std::unique_lock<std::mutex>& lock, Work& work, Question question);
  Saved save(const Json& question, const Loaded& loaded, Context& context);  // without the mutex
  void restart_views();
  void interrupt(int view);
  void make_way();
  void send(int client, const Json::Members& message);
  void send_all(const Json::Members& message);
  void refuse(int client, uint64_t n, const std::vector<EditMistake>& mistakes);
  void tell_people();
  void take_together(Client& client, const Json& message);
  Context& begin(Work& work, Work::Kind kind, int client = 0, std::chrono::steady_clock::duration spent = {});
  void end(Work& work);
  std::vector<Work*> works();
  bool has_room(int client, size_t bytes) const;

  std::unique_ptr<Renderer> renderer_;
  const std::string title_, pictures_in_;
  const std::chrono::milliseconds longest_;

  mutable std::mutex mutex_;
  std::condition_variable work_, questions_wait_, clock_;
  bool stopping_ = false;
  int next_client_ = 1;
  std::map<int, std::unique_ptr<Client>> clients_;
  std::deque<Change> changes_;
  QuestionQueue questions_;
  std::vector<int> left_;  ///< views of the renderer whose windows have gone

  History history_;
  PipelineFile good_;  ///< the last one that could be loaded
  Change last_change_{0, Json(), 0};
  bool live_ = false;       ///< the last edit was one of a drag that may go on
  Moment rest_at_;          ///< when that drag counts as over
  std::string failed_;      ///< why what was opened could not be read; "": it was, or may be yet
  bool abandoned_ = false;  ///< whoever waited for it has gone
  bool loaded_ = false, needs_load_ = true, needs_tell_ = false, cold_ = true;
  Moment tell_since_;  ///< when what is to be told was there
  uint64_t revision_ = 0;
  std::optional<FilmTimes> film_;
  std::optional<size_t> time_;                 ///< index of the step that is shown; none: what the reader gives
  std::optional<size_t> shown_time_;           ///< that of the revision
  std::string state_;                          ///< the last message "state", without what depends on the window
  Work drawing_, beside_;                      ///< of the thread that draws, and of the patient one beside it
  std::array<Work, answering.size()> asking_;  ///< of those that answer
  std::deque<std::pair<std::string, Saved>> saved_;
  bool together_ = false;             ///< all windows look from where the last one of them went
  std::optional<ViewCamera> common_;  ///< that camera, once one of them has told it
  int leader_ = 0;                    ///< who told it

  std::vector<std::thread> threads_;
};

}  // namespace sg::serve
