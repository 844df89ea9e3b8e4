// SPDX-License-Identifier: Apache-2.0
#include "serve/session/questions/question_queue.h"

#include <algorithm>

#include "serve/session/limits.h"

namespace sg::serve {

bool QuestionQueue::push(Question question) {
  if (question.wish() == Wish::probe)
    std::erase_if(waiting_, [&](const Question& q) {
      return q.client == question.client && q.wish() == Wish::probe && !q.message["keep"].boolean();
    });
  const auto same = [&](const Question& q) { return q.client == question.client; };
  if (!question.curve && size_t(std::count_if(waiting_.begin(), waiting_.end(), same)) >= most_questions) return false;
  waiting_.push_back(std::move(question));
  return true;
}

std::optional<Question> QuestionQueue::pop(Lane lane) {
  auto best = waiting_.end();
  const auto turn = [&](const Question& q) {
    const auto had = turns_.find({q.client, lane});
    return had == turns_.end() ? 0 : had->second;
  };
  for (auto it = waiting_.begin(); it != waiting_.end(); ++it) {
    if (it->lane() != lane || answered_.contains({it->client, lane})) continue;
    if (best == waiting_.end() || turn(*it) < turn(*best)) best = it;
  }
  if (best == waiting_.end()) return std::nullopt;
  std::optional<Question> next = std::move(*best);
  waiting_.erase(best);
  turns_[{next->client, lane}] = ++turn_;
  answered_.insert({next->client, lane});
  return next;
}

void QuestionQueue::done(const Question& question) { answered_.erase({question.client, question.lane()}); }

void QuestionQueue::leave(int client) {
  std::erase_if(waiting_, [&](const Question& q) { return q.client == client; });
  std::erase_if(turns_, [&](const auto& turn) { return turn.first.first == client; });
}

size_t QuestionQueue::bytes(int client) const {
  size_t sum = 0;
  for (const Question& q : waiting_)
    if (q.client == client) sum += q.bytes;
  return sum;
}

}  // namespace sg::serve
