// SPDX-License-Identifier: Apache-2.0
#include "base/text/alike_notes.h"

#include "support/test.h"

using namespace sg;

namespace {

std::vector<std::string> told(const std::vector<std::string>& texts, LogLevel wanted = LogLevel::info) {
  AlikeNotes notes;
  for (const std::string& t : texts) notes.add(LogLevel::info, t);
  std::vector<std::string> out;
  Context context;
  context.on_log = [&](LogLevel level, std::string_view text) {
    if (level == wanted) out.emplace_back(text);
  };
  notes.tell(context);
  return out;
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("alike notes: what differs in numbers alone is told once, in its order, the rest for those who ask") {
  const Lines texts = {"3 reversed", "of 39 points -1.5e-7 lie", "3 reversed", "4 reversed", "of 9 points 2.25 lie", "12 reversed"};
  CHECK(told(texts) == Lines{"3 reversed (2 more of this kind, with other numbers)",
                             "of 39 points -1.5e-7 lie (1 more of this kind, with other numbers)"});
  CHECK(told(texts, LogLevel::debug) == Lines{"4 reversed", "12 reversed", "of 9 points 2.25 lie"});
}

TEST_CASE("alike notes: names are no numbers, levels are told apart") {
  CHECK(told({"field 'u1' is flat", "field 'u2' is flat"}).size() == 2);
  CHECK(told({"lambda2 is flat", "lambda3 is flat"}).size() == 2);
  CHECK(told({"3 lines.", "4 lines.", "5 points."}).size() == 2);
  AlikeNotes notes;
  notes.add(LogLevel::info, "1 x"), notes.add(LogLevel::warning, "2 x");
  int count = 0;
  Context context;
  context.on_log = [&](LogLevel, std::string_view text) {
    ++count;
    CHECK(text.find("more") == text.npos);
  };
  notes.tell(context);
  CHECK(count == 2);
}
