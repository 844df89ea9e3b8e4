// SPDX-License-Identifier: Apache-2.0
// The thread that answers.
#include "serve/session/session.h"

#include "base/error.h"
#include "serve/guard/token.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/wish.h"
#include "serve/session/limits.h"

namespace sg::serve {

void Session::ask_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (questions_.empty()) {
      questions_wait_.wait(lock);
      continue;
    }
    const Question question = questions_.front();
    questions_.pop_front();
    answer(lock, question);
  }
}

void Session::answer(std::unique_lock<std::mutex>& lock, const Question& question) {
  const Json& m = question.message;
  const Wish wish = wish_of(m).value_or(Wish::probe);
  const auto it = clients_.find(question.client);
  if (it == clients_.end()) return;
  Json asked = m;
  if (wish == Wish::probe) {  // the renderer knows the views of all windows
    Json::Members members = m.members();
    members.emplace_back("view", Json(uint64_t(question.client * most_views + int(m["view"].number()))));
    asked = Json(std::move(members));
  }
  DrawRequest picture;
  asking_ = std::make_unique<Context>();
  lock.unlock();
  Json::Members reply;
  std::string problem;
  std::optional<Saved> saved;
  try {
    if (wish == Wish::save) {
      picture.width = int(m["size"][0].number()), picture.height = int(m["size"][1].number());
      if (!(picture.width >= 1 && picture.height >= 1 && double(picture.width) * picture.height <= most_pixels))
        fail_usage("the size of the picture is out of bounds", "size");
      picture.camera = stated_camera(m);
      std::string stem = title_.substr(0, title_.find('.'));
      const std::string name = (stem.empty() ? "picture" : stem) + ".png";
      saved = Saved{name, "image/png", std::make_shared<const std::string>(renderer_->save(picture, name, *asking_))};
    } else {
      reply = renderer_->answer(asked, *asking_);
    }
  } catch (const std::exception& e) {
    problem = e.what();
  }
  lock.lock();
  asking_.reset();
  if (!problem.empty()) return refuse(question.client, m["n"].whole(), {{"", "", problem}});
  Json::Members message{{"is", text(saved ? "saved" : std::string(word_of(wish)))}, {"n", m["n"]}};
  if (saved) {
    const std::string id = new_token();
    message.insert(message.end(), {{"url", text("/saved/" + id)}, {"name", text(saved->name)}});
    saved_.emplace_back(id, std::move(*saved));
    if (saved_.size() > most_saved) saved_.pop_front();
  }
  message.insert(message.end(), reply.begin(), reply.end());
  send(question.client, message);
}

}  // namespace sg::serve
